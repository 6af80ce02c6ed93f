#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pliant::internal {

/// Numbers of a run by column, all of one length. The first column is the time [s].
using PageColumns = std::vector<std::vector<double>>;

/// PageColumns as text for a page, which web/src/page_data.js reads: base64 of a zlib stream of
///
///   rows, columns                    32 bits each
///   bytes, order, offset, step       for each column: 32, 32, 64 and 64 bits, the last two as
///   double residuals                        for each column: `bytes` planes of `rows` bytes,
///   lowest first
///
/// least significant byte first. A value becomes a code c, and
///
///   value = offset + step c,   0 ≤ c ≤ 2ⁿ − 2,   n = 8 `bytes` = `bits`
///
/// where offset is the least value and offset + (2ⁿ − 2) step the greatest, so a value is off by
/// step / 2 at most. A column of whole numbers has step 1, if they fit, and is exact. c = 2ⁿ − 1
/// stands for no value: not a number, or infinite. The time has 8 bytes: c / 1e9, whole
/// nanoseconds, offset and step unused.
///
/// The residuals are the differences of the codes of the order 0, 1 or 2 that leaves fewest bits,
/// modulo 2ⁿ, codes before the first being 0, with 0, −1, 1, −2, 2 … counted as 0, 1, 2, 3, 4 ….
/// A smooth curve leaves one plane that is not almost all zeros.
///
/// Throws Error if there is no column, if columns differ in length, or if the time is not finite,
/// decreases or is past 2⁵³ ns.
std::string PageData(const PageColumns& columns, int bits = 24);

/// PageColumns with fewer rows, and how they came about.
struct Decimated {
  PageColumns columns;
  std::string sentence;  ///< "every value is shown"
};

/// At most `rows` (≥ 2) rows: of each bin of k rows, each column's least and greatest value in the
/// order in which they came, at the times of the bin's first row and of its middle. No peak is
/// lost, and none moves by more than a bin. Values that are not finite count only in a bin
/// that has no others.
Decimated Decimate(const PageColumns& columns, std::size_t rows);

/// A run's data as it goes into a page.
struct FittedData {
  std::string text;
  std::size_t rows;
  std::string decimation;  ///< a sentence for the page
};

/// The most that `characters` hold: all rows with 24 bits, all rows with 16 bits, or fewer rows
/// with 16 bits; two rows remain however few the characters are.
FittedData FitPageData(const PageColumns& columns, std::size_t characters);

}  // namespace pliant::internal

#include "pliant/analysis/page_data.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

constexpr int kTimeBytes = 8;
constexpr double kLastNanosecond = 9007199254740992;  // 2⁵³: a double counts no further

void Check(const PageColumns& columns) {
  Require(!columns.empty(), "page data: the first column must be the time; there is no column");
  const std::vector<double>& times = columns[0];
  for (std::size_t i = 0; i < columns.size(); ++i)
    Require(columns[i].size() == times.size(),
            "page data: column " + Text(i) + " must have as many rows as the time, " +
                Text(times.size()),
            columns[i].size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    Require(std::abs(times[i]) * 1e9 < kLastNanosecond,
            "page data: the time of row " + Text(i) + " must be finite and within 104 days",
            times[i]);
    Require(i == 0 || times[i] >= times[i - 1],
            "page data: the time of row " + Text(i) + " must be ≥ the one before, " +
                Text(times[std::max<std::size_t>(i, 1) - 1]),
            times[i]);
  }
}

// ---- codes -----------------------------------------------------------------------------------

struct Coded {
  int bytes;
  double offset, step;
  std::vector<std::uint64_t> codes;
};

Coded CodedTime(const std::vector<double>& times) {
  Coded coded{kTimeBytes, 0, 1e-9, {}};
  for (const double t : times)
    coded.codes.push_back(static_cast<std::uint64_t>(std::llround(t * 1e9)));
  return coded;
}

Coded CodedValues(const std::vector<double>& values, int bits) {
  const double none = std::ldexp(1.0, bits) - 1;
  const double top = none - 1;
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  bool whole = true;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    least = std::min(least, v);
    greatest = std::max(greatest, v);
    whole = whole && v == std::round(v);
  }
  if (least > greatest) least = greatest = 0;  // no value at all
  whole = whole && greatest - least <= top;
  // In halves: the difference of two finite numbers may overflow.
  const double half_step = whole ? 0.5 : (greatest / 2 - least / 2) / top;
  const double step = 2 * half_step;
  Coded coded{bits / 8, least, step, {}};
  for (const double v : values) {
    const double code = half_step > 0 ? std::round((v / 2 - least / 2) / half_step) : 0;
    coded.codes.push_back(
        static_cast<std::uint64_t>(std::isfinite(v) ? std::clamp(code, 0.0, top) : none));
  }
  return coded;
}

// ---- residuals -------------------------------------------------------------------------------

/// The low `bits` bits as a signed number, 0, −1, 1, −2 … counted as 0, 1, 2, 3 ….
std::uint64_t Folded(std::uint64_t difference, int bits) {
  const auto value = static_cast<std::int64_t>(difference << (64 - bits)) >> (64 - bits);
  return static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63);
}

std::vector<std::uint64_t> Residuals(const Coded& coded, int order) {
  std::vector<std::uint64_t> left = coded.codes;
  for (int k = 0; k < order; ++k)
    for (std::size_t i = left.size(); i-- > 1;) left[i] -= left[i - 1];
  for (std::uint64_t& residual : left) residual = Folded(residual, 8 * coded.bytes);
  return left;
}

long BitsOf(const std::vector<std::uint64_t>& residuals) {
  long bits = 0;
  for (const std::uint64_t r : residuals) bits += std::bit_width(r);
  return bits;
}

// ---- bytes -----------------------------------------------------------------------------------

void Append(std::string& bytes, std::uint64_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> 8 * k & 255);
}

std::string Deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6);
  Require(status == Z_OK, "page data: zlib could not compress " + Text(bytes.size()) + " bytes",
          status);
  packed.resize(size);
  return packed;
}

std::string Base64(const std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
  }
  return text;
}

// ---- rows ------------------------------------------------------------------------------------

/// The two rows of a bin: its least and greatest value in the order in which they came.
std::array<double, 2> Extremes(const double* begin, const double* end) {
  std::optional<double> least, greatest;
  bool least_first = true;
  for (const double* v = begin; v != end; ++v) {
    if (!std::isfinite(*v)) continue;
    if (!least || *v < *least) least = *v, least_first = false;
    if (!greatest || *v > *greatest) greatest = *v, least_first = true;
  }
  if (!least) return {std::nan(""), std::nan("")};
  return least_first ? std::array{*least, *greatest} : std::array{*greatest, *least};
}

bool Uniform(const std::vector<double>& times) {
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - times[i - 1] - step) > 0.01 * step) return false;
  return true;
}

std::string SentenceOf(const std::vector<double>& times, std::size_t bin) {
  std::string of = Text(bin) + " rows";
  if (Uniform(times)) {
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    const double microseconds = std::round(step * static_cast<double>(bin) * 1e6);
    of = microseconds < 1e6 ? Text(microseconds * 1e-3) + " ms" : Text(microseconds * 1e-6) + " s";
  }
  return "plots show the least and greatest of every " + of;
}

}  // namespace

std::string PageData(const PageColumns& columns, int bits) {
  Check(columns);
  Require(bits == 16 || bits == 24, "page data: bits must be 16 or 24", bits);
  std::string head, body;
  Append(head, columns[0].size(), 4);
  Append(head, columns.size(), 4);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Coded coded = c == 0 ? CodedTime(columns[c]) : CodedValues(columns[c], bits);
    std::vector<std::uint64_t> fewest = Residuals(coded, 0);
    int order = 0;
    for (const int other : {1, 2}) {
      std::vector<std::uint64_t> residuals = Residuals(coded, other);
      if (BitsOf(residuals) >= BitsOf(fewest)) continue;
      fewest = std::move(residuals);
      order = other;
    }
    Append(head, static_cast<std::uint64_t>(coded.bytes), 4);
    Append(head, static_cast<std::uint64_t>(order), 4);
    Append(head, std::bit_cast<std::uint64_t>(coded.offset), 8);
    Append(head, std::bit_cast<std::uint64_t>(coded.step), 8);
    for (int plane = 0; plane < coded.bytes; ++plane)
      for (const std::uint64_t r : fewest) body += static_cast<char>(r >> 8 * plane & 255);
  }
  return Base64(Deflated(head + body));
}

Decimated Decimate(const PageColumns& columns, std::size_t rows) {
  Check(columns);
  Require(rows >= 2, "page data: there must be room for 2 rows", rows);
  const std::size_t all = columns[0].size();
  if (all <= rows) return {columns, "every value is shown"};
  // Two rows of each bin, of which the last may be short.
  const std::size_t bins = rows / 2;
  const std::size_t size = (all + bins - 1) / bins;
  Decimated fewer{PageColumns(columns.size()), SentenceOf(columns[0], size)};
  for (std::size_t first = 0; first < all; first += size) {
    const std::size_t last = std::min(first + size, all);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double* values = columns[c].data();
      const std::array<double, 2> two =
          c == 0 ? std::array{values[first], values[first + (last - first) / 2]}
                 : Extremes(values + first, values + last);
      fewer.columns[c].insert(fewer.columns[c].end(), two.begin(), two.end());
    }
  }
  return fewer;
}

FittedData FitPageData(const PageColumns& columns, std::size_t characters) {
  const std::size_t all = columns.empty() ? 0 : columns[0].size();
  // What a stretch from the middle costs says where to begin: packing all of a long run, to find
  // that it is too much, takes seconds.
  constexpr std::size_t kStretch = 4000;
  const auto expected = [&](int bits) {
    if (all <= kStretch) return std::size_t{0};
    PageColumns stretch;
    for (const std::vector<double>& column : columns) {
      const auto begin = column.begin() + static_cast<std::ptrdiff_t>((all - kStretch) / 2);
      stretch.emplace_back(begin, begin + kStretch);
    }
    return PageData(stretch, bits).size() * all / kStretch;
  };
  for (const int bits : {24, 16}) {
    if (expected(bits) > 2 * characters) continue;
    std::string text = PageData(columns, bits);
    if (text.size() <= characters) return {std::move(text), all, "every value is shown"};
  }
  std::size_t rows = all;
  // Half as much again as expected: a stretch has a smaller span than all, and seems rougher.
  if (const std::size_t size = expected(16); size > 1.5 * static_cast<double>(characters))
    rows = static_cast<std::size_t>(1.5 * static_cast<double>(all) *
                                    static_cast<double>(characters) / static_cast<double>(size));
  for (;;) {
    const Decimated fewer = Decimate(columns, std::max<std::size_t>(rows, 2));
    std::string text = PageData(fewer.columns, 16);
    const std::size_t size = text.size(), kept = fewer.columns[0].size();
    if (size <= characters || kept <= 2) return {std::move(text), kept, fewer.sentence};
    // In proportion, and a little below: fewer rows are rougher, and cost more each.
    rows = std::min(kept - 1, static_cast<std::size_t>(0.97 * static_cast<double>(kept) *
                                                       static_cast<double>(characters) /
                                                       static_cast<double>(size)));
  }
}

}  // namespace pliant::internal

// What damaged logs do to their readers. The environment variable PLIANT_DAMAGE_ROUNDS sets how
// many random faults each log is given.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/mcap_repair.h"
#include "pliant/analysis/recording.h"
#include "pliant/systems/error.h"
#include "pliant/tests/support/mcap_bytes.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using Row = std::string;  // the bits of a time and its numbers

std::set<Row> RowsOf(const RecordedSignal& signal) {
  std::set<Row> rows;
  const auto bits = [](const double* numbers, Eigen::Index count) {
    return Row(reinterpret_cast<const char*>(numbers),
               sizeof(double) * static_cast<std::size_t>(count));
  };
  for (Eigen::Index k = 0; k < signal.times.size(); ++k)
    rows.insert(bits(&signal.times(k), 1) +
                bits(signal.numbers.col(k).data(), signal.numbers.rows()));
  return rows;
}

/// A log whose bytes a test may damage.
class Damage {
 public:
  explicit Damage(const std::string& name) : bytes{ReadText(LogOf(name))} {
    const Recording run = Write(bytes);
    for (const RecordedSignal& signal : run.signals())
      written_.emplace(signal.path, std::pair(signal, RowsOf(signal)));
  }

  /// The damaged bytes are read or refused, and what a repair makes of them is a whole log of rows
  /// that were written. Returns the number of rows, −1 if there was nothing to repair.
  int Try(const std::string& damaged) {
    int rows = -1;
    try {
      ExpectWritten(Write(damaged), "read");
    } catch (const Error&) {
    }
    try {
      RepairLog(file_, repaired_, true);
      rows = 0;
      const McapReader log(repaired_);
      EXPECT_EQ(log.fault(), "");
      log.ForEach({}, [&](const McapMessage&) {});
    } catch (const Error& error) {
      EXPECT_EQ(rows, -1) << error.what();
      return rows;
    }
    try {
      rows = ExpectWritten(Recording::Read(repaired_), "repaired");
    } catch (const Error& error) {  // no recording, or the damaged metadata of a channel
      EXPECT_THAT(error.what(), testing::StartsWith(repaired_.string()));
    }
    return rows;
  }

  int rows() const {
    int count = 0;
    for (const auto& [path, written] : written_) count += static_cast<int>(written.second.size());
    return count;
  }

  const std::string bytes;

 private:
  Recording Write(const std::string& text) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << text;
    return Recording::Read(file_);
  }

  int ExpectWritten(const Recording& run, const std::string& how) {
    int count = 0;
    for (const RecordedSignal& signal : run.signals()) {
      const auto known = written_.find(signal.path);
      // The names of a channel may be damaged where no CRC covers them.
      if (known == written_.end() || known->second.first != RecordedValue(signal)) continue;
      const std::set<Row> rows = RowsOf(signal);
      for (const Row& row : rows)
        EXPECT_TRUE(known->second.second.contains(row)) << how << ' ' << signal.path;
      count += static_cast<int>(rows.size());
    }
    return count;
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_.path() / "damaged.mcap";
  const std::filesystem::path repaired_ = directory_.path() / "repaired.mcap";
  std::map<std::string, std::pair<RecordedValue, std::set<Row>>> written_;
};

int Rounds() {
  const char* rounds = std::getenv("PLIANT_DAMAGE_ROUNDS");
  return rounds ? std::atoi(rounds) : 300;
}

class DamagedLog : public testing::TestWithParam<std::string> {};

TEST_P(DamagedLog, CutAnywhereGivesWhatWasWrittenBefore) {
  Damage damage(GetParam());
  int rows = -1;
  std::set<std::size_t> sizes{0, 1, 7, 8, damage.bytes.size() - 1};
  for (const McapBytes& record : RecordsOf(damage.bytes))
    for (const std::size_t past : {0, 1, 2, 9, 10, 21})
      if (const std::size_t size = record.at + past - 1; size < damage.bytes.size())
        sizes.insert(size);
  for (std::size_t size = 0; size < damage.bytes.size(); size += 29) sizes.insert(size);
  for (const std::size_t size : sizes) {
    const int now = damage.Try(damage.bytes.substr(0, size));
    EXPECT_GE(now, rows) << "cut at byte " << size;  // more of a file never holds fewer rows
    rows = now;
  }
  EXPECT_EQ(rows, damage.rows());
}

TEST_P(DamagedLog, WrongLengthsAreSurvived) {
  Damage damage(GetParam());
  for (const auto& [op, at, old] : RecordsOf(damage.bytes)) {
    const std::vector<std::uint64_t> lengths{0,          1,     1ull << 30,    (1ull << 30) + 1,
                                             1ull << 62, ~0ull, ~0ull - at - 8};
    for (const std::uint64_t length : lengths) {
      std::string bytes = damage.bytes;
      Overwrite(bytes, at + 1, length);
      damage.Try(bytes);
    }
  }
}

TEST_P(DamagedLog, RandomFaultsAreSurvived) {
  Damage damage(GetParam());
  const std::size_t size = damage.bytes.size();
  for (int round = 0; round < Rounds(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    std::mt19937_64 random(static_cast<std::uint64_t>(round));
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    std::string bytes = damage.bytes;
    for (std::size_t faults = 1 + below(3); faults > 0; --faults) {
      const std::size_t at = below(bytes.size());
      const std::size_t most = std::min<std::size_t>(bytes.size() - at, 1 + below(300));
      switch (below(7)) {
        case 0:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
          break;
        case 1:
          bytes[at] = static_cast<char>(random());
          break;
        case 2:
          for (std::size_t i = at; i < at + most; ++i) bytes[i] = static_cast<char>(random());
          break;
        case 3:
          bytes.insert(at, damage.bytes, below(size), most);
          break;
        case 4:
          bytes.erase(at, most);
          break;
        case 5:
          bytes.resize(at + 1);
          break;
        default:
          for (std::size_t i = at; i < std::min(at + 8, bytes.size()); ++i)
            bytes[i] = static_cast<char>(round % 2 ? 0xff : 0);
      }
    }
    damage.Try(bytes);
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(AnyLayout, DamagedLog,
                         testing::Values("plain.mcap", "zstd.mcap", "lz4.mcap", "no_index.mcap",
                                         "mcap_log.mcap"),
                         [](const auto& test) {
                           return test.param.substr(0, test.param.find('.'));
                         });

}  // namespace
}  // namespace pliant

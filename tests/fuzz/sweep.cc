#include "pliant/analysis/sweep.h"

#include <fstream>

#include "pliant/analysis/sweep_part.h"
#include "pliant/tests/fuzz/targets.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant::fuzz {

namespace {

/// What is read of a part is what a new part of its rows has.
bool Part(const std::string& bytes) {
  static const TemporaryDirectory directory;
  const std::filesystem::path part = directory.path() / "part-1-of-1";
  const std::filesystem::path again = directory.path() / "part-1-of-2";
  std::ofstream(part, std::ios::binary) << bytes;
  SweepPartContent content;
  if (!Takes([&] { content = SweepPartContent::Read(part); }) || content.whole == 0) return false;
  return Takes([&] {
    const Sweep sweep = Sweep::ReadText(content.text, "part");
    std::filesystem::remove(again);
    {
      SweepPart copy(again, sweep);
      for (const SweepRow& row : content.rows) copy.Append(row);
    }
    const SweepPartContent copied = SweepPartContent::Read(again);
    Check(copied.text == content.text && copied.rows == content.rows && copied.damaged.empty(),
          "a part's rows make the same part");
  });
}

/// A fuzzer that would have to find checksums changes the text of a sweep by itself.
bool Description(const std::string& text) {
  return Takes([&] {
    const Sweep sweep = Sweep::ReadText(text, "sweep");
    Check(sweep.text() == text, "a sweep keeps its text");
    for (const std::uint64_t run : {std::uint64_t{0}, sweep.runs() - 1}) {
      Check(sweep.RandomValuesOf(run) == sweep.RandomValuesOf(run), "a run is the same again");
      Takes([&] { sweep.FileOf(run); });
    }
  });
}

}  // namespace

bool SweepFile(const std::string& bytes) {
  return bytes.starts_with("pliant sweep 1") ? Part(bytes) : Description(bytes);
}

}  // namespace pliant::fuzz

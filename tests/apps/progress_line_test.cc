#include "pliant/apps/progress_line.h"

#include <gtest/gtest.h>

#include <thread>

namespace pliant {
namespace {

/// What a progress line writes, in the place of a terminal or of a file.
class Shown {
 public:
  explicit Shown(bool terminal) : line{file_, terminal} {}
  ~Shown() { std::fclose(file_); }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  std::string text() const {
    std::fflush(file_);
    std::string all(static_cast<std::size_t>(std::ftell(file_)), ' ');
    std::rewind(file_);
    EXPECT_EQ(std::fread(all.data(), 1, all.size(), file_), all.size());
    return all;
  }

 private:
  std::FILE* file_ = std::tmpfile();

 public:
  ProgressLine line;
};

TEST(ProgressLine, IsWrittenOverOnATerminalAndEndedByWhatFollows) {
  Shown shown(true);
  shown.line("Γ = 0", 0.5, 20, 0.25);  // within a tenth of a second of the start: not shown
  std::this_thread::sleep_for(std::chrono::milliseconds(110));
  shown.line("Γ = 0", 1, 20, 0.5);
  shown.line.End();
  shown.line.End();
  EXPECT_EQ(shown.text(), "\r\033[KΓ = 0" + std::string(23, ' ') +
                              "    1.0 of 20.0 s,   2.0 x real time, 10 s left\n");
}

TEST(ProgressLine, EndsWithTheRun) {
  Shown shown(true);
  shown.line("short", 2, 2, 0.5);
  shown.line.End();
  EXPECT_EQ(shown.text(),
            "\r\033[Kshort" + std::string(23, ' ') + "  2.000 of 2.000 s,   4.0 x real time\n");
}

TEST(ProgressLine, IsALineAtTheEndForAFileAndWritesNoControlCharacters) {
  Shown shown(false);
  std::this_thread::sleep_for(std::chrono::milliseconds(110));
  shown.line("a\033[1m", 1, 2, 0.5);  // within 10 s of the start: not shown
  shown.line("a\033[1m", 2, 2, 0.5);
  shown.line.End();
  EXPECT_EQ(shown.text(),
            "a\\x1b[1m" + std::string(20, ' ') + "  2.000 of 2.000 s,   4.0 x real time\n");
}

}  // namespace
}  // namespace pliant

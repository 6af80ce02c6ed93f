#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pliant/tests/fuzz/targets.h"
#include "pliant/tests/support/temporary_directory.h"

// What fuzzers begin with, and what they have found: each file of a corpus goes through its target.

namespace pliant::fuzz {
namespace {

struct Target {
  const char* corpus;
  bool (*take)(const std::string&);
};

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, IsReadOrRefused) {
  const std::filesystem::path folder =
      std::filesystem::path(PLIANT_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().corpus;
  int files = 0, read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++files;
    EXPECT_NO_THROW(read += GetParam().take(ReadText(entry.path()))) << entry.path();
  }
  EXPECT_GT(read, 0) << "of " << files;
}

INSTANTIATE_TEST_SUITE_P(Of, Corpus,
                         testing::Values(Target{"urdf", Urdf}, Target{"actuators", Actuators},
                                         Target{"kortex", KortexFrames},
                                         Target{"wrench", WrenchFrames},
                                         Target{"scenario", ScenarioFile},
                                         Target{"sweep", SweepFile}, Target{"mcap", Mcap},
                                         Target{"csv", Csv}, Target{"foxglove", Foxglove}),
                         [](const auto& test) { return test.param.corpus; });

}  // namespace
}  // namespace pliant::fuzz

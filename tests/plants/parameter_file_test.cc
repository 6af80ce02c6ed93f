#include "pliant/plants/parameter_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "pliant/plants/actuator_parameters.h"
#include "pliant/systems/random.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

const std::string kSource = "arm.yaml";

std::string ActuatorsOfGen3() { return ReadText(PLIANT_SOURCE_DIR "/models/gen3/actuators.yaml"); }

std::string Repeated(const std::string& part, std::size_t times) {
  std::string all;
  while (times-- > 0) all += part;
  return all;
}

std::string ErrorIn(const std::string& text) {
  return ErrorOf([&] { ParameterFile::ReadText(text, kSource); });
}

/// Reads actuators; they must be right, or refused with a message that names the source. Any other
/// exception ends the test. Returns whether they were right.
bool AreReadOrRefused(const std::string& text) {
  const Joints joints = Joints::Numbered(7);
  ArmActuators arm;
  const std::string error = ErrorOf([&] { arm = ArmActuators::ReadText(text, joints, kSource); });
  if (error != "no error") {
    // The message may quote bytes of the file, so only its beginning is matched.
    EXPECT_THAT(error.substr(0, error.find(' ')), MatchesRegex("arm\\.yaml:([0-9]+:[0-9]+:)?"))
        << error;
    return false;
  }
  EXPECT_EQ(arm.joint.size(), 7u);
  for (const ActuatorParameters& p : arm.joint)
    EXPECT_EQ(ErrorOf([&] { RequireInRange("", p); }), "no error") << text;
  return true;
}

TEST(ParameterFile, IsReadOrRefusedAtEveryLength) {
  const std::string text = ActuatorsOfGen3();
  ASSERT_TRUE(AreReadOrRefused(text));
  int read = 0;
  for (std::size_t n = 0; n < text.size() && !HasFailure(); ++n)
    read += AreReadOrRefused(text.substr(0, n));
  EXPECT_EQ(read, 1);  // all but the end of the last line is needed
}

TEST(ParameterFile, IsReadOrRefusedWithAnyBytes) {
  const std::string text = ActuatorsOfGen3();
  const RandomStream random(2024);
  int read = 0, refused = 0;
  for (std::uint64_t k = 0; k < 2000 && !HasFailure(); ++k) {
    const RandomStream of_this = random.Part(k);
    std::uint64_t n = 0;
    const auto below = [&](std::size_t limit) {
      return static_cast<std::size_t>(of_this.Uniform(n++) * static_cast<double>(limit));
    };
    std::string mutated = text;
    const std::size_t changes = 1 + below(4);
    for (std::size_t i = 0; i < changes; ++i) {
      const std::size_t at = below(mutated.size());
      const char byte = static_cast<char>(below(256));
      switch (below(3)) {
        case 0:
          mutated[at] = byte;
          break;
        case 1:
          mutated.insert(at, 1, byte);
          break;
        default:
          mutated.erase(at, 1 + below(8));
      }
    }
    (AreReadOrRefused(mutated) ? read : refused)++;
  }
  EXPECT_GT(read, 100);     // changes in comments
  EXPECT_GT(refused, 100);  // changes elsewhere
}

TEST(ParameterFile, IsReadOrRefusedWithAnySigns) {
  const std::string text = ActuatorsOfGen3();
  const std::string signs = "{}[]&*!|>%@`'\"#,:?-~<=.\t\r\n \\x\xff\xfe";
  const RandomStream random(2025);
  for (std::uint64_t k = 0; k < 2000 && !HasFailure(); ++k) {
    const RandomStream of_this = random.Part(k);
    // The head is comments, which nothing can spoil.
    const std::size_t head = text.find("transmission: elastic");
    const auto at = head + static_cast<std::size_t>(of_this.Uniform(0) *
                                                    static_cast<double>(text.size() - head));
    const auto sign =
        static_cast<std::size_t>(of_this.Uniform(1) * static_cast<double>(signs.size()));
    std::string mutated = text;
    mutated.insert(at, 1, signs[sign]);
    AreReadOrRefused(mutated);
  }
}

TEST(ParameterFile, RefusesDeepNesting) {
  constexpr int kDepth = 10'000;
  const std::string refusal = "more than 32 maps and lists inside one another";
  EXPECT_EQ(ErrorIn(std::string(kDepth, '[') + std::string(kDepth, ']')),
            "arm.yaml:1:33: " + refusal);
  std::string maps, lists;
  for (int i = 0; i < kDepth; ++i) {
    maps += "{a: ";
    lists += "- ";
  }
  EXPECT_EQ(ErrorIn(maps + "1" + std::string(kDepth, '}')), "arm.yaml:1:129: " + refusal);
  EXPECT_EQ(ErrorIn(lists + "1"), "arm.yaml:1:65: " + refusal);
  for (const std::string& open : {std::string(kDepth, '['), std::string(kDepth, '{'), maps})
    EXPECT_THAT(ErrorIn(open), StartsWith("arm.yaml:1:"));
  EXPECT_EQ(ErrorIn(std::string(32, '[') + std::string(32, ']')), "no error");
}

TEST(ParameterFile, QuotesOnlyTheBeginningOfHugeWords) {
  const std::string huge(100'000, 'x'), key(200, 'x');
  const std::string start = std::string(60, 'x') + "…'";
  const auto error = [](const std::string& text, auto use) {
    return ErrorOf([&] { use(ParameterFile::ReadText(text, kSource)); });
  };
  EXPECT_EQ(error(huge, [](const ParameterFile& f) { f.number(); }),
            "arm.yaml:1:1: expected a number, got '" + start);
  EXPECT_THAT(error(huge, [](const ParameterFile& f) { f.OneOf({"rigid"}); }),
              StartsWith("arm.yaml:1:1: expected one of rigid, got '" + start));
  EXPECT_THAT(error("{? " + key + " : 1}", [](const ParameterFile& f) { f.RequireKeys({"a"}); }),
              StartsWith("arm.yaml:1:4: there is no '" + start + " here"));
  EXPECT_EQ(ErrorIn("{? " + key + " : 1, ? " + key + " : 2}"),
            "arm.yaml:1:212: '" + start + " is given twice");
  EXPECT_EQ(error(std::string(400, '9'), [](const ParameterFile& f) { f.number(); }),
            "arm.yaml:1:1: expected a number, got '" + std::string(60, '9') + "…'");
}

TEST(ParameterFile, RefusesManyKeysQuickly) {
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += "key_" + Text(i) + ": 1\n";
  EXPECT_EQ(ErrorIn(text), "no error");
  EXPECT_EQ(ErrorIn(text + "key_7: 1\n"), "arm.yaml:20001:1: 'key_7' is given twice");
}

TEST(ParameterFile, TakesBinaryBytesForWords) {
  std::string bytes;
  for (int i = 0; i < 4096; ++i) bytes += static_cast<char>(i * 167 % 256);
  AreReadOrRefused(bytes);
  AreReadOrRefused(std::string(1000, '\0'));
  AreReadOrRefused("\xff\xfe" + ActuatorsOfGen3());  // the mark of UTF-16
  AreReadOrRefused(std::string("\0\0\xfe\xff", 4) + ActuatorsOfGen3());
  EXPECT_TRUE(AreReadOrRefused("\xef\xbb\xbf" + ActuatorsOfGen3()));  // that of UTF-8
}

TEST(ParameterFile, FollowsAliases) {
  const auto file = ParameterFile::ReadText("a: &one {x: 3}\nb: *one\n", kSource);
  EXPECT_EQ(file["b"]["x"].number(), 3);
  EXPECT_EQ(ParameterFile::ReadText("a: &x 1\nb: &x 2\nc: *x\n")["c"].number(), 2);
}

/// The most memory that this process has ever had [bytes].
std::size_t Peak() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10;
}

/// How many times the time and the memory a sanitizer takes at most; that of threads, as Clang's
/// manual has it, 5 to 15 times the time and 5 to 10 times the memory.
#if defined(__SANITIZE_THREAD__)
constexpr unsigned kSanitized = 15;
#elif defined(__SANITIZE_ADDRESS__)
constexpr unsigned kSanitized = 4;
#else
constexpr unsigned kSanitized = 1;
#endif

/// Reads what an adversary wrote: an answer within a second and some 220 bytes for each of it.
std::string AnswerTo(const std::string& text) {
  const std::size_t before = Peak();
  const std::clock_t begin = std::clock();
  const std::string answer = ErrorIn(text);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, kSanitized)
      << text.substr(0, 80);
  EXPECT_LT(Peak() - before, kSanitized * 150u << 20) << text.substr(0, 80);
  return answer;
}

TEST(ParameterFile, RefusesAliasesThatDouble) {
  std::string doubling = "a0: &a0 1\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string last = "*a" + Text(i - 1), name = "a" + Text(i);
    doubling += name + ": &" + name + " [" + last + ", " + last + "]\n";
  }
  // a_i is 2^(i+1) − 1 values, so with those before it 2^(i+2) − i − 3: too many at the second half
  // of a15.
  EXPECT_EQ(
      AnswerTo(doubling),
      "arm.yaml:16:18: more than 100000 values, those of an alias counted wherever it stands");
  EXPECT_THAT(AnswerTo("a: &a {x: [1]}\nb: [" + Repeated("*a, ", 40'000) + "1]\n"),
              HasSubstr("more than 100000 values"));
}

TEST(ParameterFile, RefusesLongWordsWhoseAliasesDouble) {
  std::string doubling = "a0: &a0 " + std::string(1024, 'x') + "\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string last = "*a" + Text(i - 1), name = "a" + Text(i);
    doubling += name + ": &" + name + " [" + last + ", " + last + "]\n";
  }
  // a_i has 2^i KiB, those up to it 2^(i+1) − 2: too many at the first half of a9.
  EXPECT_EQ(AnswerTo(doubling),
            "arm.yaml:10:10: more than 512 KiB, the words of an alias counted wherever it stands");
}

TEST(ParameterFile, RefusesLongKeys) {
  const std::string longest(255, '\x1b');
  EXPECT_EQ(AnswerTo(longest + "\x1b: 1\n"),
            "arm.yaml:1:1: the key '" + longest.substr(0, 60) + "…' has more than 255 bytes");
  const std::string text = ParameterFile::ReadText(longest + ": 1\n", "arm.yaml").yaml();
  EXPECT_EQ(ParameterFile::ReadText(text, "arm.yaml").yaml(), text);
}

TEST(ParameterFile, HasNoLineThatIsLongerThanAFile) {
  const auto file = ParameterFile::ReadText("a: " + std::string(200 << 10, '\x1b'), "arm.yaml");
  EXPECT_EQ(ErrorOf([&] { file.yaml(); }),
            "arm.yaml:1:1: in one line, without aliases, it is longer than 512 KiB");
}

TEST(ParameterFile, AnswersToHugeTextsWithinBounds) {
  for (const std::string begin : {"", "a: ", "{a: ", "- "})
    for (const std::string part : {"[",
                                   "{",
                                   "]",
                                   "}",
                                   "- ",
                                   "? ",
                                   ": ",
                                   ",",
                                   "1, ",
                                   "a: ",
                                   "a: 1\n",
                                   "- 1\n",
                                   "&a ",
                                   "*a ",
                                   "!a ",
                                   "\"",
                                   "'",
                                   "''",
                                   "|\n",
                                   ">\n ",
                                   "#",
                                   "# a\n",
                                   "\n",
                                   "\t",
                                   " ",
                                   "\r\n",
                                   "---\n",
                                   "...\n",
                                   "%YAML 1.2\n",
                                   "\xff",
                                   std::string(1, '\0').c_str(),
                                   "é",
                                   "\\",
                                   "\"a\": ",
                                   "[a]: ",
                                   "{a: 1}\n",
                                   "- - ",
                                   "? a\n",
                                   "a\n",
                                   "[]\n, "})
      AnswerTo(begin + Repeated(part, 524'288 / std::max<std::size_t>(part.size(), 1)));
}

TEST(ParameterFile, RefusesAliasesThatContainThemselves) {
  const std::string refusal = "an alias stands for what it is a part of";
  EXPECT_EQ(ErrorIn("&a [1, *a]"), "arm.yaml:1:8: " + refusal);
  EXPECT_EQ(ErrorIn("a: &x {b: [*x]}"), "arm.yaml:1:12: " + refusal);
  EXPECT_EQ(ErrorIn("a: &x\n  b: *x\n"), "arm.yaml:2:6: " + refusal);
  EXPECT_THAT(ErrorIn("a: *b\n"), StartsWith("arm.yaml:1:4: "));  // of nothing
  EXPECT_EQ(ErrorIn("a: &x 1\n*x : 2\n"), "arm.yaml:2:1: a key must be a word");
}

TEST(ParameterFile, RefusesKeysThatAreGivenTwiceOrAreNoWords) {
  EXPECT_EQ(ErrorIn("a: 1\nb: 2\na: 3\n"), "arm.yaml:3:1: 'a' is given twice");
  EXPECT_EQ(ErrorIn("m:\n  - {a: 1, b: 2}\n  - {a: 1, a: 2}\n"),
            "arm.yaml:3:12: 'a' is given twice");
  EXPECT_EQ(ErrorIn("{a: {b: 1}, b: {b: 1}}"), "no error");
  EXPECT_EQ(ErrorIn("{[1, 2]: 3}"), "arm.yaml:1:2: a key must be a word");
  EXPECT_EQ(ErrorIn("{{a: 1}: 3}"), "arm.yaml:1:2: a key must be a word");
  EXPECT_THAT(ErrorIn("? ~\n: 3\n"), HasSubstr("a key must be a word"));
}

TEST(ParameterFile, RefusesASecondDocument) {
  EXPECT_EQ(ErrorIn("---\na: 1\n---\na: 2\n"),
            "arm.yaml:3:1: a second document begins here; expected one");
  EXPECT_EQ(ErrorIn("---\na: 1\n"), "no error");
}

TEST(ParameterFile, RefusesTabsForIndentation) {
  EXPECT_THAT(ErrorIn("a:\n\tb: 1\n\tc: 2\n"), StartsWith("arm.yaml:2:"));
  EXPECT_EQ(ParameterFile::ReadText("a: 1\t# one\n")["a"].number(), 1);
}

TEST(ParameterFile, RefusesFilesThatCannotBeRead) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::filesystem::path& file) {
    return ErrorOf([&] { ParameterFile::Read(file); });
  };
  const auto refused = [](const std::filesystem::path& file) {
    return file.string() + ": cannot be read";
  };
  const std::filesystem::path file = directory.path() / "arm.yaml",
                              loop = directory.path() / "loop";
  std::ofstream(file) << "a: 1\n";
  std::filesystem::create_symlink(loop, loop);
  EXPECT_EQ(error(file), "no error");
  for (const auto& path : {directory.path(), directory.path() / "none.yaml", file / "none.yaml",
                           loop, directory.path() / std::string(1000, 'x')})
    EXPECT_EQ(error(path), refused(path));

  std::filesystem::permissions(file, std::filesystem::perms::none);
  const bool readable = access(file.c_str(), R_OK) == 0;  // as everything is to root
  EXPECT_EQ(error(file), readable ? "no error" : refused(file));

  const std::filesystem::path huge = directory.path() / "huge.yaml";
  std::ofstream(huge) << "a: 1\n";
  std::filesystem::resize_file(huge, 100 << 20);
  const std::size_t before = Peak();
  EXPECT_EQ(error(huge), huge.string() + ": a file of parameters has at most 512 KiB");
  EXPECT_EQ(error("/dev/zero"), "/dev/zero: a file of parameters has at most 512 KiB");
  EXPECT_LT(Peak() - before, 20u << 20);

  std::ofstream(directory.path() / "empty.yaml");
  EXPECT_EQ(error(directory.path() / "empty.yaml"), "no error");
}

}  // namespace
}  // namespace pliant

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pliant/plants/parameter_file.h"

namespace pliant {

enum class Colour { Red, Green, True };

inline const std::vector<std::string>& Words(Colour) {
  static const std::vector<std::string> words{"red", "green", "true"};
  return words;
}

struct Spring {
  static constexpr const char* kTag = "Spring";
  double stiffness = kToBeGiven;
  double damping = 0.5;

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "N/m", kPositive);
    f("damping", damping, "N·s/m", kNotNegative);
  }
  bool operator==(const Spring&) const = default;
};

struct Rope {
  static constexpr const char* kTag = "Rope";
  std::string colour_of = "none";

  template <class F>
  void Parameters(F&& f) {
    f("colour_of", colour_of);
  }
  bool operator==(const Rope&) const = default;
};

/// Parameters of every kind there is; none has to be given.
struct AllKinds {
  double number = 1, time = 0.1, angle = 0, limit = kUnbounded;
  int count = 3;
  std::uint64_t seed = 7;
  bool flag = false;
  std::string word = "word";
  Colour colour = Colour::Red;
  Duration period = 1ms;
  Eigen::Vector3d fixed = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1> dynamic = {};
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 4> any = {};
  std::optional<double> maybe = 2.5;
  std::optional<Spring> maybe_spring = {};
  Spring spring = {.stiffness = 1};
  std::vector<Spring> springs = {};
  std::vector<std::string> words = {};
  std::variant<Spring, Rope> either = Rope{};
  std::vector<std::variant<Spring, Rope>> parts = {};
  Overrides set = {};

  template <class F>
  void Parameters(F&& f) {
    f("number", number);
    f("time", time, "s", kNotNegative);
    f("angle", angle, "rad");
    f("limit", limit, "N", kLimit);
    f("count", count, "", Between(-10, 10));
    f("seed", seed);
    f("flag", flag);
    f("word", word);
    f("colour", colour);
    f("period", period);
    f("fixed", fixed, "m");
    f("dynamic", dynamic, "m");
    f("matrix", matrix);
    f("any", any);
    f("maybe", maybe, "s", kPositive);
    f("maybe_spring", maybe_spring);
    f("spring", spring);
    f("springs", springs);
    f("words", words);
    f("either", either);
    f("parts", parts);
    f("set", set);
  }
};

}  // namespace pliant

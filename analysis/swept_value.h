#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/systems/random.h"

namespace pliant {

/// What a sweep puts in the place of a value of a scenario:
///
///   controller.damper.rate=70,100,300     each of these, YAML
///   controller.damper.rate=70:500:20      20 numbers from 70 to 500, evenly spaced
///   controller.damper.rate=70:500:20:log  their logarithms evenly spaced
///   payload.mass=uniform(0.5,1.5)         a random number between these, drawn for each run
///   payload.mass=normal(1.25,0.1)         of this mean and standard deviation
///
/// Spaced numbers are rounded to 15 digits, so that they read as they were meant.
class SweptValue {
 public:
  /// Throws Error with the text if it says nothing of the kind.
  explicit SweptValue(const std::string& text);

  const std::string& text() const { return text_; }
  const std::string& path() const { return path_; }
  bool is_random() const { return law_ != Law::None; }
  /// YAML; none of what is random.
  const std::vector<std::string>& values() const { return values_; }
  /// The number that is drawn, of a stream for this alone.
  double Draw(const RandomStream& stream) const;
  /// What is drawn on average.
  double mean() const { return law_ == Law::Uniform ? a_ + (b_ - a_) / 2 : a_; }

 private:
  enum class Law { None, Uniform, Normal };

  [[noreturn]] void Fail(const std::string& what) const;
  bool ReadRandom(const std::string& values);
  bool ReadSpaced(const std::string& values);
  void ReadList(const std::string& values);

  std::string text_, path_;
  std::vector<std::string> values_;
  Law law_ = Law::None;
  double a_ = 0, b_ = 0;
};

/// Whether a path, such as environment.0.force.1, is another one or leads into what that holds.
bool LiesIn(const std::string& path, const std::string& other);

}  // namespace pliant

#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// What a signal is about: which joints in which order, or which frame. Cheap to copy, compared by
/// content.
class Space {
 public:
  Space() = default;

  /// Number of named elements; 0 for a frame, and where there is nothing to name.
  int size() const { return names_ ? static_cast<int>(names_->size()) : 0; }
  const std::string& operator[](int i) const { return (*names_)[static_cast<std::size_t>(i)]; }

  bool empty() const { return size() == 0 && frame_.empty(); }

  /// "(shoulder, elbow)" or "in tool"; empty where there is nothing to say.
  std::string text() const;

  bool operator==(const Space& o) const {
    return frame_ == o.frame_ &&
           (names_ == o.names_ || (names_ && o.names_ && *names_ == *o.names_));
  }

 protected:
  explicit Space(std::vector<std::string> names)
      : names_{std::make_shared<const std::vector<std::string>>(std::move(names))} {}
  explicit Space(std::string frame) : frame_{std::move(frame)} {}

 private:
  std::shared_ptr<const std::vector<std::string>> names_;
  std::string frame_;
};

/// Which joints, in which order.
class Joints : public Space {
 public:
  Joints() = default;
  Joints(std::initializer_list<std::string_view> names)
      : Joints(std::vector<std::string>(names.begin(), names.end())) {}
  explicit Joints(std::vector<std::string> names);

  /// n joints named joint_1 … joint_n.
  static Joints Numbered(int n);
};

/// The frame a spatial vector is expressed in.
class Frame : public Space {
 public:
  Frame() = default;
  Frame(const char* name) : Space(std::string(name)) {}  // NOLINT: "tool" is a Frame
  explicit Frame(std::string name) : Space(std::move(name)) {}
};

/// For values that are about nothing with names: a flag, a status, a plain number.
class Nothing : public Space {};

}  // namespace pliant

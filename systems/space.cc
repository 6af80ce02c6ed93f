#include "pliant/systems/space.h"

#include <algorithm>

#include "pliant/systems/error.h"
#include "pliant/systems/signal.h"

namespace pliant {

std::string Space::text() const {
  if (!frame_.empty()) return "in " + frame_;
  if (size() == 0) return "";
  std::string all;
  for (const std::string& name : *names_) all += (all.empty() ? "(" : ", ") + name;
  return all + ")";
}

Joints::Joints(std::vector<std::string> names) : Space(std::move(names)) {
  Require(size() <= kMaxJoints,
          "a vector of joints has at most " + Text(kMaxJoints) +
              " elements; configure with -DPLIANT_MAX_JOINTS=… for more",
          size());
  for (int i = 0; i < size(); ++i)
    for (int k = 0; k < i; ++k)
      Require((*this)[i] != (*this)[k], "joint names must differ", (*this)[i]);
}

Joints Joints::Numbered(int n) {
  std::vector<std::string> names;
  for (int i = 1; i <= n; ++i) names.push_back("joint_" + std::to_string(i));
  return Joints(std::move(names));
}

}  // namespace pliant

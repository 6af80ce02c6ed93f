#include "pliant/systems/signal.h"

namespace pliant {

// Not inline: the products would be compiled again in every file that sees a signal.

Pose Pose::operator*(const Pose& X_BC) const {
  return {position + rotation * X_BC.position, rotation * X_BC.rotation};
}

Pose Pose::inverse() const { return {-(rotation.transpose() * position), rotation.transpose()}; }

}  // namespace pliant

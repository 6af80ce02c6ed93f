// use of deleted function
#include "pliant/systems/signal.h"

pliant::JointTorque Damping(const pliant::JointVelocity& v) { return v; }

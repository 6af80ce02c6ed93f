#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// What a column of a log is: one number of a joint, or the time.
enum class SampleKind { Time, Position, Velocity, Acceleration, Current, Torque };

/// "time", "position", "velocity", …, as options and messages call them.
std::string_view NameOf(SampleKind kind);

/// What one `unit` is in s, rad, rad/s, rad/s², A or N·m: 0.017… for a velocity in "deg/s". Empty:
/// SI. "-Nm" turns the sign. Throws Error with the units that are known.
double UnitFactor(SampleKind kind, std::string_view unit);

}  // namespace pliant

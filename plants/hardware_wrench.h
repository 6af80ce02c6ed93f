#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "pliant/plants/wrench_source.h"
#include "pliant/systems/block.h"

namespace pliant {

/// How good a wrench of a sensor is.
struct WrenchStatus {
  using Space = Nothing;
  static constexpr Quantity quantity{"wrench status", ""};

  double age = 0;  ///< since the tick that took the last good measurement, or the start [s]
  LinkCounts link;
  std::uint32_t device = 0;  ///< status of the last measurement, as the sensor words it

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("age", age, "s");
    f("lost", link.lost, "");
    f("corrupted", link.corrupted, "");
    f("out_of_order", link.out_of_order, "");
    f("duplicated", link.duplicated, "");
    f("device", device, "");
  }
};

/// The wrench of a sensor that is there, at ticks of a period, as WristSensor has it: of the
/// environment on the robot, [moment; force] in the axes of `frame`,
///
///   wrench = s [R M; R F] − b
///
/// of the newest measurement (M, F). It is valid if
///
///   - the sensor does not call the measurement faulty,
///   - it is finite, and s [R M; R F] within the range,
///   - fewer than n = ⌈stale_after/period⌉ ticks have passed since one was new: neither missing nor
///     the same as before.
///
/// Otherwise `wrench` stays what it was when it was valid last; zero before the first. One
/// measurement that is good makes it valid again.
///
/// It reads the world, so a run is not repeated by restoring it: replay a recording for that.
class HardwareWrench final : public Block {
 public:
  struct Options {
    std::shared_ptr<WrenchSource> source = {};  ///< null: none is there, and nothing is valid
    std::string frame = {};                     ///< link whose frame the wrench is in
    Duration period = 1ms;
    Duration stale_after = 10ms;
    Wrench bias = {};                                    ///< b
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< R, of the sensor in `frame`
    double sign = 1;    ///< s: −1 of a sensor that shows what the robot does to the environment
    Wrench range = {};  ///< largest reading, each ≥ 0; 0: any
  };

  explicit HardwareWrench(const Options& o);

  Output<Wrench> wrench;
  Output<bool> valid;
  Output<WrenchStatus> status;

 private:
  struct Memory {
    using Space = Frame;
    static constexpr Quantity quantity{"hardware wrench memory", ""};

    Wrench wrench;
    bool good = false;           ///< the last measurement
    bool any = false;            ///< measurement was there
    std::uint32_t sequence = 0;  ///< of the last one
    std::uint32_t device = 0;
    std::int64_t since_new = 0, since_good = 0;  ///< ticks
    LinkCounts link;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("wrench", wrench, "N·m, N");
      f("good", good, "");
      f("any", any, "");
      f("sequence", sequence, "");
      f("device", device, "");
      f("since_new", since_new, "");
      f("since_good", since_good, "");
      f("link", link, "");
    }
  };

  Memory Next(const Memory& last) const;
  bool IsValid(const Memory& m) const { return m.good && m.since_new < stale_; }
  WrenchStatus StatusOf(const Memory& m) const;

  const std::shared_ptr<WrenchSource> source_;
  const double h_;
  const std::int64_t stale_;  // n
  const Wrench bias_, range_;
  const Eigen::Matrix3d R_;
  const double sign_;
  Output<Memory> memory_;
};

}  // namespace pliant

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/live_view.h"
#include "pliant/controllers/operator_panel.h"
#include "pliant/diagrams/fault_order.h"
#include "pliant/plants/gen3_address.h"
#include "pliant/systems/real_time_runner.h"

namespace pliant {

struct ArmRunOptions {
  std::filesystem::path out;  ///< the log goes to out/logs; made if it is not there
  bool force = false;         ///< write over a log that is there
  std::string user = "admin", password = "admin";
  Overrun overrun = Overrun::Skip;
  RealTimePermissions::Options permissions = {};
  std::shared_ptr<OperatorPanel> panel = std::make_shared<OperatorPanel>();
  std::function<void(const std::string&)> say = {};  ///< lines for who stands at the arm
  std::vector<FaultOrder> faults = {};               ///< a drill: those of CommandFaults
  LiveView* view = nullptr;                          ///< shows the run
  /// The way to the arm; empty: its protocol on the wire.
  std::function<std::unique_ptr<Gen3Link>(const Gen3Address&)> connect = {};
};

/// How a run on an arm went.
struct ArmRun {
  std::string address;  ///< of the arm
  std::filesystem::path log;
  bool whole = false;        ///< it came to its end, and no fault
  SafetyReport safety;       ///< at the end
  RunReport timing;          ///< of the ticks
  Gen3Report arm;            ///< frames, and the faults that the arm reports
  std::string services;      ///< that failed before, in the arm's words; empty: none did
  std::string handing_back;  ///< what did not work there; empty: all did

  std::string text() const;  ///< for who stands at the arm
};

/// Runs the one run of an experiment on the arm of its station, !Gen3. It is the diagram of the
/// simulation, with the arm in the place of the plant:
///
///   - a guard hands the arm back if this process dies; the arm is asked where it is
///   - the offset of a wrist sensor is the mean of 200 measurements less the weight of what hangs
///     on it: nothing may touch it then
///   - ticks by the wall clock, 1 kHz, or in lock-step with an emulator
///   - from the scenario's duration on, or when the panel says so, the arm is stopped
///   - the arm is handed back, however the run ends
///
/// Every tick has a row in the log; rows that the disk is too slow for are dropped and counted.
/// Throws Error if the file is none for an arm or its log is there, FailedRun if there is no such
/// arm or sensor, and what the run throws.
ArmRun RunOnArm(const ExperimentFile& file, const ArmRunOptions& o);

}  // namespace pliant

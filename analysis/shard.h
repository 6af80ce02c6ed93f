#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace pliant {

/// One of several processes that share runs: it makes those whose index modulo `of` is
/// `number` − 1.
struct Shard {
  std::uint32_t number = 1, of = 1;
  std::string from = {};  ///< who says so, in words

  bool has(std::uint64_t run) const { return run % of == number - 1; }

  /// "2/8", the second of eight. Throws Error for what is none.
  static Shard Read(const std::string& text);

  /// What a launcher says: OMPI_COMM_WORLD_RANK and _SIZE of Open MPI, PMI_RANK and PMI_SIZE of
  /// MPICH and others, or SLURM_ARRAY_TASK_ID, _MIN and _COUNT, of which each may be a step of
  /// SLURM_STEP_NUM_TASKS tasks, SLURM_PROCID. Throws Error for numbers that contradict each other.
  static Shard OfEnvironment(
      const std::function<std::optional<std::string>(const char*)>& variable = Environment);
  static std::optional<std::string> Environment(const char* name);
};

}  // namespace pliant

#include "pliant/analysis/shard.h"

#include <cstdlib>
#include <string_view>

#include "pliant/analysis/printable.h"
#include "pliant/analysis/read_number.h"
#include "pliant/systems/error.h"

namespace pliant {

using internal::ReadNumber;

namespace {

constexpr std::uint32_t kMostShards = 1'000'000;

using Variable = std::function<std::optional<std::string>(const char*)>;

std::uint32_t NumberIn(const Variable& variable, const char* name) {
  const std::optional<std::string> text = variable(name);
  const auto number = text ? ReadNumber<std::uint32_t>(*text) : std::nullopt;
  if (!number)
    throw Error("the launcher's " + std::string(name) + " must be a whole number, got " +
                (text ? "'" + Printable(*text) + "'" : "none") + "; --shard 1/1 does without it");
  return *number;
}

/// A rank from 0 of so many.
struct Rank {
  std::uint32_t number = 0, of = 1;
};

Rank RankIn(const Variable& variable, const char* rank, const char* size) {
  const Rank found{NumberIn(variable, rank), NumberIn(variable, size)};
  if (found.number >= found.of || found.of > kMostShards)
    throw Error("the launcher's " + std::string(rank) + "=" + Text(found.number) + " and " + size +
                "=" + Text(found.of) + " do not go together");
  return found;
}

Rank ArrayTaskIn(const Variable& variable) {
  const std::uint32_t id = NumberIn(variable, "SLURM_ARRAY_TASK_ID"),
                      least = NumberIn(variable, "SLURM_ARRAY_TASK_MIN"),
                      count = NumberIn(variable, "SLURM_ARRAY_TASK_COUNT");
  if (id < least || id - least >= count || count > kMostShards)
    throw Error("the tasks of a Slurm array must be numbered without gaps, such as --array=0-" +
                Text(count > 0 ? count - 1 : 0) + "; task " + Text(id) + " of " + Text(count) +
                " from " + Text(least) + " is beyond them");
  return {id - least, count};
}

Shard ShardOf(const Rank& rank, std::string from) {
  return {rank.number + 1, rank.of, std::move(from)};
}

}  // namespace

Shard Shard::Read(const std::string& text) {
  const std::size_t sign = text.find('/');
  const auto number = ReadNumber<std::uint32_t>(std::string_view(text).substr(0, sign));
  const auto of = ReadNumber<std::uint32_t>(
      sign == std::string::npos ? "" : std::string_view(text).substr(sign + 1));
  if (!number || !of || *number < 1 || *number > *of || *of > kMostShards)
    throw Error("--shard wants i/N with 1 <= i <= N <= " + std::to_string(kMostShards) +
                ", such as 2/8, got " + Printable(text));
  return {*number, *of, "--shard"};
}

Shard Shard::OfEnvironment(const Variable& variable) {
  struct Launcher {
    const char *name, *rank, *size, *is_there;
  };
  std::string from;
  Rank process;
  for (const Launcher& launcher :
       {Launcher{"Open MPI", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE",
                 "OMPI_COMM_WORLD_RANK"},
        Launcher{"MPI", "PMI_RANK", "PMI_SIZE", "PMI_RANK"},
        Launcher{"Slurm", "SLURM_PROCID", "SLURM_STEP_NUM_TASKS", "SLURM_STEP_NUM_TASKS"}}) {
    if (!variable(launcher.is_there)) continue;
    from = launcher.name;
    process = RankIn(variable, launcher.rank, launcher.size);
    break;
  }
  Rank task;
  if (variable("SLURM_ARRAY_TASK_ID")) {
    task = ArrayTaskIn(variable);
    from = from.empty() || from == "Slurm" ? "Slurm" : from + " in a Slurm array";
  }
  if (from.empty()) return {};
  if (static_cast<std::uint64_t>(task.of) * process.of > kMostShards)
    throw Error("Slurm has " + Text(task.of) + " array tasks of " + Text(process.of) +
                " processes, and a sweep has at most " + std::to_string(kMostShards) + " parts");
  return ShardOf({task.number * process.of + process.number, task.of * process.of}, from);
}

std::optional<std::string> Shard::Environment(const char* name) {
  const char* const value = std::getenv(name);
  return value ? std::optional<std::string>(value) : std::nullopt;
}

}  // namespace pliant

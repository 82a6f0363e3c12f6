#include "app/commands/shards/launcher.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace fettle::app {

namespace {

using engine::Shard;

// Where a launcher says which of how many tasks a process is.
struct LauncherVariables {
  const char* title;
  const char* number;
  const char* count;
  bool array = false;  // numbers begin at a variable of their own, and may lie apart
  bool outer = false;  // of nodes or steps that another launcher divides further
};

constexpr std::array<LauncherVariables, 4> kLaunchers{
    {{"Slurm's task array", "SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", true, false},
     {"Open MPI", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", false, false},
     {"MPI", "PMI_RANK", "PMI_SIZE", false, false},
     {"srun", "SLURM_PROCID", "SLURM_NTASKS", false, true}}};

std::optional<int> wholeNumber(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

engine::Result<int> numberIn(const char* name, const char* text) {
  const auto number = wholeNumber(text);
  if (!number)
    return engine::inputError(fmt::format("{} is not a whole number", text), name,
                              "start it by the launcher, or give --shard K/N");
  return *number;
}

engine::Result<std::optional<Shard>> shardOf(const LauncherVariables& launcher,
                                             const Environment& environment) {
  const char* const number = environment(launcher.number);
  const char* const count = environment(launcher.count);
  if (number == nullptr && count == nullptr) return std::nullopt;
  if (number == nullptr || count == nullptr) {
    // A batch script outside of an array and of steps has one of srun's.
    if (launcher.outer) return std::nullopt;
    return engine::inputError(
        fmt::format("{} is not set", number == nullptr ? launcher.number : launcher.count),
        number == nullptr ? launcher.count : launcher.number,
        "start it by the launcher, or give --shard K/N");
  }
  const auto k = numberIn(launcher.number, number), n = numberIn(launcher.count, count);
  if (!k) return tl::unexpected(k.error());
  if (!n) return tl::unexpected(n.error());
  int first = 0, step = 1;
  for (const auto& [name, to] : {std::pair{"SLURM_ARRAY_TASK_MIN", &first}, {"SLURM_ARRAY_TASK_STEP", &step}})
    if (const char* const text = launcher.array ? environment(name) : nullptr) {
      const auto value = numberIn(name, text);
      if (!value) return tl::unexpected(value.error());
      *to = *value;
    }
  const int offset = *k - first;
  if (step < 1 || *n < 1 || *n > Shard::kMost || offset < 0 || offset % step != 0 || offset / step >= *n)
    return engine::inputError(fmt::format("{} of {} tasks is none", number, count), launcher.number,
                              "start it by the launcher, or give --shard K/N");
  return Shard{offset / step + 1, *n};
}

}  // namespace

const char* variableOfProcess(const char* name) {
  return std::getenv(name);
}

engine::Result<std::optional<Shard>> shardOfLauncher(const Environment& environment) {
  const LauncherVariables* by = nullptr;
  std::optional<Shard> found;
  for (const LauncherVariables& launcher : kLaunchers) {
    const auto shard = shardOf(launcher, environment);
    if (!shard) return tl::unexpected(shard.error());
    if (!*shard) continue;
    if (!found || found->count == 1) {
      by = &launcher;
      found = **shard;
    } else if ((*shard)->count > 1 && !(launcher.outer && !by->array) && **shard != *found) {
      return engine::inputError(fmt::format("{} says {} of {}, {} says {} of {}", by->title, found->number,
                                            found->count, launcher.title, (*shard)->number, (*shard)->count),
                                launcher.number, "let only one of them divide the work, or give --shard K/N");
    }
  }
  return found;
}

engine::Result<Shard> parseShard(const std::string& typed, int planned, const Environment& environment) {
  Shard shard;
  if (typed == "auto") {
    const auto found = shardOfLauncher(environment);
    if (!found) return tl::unexpected(found.error());
    if (!*found)
      return engine::inputError("no launcher says which shard this is", "--shard auto",
                                "start it by sbatch --array, srun or mpirun, or give --shard K/N");
    shard = **found;
  } else {
    const std::size_t slash = typed.find('/');
    const auto k = wholeNumber(std::string_view(typed).substr(0, slash));
    const auto n = slash == std::string::npos ? std::optional(planned)
                                              : wholeNumber(std::string_view(typed).substr(slash + 1));
    if (!k || !n || *n > Shard::kMost || (*n < 1 && slash != std::string::npos))
      return engine::inputError(fmt::format("{} is not a shard", typed), "--shard",
                                "give K/N, counted from 1 as in 2/7, or auto");
    if (*n == 0)
      return engine::inputError(fmt::format("shard {} of how many", *k), "--shard", "give K/N, as in 2/7");
    shard = {*k, *n};
  }
  if (shard.number < 1 || shard.number > shard.count)
    return engine::inputError(fmt::format("there is no shard {} of {}", shard.number, shard.count), "--shard",
                              fmt::format("give 1/{0} to {0}/{0}", shard.count));
  if (planned != 0 && shard.count != planned)
    return engine::inputError(
        fmt::format("this is a shard of {}, the work was planned for {}", shard.count, planned), "--shard",
        fmt::format("start {} of them, or plan again", planned));
  return shard;
}

}  // namespace fettle::app

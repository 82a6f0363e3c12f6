#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include "app/commands/command.h"
#include "app/commands/shards/shard_folder.h"
#include "app/commands/shards/shard_option.h"
#include "app/commands/shards/submit_script.h"
#include "engine/io/files/atomic_file.h"

extern char** environ;

namespace fettle::app {

namespace {

struct SubmitArguments {
  std::string out;
  std::string engine;
  int at_once = 0, threads = 0, tasks = 1000;
  std::string more;
  bool run = false;
};

// Runs a script to its end, with this process's own output. `array`: it asks Slurm for an array.
engine::Status runScript(const std::string& path, bool array) {
  std::string shell = "/bin/sh", script = path;
  char* const arguments[] = {shell.data(), script.data(), nullptr};
  pid_t process = 0;
  if (const int error = posix_spawn(&process, shell.c_str(), nullptr, nullptr, arguments, environ);
      error != 0)
    return engine::failure("the script could not be started: " + std::generic_category().message(error),
                           path);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  return engine::failure(
      "the script did not end well", path,
      std::string("see what is printed above, and fettle status; the same command continues") +
          (array ? ". Where Slurm refuses so large an array, give --tasks" : ""));
}

engine::Result<Report> submit(const SubmitArguments& options) {
  const ShardFolder folder(options.out);
  const auto plan = readPlan(folder.plan());
  if (!plan) return tl::unexpected(plan.error());
  if (plan->inTurn())
    return engine::inputError("these bands are worked on in turn by one process", folder.plan(),
                              "run the same command again, or plan with --again");
  SubmitOptions asked;
  asked.engine = options.engine == "slurm" ? ShardEngine::kSlurm
                 : options.engine == "mpi" ? ShardEngine::kMpi
                                           : ShardEngine::kLocal;
  asked.threads = options.threads;
  asked.tasks = options.tasks;
  const ShardNeeds needs = needsOf(*plan, options.threads);
  asked.at_once = options.at_once;
  if (asked.engine == ShardEngine::kLocal && asked.at_once == 0)
    asked.at_once = std::max(1, usableCores() / needs.threads);
  asked.more = options.more;
  std::error_code error;
  asked.program = std::filesystem::read_symlink("/proc/self/exe", error).string();
  if (error) asked.program = "fettle";
  const std::string script = submitScript(*plan, asked);
  Report report{{"engine", options.engine},
                {"shards", plan->shards},
                {"threads", needs.threads},
                {"memory_per_shard", static_cast<std::uint64_t>(needs.memory_bytes)},
                {"seconds_per_shard", needs.seconds},
                {"script", script},
                {"run", options.run}};
  if (!options.run) return report;
  const std::string file = folder.path() + "/submit.sh";
  if (auto status = engine::writeFileAtomically(file, script); !status) return tl::unexpected(status.error());
  const bool array = asked.engine == ShardEngine::kSlurm && plan->shards > 1;
  if (auto status = runScript(file, array); !status) return tl::unexpected(status.error());
  return report;
}

// The script is what was asked for; one that ran has printed what there is to say.
void printSubmit(const Report& report) {
  if (!report["run"].get<bool>()) fmt::print("{}", report["script"].get<std::string>());
}

}  // namespace

void addSubmit(Command root, Chosen& chosen) {
  auto options = std::make_shared<SubmitArguments>();
  Command command = addCommand(
      root, chosen, "submit", "Print, or run, the job that does all shards of a plan and gathers them",
      [options](engine::JobControl&) { return submit(*options); }, printSubmit, Progress::kOwn, {},
      Printing::kResult);
  command.add(
      {{.name = "OUT",
        .to = &options->out,
        .text = "The file that was planned",
        .kind = ValueKind::kFile,
        .required = true},
       {.name = "--engine",
        .to = &options->engine,
        .text = "Who starts the shards",
        .words = {{"slurm", "a task array of Slurm, and a job after it"},
                  {"mpi", "mpirun, a rank for each"},
                  {"local", "processes of this machine"}},
        .required = true},
       {.name = "--run", .to = &options->run, .text = "Run the job instead of printing it"},
       {.name = "--at-once",
        .to = &options->at_once,
        .text = "Shards that run at the same time",
        .range = Range{0.0, 100000.0},
        .otherwise = "0, all of them; on one machine as its cores allow"},
       {.name = "--threads",
        .to = &options->threads,
        .text = "Cores of each shard",
        .range = Range{1.0, 1024.0},
        .otherwise = "as fettle plan was told, 1"},
       {.name = "--tasks",
        .to = &options->tasks,
        .text = "Slurm: tasks of the array, as a site allows (MaxArraySize); of more shards each task does "
                "several",
        .range = Range{1.0, 1000000.0}},
       {.name = "--with",
        .to = &options->more,
        .text = "Further words for sbatch or mpirun, as \"--partition=long\"",
        .shown = "WORDS"}});
}

}  // namespace fettle::app

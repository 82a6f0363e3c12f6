#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/shards/gathering.h"
#include "app/commands/shards/shard_note.h"
#include "app/terminal.h"

namespace fettle::app {

namespace {

// What a shard that runs says of itself; null where none does.
Report noteOfRunning(const ShardFolder& folder, int number) {
  const std::string path = folder.note(number);
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  if (error) return {};
  const std::chrono::duration<double> age = std::filesystem::file_time_type::clock::now() - time;
  if (age.count() > kOldNote) return {};
  std::ifstream file(path);
  const Report note = Report::parse(file, nullptr, false);
  // Half a note is one that is being written.
  return note.is_object() ? note : Report::object();
}

engine::Result<Report> statusOf(const std::string& out) {
  const ShardFolder folder(out);
  const auto plan = readPlan(folder.plan());
  if (!plan) return tl::unexpected(plan.error());
  Report running = Report::array();
  std::vector<int> done, stopped, waiting;
  double work = 0.0, seconds = 0.0;
  for (int k = 1; k <= plan->shards; ++k) {
    if (const Report shard = reportOfShard(folder, *plan, k); !shard.is_null()) {
      done.push_back(k);
      work += 1.0;
      seconds += shard["seconds"].get<double>();
      continue;
    }
    Report note = noteOfRunning(folder, k);
    std::error_code ignored;
    if (note.is_null()) {
      (std::filesystem::exists(folder.note(k), ignored) ? stopped : waiting).push_back(k);
      continue;
    }
    work += note.value("stage", std::string()) == "filtering" ? note.value("share", 0.0) : 0.0;
    running.push_back({{"shard", k},
                       {"host", note.value("host", std::string())},
                       {"stage", note.value("stage", std::string())},
                       {"share", note.value("share", 0.0)}});
  }
  const double each = done.empty() ? plan->seconds : seconds / static_cast<double>(done.size());
  const auto at_once = static_cast<double>(running.empty() ? 1 : running.size());
  return Report{
      {"shards", plan->shards},
      {"done", done},
      {"running", running},
      {"stopped", stopped},
      {"waiting", waiting},
      {"share", work / plan->shards},
      {"seconds_left",
       done.size() == static_cast<std::size_t>(plan->shards) ? 0.0 : each * (plan->shards - work) / at_once}};
}

// "5 of 7 shards done, 1 runs (tower: 43 %), 1 stopped: 3; about 2 min left".
void printStatus(const Report& report) {
  std::string text = fmt::format("{} of {} shards done", report["done"].size(), report["shards"].get<int>());
  if (const Report& running = report["running"]; !running.empty()) {
    double share = 0.0;
    for (const Report& each : running)
      share += each["share"].get<double>() / static_cast<double>(running.size());
    text +=
        fmt::format(", {} run{} ({:.0f} %)", running.size(), running.size() == 1 ? "s" : "", 100.0 * share);
  }
  for (const char* which : {"stopped", "waiting"})
    if (!report[which].empty())
      text += fmt::format(", {} {}: {}", report[which].size(), which,
                          numbersText(report[which].get<std::vector<int>>()));
  if (!report["running"].empty())
    text += fmt::format("; about {} left", durationText(report["seconds_left"].get<double>()));
  fmt::print("{}\n", text);
}

}  // namespace

void addStatus(Command root, Chosen& chosen) {
  auto out = std::make_shared<std::string>();
  Command command = addCommand(
      root, chosen, "status", "How far the shards of a plan are, in one line",
      [out](engine::JobControl&) { return statusOf(*out); }, printStatus, Progress::kLine, {},
      Printing::kResult);
  command.add({{.name = "OUT",
                .to = out.get(),
                .text = "The file that was planned",
                .kind = ValueKind::kFile,
                .required = true}});
}

}  // namespace fettle::app

#include "app/commands/shards/list_shard.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/commands/shards/gathering.h"
#include "app/commands/shards/launcher.h"
#include "app/commands/shards/shard_plan.h"
#include "app/commands/shell_word.h"
#include "app/work/outputs.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

engine::Result<ListShard> ListShard::begin(const std::vector<BatchTask>& tasks, const std::string& typed,
                                           const std::string& folder,
                                           const std::vector<std::string>& arguments) {
  ListShard mine;
  if (typed.empty()) {
    mine.tasks_ = tasks;
    return mine;
  }
  const auto chosen = parseShard(typed, 0, variableOfProcess);
  if (!chosen) return tl::unexpected(chosen.error());
  mine.shard_ = *chosen;
  for (auto i = static_cast<std::size_t>(chosen->number - 1); i < tasks.size();
       i += static_cast<std::size_t>(chosen->count))
    mine.tasks_.push_back(tasks[i]);
  if (folder.empty()) return mine;
  // What does not change a result, and where the program and a table of each shard's own lie, may differ between machines.
  const std::vector<std::string> words = wordsWithout(
      arguments, {"--json", "-q", "--quiet", "--force", "--resume"}, {"--shard", "--threads", "--csv"});
  std::string work;
  for (std::size_t i = 1; i < words.size(); ++i) (work += words[i]) += '\n';
  mine.work_ = hashOfText(work);
  mine.file_ =
      (std::filesystem::path(folder) / "shards" / fmt::format("{}-of-{}.json", chosen->number, chosen->count))
          .string();
  if (auto status = checkPlaces({{mine.file_, OutputKind::kText, {}, true}}, {}); !status)
    return tl::unexpected(status.error());
  std::error_code error;
  std::filesystem::remove(mine.file_, error);
  if (error) return engine::writeError(mine.file_, error.value());
  return mine;
}

engine::Status ListShard::keep(const Report& report) const {
  if (file_.empty()) return {};
  const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return engine::writeError(folder.string(), error.value());
  Report file{
      {"schema", "fettle.gather/1"}, {"shard", shard_.number}, {"shards", shard_.count}, {"work", work_}};
  file.update(report);
  return engine::writeFileAtomically(file_,
                                     file.dump(1, ' ', false, Report::error_handler_t::replace) + "\n");
}

bool isListFolder(const std::string& folder) {
  std::error_code error;
  return std::filesystem::is_directory(std::filesystem::path(folder) / "shards", error);
}

engine::Result<Report> gatherList(const std::string& folder) {
  const std::filesystem::path shards = std::filesystem::path(folder) / "shards";
  std::error_code error;
  std::map<int, Report> found;
  std::optional<int> count;
  for (const auto& entry : std::filesystem::directory_iterator(shards, error)) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream file(entry.path());
    Report report = Report::parse(file, nullptr, false);
    if (!report.is_object() || !report.value("shard", Report()).is_number_integer() ||
        !report.value("shards", Report()).is_number_integer() ||
        !report.value("work", Report()).is_string() || !report.value("files", Report()).is_array())
      return engine::failure("this is not the report of a shard", entry.path().string(),
                             "do the shard again, or remove the file");
    if (count && *count != report["shards"])
      return engine::failure(
          fmt::format("there are shards of {} and of {}", *count, report["shards"].get<int>()),
          shards.string(), "remove those of the other run");
    count = report["shards"].get<int>();
    const int number = report["shard"].get<int>();
    found[number] = std::move(report);
  }
  if (!count)
    return engine::inputError("there is no report of a shard", shards.string(), "run the shards first");
  std::vector<int> missing;
  for (int k = 1; k <= *count; ++k)
    if (!found.contains(k)) missing.push_back(k);
  if (!missing.empty())
    return engine::failure(fmt::format("{} of {} shards {} not done: {}", missing.size(), *count,
                                       missing.size() == 1 ? "is" : "are", numbersText(missing)),
                           shards.string(), "run the same command with --shard K/N for them");
  for (const auto& [k, report] : found)
    if (report["work"] != found.begin()->second["work"])
      return engine::failure(
          fmt::format("shard {} was done by another command, or of another list, than shard {}", k,
                      found.begin()->first),
          shards.string(), "do the shards of the earlier command again by the later one");
  Report files = Report::array();
  std::size_t failed = 0;
  // Every count-th scan is of one shard: taken in turn they have the order of the list.
  for (std::size_t i = 0;; ++i) {
    bool any = false;
    for (auto& [k, report] : found) {
      if (i >= report["files"].size()) continue;
      any = true;
      files.push_back(report["files"][i]);
      failed += files.back().contains("error") ? 1 : 0;
    }
    if (!any) break;
  }
  return Report{
      {"shards", *count}, {"done", files.size() - failed}, {"failed", failed}, {"files", std::move(files)}};
}

}  // namespace fettle::app

#include "app/commands/finished_scans.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "app/terminal.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

constexpr const char* kNoteKind = "finished scan 1";

std::string noteOf(const std::string& out) {
  return out + ".finished";
}

// Size and time of a file; null where there is none.
Report stampOf(const std::string& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (error) return {};
  const auto time = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  if (error) return {};
  return {{"bytes", bytes}, {"time", static_cast<std::int64_t>(time)}};
}

}  // namespace

std::optional<Report> FinishedScans::earlier(const std::string& out, const std::string& identity) const {
  if (!active_) return std::nullopt;
  std::ifstream file(noteOf(out), std::ios::binary);
  if (!file.is_open()) return std::nullopt;
  const Report note = Report::parse(file, nullptr, false);
  const Report stamp = stampOf(out);
  if (!note.is_object() || stamp.is_null() || note.value("fettle", Report()) != kNoteKind ||
      note.value("identity", Report()) != identity || note.value("file", Report()) != stamp ||
      !note.value("report", Report()).is_object())
    return std::nullopt;
  app::note(fmt::format("{}: finished by an earlier run, kept", out));
  Report report = note["report"];
  report["finished_before"] = true;
  return report;
}

void FinishedScans::add(const std::string& out, const std::string& identity, const Report& report) const {
  if (!active_) return;
  const Report note{
      {"fettle", kNoteKind}, {"identity", identity}, {"file", stampOf(out)}, {"report", report}};
  const std::string text = note.dump(1, ' ', false, Report::error_handler_t::replace) + "\n";
  if (auto status = engine::writeFileAtomically(noteOf(out), text); !status)
    warn(fmt::format("{}: that {} is finished is not kept, the same command would do it again",
                     status.error().line(), out));
}

void FinishedScans::end(const std::vector<BatchTask>& tasks, const Report& batch) const {
  if (!active_) return;
  if (batch.contains("failed") && batch["failed"] != 0) {
    note("the same command does only the scans that failed");
    return;
  }
  std::error_code ignored;
  for (const BatchTask& task : tasks) std::filesystem::remove(noteOf(task.out), ignored);
}

std::string writingIdentity(const engine::Grid& grid, const engine::ExportOptions& writing) {
  return fmt::format("grid {} {} {} {} {} {} {} {}\nwriting {}\n", grid.spacing_x, grid.spacing_y,
                     grid.origin_x, grid.origin_y, grid.lateral_unit.name, grid.height_unit.name,
                     grid.height_per_count, grid.crs_wkt,
                     writing.tiff_compression ? static_cast<int>(*writing.tiff_compression) : -1);
}

}  // namespace fettle::app

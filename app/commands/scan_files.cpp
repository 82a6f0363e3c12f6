#include "app/commands/scan_files.h"

#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/formats/formats.h"
#include "engine/io/lines/lines.h"
#include "engine/io/raster/marks.h"

namespace fettle::app {

void addStreamFormat(Command command, std::string& to) {
  command.add({{.name = "--to",
                .to = &to,
                .text = "With - for OUT, standard output: its format, as extension",
                .kind = ValueKind::kFormat}});
}

namespace {

engine::Result<engine::Imported> warned(engine::Result<engine::Imported> imported, const std::string& name) {
  if (imported)
    for (const std::string& warning : imported->warnings) warn(fmt::format("{}: {}", name, warning));
  return imported;
}

}  // namespace

engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                          engine::JobControl& job) {
  const auto import = importOptions(options);
  if (!import) return tl::unexpected(import.error());
  if (!isStream(path)) return warned(engine::importField(path, *import, job), path);
  const auto input = StandardInput::read(options.from.empty() ? "" : withDot(options.from), job);
  if (!input) return tl::unexpected(input.error());
  auto imported = engine::importField(input->path(), *import, job);
  if (!imported) return tl::unexpected(input->renamed(imported.error()));
  return warned(std::move(imported), shownInput(path));
}

engine::Result<engine::Version> withMarks(const engine::Version& field, const std::string& picture) {
  return picture.empty() ? field : engine::importMarks(field, picture);
}

engine::Result<engine::Version> withLines(const engine::Version& field, const std::string& file) {
  if (file.empty()) return field;
  auto lines = engine::importLines(file, field);
  if (!lines) return tl::unexpected(lines.error());
  // A number that a file uses twice is that of two lines.
  std::int64_t id = 0;
  for (engine::EdgeLine& line : *lines) line.id = id++;
  return field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(*std::move(lines)));
}

std::string hashOf(const engine::Version& field) {
  return fmt::format("{:016x}", engine::contentHash(field));
}

engine::Status saveField(const engine::Version& field, const std::string& path, engine::JobControl& job,
                         const engine::ExportOptions& writing, const std::string& to) {
  return writeTo(path, withDot(to), job, [&](const std::string& file) -> engine::Status {
    auto written = engine::exportField(field, file, writing, job);
    if (!written) return tl::unexpected(written.error());
    for (const std::string& warning : written->warnings)
      warn(fmt::format("{}: {}", shownOutput(path), warning));
    return {};
  });
}

}  // namespace fettle::app

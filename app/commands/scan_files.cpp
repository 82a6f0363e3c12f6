#include "app/commands/scan_files.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/field/mark_setter.h"
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
  if (const MemoryPlace* place = memoryPlace(path)) {
    if (place->scan) return *place->scan;
    return engine::inputError("this is not a scan", path, "give a field");
  }
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
  if (picture.empty()) return field;
  const MemoryPlace* place = memoryPlace(picture);
  if (place == nullptr) return engine::importMarks(field, picture);
  if (!place->scan)
    return engine::inputError("these are not marks", picture, "give a mask of the field's shape");
  const engine::FieldReader marks = place->scan->field.reader();
  if (marks.width() != field.grid().width || marks.height() != field.grid().height)
    return engine::inputError(
        fmt::format("the marks have {} rows and {} columns, the field {} and {}", marks.height(),
                    marks.width(), field.grid().height, field.grid().width),
        picture, "give marks of the field's shape");
  engine::MarkSetter setter(field);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(marks.width()));
  for (std::int32_t r = marks.height() - 1; r >= 0; --r) {
    marks.readMarks(0, r, marks.width(), 1, row.data(), marks.width());
    if (!setter.take(r, row.data()))
      return engine::failure("there is not enough memory for the marks", picture);
  }
  return setter.result();
}

engine::Result<std::vector<engine::EdgeLine>> readLines(const std::string& file,
                                                        const engine::Version& field) {
  const MemoryPlace* place = memoryPlace(file);
  if (place == nullptr) return engine::importLines(file, field);
  if (!place->lines) return engine::inputError("these are not edge lines", file, "give lines");
  return *place->lines;
}

engine::Result<engine::Version> withLines(const engine::Version& field, const std::string& file) {
  if (file.empty()) return field;
  auto lines = readLines(file, field);
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
  if (MemoryPlace* place = memoryPlace(path)) {
    place->scan.emplace();
    place->scan->field = field;
    place->scan->original = writing.original;
    return {};
  }
  return writeTo(path, withDot(to), job, [&](const std::string& file) -> engine::Status {
    auto written = engine::exportField(field, file, writing, job);
    if (!written) return tl::unexpected(written.error());
    for (const std::string& warning : written->warnings)
      warn(fmt::format("{}: {}", shownOutput(path), warning));
    return {};
  });
}

engine::Status saveMarks(const engine::Version& field, const std::string& path) {
  MemoryPlace* place = memoryPlace(path);
  if (place == nullptr) return engine::exportMarks(field, path);
  place->scan.emplace();
  place->scan->field = field;
  return {};
}

engine::Status saveLines(const std::string& path, std::span<const engine::EdgeLine> lines,
                         const engine::Grid& grid) {
  MemoryPlace* place = memoryPlace(path);
  if (place == nullptr) return engine::exportLines(path, lines, grid);
  place->lines.emplace(lines.begin(), lines.end());
  return {};
}

}  // namespace fettle::app

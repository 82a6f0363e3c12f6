#include "app/commands/scan_files.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <ios>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/field/mark_setter.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/io/lines/lines.h"
#include "engine/io/raster/marks.h"

namespace fettle::app {

void addStreamFormat(Command command, std::string& to) {
  command.add({{.name = "--to",
                .to = &to,
                .text = "With - for OUT, standard output: its format, as extension",
                .kind = ValueKind::kFormat,
                .proposed = extensionWords(&engine::FormatInfo::writes)}});
}

namespace {

engine::Result<engine::Imported> warned(engine::Result<engine::Imported> imported, const std::string& name) {
  if (imported)
    for (const std::string& warning : imported->warnings) warn(fmt::format("{}: {}", name, warning));
  return imported;
}

// The extension of the file whose first bytes these are; empty: unknown.
using Recogniser = std::string_view(std::string_view head) noexcept;

// Standard input in a file, if it is not there yet.
engine::Status readOnce(std::optional<StandardInput>& input, Recogniser* recognise, engine::JobControl& job) {
  if (input) return {};
  auto read = StandardInput::read("", job);
  if (!read) return tl::unexpected(read.error());
  if (recognise != nullptr) {
    std::array<char, 64> head{};
    std::ifstream file(read->path(), std::ios::binary);
    file.read(head.data(), head.size());
    const std::string_view extension =
        recognise({head.data(), static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0))});
    if (extension.empty())
      return engine::inputError("its format cannot be recognised", shownInput("-"),
                                "give edge lines as CSV, GeoJSON, GeoPackage or DXF");
    if (auto status = read->nameAs(std::string(extension)); !status) return status;
  }
  input.emplace(*std::move(read));
  return {};
}

// The marks of a field in memory, of the same shape.
engine::Result<engine::Version> withMarksOf(const MemoryPlace& place, const engine::Version& field,
                                            const std::string& name) {
  if (!place.scan) return engine::inputError("these are not marks", name, "give a mask of the field's shape");
  const engine::FieldReader marks = place.scan->field.reader();
  if (marks.width() != field.grid().width || marks.height() != field.grid().height)
    return engine::inputError(
        fmt::format("the marks have {} rows and {} columns, the field {} and {}", marks.height(),
                    marks.width(), field.grid().height, field.grid().width),
        name, "give marks of the field's shape");
  engine::MarkSetter setter(field);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(marks.width()));
  for (std::int32_t r = marks.height() - 1; r >= 0; --r) {
    marks.readMarks(0, r, marks.width(), 1, row.data(), marks.width());
    if (!setter.take(r, row.data())) return engine::failure("there is not enough memory for the marks", name);
  }
  return setter.result();
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

engine::Result<engine::Imported> loadSamples(const std::string& path, const ScanOptions& options,
                                             engine::JobControl& job) {
  auto imported = loadScan(path, options, job);
  if (!imported || imported->field.seenOf() == nullptr) return imported;
  warn(fmt::format("{}: its heights are taken with the form that lies over it", shownInput(path)));
  if (auto status = takeSamples(*imported, job); !status) return tl::unexpected(status.error());
  return imported;
}

engine::Status takeSamples(engine::Imported& imported, engine::JobControl& job) {
  for (engine::Version* version : {&imported.field, imported.original ? &*imported.original : nullptr}) {
    if (version == nullptr) continue;
    auto samples = engine::withoutLayer(*version, job);
    if (!samples) return tl::unexpected(samples.error());
    *version = *std::move(samples);
  }
  return {};
}

engine::Result<engine::Version> withMarks(const engine::Version& field, const std::string& picture,
                                          engine::JobControl& job) {
  if (picture.empty()) return field;
  if (const MemoryPlace* place = memoryPlace(picture)) return withMarksOf(*place, field, picture);
  if (!isStream(picture)) return engine::importMarks(field, picture);
  static std::optional<StandardInput> input;  // for every scan of the command
  if (auto status = readOnce(input, nullptr, job); !status) return tl::unexpected(status.error());
  auto marked = engine::importMarks(field, input->path());
  if (!marked) return tl::unexpected(input->renamed(marked.error()));
  return marked;
}

engine::Result<std::vector<engine::EdgeLine>> readLines(const std::string& file, const engine::Version& field,
                                                        engine::JobControl& job) {
  if (const MemoryPlace* place = memoryPlace(file)) {
    if (place->lines) return *place->lines;
    return engine::inputError("these are not edge lines", file, "give lines");
  }
  if (!isStream(file)) return engine::importLines(file, field, &job);
  static std::optional<StandardInput> input;  // for every scan of the command
  if (auto status = readOnce(input, engine::lineExtensionOf, job); !status)
    return tl::unexpected(status.error());
  auto lines = engine::importLines(input->path(), field, &job);
  if (!lines) return tl::unexpected(input->renamed(lines.error()));
  return lines;
}

engine::Result<engine::Version> withLines(const engine::Version& field, const std::string& file,
                                          engine::JobControl& job) {
  if (file.empty()) return field;
  auto lines = readLines(file, field, job);
  if (!lines) return tl::unexpected(lines.error());
  // A number that a file uses twice is that of two lines.
  std::int64_t id = 0;
  for (engine::EdgeLine& line : *lines) line.id = id++;
  return field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(*std::move(lines)));
}

engine::Result<engine::Session> loadSession(const std::string& path,
                                            const engine::SessionOpenOptions& options,
                                            engine::JobControl& job) {
  if (!isStream(path)) return engine::openSession(path, options, engine::importField, job);
  static std::optional<StandardInput> input;  // a session is opened twice where its history is needed
  if (auto status = readOnce(input, nullptr, job); !status) return tl::unexpected(status.error());
  auto session = engine::openSession(input->path(), options, engine::importField, job);
  if (!session) return tl::unexpected(input->renamed(session.error()));
  return session;
}

engine::Status saveMarks(const engine::Version& field, const std::string& path, engine::JobControl& job,
                         const std::string& to) {
  if (MemoryPlace* place = memoryPlace(path)) {
    place->scan.emplace();
    place->scan->field = field;
    return {};
  }
  return writeTo(path, withDot(to), job,
                 [&](const std::string& file) { return engine::exportMarks(field, file); });
}

engine::Status saveLines(const std::vector<engine::EdgeLine>& lines, const engine::Grid& grid,
                         const std::string& path, engine::JobControl& job) {
  if (MemoryPlace* place = memoryPlace(path)) {
    place->lines = lines;
    return {};
  }
  return writeTo(path, kLinesStream, job,
                 [&](const std::string& file) { return engine::exportLines(file, lines, grid); });
}

std::string hashOf(const engine::Version& field) {
  engine::JobControl job;
  const auto stored = engine::restored(field, job);
  if (!stored) throw std::bad_alloc();
  return fmt::format("{:016x}", engine::contentHash(*stored));
}

engine::Status saveField(const engine::Version& field, const std::string& path, engine::JobControl& job,
                         const engine::ExportOptions& writing, const std::string& to) {
  if (MemoryPlace* place = memoryPlace(path)) {
    place->scan.emplace();
    place->scan->field = field;
    place->scan->original = writing.original;
    place->scan->recipe = writing.recipe;
    place->scan->steps = writing.steps;
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

}  // namespace fettle::app

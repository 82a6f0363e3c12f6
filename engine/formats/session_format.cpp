// Sessions as a format of scans: reads the current field of the session as it is seen, marks included.

#include <algorithm>
#include <cstdint>
#include <tuple>

#include <fmt/format.h>

#include "engine/field/seen_field.h"
#include "engine/field/upright.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"
#include "engine/io/format.h"
#include "engine/remove/remove_step.h"
#include "engine/session/session.h"
#include "engine/session/session_reader.h"
#include "engine/session/stored_tiles.h"
#include "engine/session/tables.h"

namespace fettle::engine {

namespace {

bool looksLikeSession(std::string_view head, std::string_view extension) {
  // Another SQLite database is recognised, and refused, only if its name is that of a session.
  constexpr std::string_view kSqlite("SQLite format 3\0", 16);
  if (extension == ".fettle") return true;
  if (!head.starts_with(kSqlite) || head.size() < 72) return false;
  std::int64_t application = 0;
  for (std::size_t i = 68; i < 72; ++i) application = application << 8 | static_cast<unsigned char>(head[i]);
  return application == kSessionApplicationId;
}

// The note of steps, where they and no others led to the current state.
std::string stepsOfCommands(const Session& session) {
  const History& history = session.history;
  const auto steps = session.notes.find(kStepsNote);
  if (steps == session.notes.end() || history.number() != 1 || history.last() != 1 || history.first() != 0)
    return {};
  const StepInfo& only = history.info(1);
  return only.kind == StepKind::kImport && only.name == kByCommands ? steps->second : std::string();
}

// Whether a step before the current state may have removed samples: one of the window, or what commands did before it.
Result<bool> mayHaveRemoved(const std::string& path) {
  const Result<ReadingConnection> connection = ReadingConnection::open(path);
  if (!connection) return tl::unexpected(connection.error());
  SessionTables tables(connection->database());
  const auto head = tables.readHead();
  if (!head) return tl::unexpected(head.error());
  if (head->state < 2) return false;
  const auto steps = tables.readSteps(*head);
  if (!steps) return tl::unexpected(steps.error());
  return std::any_of(steps->begin() + 1, steps->begin() + head->state, [](const StepRow& step) {
    return step.info.kind == StepKind::kImport ||
           (step.info.kind == StepKind::kFilter && step.info.name.starts_with(kRemoveStep));
  });
}

// With all its states where what was removed and filled is to be found in them.
Result<Session> openedForReading(const std::string& path, JobControl& job) {
  SessionOpenOptions reading;
  reading.history_bytes = 0;
  reading.journal = JournalReading::kLeave;
  Result<Session> session = openSession(path, reading, importField, job);
  if (!session) return session;
  if (session->history.number() < 2) return session;
  const Result<bool> removed = mayHaveRemoved(path);
  if (!removed) return tl::unexpected(removed.error());
  if (!*removed) return session;
  reading.history_bytes = History::kNoBound;
  return openSession(path, reading, importField, job);
}

// The scan without the heights that were removed and filled since: none of these samples is a measured one.
Result<Version> measuredScan(const Session& session, JobControl& job) {
  const History& history = session.history;
  Result<Version> scan = session.original;
  for (std::int64_t k = std::max<std::int64_t>(history.first(), 1); k < history.number() && scan; ++k)
    scan = withoutReplaced(*scan, history.state(k), history.current(), job);
  return scan;
}

Result<Imported> readSession(const InputFile& file, const ImportOptions& options, JobControl& job) {
  if (options.no_data || options.z_scale)
    return inputError("a session stores heights and holes unchanged",
                      options.no_data ? "--no-data" : "--z-scale", "omit the option");
  Result<Session> session = openedForReading(file.path(), job);
  if (!session) return tl::unexpected(session.error());
  const Result<Version> scan = measuredScan(*session, job);
  if (!scan) return tl::unexpected(scan.error());
  Imported imported;
  imported.field = session->history.current();
  const bool inverted = imported.field.reader().sign() != scan->reader().sign();
  imported.original = (inverted ? scan->inverted() : *scan).withForm(imported.field.form());
  if (const auto recipe = session->notes.find(kRecipeNote); recipe != session->notes.end())
    imported.recipe = recipe->second;
  imported.steps = stepsOfCommands(*session);
  if (const auto sections = session->notes.find(kSectionsNote); sections != session->notes.end())
    imported.sections = sections->second;
  imported.format = "Fettle";
  Grid grid = imported.field.grid();
  if (options.spacing && *options.spacing != std::pair(grid.spacing_x, grid.spacing_y)) {
    imported.warnings.push_back(
        fmt::format("the session's spacing {} x {} was replaced", grid.spacing_x, grid.spacing_y));
    std::tie(grid.spacing_x, grid.spacing_y) = *options.spacing;
  }
  if (options.unit && (*options.unit != grid.lateral_unit || *options.unit != grid.height_unit)) {
    imported.warnings.push_back(fmt::format("the session's units {} and {} were replaced",
                                            grid.lateral_unit.name, grid.height_unit.name));
    grid.lateral_unit = grid.height_unit = *options.unit;
  }
  if (!(grid == imported.field.grid())) {
    imported.field = imported.field.withGrid(grid);
    imported.original = imported.original->withGrid(std::move(grid));
  }
  const auto seen = SeenField::of(imported.field, job);
  if (!seen) return tl::unexpected(seen.error());
  const auto original = seen->at(*imported.original, job);
  if (!original) return tl::unexpected(original.error());
  imported.field = seen->seen();
  imported.original = original->seen();
  return imported;
}

// A session (engine/session) that begins with this field, or with ExportOptions::original, marks, sign and form
// included, bit-identical.
Result<Exported> writeSession(const Version& field, const std::string& path, const ExportOptions& options,
                              JobControl& job) {
  // The original of a session is upright and has no form over it; either is a step from there.
  const bool inverted = field.reader().sign() < 0;
  Session session;
  session.original = upright(options.original.value_or(field)).withForm(nullptr);
  session.history = History(session.original);
  if (const Version worked = upright(field).withForm(nullptr);
      !tilesThatDiffer(session.original, worked).empty() || worked.lines() != session.original.lines())
    session.history.push(
        {options.steps.empty() ? "Earlier steps" : kByCommands, StepKind::kImport, stepTimeNow(), {}, 0},
        worked);
  if (field.form() != nullptr)
    session.history.push({"Form", StepKind::kForm, stepTimeNow(), {}, 0},
                         session.history.current().withForm(field.form()));
  if (inverted) session.history.push({"Invert", StepKind::kInvert, stepTimeNow(), {}, 0}, field);
  // Steps that changed nothing are of the scan itself.
  const bool stepped = session.history.number() > 0;
  const std::string& before = stepped || options.steps.empty() ? options.recipe : options.steps;
  if (!before.empty()) session.notes.emplace(kRecipeNote, before);
  if (stepped && !options.steps.empty()) session.notes.emplace(kStepsNote, options.steps);
  if (auto saved = saveSession(session, path, job); !saved) return tl::unexpected(saved.error());
  return Exported{"Fettle", {}};
}

}  // namespace

constexpr std::string_view kFettleExtensions[] = {".fettle"};
constexpr Format kFettleFormat{
    .info = {"Fettle", "Fettle session", kFettleExtensions, true, true},
    .recognises = looksLikeSession,
    .read = readSession,
    .write = writeSession,
    .units_certain = true,
};

}  // namespace fettle::engine

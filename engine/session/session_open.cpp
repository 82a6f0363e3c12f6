#include <algorithm>
#include <filesystem>
#include <map>
#include <new>
#include <unordered_map>

#include <fmt/format.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/field/seen_field.h"
#include "engine/io/field_limits.h"
#include "engine/session/session_reader.h"
#include "engine/session/session_scan.h"
#include "engine/session/stored_tiles.h"

namespace fettle::engine {

namespace {

namespace fs = std::filesystem;

// Tiles of the file that are in memory, by id: tiles shared by states in the file are shared in memory.
using TilesById = std::unordered_map<std::int64_t, TileRef>;

// Indices into index.places of the tiles of each step.
std::vector<std::vector<std::size_t>> placesByStep(const SessionIndex& index) {
  std::vector<std::vector<std::size_t>> by_step(index.steps.size());
  for (std::size_t i = 0; i < index.places.size(); ++i)
    by_step[static_cast<std::size_t>(index.places[i].step)].push_back(i);
  return by_step;
}

// The tile of state `state` at the position of place `i`: the last one there of a step at or below; null if
// it is the original's and not in the file.
const TilePlace* placeAt(const SessionIndex& index, std::size_t i, std::int64_t state) {
  const std::int64_t position = index.places[i].position;
  const TilePlace* found = nullptr;
  while (i > 0 && index.places[i - 1].position == position) --i;
  for (; i < index.places.size() && index.places[i].position == position; ++i) {
    if (index.places[i].step > state) break;
    found = &index.places[i];
  }
  return found != nullptr && found->step > 0 ? found : nullptr;
}

TileRef originalTile(const Version& original, std::int64_t position) {
  const FieldReader reader = original.reader();
  return TileRef::share(&reader.tile(static_cast<std::int32_t>(position % reader.tileColumns()),
                                     static_cast<std::int32_t>(position / reader.tileColumns())));
}

// Goes from a version to state `state`, given the places in which they differ.
Result<Version> moved(const Version& from, std::int64_t state, std::span<const std::size_t> where,
                      const SessionIndex& index, const Version& original, const TilesById& tiles,
                      const std::string& path) {
  LiveField live(from, Growth::kAllowed);
  const std::int32_t columns = from.reader().tileColumns();
  for (const std::size_t i : where) {
    const std::int64_t position = index.places[i].position;
    const TilePlace* place = placeAt(index, i, state);
    TileRef tile = place == nullptr ? originalTile(original, position) : tiles.at(place->id);
    if (!live.replaceTile(static_cast<std::int32_t>(position % columns),
                          static_cast<std::int32_t>(position / columns), std::move(tile)))
      return failure("memory for its tiles could not be allocated", path);
  }
  const auto sign = static_cast<float>(index.steps[static_cast<std::size_t>(state)].sign);
  if (live.snapshot().reader().sign() != sign) live.invert();
  const EdgeLines& lines = index.lines[static_cast<std::size_t>(state)];
  Version version = live.snapshot();
  if (version.lines() != lines) version = version.withLines(lines);
  const FieldForm& form = index.forms[static_cast<std::size_t>(state)];
  return version.form() == form ? version : version.withForm(form);
}

// Reads tiles that are not in `tiles` yet.
Status load(SessionTables& tables, const Grid& grid, std::vector<TilePlace> needed, TilePool& pool,
            TilesById& tiles, JobControl& job) {
  std::erase_if(needed, [&](const TilePlace& p) { return tiles.contains(p.id); });
  std::ranges::sort(needed, {}, &TilePlace::id);
  needed.erase(std::unique(needed.begin(), needed.end(),
                           [](const TilePlace& a, const TilePlace& b) { return a.id == b.id; }),
               needed.end());
  std::vector<TileRef> room(needed.size());
  for (TileRef& tile : room) {
    tile = TileRef::adopt(pool.acquire());
    if (!tile) return failure("memory for its tiles could not be allocated", tables.database().shownPath());
  }
  job.begin("reading the session", needed.size());
  if (Status status = loadTiles(
          tables, grid, needed, [&](std::size_t i) { return room[i].get(); }, job);
      !status)
    return status;
  for (std::size_t i = 0; i < needed.size(); ++i) {
    finishTile(*room[i]);
    tiles.emplace(needed[i].id, std::move(room[i]));
  }
  return {};
}

Result<Version> embeddedOriginal(SessionTables& tables, const SessionIndex& index, JobControl& job) {
  const std::string& path = tables.database().shownPath();
  if (Status status = checkFieldSize(static_cast<std::uint64_t>(index.grid.width),
                                     static_cast<std::uint64_t>(index.grid.height), 0, path);
      !status)
    return tl::unexpected(status.error());
  Result<FieldBuilder> builder = FieldBuilder::create(index.grid, path);
  if (!builder) return tl::unexpected(builder.error());
  std::vector<TilePlace> places;
  std::ranges::copy_if(index.places, std::back_inserter(places),
                       [](const TilePlace& p) { return p.step == 0; });
  const std::int32_t columns = (index.grid.width + kTileSide - 1) / kTileSide;
  const std::int32_t rows = (index.grid.height + kTileSide - 1) / kTileSide;
  if (static_cast<std::int64_t>(places.size()) != std::int64_t{columns} * rows)
    return damaged(
        fmt::format("{} of the {} tiles of its scan are there", places.size(), std::int64_t{columns} * rows),
        path);
  job.begin("reading the session", places.size());
  const auto room = [&](std::size_t i) {
    return &builder->tile(static_cast<std::int32_t>(places[i].position % columns),
                          static_cast<std::int32_t>(places[i].position / columns));
  };
  if (Status status = loadTiles(tables, index.grid, places, room, job); !status)
    return tl::unexpected(status.error());
  return std::move(*builder).build();
}

// The first possible place of a referenced scan at which it exists.
Result<std::string> findScan(const OriginalRow& row, const SessionOpenOptions& options,
                             const std::string& session) {
  std::vector<std::string> places{options.scan_path};
  if (options.scan_path.empty()) places = scanPlaces(row, session);
  std::optional<Error> other;
  for (const std::string& place : places) {
    std::error_code error;
    if (!fs::is_regular_file(place, error)) continue;
    const Result<FileChecksum> sum = fileChecksum(place);
    if (sum && *sum == row.file) return place;
    other = sum ? inputError("the scan is not the one the session was made with: its bytes differ", place,
                             "put the original file back, or copy it to the session's folder")
                      .value()
                : sum.error();
  }
  if (other) return tl::unexpected(*other);
  return inputError(fmt::format("the scan of the session is missing: {}", places.front()), session,
                    "put it back there, or copy it to the session's folder");
}

Result<Version> referencedOriginal(const SessionIndex& index, const SessionOpenOptions& options,
                                   OriginalScan& scan, const std::string& path, ScanImport* import_scan,
                                   JobControl& job) {
  const Result<std::string> file = findScan(index.original, options, path);
  if (!file) return tl::unexpected(file.error());
  scan.read = fileStamp(*file);
  Result<Imported> imported = import_scan(*file, index.original.scan.import, job);
  if (!imported) return tl::unexpected(imported.error());
  // The samples, where the scan is a session with a form over it.
  Result<Version> samples = withoutLayer(imported->field, job);
  if (!samples) return tl::unexpected(samples.error());
  if (contentHash(*samples) != index.original.content_hash || !(samples->grid() == index.grid))
    return inputError("the scan is now imported differently than when the session was made", *file,
                      "open the session with the program that made it, and save it with the scan embedded");
  scan.path = *file;
  return samples;
}

// Which states to hold: outward from the current one, back first, while their tiles fit.
std::pair<std::int64_t, std::int64_t> statesToHold(const SessionIndex& index, std::size_t bound) {
  std::int64_t first = index.head.state;
  std::int64_t last = index.head.state;
  std::size_t bytes = 0;
  const auto costs = [&](std::int64_t step) {
    bytes += static_cast<std::size_t>(index.steps[static_cast<std::size_t>(step)].tiles) * sizeof(Tile);
    return bytes;
  };
  while (first > 0 && (costs(first) <= bound || first == index.head.state)) --first;
  while (last < index.head.last_state && (costs(last + 1) <= bound || last == index.head.state)) ++last;
  return {first, last};
}

}  // namespace

Result<SessionIndex> readIndex(SessionTables& tables) {
  SessionIndex index;
  if (Status status = tables.recognise(); !status) return tl::unexpected(status.error());
  auto head = tables.readHead();
  if (!head) return tl::unexpected(head.error());
  index.head = *head;
  auto grid = tables.readGrid();
  if (!grid) return tl::unexpected(grid.error());
  index.grid = std::move(*grid);
  auto original = tables.readOriginal();
  if (!original) return tl::unexpected(original.error());
  index.original = std::move(*original);
  auto steps = tables.readSteps(index.head);
  if (!steps) return tl::unexpected(steps.error());
  index.steps = std::move(*steps);
  auto places = tables.readPlaces(index.steps);
  if (!places) return tl::unexpected(places.error());
  index.places = std::move(*places);
  auto lines = tables.readLines(index.steps);
  if (!lines) return tl::unexpected(lines.error());
  index.lines = std::move(*lines);
  auto forms = tables.readForms(index.steps, index.grid);
  if (!forms) return tl::unexpected(forms.error());
  index.forms = std::move(*forms);
  return index;
}

Result<Session> readSession(SessionTables& tables, const SessionOpenOptions& options, ScanImport* import_scan,
                            JobControl& job) try {
  const std::string& path = tables.database().shownPath();
  const Result<SessionIndex> found = readIndex(tables);
  if (!found) return tl::unexpected(found.error());
  const SessionIndex& index = *found;

  Session session;
  session.scan = index.original.scan;
  session.storage = index.original.storage;
  Result<Version> original = session.storage == OriginalStorage::kEmbedded
                                 ? embeddedOriginal(tables, index, job)
                                 : referencedOriginal(index, options, session.scan, path, import_scan, job);
  if (!original) return tl::unexpected(original.error());
  session.original = index.lines.front() ? original->withLines(index.lines.front()) : *std::move(original);
  if (index.forms.front()) session.original = session.original.withForm(index.forms.front());

  const auto by_step = placesByStep(index);
  const auto [first, last] = statesToHold(index, options.history_bytes);
  const std::int64_t now = index.head.state;

  // The tiles of the current state, then those that differ in the states around it.
  std::vector<std::size_t> touched;  // one place for each position that a step up to now has touched
  std::vector<TilePlace> needed;
  for (std::size_t i = 0; i < index.places.size();) {
    std::size_t end = i;
    while (end < index.places.size() && index.places[end].position == index.places[i].position) ++end;
    if (const TilePlace* place = placeAt(index, i, now)) {
      touched.push_back(i);
      needed.push_back(*place);
    }
    i = end;
  }
  for (std::int64_t k = first + 1; k <= last; ++k)
    for (const std::size_t i : by_step[static_cast<std::size_t>(k)]) {
      if (k > now) needed.push_back(index.places[i]);
      if (k <= now)
        if (const TilePlace* before = placeAt(index, i, k - 1)) needed.push_back(*before);
    }
  TilesById tiles;
  if (Status status =
          load(tables, index.grid, std::move(needed), session.original.memory()->bulk(), tiles, job);
      !status)
    return tl::unexpected(status.error());

  std::map<std::int64_t, Version> states;
  const auto make = [&](std::int64_t state, const Version& from,
                        std::span<const std::size_t> where) -> Status {
    Result<Version> version = moved(from, state, where, index, session.original, tiles, path);
    if (!version) return tl::unexpected(version.error());
    states[state] = std::move(*version);
    return {};
  };
  if (Status status = make(now, session.original, touched); !status) return tl::unexpected(status.error());
  for (std::int64_t k = now; k > first; --k)
    if (Status status = make(k - 1, states.at(k), by_step[static_cast<std::size_t>(k)]); !status)
      return tl::unexpected(status.error());
  for (std::int64_t k = now; k < last; ++k)
    if (Status status = make(k + 1, states.at(k), by_step[static_cast<std::size_t>(k + 1)]); !status)
      return tl::unexpected(status.error());

  std::vector<Step> steps;
  for (std::int64_t k = first + 1; k <= last; ++k)
    steps.push_back({index.steps[static_cast<std::size_t>(k)].info, states.at(k - 1), states.at(k)});
  session.history = History(states.at(now), now, first, std::move(steps), options.history_bytes);

  Result<SessionNotes> notes = tables.readNotes(index.head);
  if (!notes) return tl::unexpected(notes.error());
  session.notes = std::move(*notes);
  if (options.journal == JournalReading::kRead) {
    Result<std::vector<JournalEntry>> journal = tables.readJournal(index.head);
    if (!journal) return tl::unexpected(journal.error());
    session.journal = std::move(*journal);
  }
  return session;
} catch (const std::bad_alloc&) {
  return failure("memory for the session could not be allocated", tables.database().shownPath());
}

Result<Step> readStep(SessionTables& tables, const SessionIndex& index, std::int64_t number,
                      const Version& after, const Version& original, JobControl& job) {
  const std::string& path = tables.database().shownPath();
  const auto by_step = placesByStep(index);
  const std::vector<std::size_t>& where = by_step[static_cast<std::size_t>(number)];
  std::vector<TilePlace> needed;
  for (const std::size_t i : where)
    if (const TilePlace* before = placeAt(index, i, number - 1)) needed.push_back(*before);
  TilesById tiles;
  if (Status status = load(tables, index.grid, std::move(needed), original.memory()->bulk(), tiles, job);
      !status)
    return tl::unexpected(status.error());
  Result<Version> before = moved(after, number - 1, where, index, original, tiles, path);
  if (!before) return tl::unexpected(before.error());
  return Step{index.steps[static_cast<std::size_t>(number)].info, std::move(*before), after};
}

Result<Session> openSession(const std::string& path, const SessionOpenOptions& options,
                            ScanImport* import_scan, JobControl& job) {
  Result<ReadingConnection> connection = ReadingConnection::open(path);
  if (!connection) return tl::unexpected(connection.error());
  SessionTables tables(connection->database());
  // One transaction: all tables of the same commit.
  if (Status status = connection->database().execute("BEGIN"); !status) return tl::unexpected(status.error());
  return readSession(tables, options, import_scan, job);
}

}  // namespace fettle::engine

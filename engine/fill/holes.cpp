#include "engine/fill/holes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <tbb/parallel_for.h>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

// The runs of the rows of one row of tiles of a part, by row and then column.
std::vector<HoleRun> runsOfTileRow(const FieldReader& field, const TileRange& part, std::int32_t tr) {
  std::vector<HoleRun> runs;
  const std::int32_t row0 = tr * kTileSide, rows = std::min(kTileSide, field.height() - row0);
  std::vector<std::int32_t> holed;  // columns of tiles
  for (std::int32_t tc = part.column; tc < part.column + part.columns; ++tc) {
    const std::int32_t columns = std::min(kTileSide, field.width() - tc * kTileSide);
    const auto outside = static_cast<std::uint32_t>(kTileSamples - columns * rows);
    if (field.tile(tc, tr).nan_samples > outside) holed.push_back(tc);
  }
  for (std::int32_t r = 0; r < rows; ++r) {
    const std::size_t of_row = runs.size();
    for (const std::int32_t tc : holed) {
      const Tile& tile = field.tile(tc, tr);
      const std::int32_t columns = std::min(kTileSide, field.width() - tc * kTileSide);
      const float* z = tile.samples.data() + r * kTileSide;
      for (std::int32_t c = 0; c < columns; ++c) {
        if (!std::isnan(z[c]) || tile.marked(c, r)) continue;
        const std::int32_t column = tc * kTileSide + c;
        if (runs.size() > of_row && runs.back().last == column - 1)
          runs.back().last = column;
        else
          runs.push_back({row0 + r, column, column});
      }
    }
  }
  return runs;
}

// Sets of runs that are connected; the representative of a set is its first run.
class RunSets {
 public:
  explicit RunSets(std::size_t runs) : parents_(runs) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  [[nodiscard]] std::size_t find(std::size_t run) noexcept {
    while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
    return run;
  }
  void join(std::size_t a, std::size_t b) noexcept {
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parents_;
};

void joinNeighbours(const std::vector<HoleRun>& runs, RunSets& sets) {
  std::size_t below = 0;  // the first run of the row below that may still touch
  for (std::size_t i = 0; i < runs.size(); ++i) {
    while (below < i && (runs[below].row < runs[i].row - 1 ||
                         (runs[below].row == runs[i].row - 1 && runs[below].last < runs[i].first)))
      ++below;
    for (std::size_t k = below; k < i && runs[k].row == runs[i].row - 1 && runs[k].first <= runs[i].last; ++k)
      sets.join(i, k);
  }
}

// Whether a run touches a side of the part that is not one of the field.
bool isCut(const HoleRun& run, const TileRange& part, const FieldReader& field) noexcept {
  const std::int32_t c0 = part.column * kTileSide, r0 = part.row * kTileSide;
  const std::int32_t c1 = std::min(c0 + part.columns * kTileSide, field.width());
  const std::int32_t r1 = std::min(r0 + part.rows * kTileSide, field.height());
  return (run.first == c0 && c0 > 0) || (run.last == c1 - 1 && c1 < field.width()) ||
         (run.row == r0 && r0 > 0) || (run.row == r1 - 1 && r1 < field.height());
}

}  // namespace

Result<Holes> findHoles(const Version& field, JobControl& job) {
  return findHoles(field, allTiles(field.grid()), job);
}

Result<Holes> findHoles(const Version& field, const TileRange& part, JobControl& job) {
  const FieldReader reader = field.reader();
  std::vector<std::vector<HoleRun>> parts(static_cast<std::size_t>(part.rows));
  job.begin("finding holes", parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t tr) {
    if (job.cancelled()) return;
    parts[tr] = runsOfTileRow(reader, part, part.row + static_cast<std::int32_t>(tr));
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  std::vector<HoleRun> runs;
  std::size_t count = 0;
  for (const auto& of_row : parts) count += of_row.size();
  runs.reserve(count);
  for (auto& of_row : parts) {
    runs.insert(runs.end(), of_row.begin(), of_row.end());
    of_row = {};
  }
  RunSets sets(runs.size());
  joinNeighbours(runs, sets);

  Holes found;
  std::vector<std::size_t> hole_of(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const HoleRun& run = runs[i];
    const std::size_t first = sets.find(i);
    if (first == i) {
      hole_of[i] = found.holes.size();
      found.holes.emplace_back();
    } else {
      hole_of[i] = hole_of[first];
    }
    Hole& hole = found.holes[hole_of[i]];
    ++hole.runs;
    hole.samples += run.samples();
    hole.box = hole.box.joined({run.first, run.row, run.samples(), 1});
    hole.at_border = hole.at_border || run.row == 0 || run.first == 0 || run.row == reader.height() - 1 ||
                     run.last == reader.width() - 1;
    hole.cut = hole.cut || isCut(run, part, reader);
  }
  std::vector<std::size_t> next;
  next.reserve(found.holes.size());
  std::size_t at = 0;
  for (Hole& hole : found.holes) {
    hole.first_run = at;
    next.push_back(at);
    at += hole.runs;
  }
  found.runs.resize(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) found.runs[next[hole_of[i]]++] = runs[i];
  return found;
}

}  // namespace fettle::engine

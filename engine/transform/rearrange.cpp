#include "engine/transform/rearrange.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/transform/form_along.h"

namespace fettle::engine {

namespace {

// A field of `grid` whose tiles are written by read(rectangle of the result, heights, marks), row-major with stride
// kTileSide.
Result<Version> built(Grid grid, const char* stage, JobControl& job,
                      const std::function<void(const SampleRect&, float*, std::uint8_t*)>& read) {
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the transformed field");
  if (!builder) return tl::unexpected(builder.error());
  const TileRange tiles = allTiles(builder->grid());
  job.begin(stage, static_cast<std::uint64_t>(tiles.tiles()));
  tbb::parallel_for(std::int64_t{0}, tiles.tiles(), [&](std::int64_t i) {
    if (job.cancelled()) return;
    SampleRect rect{static_cast<std::int32_t>(i % tiles.columns) * kTileSide,
                    static_cast<std::int32_t>(i / tiles.columns) * kTileSide, 0, 0};
    rect.columns = std::min(kTileSide, builder->grid().width - rect.column);
    rect.rows = std::min(kTileSide, builder->grid().height - rect.row);
    float z[kTileSamples];
    std::uint8_t marks[kTileSamples];
    read(rect, z, marks);
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    builder->writeMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

// Where a sample of the turned field comes from, as whole numbers: column = c0 + cc * column' + cr * row', likewise row.
struct Origin {
  std::int32_t c0, cc, cr, r0, rc, rr;
};

Origin originOf(const Turning& turning, std::int32_t width, std::int32_t height) {
  // Of the mirrored field, which is as large as the field.
  Origin at{};
  switch (turning.quarters) {
    case 1:
      at = {0, 0, 1, height - 1, -1, 0};
      break;
    case 2:
      at = {width - 1, -1, 0, height - 1, 0, -1};
      break;
    case 3:
      at = {width - 1, 0, -1, 0, 1, 0};
      break;
    default:
      at = {0, 1, 0, 0, 0, 1};
      break;
  }
  if (turning.mirror_x) at = {width - 1 - at.c0, -at.cc, -at.cr, at.r0, at.rc, at.rr};
  if (turning.mirror_y) at = {at.c0, at.cc, at.cr, height - 1 - at.r0, -at.rc, -at.rr};
  return at;
}

// The lines with the samples: of a mirrored line left becomes right, and the step changes its sign; the change of slope,
// counted towards the left, stays.
EdgeLines turnedLines(const std::vector<EdgeLine>& lines, const Origin& at, bool mirrored) {
  auto moved = std::make_shared<std::vector<EdgeLine>>(lines);
  for (EdgeLine& line : *moved)
    for (EdgePoint& point : line.points) {
      // The whole numbers are a turn and perhaps a mirror: its inverse is its transpose.
      const double c = point.position.x - at.c0, r = point.position.y - at.r0;
      point.position = {at.cc * c + at.rc * r, at.cr * c + at.rr * r};
      if (mirrored) point.step = -point.step;
    }
  return moved;
}

// Of the runs that a rectangle leaves of a line the first keeps its number; the others get numbers that no line has.
EdgeLines numberedOnce(const EdgeLines& runs) {
  if (runs->empty()) return nullptr;
  std::int64_t next = 0;
  for (const EdgeLine& run : *runs) next = std::max(next, run.id);
  auto numbered = std::make_shared<std::vector<EdgeLine>>(*runs);
  std::unordered_set<std::int64_t> taken;
  for (EdgeLine& run : *numbered)
    if (!taken.insert(run.id).second) run.id = ++next;
  return numbered;
}

Result<Version> croppedSamples(const Version& field, const SampleRect& rect, JobControl& job) {
  Grid grid = field.grid();
  grid.width = rect.columns;
  grid.height = rect.rows;
  grid.origin_x += rect.column * grid.spacing_x;
  grid.origin_y += rect.row * grid.spacing_y;
  const FieldReader from = field.reader();
  auto piece =
      built(std::move(grid), "cropping", job, [&](const SampleRect& to, float* z, std::uint8_t* marks) {
        from.readHeights(rect.column + to.column, rect.row + to.row, to.columns, to.rows, z, kTileSide);
        from.readMarks(rect.column + to.column, rect.row + to.row, to.columns, to.rows, marks, kTileSide);
      });
  if (!piece || field.lines() == nullptr) return piece;
  return piece->withLines(numberedOnce(linesOfPiece(*field.lines(), rect)));
}

Result<Version> turnedSamples(const Version& field, const Turning& turning, JobControl& job) {
  Grid grid = field.grid();
  const Origin at = originOf(turning, grid.width, grid.height);
  const double middle_x = grid.origin_x + 0.5 * (grid.width - 1) * grid.spacing_x;
  const double middle_y = grid.origin_y + 0.5 * (grid.height - 1) * grid.spacing_y;
  // Of a square the origin stays, which the way over its middle would round.
  if (turning.quarters % 2 != 0 && (grid.width != grid.height || grid.spacing_x != grid.spacing_y)) {
    std::swap(grid.width, grid.height);
    std::swap(grid.spacing_x, grid.spacing_y);
    grid.origin_x = middle_x - 0.5 * (grid.width - 1) * grid.spacing_x;
    grid.origin_y = middle_y - 0.5 * (grid.height - 1) * grid.spacing_y;
  }
  if (!turning.none()) grid.crs_wkt.clear();
  const FieldReader from = field.reader();
  auto result =
      built(std::move(grid), "turning", job, [&](const SampleRect& to, float* z, std::uint8_t* marks) {
        // The rectangle that it comes from, then sample by sample within it.
        const std::int32_t last_c = to.column + to.columns - 1, last_r = to.row + to.rows - 1;
        const auto columnOf = [&](std::int32_t c, std::int32_t r) { return at.c0 + at.cc * c + at.cr * r; };
        const auto rowOf = [&](std::int32_t c, std::int32_t r) { return at.r0 + at.rc * c + at.rr * r; };
        const std::int32_t left = std::min(columnOf(to.column, to.row), columnOf(last_c, last_r));
        const std::int32_t low = std::min(rowOf(to.column, to.row), rowOf(last_c, last_r));
        const bool swapped = at.cc == 0;
        float heights[kTileSamples];
        std::uint8_t kept[kTileSamples];
        const std::int32_t columns = swapped ? to.rows : to.columns, rows = swapped ? to.columns : to.rows;
        from.readHeights(left, low, columns, rows, heights, kTileSide);
        from.readMarks(left, low, columns, rows, kept, kTileSide);
        for (std::int32_t r = 0; r < to.rows; ++r)
          for (std::int32_t c = 0; c < to.columns; ++c) {
            const std::int32_t k = (rowOf(to.column + c, to.row + r) - low) * kTileSide +
                                   columnOf(to.column + c, to.row + r) - left;
            z[r * kTileSide + c] = heights[k];
            marks[r * kTileSide + c] = kept[k];
          }
      });
  if (!result || field.lines() == nullptr) return result;
  return result->withLines(turnedLines(*field.lines(), at, turning.mirror_x != turning.mirror_y));
}

// What is seen of the samples under the form, both moved by `move`, which is `places` of it.
template <class Move>
Result<Version> movedWithForm(const Version& field, const PlaceMap& places, JobControl& job, Move&& move) {
  const auto samples = restored(field, job);
  if (!samples) return samples;
  const auto moved = move(*samples);
  if (!moved) return moved;
  return seenUnder(*moved, formAlong(field, places, moved->grid().width, moved->grid().height), job);
}

}  // namespace

Result<Version> cropped(const Version& field, const SampleRect& rect, JobControl& job) {
  assert(!rect.empty() && field.grid().contains(rect.column, rect.row) &&
         rect.column + rect.columns <= field.grid().width && rect.row + rect.rows <= field.grid().height);
  if (field.formOver() == nullptr) return croppedSamples(field, rect, job);
  return movedWithForm(field, {.first = glm::dvec2(rect.column, rect.row)}, job,
                       [&](const Version& samples) { return croppedSamples(samples, rect, job); });
}

Result<Version> turned(const Version& field, const Turning& turning, JobControl& job) {
  assert(turning.quarters >= 0 && turning.quarters < 4);
  if (field.formOver() == nullptr) return turnedSamples(field, turning, job);
  const Origin at = originOf(turning, field.grid().width, field.grid().height);
  const PlaceMap places{.first = glm::dvec2(at.c0, at.r0),
                        .per_column = glm::dvec2(at.cc, at.rc),
                        .per_row = glm::dvec2(at.cr, at.rr)};
  return movedWithForm(field, places, job,
                       [&](const Version& samples) { return turnedSamples(samples, turning, job); });
}

}  // namespace fettle::engine

#include "engine/scanner/scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/scanner/counter_random.h"
#include "engine/scanner/laser_effects.h"
#include "engine/scanner/part.h"

namespace fettle::engine {

namespace {

// One stream of random numbers per effect, so that switching one off does not change the numbers of the
// others.
enum Stream : std::uint64_t { kMixing = 1, kSensor, kSpeckle, kLines, kSteepness };

Status check(const ScannerSpec& spec) {
  const auto within = [](double value, double most) { return value >= 0.0 && value <= most; };
  if (!within(spec.noise, 100.0))
    return inputError(fmt::format("a noise of {} cannot be simulated", spec.noise), "--noise",
                      "give 0 to 100");
  if (!within(spec.outliers, 1.0))
    return inputError(fmt::format("a share of outliers of {} is not possible", spec.outliers), "--outliers",
                      "give 0 to 1");
  if (!within(spec.dropouts, 10.0))
    return inputError(fmt::format("dropouts of {} cannot be simulated", spec.dropouts), "--dropouts",
                      "give 0 to 10");
  if (!within(spec.spot, 4.0))
    return inputError(fmt::format("a spot of {} samples cannot be simulated", spec.spot), "--spot",
                      "give 0 to 4");
  return {};
}

// Placement of the part in the field: the part's origin, and the sample spacing.
struct Layout {
  Grid grid;
  double spacing_mm = 1.0;
  glm::dvec2 shift{0.0, 0.0};  // part to field coordinates

  Layout(const Part& part, int width, int height)
      : spacing_mm(std::max(part.info.width_mm / width, part.info.height_mm / height)),
        shift(0.5 * (width - 1) * spacing_mm, 0.5 * (height - 1) * spacing_mm) {
    grid.width = width;
    grid.height = height;
    grid.spacing_x = grid.spacing_y = spacing_mm;
  }
  [[nodiscard]] glm::dvec2 inPart(double column, double row) const noexcept {
    return glm::dvec2{column * spacing_mm, row * spacing_mm} - shift;
  }
};

// Calls f(tile column, tile row) for all tiles, on all workers; each tile column from its highest tile down.
bool forEachTileDown(const Grid& grid, const char* stage, JobControl& job, auto&& f) {
  const std::int32_t tile_columns = (grid.width + kTileSide - 1) / kTileSide;
  const std::int32_t tile_rows = (grid.height + kTileSide - 1) / kTileSide;
  job.begin(stage, static_cast<std::uint64_t>(tile_columns) * tile_rows);
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, tile_columns, 1), [&](const auto& range) {
    for (std::int32_t tc = range.begin(); tc < range.end(); ++tc) {
      auto column_state = f.columnState();
      for (std::int32_t tr = tile_rows - 1; tr >= 0 && !job.cancelled(); --tr) {
        f(tc, tr, column_state);
        job.advance();
      }
    }
  });
  return !job.cancelled();
}

struct TruthTile {
  const Part& part;
  const Layout& layout;
  FieldBuilder& out;

  struct None {};
  [[nodiscard]] None columnState() const noexcept { return {}; }

  void operator()(std::int32_t tc, std::int32_t tr, None) const {
    const std::int32_t column = tc * kTileSide;
    const std::int32_t row = tr * kTileSide;
    const int columns = std::min(kTileSide, layout.grid.width - column);
    const int rows = std::min(kTileSide, layout.grid.height - row);
    const glm::dvec2 first = layout.inPart(column, row);
    const double half = 0.5 * kTileSide * layout.spacing_mm;
    const std::vector<const Feature*> features = part.near(first + glm::dvec2{half, half}, 1.5 * half);
    float heights[kTileSamples];
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        heights[r * kTileSide + c] =
            static_cast<float>(Part::heightAt(layout.inPart(column + c, row + r), features));
    out.writeHeights(column, row, columns, rows, heights, kTileSide);
  }
};

struct ScannedTile {
  const ScannerSpec& spec;
  const Part& part;
  const LaserModel& model;
  const Layout& layout;
  const FieldReader truth;
  FieldBuilder& out;
  const std::vector<double> speckle = speckleKernel(model, layout.spacing_mm);

  [[nodiscard]] std::vector<double> columnState() const {
    return std::vector<double>(kTileSide, -std::numeric_limits<double>::infinity());
  }

  void operator()(std::int32_t tc, std::int32_t tr, std::vector<double>& horizon) const {
    ScanBlock block;
    block.column = tc * kTileSide;
    block.row = tr * kTileSide;
    block.columns = std::min(kTileSide, truth.width() - block.column);
    block.rows = std::min(kTileSide, truth.height() - block.row);
    block.spacing_mm = layout.spacing_mm;
    truth.readHeights(block.column - 1, block.row - 1, block.columns + 2, block.rows + 2, block.truth.data(),
                      ScanBlock::kStride);
    for (int r = 0; r < block.rows; ++r)
      for (int c = 0; c < block.columns; ++c) block.heightAt(c, r) = block.truthAt(c, r);
    if (spec.spot > 0.0) {
      const double reach =
          ScanBlock::kSide + 4.0 * spec.spot;  // of its corners from the middle, and the spot
      const std::vector<const Feature*> features =
          part.near(layout.inPart(block.column + 0.5 * block.columns, block.row + 0.5 * block.rows),
                    reach * layout.spacing_mm);
      averageUnderSpot(block, spec.spot, [&](double column, double row) {
        return Part::heightAt(layout.inPart(column, row), features);
      });
    }
    const auto random = [&](Stream stream) { return CounterRandom(spec.seed, stream); };
    if (spec.outliers > 0.0) mixPixels(block, model, spec.outliers, random(kMixing));
    if (spec.noise > 0.0) {
      addSensorNoise(block, model, spec.noise, random(kSensor));
      addSpeckle(block, model, spec.noise, speckle, random(kSpeckle));
      addLineOffset(block, model, spec.noise, random(kLines));
      quantise(block, model, spec.noise);
    }
    if (spec.dropouts > 0.0) {
      dropSteep(block, model, spec.dropouts, random(kSteepness));
      dropShadowed(block, model, horizon);
    }
    float heights[kTileSamples];
    for (int r = 0; r < block.rows; ++r)
      for (int c = 0; c < block.columns; ++c)
        heights[r * kTileSide + c] = static_cast<float>(block.heightAt(c, r));
    out.writeHeights(block.column, block.row, block.columns, block.rows, heights, kTileSide);
  }
};

// Marks the sample nearest each point of the lines, in steps of a quarter of a sample. False: memory
// exhausted.
bool markEdges(const std::vector<Edge>& edges, double spacing_mm, LiveField& field) {
  const auto mark = [&](glm::dvec2 p) {
    const auto column = static_cast<std::int32_t>(std::lround(p.x / spacing_mm));
    const auto row = static_cast<std::int32_t>(std::lround(p.y / spacing_mm));
    if (!field.grid().contains(column, row) || field.reader().markedAt(column, row)) return true;
    return field.setMark(column, row, true);
  };
  constexpr int kPieces = 4;  // neighbouring points lie at most one sample apart
  for (const Edge& edge : edges) {
    const std::size_t n = edge.points_mm.size();
    for (std::size_t i = 0; i + (edge.closed ? 0 : 1) < n; ++i) {
      const glm::dvec2 from = edge.points_mm[i];
      const glm::dvec2 to = edge.points_mm[(i + 1) % n];
      for (int k = 0; k <= kPieces; ++k)
        if (!mark(from + (to - from) * (static_cast<double>(k) / kPieces))) return false;
    }
  }
  return true;
}

Result<SimulatedScan> simulate(const ScannerSpec& spec, const Part& part, JobControl& job) {
  const std::string what = "the part " + spec.part;
  const auto memory = std::make_shared<FieldMemory>();
  Grid asked;
  asked.width = spec.width;
  asked.height = spec.height;
  // Before the layout divides by them: the builder checks which sizes are valid.
  if (spec.width < 1 || spec.height < 1) return tl::unexpected(FieldBuilder::create(asked, what).error());
  const Layout layout(part, spec.width, spec.height);
  const LaserModel model;

  Result<FieldBuilder> truth_builder = FieldBuilder::create(layout.grid, memory, what);
  if (!truth_builder) return tl::unexpected(truth_builder.error());
  if (!forEachTileDown(layout.grid, "making the part", job, TruthTile{part, layout, *truth_builder}))
    return cancelled();
  SimulatedScan result;
  result.truth = std::move(*truth_builder).build();

  const glm::dvec2 extent{(spec.width - 1) * layout.spacing_mm, (spec.height - 1) * layout.spacing_mm};
  result.edge_lines = edgesOf(part, layout.spacing_mm, layout.shift, extent);
  LiveField edges(result.truth, Growth::kAllowed);
  if (!markEdges(result.edge_lines, layout.spacing_mm, edges)) return failure("memory is exhausted", what);
  result.edges = edges.snapshot();

  Result<FieldBuilder> scan_builder = FieldBuilder::create(layout.grid, memory, what);
  if (!scan_builder) return tl::unexpected(scan_builder.error());
  const ScannedTile scanned{spec, part, model, layout, result.truth.reader(), *scan_builder};
  if (!forEachTileDown(layout.grid, "scanning the part", job, scanned)) return cancelled();
  result.scan = std::move(*scan_builder).build();
  result.sigma_mm = model.sigma_mm * spec.noise;
  return result;
}

}  // namespace

Result<SimulatedScan> simulateScan(const ScannerSpec& spec, JobControl& job) {
  const Part* part = findPart(spec.part);
  if (part == nullptr) {
    std::string names;
    for (const PartInfo& info : parts()) names += (names.empty() ? "" : ", ") + std::string(info.name);
    return inputError(fmt::format("there is no part \"{}\"", spec.part), "--part", "choose one of " + names);
  }
  if (const Status status = check(spec); !status) return tl::unexpected(status.error());
  try {
    return simulate(spec, *part, job);
  } catch (const std::bad_alloc&) {
    return failure("memory is exhausted", fmt::format("the part {}", spec.part), "choose fewer samples");
  }
}

}  // namespace fettle::engine

#include "engine/filter/catalogue.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/filter/areal_gaussian.h"
#include "engine/filter/line_windows.h"
#include "engine/filter/median.h"
#include "engine/filter/opening.h"
#include "engine/filter/planes.h"
#include "engine/filter/robust_gaussian.h"
#include "engine/filter/spline.h"
#include "engine/filter/tgv_device.h"
#include "engine/filter/tgv_schedule.h"
#include "engine/filter/window_pass.h"

namespace fettle::engine {

// Each in the source that is named after it.
WindowFilter::Maker makeBoxFilter, makeGaussianFilter, makeBilateralFilter, makeTotalVariationFilter,
    makeTgvFilter, makePlanesFilter, makeOutlierFilter;

namespace {

constexpr FilterParameter kRange{"height_unit", FilterSpec::kLeastRange, FilterSpec::kMostRange, 0.0,
                                 "from the noise"};

constexpr FilterParameter sigmaElse(std::string_view otherwise) {
  return {"samples", 0.0, std::numeric_limits<double>::max(), 0.0, otherwise};
}

constexpr FilterParameter kNesting{"mm", 1e-12, 1e12, 0.0};

// A strip's scratch follows its width alone, so that it can be long.
constexpr WindowFilter kBoxWindows{.make = makeBoxFilter,
                                   .columns = {4, 512, 2048},
                                   .rows = {8, 2048, 8192},
                                   .strip = BoxStrip::make,
                                   .tile = makeTileBox};
constexpr WindowFilter kGaussianWindows{
    .make = makeGaussianFilter, .columns = {4, 512, 1024}, .rows = {1, 128, 512}, .tile = makeTileGaussian};
constexpr WindowFilter kMedianWindows{
    .make = makeMedianFilter, .columns = {1, 128, 512}, .rows = {1, 128, 512}, .tile = makeTileMedian};
constexpr WindowFilter kBilateralWindows{makeBilateralFilter};
constexpr WindowFilter kTotalVariationWindows{makeTotalVariationFilter};

constexpr WindowFilter kOutlierWindows{makeOutlierFilter};

constexpr WindowFilter kTgvSquares{.make = makeTgvFilter, .squares = {tgv::kSide, tgv::kHalo}};
constexpr WindowFilter kPlaneSquares{.make = makePlanesFilter, .squares = {planes::kSide, planes::kHalo}};

std::int32_t anywhere(const FilterSpec&) {
  return Grid::kMaxSide;
}

// Means and medians smooth the edges together with the noise unless these are marked.
constexpr FilterTrial kBoxTrials[] = {
    {3, 1.4}, {5, 1.4}, {9, 1.4}, {3, 1.4, 2, 0, true}, {5, 1.4, 2, 0, true}, {9, 1.4, 2, 0, true}};
constexpr FilterTrial kGaussianTrials[] = {{3, 1.5}, {5, 1.6}, {9, 2.0}};
constexpr FilterTrial kMedianTrials[] = {{3, 1.7}, {5, 4.8}, {7, 7.7}, {5, 4.8, 1, 0, true}};
constexpr FilterTrial kBilateralTrials[] = {{3, 4.4, 1, 4},  {5, 8.1, 1, 4}, {7, 13.4, 1, 4},
                                            {9, 20.5, 1, 4}, {5, 8.1, 2, 3}, {9, 20.5, 1, 6}};
constexpr FilterTrial kTotalVariationTrials[] = {
    {7, 6.3, 1, 1},   {7, 6.3, 1, 1.5},   {17, 10.6, 1, 1}, {17, 10.6, 1, 1.5},
    {31, 19.8, 1, 1}, {31, 19.8, 1, 1.5}, {51, 31.7, 1, 2}, {17, 10.6, 1, 1.5, true}};

constexpr FilterTrial kPlaneTrials[] = {{FilterSpec{}.window, 30, 1, 1}, {FilterSpec{}.window, 30, 1, 1.3}};
constexpr FilterTrial kTgvTrials[] = {{FilterSpec{}.window, 930, 1, 1}, {FilterSpec{}.window, 930, 1, 1.3}};

constexpr std::array kFilters{
    Filter{.kind = FilterKind::kBox,
           .word = "box",
           .title = "Box",
           .says = "mean of the window: the quickest; steps become ramps",
           .pass = windowPass<kBoxWindows>,
           .trials = kBoxTrials,
           .knows_lines = true},
    Filter{.kind = FilterKind::kGaussian,
           .word = "gaussian",
           .title = "Gaussian",
           .says = "weighted mean of the window: smoother than a box; steps become ramps",
           .sigma = sigmaElse("binomial weights"),
           .pass = windowPass<kGaussianWindows>,
           .trials = kGaussianTrials,
           .knows_lines = true},
    Filter{.kind = FilterKind::kMedian,
           .word = "median",
           .title = "Median",
           .says = "median of the window: spikes and pits go, steps stay, corners become round",
           .pass = windowPass<kMedianWindows>,
           .trials = kMedianTrials,
           .knows_lines = true},
    Filter{.kind = FilterKind::kBilateral,
           .word = "bilateral",
           .title = "Bilateral",
           .says = "mean of heights near its own: noise goes, steps stay, spikes too",
           .keeps_edges = true,
           .sigma = sigmaElse("a quarter of the window"),
           .range_sigma = kRange,
           .noises = 4.0,
           .pass = windowPass<kBilateralWindows>,
           .trials = kBilateralTrials,
           .knows_lines = true},
    Filter{.kind = FilterKind::kTotalVariation,
           .word = "tv",
           .title = "Total variation",
           .says = "level flats and steep steps; slopes become small stairs",
           .keeps_edges = true,
           .range_sigma = kRange,
           .noises = 1.0,
           .pass = windowPass<kTotalVariationWindows>,
           .trials = kTotalVariationTrials},
    Filter{.kind = FilterKind::kGeneralisedVariation,
           .word = "tgv",
           .title = "Generalised variation",
           .says = "flats, slopes and curves with their steps and creases; lone spikes go; slow",
           .keeps_edges = true,
           .window = {},
           .range_sigma = kRange,
           .noises = 1.0,
           .pass = windowPass<kTgvSquares>,
           .reach = [](const FilterSpec&) { return tgv::kSide - 1 + tgv::kHalo; },
           .grid = tgv::kSide,
           .trials = kTgvTrials,
           .knows_lines = true,
           .on_device = tgvPassOnDevice},
    Filter{.kind = FilterKind::kPlanes,
           .word = "planes",
           .title = "Planes",
           .says = "planes between steps and creases: machined parts; curved places stay rougher",
           .keeps_edges = true,
           .window = {},
           .range_sigma = kRange,
           .noises = 1.1,
           .pass = windowPass<kPlaneSquares>,
           .reach = [](const FilterSpec&) { return planes::kSide - 1 + planes::kHalo; },
           .grid = planes::kSide,
           .trials = kPlaneTrials,
           .knows_lines = true},
    Filter{.kind = FilterKind::kArealGaussian,
           .word = "areal-gaussian",
           .title = "Areal Gaussian",
           .says = "takes out waves shorter than the cut-off (ISO 16610-61)",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "cutoff",
           .pass = arealGaussianPass,
           .reach = anywhere,
           .reach_on = arealGaussianReach,
           .grid_on = arealGaussianGrid},
    Filter{.kind = FilterKind::kRobustGaussian,
           .word = "robust-gaussian",
           .title = "Robust Gaussian",
           .says = "follows bends up to its ends, not drawn aside by grooves and peaks (ISO 16610-71)",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "cutoff",
           .robust = true,
           .pass = robustGaussianPass,
           .reach = anywhere,
           .sampled = false},
    Filter{.kind = FilterKind::kOpening,
           .word = "opening",
           .title = "Opening",
           .says = "a ball rolled along below: peaks narrower than it go, nothing rises",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "radius",
           .least_nesting = FilterSpec::kLeastRadius,
           .has_element = true,
           .pass = openingPass,
           .reach = anywhere,
           .reach_on = openingReach,
           .sampled = false},
    Filter{.kind = FilterKind::kClosing,
           .word = "closing",
           .title = "Closing",
           .says = "a ball rolled along above: grooves narrower than it are filled, nothing sinks",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "radius",
           .least_nesting = FilterSpec::kLeastRadius,
           .has_element = true,
           .pass = closingPass,
           .reach = anywhere,
           .reach_on = openingReach,
           .sampled = false},
    Filter{.kind = FilterKind::kSpline,
           .word = "spline",
           .title = "Spline",
           .says = "waves shorter than the cut-off go, without end effects (ISO 16610-22)",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "cutoff",
           .pass = splinePass,
           .reach = anywhere,
           .sampled = false},
    Filter{.kind = FilterKind::kRobustSpline,
           .word = "robust-spline",
           .title = "Robust spline",
           .says = "the same, not drawn aside by grooves and peaks",
           .window = {},
           .nesting = kNesting,
           .nesting_word = "cutoff",
           .robust = true,
           .pass = robustSplinePass,
           .reach = anywhere,
           .sampled = false},
    Filter{.kind = FilterKind::kOutliers,
           .word = "outliers",
           .title = "Outliers",
           .says = "lone spikes and pits on even ground go, nothing else changes; beside walls take the "
                   "median on marks",
           .keeps_edges = true,
           .range_sigma = kRange,
           .noises = 5.0,
           .pass = windowPass<kOutlierWindows>},
};

constexpr bool inTheOrderOfTheEnum() {
  for (std::size_t i = 0; i < kFilters.size(); ++i)
    if (static_cast<std::size_t>(kFilters[i].kind) != i) return false;
  return true;
}
static_assert(inTheOrderOfTheEnum());

}  // namespace

std::span<const Filter> filters() noexcept {
  return kFilters;
}

const Filter& filterOf(FilterKind kind) noexcept {
  return kFilters[static_cast<std::size_t>(kind)];
}

const Filter* filterNamed(std::string_view word) noexcept {
  for (const Filter& filter : kFilters)
    if (filter.word == word) return &filter;
  return nullptr;
}

std::string_view name(FilterKind kind) noexcept {
  return filterOf(kind).word;
}

bool hasRange(FilterKind kind) noexcept {
  return filterOf(kind).range_sigma.exists();
}

std::int32_t reachOf(const FilterSpec& spec) noexcept {
  return static_cast<std::int32_t>(
      std::min<std::int64_t>(std::int64_t{spec.passes} * filterOf(spec.kind).reach(spec), Grid::kMaxSide));
}

std::int32_t reachOf(const FilterSpec& spec, const Grid& grid, bool lines) noexcept {
  const Filter& filter = filterOf(spec.kind);
  if (filter.reach_on != nullptr)
    return static_cast<std::int32_t>(
        std::min<std::int64_t>(std::int64_t{spec.passes} * filter.reach_on(spec, grid), Grid::kMaxSide));
  const bool ends_at_lines = filter.knows_lines && filter.window.exists() && lines;
  return reachOf(spec) + (ends_at_lines ? spec.passes * kLineReach : 0);
}

std::int32_t reachOf(const FilterSpec& spec, const Version& input) noexcept {
  return reachOf(spec, input.grid(), input.lines() != nullptr);
}

bool needsWholeField(const Filter& filter) noexcept {
  return filter.reach_on == nullptr && filter.reach == anywhere;
}

std::int32_t pieceGridOf(const FilterSpec& spec, const Grid& grid) noexcept {
  const Filter& filter = filterOf(spec.kind);
  return filter.grid_on != nullptr ? filter.grid_on(spec, grid) : filter.grid;
}

bool separatesScales(const Filter& filter) noexcept {
  return filter.nesting.exists();
}

bool hasElement(const Filter& filter) noexcept {
  return filter.has_element;
}

bool keepsEdges(const Filter& filter) noexcept {
  return filter.keeps_edges;
}

bool knowsLines(const Filter& filter) noexcept {
  return filter.knows_lines;
}

bool runsOnDevices(const Filter& filter) noexcept {
  return filter.on_device != nullptr;
}

double usualNesting(const Filter& filter, const Grid& grid) noexcept {
  return filter.nesting.exists() ? 25.0 * std::max(grid.spacingXMm(), grid.spacingYMm()) : 0.0;
}

std::vector<FilterKind> plainFilters() {
  std::vector<FilterKind> kinds;
  for (const Filter& filter : kFilters)
    if (!filter.keeps_edges && !separatesScales(filter)) kinds.push_back(filter.kind);
  return kinds;
}

std::string filterWords(bool (*which)(const Filter&), std::string_view last_between) {
  std::string text;
  std::string_view last;
  for (const Filter& filter : kFilters) {
    if (!which(filter)) continue;
    if (!last.empty()) (text += text.empty() ? "" : ", ") += last;
    last = filter.word;
  }
  return text.empty() ? std::string(last) : (text += last_between) += last;
}

}  // namespace fettle::engine

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/filter/filter.h"

namespace fettle::engine {

class FilterWork;
struct FilterTuning;
struct PassResult;
class TgvDevice;

/// A number of a FilterSpec as one filter takes it.
struct FilterParameter {
  std::string_view unit{};  ///< "samples", "height_unit" or "mm"; empty: the filter has no such number
  double least = 0.0, most = 0.0;
  double usual = 0.0;            ///< of a spec that says nothing; 0 may stand outside least .. most
  std::string_view when_zero{};  ///< what takes the place of 0, in words; empty where 0 is a value as any

  [[nodiscard]] constexpr bool exists() const noexcept { return !unit.empty(); }
};

/// A setting of a filter that suggestFilter tries.
struct FilterTrial {
  int window;
  /// Processor time of one pass [ns per sample, one thread with AVX-512], as measured once: which of two is faster is not
  /// left to the clock of a machine that does other work besides.
  double cost;
  int passes = 1;
  double noises = 0.0;  ///< range sigma in standard deviations of the noise, for a filter that has one
  bool around_edges = false;
};

/// One pass over a whole field: `input` with its holes and marks, changed where `spec` says by no more than it
/// allows against `original`. On the calling thread's task arena; the spec is valid. Advances the progress by
/// the field's samples. Errors as applyFilter; throws std::bad_alloc.
using FilterPass = Result<PassResult> (*)(const Version& input, const Version& original,
                                          const FilterSpec& spec, const FilterTuning& tuning,
                                          JobControl& job);

/// The same on another processor; its errors as well. `work` as FilterTuning::work.
using FilterPassOnDevice = Result<PassResult> (*)(const Version& input, const Version& original,
                                                  const FilterSpec& spec, TgvDevice& device, FilterWork* work,
                                                  JobControl& job);

/// All that the program knows of a filter: command line, journal, panel, suggestion, benchmarks,
/// demonstration and the table of docs/commands.md follow it.
struct Filter {
  FilterKind kind;
  std::string_view word;  ///< of the command line, of journals and of sessions: never changed
  const char* title;      ///< of panels
  std::string_view says;  ///< what it does to a scan, for those who choose one
  /// Steps stay as steep as they are. Those that do not are the paper's: the demonstration and, unless
  /// others are named, the benchmarks run these. What keeps edges costs ten to a hundred times as much.
  bool keeps_edges = false;
  FilterParameter window{"samples", 1, FilterSpec::kMaxWindow, 3};
  FilterParameter sigma{}, range_sigma{};
  /// FilterSpec::nesting_mm, which must then be given, and its word in commands and recipes. Such filters separate
  /// scales instead of removing noise: neither suggestion, demonstration nor, unless named, benchmarks try them.
  FilterParameter nesting{};
  std::string_view nesting_word{};
  double least_nesting = FilterSpec::kLeastNesting;  ///< [the larger spacing of a field]
  bool has_element = false;                          ///< FilterSpec::element
  bool robust = false;  ///< samples may lose their weight (FilterReport::weightless)
  /// Range sigma in standard deviations of the noise when none is given: with it the least error was left
  /// over the whole of simulated bracket, wedges, steps and die (384 x 384, noise 1 and 3), 0.41 of the scan's
  /// own for both that have one. Half as much leaves a tenth more, twice as much takes a tenth more off the
  /// edges.
  double noises = 0.0;
  FilterPass pass;
  /// How far a result of one pass depends on samples around it [samples].
  std::int32_t (*reach)(const FilterSpec& spec) = [](const FilterSpec& spec) { return spec.window / 2; };
  /// In place of `reach` and `grid` where they depend on the field's spacing.
  std::int32_t (*reach_on)(const FilterSpec& spec, const Grid& grid) = nullptr;
  std::int32_t (*grid_on)(const FilterSpec& spec, const Grid& grid) = nullptr;
  /// Its blocks can be worked out alone, so that some of them tell what all will take.
  bool sampled = true;
  /// Side of the squares, on a grid that begins at the field's first sample, that the filter works in: a piece
  /// of a field has the field's results where it begins at a multiple of it [samples].
  std::int32_t grid = 1;
  std::span<const FilterTrial> trials{};
  bool knows_lines = false;  ///< the edge lines of its input (Version::lines) have an influence
  /// Null: it runs on this processor alone. tgv_device.h states how far results differ.
  FilterPassOnDevice on_device = nullptr;
};

/// Every filter, in the order of FilterKind.
[[nodiscard]] std::span<const Filter> filters() noexcept;

[[nodiscard]] const Filter& filterOf(FilterKind kind) noexcept;
/// Null where no filter has the word.
[[nodiscard]] const Filter* filterNamed(std::string_view word) noexcept;

/// Filter::word.
[[nodiscard]] std::string_view name(FilterKind kind) noexcept;

/// Whether a filter separates noise from surface by height differences: FilterSpec::range_sigma.
[[nodiscard]] bool hasRange(FilterKind kind) noexcept;

/// How far the result of all passes depends on samples around it [samples]. Of a filter with reach_on: kMaxSide.
[[nodiscard]] std::int32_t reachOf(const FilterSpec& spec) noexcept;
/// The same in a field: with edge lines a window that ends at them looks farther (kLineReach).
[[nodiscard]] std::int32_t reachOf(const FilterSpec& spec, const Version& input) noexcept;
/// The same in a field of this grid, with or without edge lines.
[[nodiscard]] std::int32_t reachOf(const FilterSpec& spec, const Grid& grid, bool lines) noexcept;

/// Whether a result depends on the whole field, whatever its size: no piece of it has the field's results.
[[nodiscard]] bool needsWholeField(const Filter& filter) noexcept;

/// At what multiples pieces of a field begin that have the field's results: Filter::grid, or by grid_on [samples].
[[nodiscard]] std::int32_t pieceGridOf(const FilterSpec& spec, const Grid& grid) noexcept;

/// Filter::keeps_edges, for filterWords.
[[nodiscard]] bool keepsEdges(const Filter& filter) noexcept;

/// Filter::knows_lines, for filterWords.
[[nodiscard]] bool knowsLines(const Filter& filter) noexcept;

/// Filter::on_device, for filterWords.
[[nodiscard]] bool runsOnDevices(const Filter& filter) noexcept;

/// Whether a filter has a nesting index, for filterWords.
[[nodiscard]] bool separatesScales(const Filter& filter) noexcept;

/// Filter::has_element, for filterWords.
[[nodiscard]] bool hasElement(const Filter& filter) noexcept;

/// Words of the command line, of journals and of recipes, in the order of Element: never changed.
inline constexpr std::array<std::string_view, 3> kElementWords{"ball", "disk", "square"};

/// A nesting index to begin with: 25 of the larger spacings [mm]; 0 for a filter without.
[[nodiscard]] double usualNesting(const Filter& filter, const Grid& grid) noexcept;

/// Those that neither keep edges nor separate scales.
[[nodiscard]] std::vector<FilterKind> plainFilters();

/// The words of the filters for which `which` is true, as "box, gaussian and median".
[[nodiscard]] std::string filterWords(bool (*which)(const Filter&), std::string_view last_between = " and ");

}  // namespace fettle::engine

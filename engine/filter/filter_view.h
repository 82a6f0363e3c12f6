#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/field_view.h"
#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/filter/coarse_filter.h"
#include "engine/filter/filter.h"
#include "engine/filter/filter_work.h"

namespace fettle::engine {

/// A filter of a whole field, of which what is seen is there first.
///
/// The tiles in view come first, the nearest to its middle before the others, then the rest, each with the bits of
/// applyFilter. Where those in view would take longer than kSoon_s, they are approximated first from means of as many samples
/// as take a fraction of it (CoarseFilter), and each tile is replaced as its result comes. Where much of the field is in view,
/// the first picture is the field of the means itself: tiles for all of it take longer to fill than to filter. How far the
/// approximation is off is measured on every tile that is replaced, of a filter that needs the whole field beforehand by an
/// approximation from fewer samples. A result that is adopted is that of applyFilter of the whole: no approximation goes into it.
///
/// Threading: look(), picture(), wantsCoarse() from any thread, a lock is held for microseconds to milliseconds; run() once,
/// and coarsen() meanwhile, on threads of their own.
class FilterView : private FilterWork {
 public:
  static constexpr double kSoon_s = 0.3;

  /// All of one grid. `view`: empty tiles: no part comes first.
  FilterView(Version input, Version original, const FieldView& view);

  /// The camera moved: what is not worked out yet is in another order from now on.
  void look(const FieldView& view);

  struct Done {
    FilterSpec spec;  ///< with its range (withMeasuredRange of the original)
    Filtered filtered;
  };
  /// As withMeasuredRange and applyFilter, and with their errors.
  [[nodiscard]] Result<Done> run(const FilterSpec& asked, JobControl& job);

  /// Whether tiles came into view that show nothing of the filter yet, and it takes so long that they should.
  [[nodiscard]] bool wantsCoarse() const;
  /// Approximates them.
  [[nodiscard]] Status coarsen(JobControl& job);

  /// How far the approximation is off [height_unit].
  struct Off {
    double rms = 0.0, most = 0.0;
    bool estimated = false;  ///< against an approximation from fewer samples, not against results
  };
  /// The result so far.
  struct Picture {
    Version field;  ///< of the input's grid, or of one with `step` times its spacing; empty: nothing is there
    double exact = 0.0;      ///< share of the tiles in view that have their result, 0 .. 1
    double untouched = 0.0;  ///< and of those that show the input
    std::int32_t step =
        0;  ///< the approximated ones are from means of this many samples on a side; 0: there are none
    std::optional<Off> off;  ///< as measured until now
  };
  [[nodiscard]] Picture picture() const;

 private:
  // Of a tile: the samples on a side of the means that it is approximated from, or one of these.
  using TileStep = std::uint16_t;
  static constexpr TileStep kInput = 0, kExact = 0xFFFF;
  struct NewExact {
    std::int32_t column, row;
    TileRef tile;
  };

  Result<State> begin(const Version& input) override { return State{0, input}; }
  Status beginPass(const State& before) override;
  std::uint64_t wish() override { return wish_.load(std::memory_order_relaxed); }
  double rank(const TileRect& block) override;
  bool isDone(const TileRect&) override { return false; }
  void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) override;
  void addMade(std::vector<NewTile>&) override {}

  void approximateIfSlow(const FilterSpec& asked, JobControl& job);
  void filterPieces(const FilterSpec& spec, JobControl& job);
  [[nodiscard]] std::vector<NewExact> filterPiece(const FilterSpec& spec, const TileRange& piece,
                                                  JobControl& job) const;
  [[nodiscard]] std::optional<TileRange> nearestPiece(std::int32_t side) const;
  [[nodiscard]] FieldView viewNow() const;
  [[nodiscard]] SampleRect approximated(const FieldView& view) const;
  [[nodiscard]] std::int32_t stepFor(const FieldView& view) const;
  void compareNearest(const CoarseFilter& coarse, const FilterSpec& spec, JobControl& job);
  Status putCoarse(const CoarseFilter& coarse, const TileRange& tiles, JobControl& job);
  void putExact(std::vector<NewExact> tiles);
  [[nodiscard]] TileStep& stepOf(std::int32_t tc, std::int32_t tr) {
    return steps_[static_cast<std::size_t>(tr) * static_cast<std::size_t>(all_.columns) +
                  static_cast<std::size_t>(tc)];
  }
  [[nodiscard]] TileStep stepOf(std::int32_t tc, std::int32_t tr) const {
    return const_cast<FilterView*>(this)->stepOf(tc, tr);
  }

  const Version input_, original_;
  const TileRange all_;
  std::atomic<std::uint64_t> wish_{1};
  // Of the pass that runs; written while no worker works.
  Version before_;
  bool last_pass_ = false;
  int passes_ = 1;

  mutable std::mutex mutex_;  // guards all below
  FieldView view_;
  LiveField live_;
  std::vector<TileStep> steps_;
  bool begun_ = false;
  Version means_;  // as long as they are the picture
  std::int32_t step_of_means_ = 0;
  std::optional<FilterSpec> coarse_spec_;  // of a filter that takes long; its range may be a guess
  bool range_is_guessed_ = false;
  double seconds_a_sample_ = 0.0;
  double squares_ = 0.0, most_ = 0.0;  // of what was approximated, off the results
  std::int64_t compared_ = 0;
  std::optional<Off> estimate_;
};

}  // namespace fettle::engine

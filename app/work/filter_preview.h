#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/touch.h"
#include "engine/field/tile_range.h"
#include "engine/filter/catalogue.h"
#include "haptic/loop/adopt_filtered.h"

namespace fettle::app {

/// "Median 5 x 5", "Gaussian 7 x 7, 3 passes, only marks".
[[nodiscard]] std::string filterName(const engine::FilterSpec& spec);

/// Filters tried out on the field in the background while touch goes on, and the one that is applied.
/// Threading: main.
class FilterPreview {
 public:
  static constexpr std::size_t kMostVariants = 4;  // and the field itself: five pictures

  struct Variant {
    engine::FilterSpec asked;  ///< as the panel had it
    engine::FilterSpec spec;   ///< as computed: with a range sigma, where the panel left it to the noise
    engine::Version base;      ///< as felt when it was computed
    engine::Filtered result;
    std::uint64_t base_id = 0;  ///< the base's in the journal (Touch::noteFilterBase)
  };

  /// What the panel edits. A range sigma of 0 is one for the field's noise (engine::withMeasuredRange).
  engine::FilterSpec spec;

  /// A picture of a filter: what it made, or has made so far.
  struct Picture {
    engine::Version field;
    std::string title;
  };

  /// Computes `spec` on the field as it is now. `keep`: beside the variants there are; else in their place.
  /// `seen_first`: what is filtered before all else (visiblePart), to be shown while the rest is worked on.
  enum class Keep : std::uint8_t { kReplace, kBeside };
  void compute(Touch& touch, Keep keep, std::vector<engine::TileRange> seen_first = {});
  /// Brings the newest variant into the field as one step; computes it first when there is none for `spec`.
  void apply(Touch& touch);
  void cancel(Touch& touch);
  /// Takes in what was computed. True when something to be seen changed.
  [[nodiscard]] bool poll(Touch& touch, std::vector<Notice>& notices);

  [[nodiscard]] const std::vector<Variant>& variants() const noexcept { return variants_; }
  void drop(std::size_t variant);
  /// What is to be drawn beside the field.
  [[nodiscard]] std::vector<Picture> pictures() const;
  [[nodiscard]] bool computing() const noexcept { return computing_.busy(); }
  [[nodiscard]] bool applying() const noexcept { return applying_.busy(); }
  [[nodiscard]] double progress() const noexcept {
    return computing_.busy() ? computing_.progress() : applying_.progress();
  }
  /// Times a filter was applied.
  [[nodiscard]] int applied() const noexcept { return applied_; }
  /// How long the last computation took [s].
  [[nodiscard]] double seconds() const noexcept { return seconds_; }

 private:
  // The worker's latest result in parts; the main thread looks at it once a frame.
  struct SoFar {
    std::mutex mutex;
    engine::Version field;
    engine::FilterSpec spec;
  };
  void adopt(Touch& touch, Variant variant);

  std::vector<Variant> variants_;
  Keep keep_ = Keep::kReplace;
  bool apply_when_done_ = false;
  double seconds_ = 0.0;
  int applied_ = 0;
  std::shared_ptr<SoFar> so_far_;
  engine::Version seen_so_far_;
  Background<Variant> computing_;
  Background<haptic::AdoptionReport> applying_;
};

}  // namespace fettle::app

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/work/areal_table.h"
#include "app/work/beside_the_field.h"
#include "app/work/read_units.h"
#include "app/work/surface_numbers.h"
#include "engine/field/sample_rect.h"

namespace fettle::app {

/// Surface texture parameters of the field that is worked on, beside those of the scan it began with, measured in the background while
/// the hand goes on. Threading: main.
class MeasureTool {
 public:
  /// The samples that count.
  enum class Where : std::uint8_t { kAll, kVisible, kMarked, kUnmarked };
  /// Edited by the panel.
  struct Options {
    Where where = Where::kAll;
    int degree = 1;  ///< of the form that is taken out
    bool robust = false;
    bool noise = false;   ///< figures without noise, by 16 trials
    bool scales = false;  ///< the next two count; else no filter does
    double s_mm = 0.0;    ///< of the S-filter before the form, an areal Gaussian; 0: none
    double l_mm = 0.0;    ///< of the L-filter after the form, what it leaves is taken away; 0: none
    bool own = false;     ///< the next ones count, else they are the usual ones
    double peaks = 10.0, dales = 80.0;  ///< material ratios where peaks end and dales begin [%]
    double prune = 5.0;                 ///< hills and dales that are lower are no features [% of Sz]
    bool between = false;               ///< also Sdc, of the next two
    double from = 10.0, to = 80.0;      ///< material ratios [%]
  };
  Options options;
  /// The curve that the panel shows.
  enum class Curve : std::uint8_t { kAbbott, kDecay, kSpectrum };
  Curve curve = Curve::kAbbott;

  struct Figures {
    Options options;
    std::int64_t samples = 0;
    std::vector<ArealLine>
        lines;            ///< a value for the scan, unless nothing differs from it, and one for the field
    bool before = false;  ///< whether lines have the scan's
    std::vector<SurfaceCurves> curves;  ///< one for each value of the lines
  };

  /// Measures `options` on the newest field; `seen`: the rectangle that is visible. One that is empty is refused by a notice of poll().
  /// `across`, `heights`: the units of the window, as of arealLines().
  void measure(const LoopClient& client, const engine::SampleRect& seen, const ReadAs& across,
               const ReadAs& heights);
  void cancel() noexcept { work_.cancel(); }
  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices) {
    return work_.poll(client, notices).changed;
  }

  [[nodiscard]] bool busy() const noexcept { return work_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return work_.progress(); }
  /// The last figures; null before, and of another document.
  [[nodiscard]] const Figures* figures() const noexcept {
    return work_.get() ? &work_.get()->figures : nullptr;
  }
  /// What was asked for last, measured or not; null before, and of another document.
  [[nodiscard]] const Options* asked() const noexcept { return asked_ ? &*asked_ : nullptr; }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return work_.outdated(); }
  /// Forgets the figures, of a document that is closed.
  void clear() {
    work_.clear();
    asked_.reset();
  }

 private:
  struct Work {
    engine::Version field;
    Figures figures;
  };
  std::optional<Options> asked_;
  BesideTheField<Work> work_;
};

}  // namespace fettle::app

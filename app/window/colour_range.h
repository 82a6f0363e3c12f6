#pragma once

#include <optional>
#include <vector>

#include "app/window/settings.h"
#include "app/work/background.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"
#include "render/plan/colour_map.h"
#include "render/plan/value_range.h"

namespace fettle::app {

/// Which values the colours span, and how often each occurs. The rule is a setting (Display::heights, ::changes)
/// and is kept for the next start; values that are typed or dragged belong to the scan. Samples are taken in the
/// background, and only where a rule or the panel needs them.
///
/// All values are in the field's height unit. Threading: main.
class ColourRange {
 public:
  /// What belongs to the scan, for the user to set.
  struct Typed {
    double tolerance = 0.0;  ///< deviations up to this are shown as zero; 0: none
    double height_contours = 0.0, change_contours = 0.0;  ///< between two contour lines; 0: the bar's steps
  };
  Typed typed;

  /// Another scan, or the same under another form: typed values are dropped, and rules that need them.
  void clear(Display& display);
  /// Takes results, starts on what is shown now where `needed`; `working`: a stroke or a filter is running, and the colours
  /// stay as they are. True when something visible changed.
  [[nodiscard]] bool poll(const render::Shown& shown, bool needed, bool working);

  /// Whether it is a difference from another field.
  [[nodiscard]] static bool isChange(render::Quantity quantity) noexcept {
    return quantity != render::Quantity::kHeight;
  }
  /// Of what `shown` shows.
  [[nodiscard]] static render::Quantity quantityOf(const render::Shown& shown) noexcept;
  /// The rule for it.
  [[nodiscard]] static RangeRule& ruleOf(Display& display, render::Quantity quantity) noexcept;
  [[nodiscard]] static const RangeRule& ruleOf(const Display& display, render::Quantity quantity) noexcept;
  /// Whether a rule needs a sample.
  [[nodiscard]] static bool needsSample(const Display& display, const render::Shown& shown) noexcept;

  /// The range by the rule; nothing: the picture finds it itself (render::PictureSpec::range).
  [[nodiscard]] std::optional<render::ValueRange> range(const Display& display,
                                                        const render::Shown& shown) const;
  /// How values become colours. Of differences with a sign the map is the diverging one, whatever is chosen for heights.
  [[nodiscard]] render::Colouring colouring(const Display& display, render::Quantity quantity) const;
  /// Sets the ends by hand: the rule becomes RangeRule::Kind::kTyped. low < high; of a difference the farther end counts, on both sides of zero.
  void type(Display& display, const render::Shown& shown, const render::ValueRange& range);

  /// Of what is shown, or was shown some frames ago; null while there is none.
  [[nodiscard]] const render::ValueSample* sample(render::Quantity quantity) const noexcept {
    return sample_ && sampled_ == isChange(quantity) ? &*sample_ : nullptr;
  }
  [[nodiscard]] bool busy() const noexcept { return measuring_.busy(); }

  /// Places of the handles on the panel, in pixels of the window; empty while it shows none.
  struct Handles {
    double low_x = 0.0, high_x = 0.0, y = 0.0;
  };
  std::optional<Handles> handles;
  /// The ends of the histogram while a handle is dragged, and which one.
  struct Drag {
    render::ValueRange axis;
    bool high = true;
  };
  std::optional<Drag> drag;

 private:
  // What is shown, as far as it decides about values.
  struct Values {
    std::vector<engine::Version> versions;
    std::optional<engine::Version> original;
    friend bool operator==(const Values&, const Values&) = default;
  };
  // Whether what was counted lies under the form of what is shown: else its heights are others.
  [[nodiscard]] bool isOfForm(const render::Shown& shown) const;

  Background<render::ValueSample> measuring_;
  Values measured_;  // that measuring_ works on, or of sample_
  std::optional<render::ValueSample> sample_;
  bool sampled_ = false;                       // of a difference
  bool turned_ = false;                        // whether sample_ is of a field upside down
  std::optional<render::ValueRange> heights_;  // typed, of the field with sign +1
  std::optional<double> limit_;                // typed, of deviations
};

}  // namespace fettle::app

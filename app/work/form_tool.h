#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/coarse_form.h"
#include "app/work/form_change.h"
#include "app/work/loop_client.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// The form over the field: fitted, taken out and put back as steps, worked out in the background while the hand goes on.
/// Threading: main.
class FormTool {
 public:
  /// Edited by the panel.
  engine::FormChoice options;

  /// A fit: how far the samples that count are from the form.
  struct Fit {
    engine::FormChoice options;
    engine::FieldForm form;
    std::int64_t samples = 0;
    double rms = 0.0;                       ///< [height_unit]
    std::string open, leaves;               ///< as those of FittedForm
    std::int64_t beyond = 0;                ///< samples that count beyond the outline of a shape
    std::optional<engine::Tilt> tilt = {};  ///< of a polynomial; with errors of a plane through three points
    std::string figures = {};               ///< formFigures()
  };

  /// A form before it is taken out: what is seen less `surface` is what would be seen without it. Nothing else changes.
  struct Preview {
    engine::FormChoice options;
    engine::Version surface;  ///< upright
    engine::FieldForm over;   ///< that lies over the field: under another one the surface is another
    /// Approximate, until the surface is there: `surface` is over its means, which are seen in place of the field.
    std::optional<CoarseForm> coarse = {};
  };

  /// Fits `options` to the samples of the newest field, with the form that lies over it: fit() has the result.
  void measure(const LoopClient& client);
  /// Fits, and takes the form out, in place of the one over the field, if any.
  void takeOut(const LoopClient& client);
  /// Fits, and works out the preview. It ends with the form over the field.
  void preview(const LoopClient& client);
  /// Works it out again where `options` are others than those of the preview that is shown.
  void followOptions(const LoopClient& client);
  void dropPreview();
  [[nodiscard]] const std::optional<Preview>& previewed() const noexcept { return preview_; }
  /// For a field under a form.
  void putBack(const LoopClient& client) { start(client, FormStep::kPutBack); }
  void makeHeights(const LoopClient& client) { start(client, FormStep::kMakeHeights); }
  void cancel() noexcept { working_.cancel(); }

  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  /// The last fit; empty before, and of another document.
  [[nodiscard]] const std::optional<Fit>& fit() const noexcept { return fit_; }
  /// Forgets the fit, of a document that is closed.
  void clear();

 private:
  struct Work {
    std::optional<Fit> fit;
    std::optional<FormChange> change;
    std::optional<Preview> preview;
  };
  // An approximation on its way from the worker, which goes on.
  struct Slot {
    std::mutex mutex;
    std::optional<Preview> preview;
  };
  void start(const LoopClient& client, FormStep step);
  void dropApproximation();

  std::optional<Fit> fit_;
  std::optional<Preview> preview_;
  std::shared_ptr<Slot> slot_;
  Background<Work> working_;
};

}  // namespace fettle::app

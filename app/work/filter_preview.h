#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "app/work/preview_pace.h"
#include "app/work/preview_picture.h"
#include "app/work/scan_noise.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/filter_view.h"
#include "haptic/loop/adopt_filtered.h"

namespace fettle::app {

/// "Median 5 x 5", "Gaussian 7 x 7, 3 passes, only marks".
[[nodiscard]] std::string filterName(const engine::FilterSpec& spec);

/// What a preview is as long as it is not the filter's result: "approximate, off by 12 um rms", "40 %
/// so far", "exact in view".
[[nodiscard]] std::string previewState(const engine::FilterView::Picture& picture, const engine::Grid& grid);

/// Filters previewed on the field in the background during touch, and the one that is applied. Threading:
/// main.
class FilterPreview {
 public:
  static constexpr std::size_t kMostVariants = 4;  // and the field itself: five pictures

  struct Variant {
    engine::FilterSpec asked;  ///< as set in the panel
    engine::FilterSpec spec;   ///< as computed: with a range sigma from the noise if the panel gave none
    engine::Version base;      ///< as felt when it was computed
    engine::Filtered result;
    std::uint64_t base_id = 0;  ///< the base's in the journal (LoopClient::noteFilterBase)
    std::int64_t unjudged = 0;  ///< of outliers: engine::countUnjudged
  };

  /// Edited by the panel. A range sigma of 0 means one for the noise of the scan as it was opened (engine::withMeasuredRange),
  /// also after other filters, which leave less.
  engine::FilterSpec spec;
  /// What that 0 stands for [height_unit], measured from now on where it is not known; nothing until then, for filters
  /// without a range, and where no noise is seen.
  [[nodiscard]] std::optional<double> rangeOfNoise(const LoopClient& client);

  [[nodiscard]] bool measuresNoise() const noexcept { return noise_.busy(); }

  /// Another filter in the fields, with the numbers that were said for it, else its usual ones on `grid`; limit of change and
  /// scope stay as they are.
  void chooseKind(engine::FilterKind kind, const engine::Grid& grid);
  /// Puts a filter with its numbers into the fields; the limit of change stays as it is.
  void choose(const engine::FilterSpec& filter);
  /// Whether the fields say this filter, whatever the limit of change.
  [[nodiscard]] bool says(const engine::FilterSpec& filter) const;

  /// Computes `spec` on the present field. `keep`: in addition to the existing variants, or replacing them, or the newest of
  /// them. `view`: what is shown of the field (visiblePart) is filtered first, approximately where that takes long.
  enum class Keep : std::uint8_t { kReplace, kAdd, kRenew };
  void compute(LoopClient& client, Keep keep, const engine::FieldView& view = {});
  /// Lets the newest preview follow the fields of its filter, once a frame: where the last one of that filter was soon seen
  /// (PreviewPace), it is renewed when the fields have rested, and what was computed of their values before is cancelled at
  /// once. Another filter, or one that takes longer, waits until it is asked for. `view`: as of compute().
  void follow(LoopClient& client, const std::function<engine::FieldView()>& view);
  /// Whether follow() will begin a preview when the fields rest.
  [[nodiscard]] bool awaitsRest() const noexcept { return fields_.changed(); }
  /// Whether no preview, shown or on its way, is what `spec` asks for; false without any.
  [[nodiscard]] bool isBehind() const;
  /// Whether what is computed follows the fields and has not taken long, so that the panel need not say so.
  [[nodiscard]] bool followsSoon() const;
  /// Whether it is time to say what is shown now, since something is computed in its order.
  [[nodiscard]] bool wantsView() const;
  void look(const engine::FieldView& view);
  /// The picture so far of what is computed; its field is empty before, and afterwards.
  [[nodiscard]] const engine::FilterView::Picture& soFar() const noexcept { return so_far_; }
  /// Whether its picture, the last of pictures(), is of means of samples: smoother than the result.
  [[nodiscard]] bool showsMeans() const noexcept { return !so_far_.field.empty() && so_far_.step > 1; }
  /// Adopts the newest variant into the field as one step; computes it first when there is none for `spec`. Where the preview
  /// that is shown is one of another filter, that of `spec` is shown instead, a notice says so, and nothing is applied: what
  /// was never seen becomes no step beside a picture of something else.
  void apply(LoopClient& client);
  void cancel(LoopClient& client);
  /// As cancel(), and waits until no worker uses the port of `client`, which may be destroyed afterwards.
  void finish(LoopClient& client);
  /// Takes over computed results. True when something visible changed; more of a result that is being computed is none, which who
  /// draws it sees by itself.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] const std::vector<Variant>& variants() const noexcept { return variants_; }
  /// Whether a variant is what `spec` asks for now.
  [[nodiscard]] bool isCurrent(const Variant& variant) const;
  void drop(std::size_t variant);
  /// What is to be drawn next to the field.
  [[nodiscard]] std::vector<PreviewPicture> pictures() const;
  [[nodiscard]] bool computing() const noexcept { return computing_.busy(); }
  [[nodiscard]] bool applying() const noexcept { return applying_.busy(); }
  [[nodiscard]] WorkProgress progress() const {
    return computing_.busy() ? computing_.progress() : applying_.progress();
  }
  /// Times a filter was applied.
  [[nodiscard]] int applied() const noexcept { return applied_; }
  /// How long the last computation took [s].
  [[nodiscard]] double seconds() const noexcept { return seconds_; }

 private:
  using Clock = PreviewPace::Clock;
  // The fields of a filter; threads are none.
  struct Fields {
    engine::FilterSpec spec;
    bool operator==(const Fields& other) const;
  };
  void takeSoFar();
  void dropSoFar();
  void noteSeen();
  void stopFollowing();
  [[nodiscard]] bool computes() const { return computing_.busy() && !computing_.cancelling(); }
  void adopt(LoopClient& client, Variant variant);

  std::vector<Variant> variants_;
  std::map<engine::FilterKind, engine::FilterSpec> said_;  // of filters that were in the fields before
  Keep keep_ = Keep::kReplace;
  bool apply_when_done_ = false;
  bool shown_instead_ = false;  // of a preview of another filter, which was to be applied
  double seconds_ = 0.0;
  int applied_ = 0;
  engine::FieldForm form_;                    // over the field that is previewed
  std::shared_ptr<engine::FilterView> view_;  // of what is computed
  engine::FilterSpec of_view_;
  engine::FilterView::Picture so_far_;  // or the last one of what was computed before, until there is one
  engine::FilterSpec of_so_far_;
  bool seen_ = false;     // something of what is computed
  bool follows_ = false;  // what is computed was begun by follow()
  std::map<engine::FilterKind, PreviewPace> paces_;
  RestingFields<Fields> fields_;
  std::optional<Keep> again_;  // of a computation that was cancelled since the fields changed
  Clock::time_point begun_, looked_;
  ScanNoise noise_;
  Background<Variant> computing_;
  Background<bool> approximating_;  // what came into view meanwhile
  Background<haptic::AdoptionReport> applying_;
};

}  // namespace fettle::app

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "app/work/preview_pace.h"
#include "app/work/preview_picture.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "haptic/journal/computed_heights.h"
#include "haptic/journal/early_heights.h"

namespace fettle::app {

/// Fills holes of the field that is worked on, levels the lines of a line scanner and removes samples, as `fettle fill`, `fettle level
/// --rows` and `fettle remove` do: each a step, worked out in the background while the hand goes on. A stroke meanwhile is
/// kept: it is worked out again with it.
///
/// A preview is the same beside the field, and no step; what is seen of it comes first, also after the camera moved
/// (haptic::EarlyHeights). It becomes the step as it is. It is of one state of the field, and ends with it: with an edit, an undo, another form, other marks. Threading: main.
class HeightTool {
 public:
  /// Edited by the panel.
  engine::FillOptions fill;
  /// Slow form stays unless a person says otherwise: who takes stripes away does not expect it to go.
  engine::LineOptions lines{.form_degree = engine::LineOptions::kUsualFormDegree};
  engine::RemoveOptions remove;

  /// Up to how long holes are filled in a scan that was just opened [mm]: a hole of that length is as long as 20 samples. Where
  /// the scanner missed some, the rim says what was there; it does not of a pocket or of what lies around a part.
  [[nodiscard]] static double usualExtentMm(const engine::Grid& grid) noexcept;

  void fillHoles() { make(fill); }
  void levelLines() { make(lines); }
  void removeSamples() { make(remove); }
  /// Marked samples of any height, whatever the fields say.
  void removeMarked() { make(engine::RemoveOptions{.region = engine::Region::kMarked}); }
  /// `view`: what is shown of the field (visiblePart).
  void preview(const haptic::HeightsMaker& maker, const engine::FieldView& view);
  /// Lets a preview follow the fields that it is of, once a frame, where it is soon seen: as FilterPreview::follow.
  void follow(const std::function<engine::FieldView()>& view);
  /// Whether follow() will begin a preview when the fields rest.
  [[nodiscard]] bool awaitsRest() const noexcept;
  /// Whether what is computed follows the fields and has not taken long, so that the panel need not say so.
  [[nodiscard]] bool followsSoon() const;
  /// Whether it is time to say what is shown now, since something is computed for it.
  [[nodiscard]] bool wantsView() const;
  void look(const engine::FieldView& view);
  void dropPreview();
  /// Makes what is previewed the step.
  void applyPreview();
  /// Of what is being worked out, too: a preview that is wanted as a step. Previews that are there stay.
  void cancel() noexcept;
  /// Takes over results, as steps or previews. True when something visible changed.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy() || asked_ || done_; }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  [[nodiscard]] const char* stage() const noexcept { return working_.stage(); }
  /// What the last one found, in a sentence; empty before.
  [[nodiscard]] const std::string& found() const noexcept { return found_; }
  /// Whether the last one was of this kind.
  [[nodiscard]] bool wasLast(const haptic::HeightsMaker& maker) const noexcept {
    return wanted_.maker.index() == maker.index();
  }
  /// What makes the whole result that is previewed; null without one.
  [[nodiscard]] const haptic::HeightsMaker* previewed() const noexcept {
    return preview_ ? &preview_->maker : nullptr;
  }
  /// Its name, as that of the step; empty without one.
  [[nodiscard]] std::string previewName() const;
  [[nodiscard]] bool previews(const haptic::HeightsMaker& maker) const {
    return preview_ && preview_->maker == maker;
  }
  /// What is shown until the whole result is there, in words; empty without.
  [[nodiscard]] std::string soFar() const;
  /// Whether picture() is of means of samples: smoother than the result.
  [[nodiscard]] bool showsMeans() const noexcept { return early_ && early_->picture.step > 1; }
  /// What is to be drawn next to the field.
  [[nodiscard]] std::optional<PreviewPicture> picture() const;
  /// Forgets all of a document that is closed.
  void clear();

 private:
  enum class Becomes : std::uint8_t { kStep, kPreview };
  struct Wanted {
    haptic::HeightsMaker maker;
    Becomes becomes = Becomes::kStep;
    engine::FieldView view;
  };
  struct Work {
    engine::Version base;
    haptic::ComputedHeights heights;
    std::int64_t holes = 0;  // samples without a height that are left when holes were filled
  };
  struct Preview {
    haptic::HeightsMaker maker;
    Work work;
  };
  struct Early {
    engine::EarlyPicture picture;
    engine::TileRange tiles;  // in view, that it is of
  };
  // Of a preview that is computed: a picture on its way from a worker, which goes on.
  struct Seeing {
    Seeing(const engine::Version& base, const haptic::HeightsMaker& maker) : heights(base, maker) {}
    void see(const engine::FieldView& view, engine::JobControl& job);

    haptic::EarlyHeights heights;
    std::mutex mutex;
    std::optional<Early> newest;  // guarded by mutex
  };
  void seeMoved();
  // Whether the camera shows something else than what the picture is of.
  [[nodiscard]] bool moved() const noexcept;
  void make(const haptic::HeightsMaker& maker);
  void dropEarly();
  void forgetFound() noexcept;
  void stopFollowing() noexcept;
  [[nodiscard]] haptic::HeightsMaker fieldsOf(std::size_t kind) const;
  // Of a preview that is asked for, worked out or shown, in this order; null without.
  [[nodiscard]] const haptic::HeightsMaker* newestPreview() const noexcept;
  [[nodiscard]] bool computesPreview() const noexcept {
    return working_.busy() && !working_.cancelling() && wanted_.becomes == Becomes::kPreview;
  }
  [[nodiscard]] bool dropOutdated(const LoopClient& client);
  [[nodiscard]] bool takeEarly();
  /// What was found goes with the step, when it is undone.
  [[nodiscard]] bool forgetUndone(const LoopClient& client);
  void start(LoopClient& client);

  std::optional<Wanted> asked_;  // to be worked out
  Wanted wanted_;                // that is worked out
  engine::Version base_;         // of what is worked out as a preview
  std::optional<Work> done_;     // waits for the end of a stroke
  std::optional<Preview> preview_;
  std::shared_ptr<Seeing> seeing_;
  std::optional<Early> early_;
  engine::FieldView view_;         // as the camera shows it
  engine::TileRange asked_tiles_;  // that are worked out first, or were
  PreviewPace::Clock::time_point looked_;
  std::string found_;
  std::optional<engine::Version> made_from_;  // by the step that was found; nothing: it was none
  bool made_ = false;                         // and the step is there
  bool changed_nothing_ = false;              // so that there is no step
  static constexpr std::size_t kKinds = std::variant_size_v<haptic::HeightsMaker>;
  std::array<PreviewPace, kKinds> paces_;
  std::array<RestingFields<haptic::HeightsMaker>, kKinds> fields_;
  bool again_ = false;    // a preview was cancelled since its fields changed
  bool follows_ = false;  // what is worked out was asked for by follow()
  PreviewPace::Clock::time_point begun_;
  Background<Work> working_;
  Background<bool> moving_;  // works out what came into view, beside the whole
};

/// "Fill holes: least curvature", "Level rows: median, form stays", "Remove unmarked samples below 0.2 mm": the step in the list of
/// steps.
/// `field`: that it is made from, with its unit and the way up that its heights are read.
[[nodiscard]] std::string makerName(const haptic::HeightsMaker& maker, const engine::Version& field);

/// "approximate, off by 12 um rms, 20 % exact", "40 % so far", "exact in view".
[[nodiscard]] std::string earlyState(const engine::EarlyPicture& picture);

}  // namespace fettle::app

#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "app/work/preview_picture.h"
#include "haptic/journal/computed_heights.h"

namespace fettle::app {

/// Fills holes of the field that is worked on and levels the lines of a line scanner, as `fettle fill` and `fettle level --rows` do: each a step,
/// worked out in the background while the hand goes on. A stroke meanwhile is kept: it is worked out again with it.
///
/// A preview is the same beside the field, and no step; what is seen of it comes first (haptic::computeHeights). It becomes
/// the step as it is. It is of one state of the field, and ends with it: with an edit, an undo, another form, other marks. Threading: main.
class HeightTool {
 public:
  /// Edited by the panel.
  engine::FillOptions fill;
  engine::LineOptions lines;

  void fillHoles() { make(fill); }
  void levelLines() { make(lines); }
  /// `view`: what is shown of the field (visiblePart).
  void preview(const haptic::HeightsMaker& maker, const engine::FieldView& view);
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
  /// Whether the last one filled holes instead of levelling lines.
  [[nodiscard]] bool filledLast() const noexcept {
    return std::holds_alternative<engine::FillOptions>(wanted_.maker);
  }
  /// What makes the whole result that is previewed; null without one.
  [[nodiscard]] const haptic::HeightsMaker* previewed() const noexcept {
    return preview_ ? &preview_->maker : nullptr;
  }
  [[nodiscard]] bool previews(const haptic::HeightsMaker& maker) const {
    return preview_ && preview_->maker == maker;
  }
  /// What is shown until the whole result is there, in words; empty without.
  [[nodiscard]] std::string soFar() const;
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
  };
  struct Preview {
    haptic::HeightsMaker maker;
    Work work;
  };
  // A picture on its way from the worker, which goes on.
  struct Slot {
    std::mutex mutex;
    std::optional<engine::EarlyPicture> picture;
  };
  void make(const haptic::HeightsMaker& maker);
  void dropEarly();
  void forgetFound() noexcept;
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
  std::shared_ptr<Slot> slot_;
  std::optional<engine::EarlyPicture> early_;
  std::string found_;
  std::optional<engine::Version> made_from_;  // by the step that was found; nothing: it was none
  bool made_ = false;                         // and the step is there
  Background<Work> working_;
};

/// "Fill holes: least curvature", "Level rows: median": the step in the list of steps.
[[nodiscard]] std::string makerName(const haptic::HeightsMaker& maker);

/// "approximate, off by 12 um rms", "40 % so far", "exact in view".
[[nodiscard]] std::string earlyState(const engine::EarlyPicture& picture);

}  // namespace fettle::app

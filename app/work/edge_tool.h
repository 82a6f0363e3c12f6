#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "app/work/mark_edit.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::app {

/// The suggestion of edges in the window: computed in the background, shown as marks that are not set yet,
/// and accepted as one step or dropped. While it is shown the field may be edited; the suggestion does not
/// change. Threading: main.
class EdgeTool {
 public:
  double sigma = engine::EdgeMap::kUsualSigma;  ///< of the next search [samples]
  engine::EdgeChoice choice;                    ///< followed while shown

  /// Finds edges on the present field.
  void search(const LoopClient& client);
  /// The choice was changed: draws the suggestion again from the edges found.
  void redraw(const LoopClient& client);
  void drop();
  /// Makes a step of the shown suggestion. False when there is none.
  bool accept(LoopClient& client);
  /// The same as edge lines, located in the background (drawSuggestion).
  bool acceptAsLines(MarkEdit& edit);
  /// True when something visible changed.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  /// Searching, drawing or showing.
  [[nodiscard]] bool on() const noexcept { return searching_.busy() || drawing_.busy() || shown_; }
  [[nodiscard]] bool busy() const noexcept { return searching_.busy() || drawing_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return searching_.progress(); }
  [[nodiscard]] const engine::EdgeSuggestion* suggestion() const noexcept {
    return shown_ ? &*shown_ : nullptr;
  }
  [[nodiscard]] const engine::EdgeMap* map() const noexcept { return found_ ? &found_->map : nullptr; }

  /// `live` with the suggested marks on it, to be drawn instead; `live` itself when there are none. Cost
  /// proportional to the tiles that changed since the last call.
  [[nodiscard]] engine::Version over(const engine::Version& live);

 private:
  struct Found {
    engine::Version field;  // upright
    engine::EdgeMap map;
  };
  struct Drawn {
    engine::EdgeChoice choice;
    engine::Version base;
    engine::EdgeSuggestion suggestion;
  };
  [[nodiscard]] TakenEdges taken() const;

  Background<std::shared_ptr<const Found>> searching_;
  Background<Drawn> drawing_;
  bool draw_again_ = false;
  std::shared_ptr<const Found> found_;
  engine::Version base_;      // upright: what shown_ was drawn on
  engine::EdgeChoice drawn_;  // what shown_ was drawn with
  std::optional<engine::EdgeSuggestion> shown_;
  // over(): under_ with the marks is over_.
  engine::Version under_, over_;
};

}  // namespace fettle::app

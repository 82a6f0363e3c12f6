#pragma once

#include <vector>

#include "app/window/window_picture.h"
#include "app/work/edge_tool.h"
#include "app/work/lasso.h"
#include "app/work/mark_edit.h"

namespace fettle::app {

/// Marks set at once: by a lasso, by a box, by suggested edges, all of them. Threading: main.
class Marking {
 public:
  /// Where the lasso is drawn.
  struct Scope {
    const LoopClient& touch;
    const WindowPicture& picture;
    const render::View& view;
    Display& display;
    bool dragging;  ///< the view moves with the cursor
  };
  /// A lasso or a box from the cursor on, or from the middle of the picture where the cursor is elsewhere.
  void beginLasso(Lasso::Shape shape, const glm::dvec2& cursor, const render::Rectangle& area,
                  const WindowPicture& picture);
  /// Whether the event was the lasso's; others, such as the wheel, go on to the view.
  bool handle(const render::InputEvent& event, const Scope& scope);
  void leaveLasso();
  /// The button is not held any more.
  void release() noexcept { held_ = false; }
  [[nodiscard]] const Lasso& lasso() const noexcept { return lasso_; }
  /// The line is being drawn.
  [[nodiscard]] bool held() const noexcept { return held_ && lasso_.active(); }

  /// Turns a number of the edges' choice, within its range, and follows it.
  void turnChoice(double engine::EdgeChoice::*number, double by, double high, const LoopClient& touch);
  /// Another scale: looks again when edges are looked for.
  void scaleEdges(double factor, const LoopClient& touch);

  /// Takes in what was worked out. True when something to be seen changed.
  [[nodiscard]] bool poll(LoopClient& touch, std::vector<Notice>& notices);
  /// Another field.
  void reset();
  [[nodiscard]] bool busy() const noexcept { return edit.busy() || edges.busy(); }

  MarkEdit edit;
  EdgeTool edges;

 private:
  bool handleKey(const render::InputEvent& event, const Scope& scope);
  void finish(engine::MarkChange change, const Scope& scope);

  Lasso lasso_;
  bool drawn_ = false;  // by hand, since the button went down
  bool held_ = false;
};

}  // namespace fettle::app

#pragma once

#include <vector>

#include "app/window/window_picture.h"
#include "app/work/edge_tool.h"
#include "app/work/lasso.h"
#include "app/work/line_tool.h"
#include "app/work/mark_edit.h"
#include "app/work/place_tool.h"

namespace fettle::app {

/// Marks set in one step: by a lasso, by a box, by suggested edges, or all of them; edge lines, and the places where
/// they are worth most. Lasso and box stay on after each line, until another tool is chosen or Escape. Threading: main.
class Marking {
 public:
  /// The environment of the lasso.
  struct Scope {
    const LoopClient& client;
    const WindowPicture& picture;
    const render::View& view;
    Display& display;
    bool dragging;  ///< the view moves with the cursor
  };
  /// Begins a lasso or a box at the cursor, or at the middle of the picture where the cursor is elsewhere.
  void beginLasso(Lasso::Shape shape, const glm::dvec2& cursor, const render::Rectangle& area,
                  const WindowPicture& picture);
  /// Whether the lasso used the event; others, such as the wheel, are passed to the view.
  bool handle(const render::InputEvent& event, const Scope& scope);
  void leaveLasso();
  /// The button was released.
  void release() noexcept { held_ = false; }
  [[nodiscard]] const Lasso& lasso() const noexcept { return lasso_; }
  /// Whether the line is being drawn.
  [[nodiscard]] bool held() const noexcept { return held_ && lasso_.active(); }

  /// Changes a number of the edges' choice, within its range, and follows the result.
  void turnChoice(double engine::EdgeChoice::*number, double by, double high, const LoopClient& client);
  /// Changes the scale: searches again if edges are being searched.
  void scaleEdges(double factor, const LoopClient& client);

  /// Takes results. True when something visible changed.
  /// `draw_lines`: strokes of the mark tool become edge lines.
  [[nodiscard]] bool poll(LoopClient& client, bool draw_lines, std::vector<Notice>& notices);
  /// Another field was opened.
  void reset();
  [[nodiscard]] bool busy() const noexcept { return edit.busy() || edges.busy() || places.busy(); }

  MarkEdit edit;
  EdgeTool edges;
  LineTool lines;
  PlaceTool places;

 private:
  bool handleKey(const render::InputEvent& event, const Scope& scope);
  void beginNext();
  void finish(engine::MarkChange change, const Scope& scope);

  Lasso lasso_;
  bool drawn_ = false;  // drawn with the mouse, since the button went down
  bool held_ = false;
};

}  // namespace fettle::app

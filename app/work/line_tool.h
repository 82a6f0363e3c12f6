#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "app/work/loop_client.h"
#include "app/work/mark_edit.h"
#include "engine/edges/locate.h"

namespace fettle::app {

/// The name of the step that puts a line in the place of the marks of its stroke, the step before it.
inline constexpr std::string_view kLineOfStroke = "Edge line";

/// An edge line as a list shows it.
struct LineFigures {
  std::int64_t id = 0;
  bool closed = false;
  double length_mm = 0.0;
  double located = 0.0;       ///< share of its points
  double deviation_mm = 0.0;  ///< root mean square over the located points, across the line
  double step = 0.0;          ///< median of the steps' sizes [height_unit]
};

/// Edge lines drawn by hand: strokes of the mark tool become lines, strokes of the unmark tool erase them. One line can
/// be chosen, to be removed or joined. Every change is a step, made by MarkEdit in the order of the strokes.
/// Threading: main.
class LineTool {
 public:
  engine::LocateOptions options;  ///< the hand's

  /// Takes the strokes that have ended. Without `draws` they remain marks, and erase no line.
  void follow(LoopClient& client, MarkEdit& edit, bool draws);

  /// Chooses the line after the chosen one, in the order of the list; the first after the last.
  void chooseNext(const LoopClient& client);
  void choose(std::optional<std::int64_t> id) noexcept { chosen_ = id; }
  /// Of the newest field; none when its line is gone.
  [[nodiscard]] std::optional<std::int64_t> chosen(const LoopClient& client) const;

  /// The line with a point within `radius` [samples] of a place, the nearest; nothing where there is none.
  [[nodiscard]] static std::optional<std::int64_t> lineAt(const LoopClient& client, glm::dvec2 place,
                                                          double radius);
  /// Pulls a line at a place to another one (dragLine).
  void drag(MarkEdit& edit, std::int64_t id, glm::dvec2 from, glm::dvec2 to) const;

  void removeChosen(const LoopClient& client, MarkEdit& edit) const;
  void joinChosen(const LoopClient& client, MarkEdit& edit) const;

  /// Of the lines of a field; computed when they are other ones than at the last call.
  [[nodiscard]] const std::vector<LineFigures>& figures(const engine::Version& field);

 private:
  std::optional<std::int64_t> chosen_;
  engine::EdgeLines figures_of_;
  std::vector<LineFigures> figures_;
};

}  // namespace fettle::app

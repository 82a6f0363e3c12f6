#include "app/work/line_tool.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/texts/texts.h"
#include "app/work/line_edits.h"

namespace fettle::app {

namespace {

using engine::EdgeLine;
using engine::EdgePoint;

LineFigures figuresOf(const EdgeLine& line, const engine::Grid& grid) {
  LineFigures out;
  out.id = line.id;
  out.closed = line.closed;
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  std::vector<double> steps;
  double squares = 0.0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const EdgePoint& point = line.points[i];
    const bool first = i == 0;
    if (!first || line.closed) {
      const EdgePoint& before = first ? line.points.back() : line.points[i - 1];
      out.length_mm += glm::length(spacing * (point.position - before.position));
    }
    if (!point.located) continue;
    squares += point.deviation * point.deviation;
    steps.push_back(std::abs(point.step));
  }
  if (steps.empty()) return out;
  out.located = static_cast<double>(steps.size()) / static_cast<double>(line.points.size());
  out.deviation_mm =
      std::sqrt(squares / static_cast<double>(steps.size())) * std::sqrt(spacing.x * spacing.y);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  out.step = *middle;
  return out;
}

// Where a stroke is, in the scan's own coordinates.
std::string middleOf(const MarkStroke& stroke) {
  const engine::Grid& grid = stroke.after.grid();
  const std::vector<glm::dvec2>& longest =
      *std::ranges::max_element(stroke.pieces, {}, [](const auto& piece) { return piece.size(); });
  const glm::dvec2 at = longest[longest.size() / 2];
  return trFormat("at x {:.6g}, y {:.6g}", grid.origin_x + at.x * grid.spacing_x,
                  grid.origin_y + at.y * grid.spacing_y);
}

// One change of a whole stroke, so that undo, Cancel and notices count what a hand has done and not how many holes it went over.
engine::Result<engine::Version> linesAlong(const MarkStroke& stroke, const engine::Version& base,
                                           double radius, const engine::LocateOptions& options,
                                           engine::JobControl& job) {
  engine::Version changed = base;
  for (const auto& piece : stroke.pieces) {
    auto drawn = drawLine(changed, {piece, stroke.before, stroke.after, radius}, options, job);
    if (!drawn) return drawn;
    changed = *std::move(drawn);
  }
  return changed;
}

}  // namespace

void LineTool::follow(LoopClient& client, MarkEdit& edit, bool draws) {
  for (MarkStroke& taken : client.takeMarkStrokes()) {
    if (!draws) continue;
    const double radius = client.scene().mark_radius_samples;
    const auto stroke = std::make_shared<const MarkStroke>(std::move(taken));
    if (stroke->tool == haptic::Tool::kMark)
      edit.ask(std::string(kLineOfStroke),
               [stroke, radius, options = options](const engine::Version& base, engine::JobControl& job) {
                 return linesAlong(*stroke, base, radius, options, job);
               },
               {trFormat("no edge was found along the stroke {}", middleOf(*stroke)),
                textOf("it stays a mark"), textOf("strokes lie along no edge: they stay marks")});
    else if (client.newest().lines() || edit.busy())
      edit.ask(textOf("Erase edge line"),
               [stroke, radius](const engine::Version& base,
                                engine::JobControl&) -> engine::Result<engine::Version> {
                 engine::Version changed = base;
                 for (const auto& piece : stroke->pieces) changed = eraseLines(changed, piece, radius + 1.0);
                 return changed;
               });
  }
}

std::optional<std::int64_t> LineTool::chosen(const LoopClient& client) const {
  const engine::EdgeLines lines = client.newest().lines();
  if (!chosen_ || lines == nullptr || std::ranges::find(*lines, *chosen_, &EdgeLine::id) == lines->end())
    return std::nullopt;
  return chosen_;
}

void LineTool::chooseNext(const LoopClient& client) {
  const engine::EdgeLines lines = client.newest().lines();
  if (lines == nullptr) return;
  auto at = chosen_ ? std::ranges::find(*lines, *chosen_, &EdgeLine::id) : lines->end();
  if (at != lines->end()) ++at;
  chosen_ = at == lines->end() ? lines->front().id : at->id;
}

std::optional<std::int64_t> LineTool::lineAt(const LoopClient& client, glm::dvec2 place, double radius) {
  const engine::EdgeLines lines = client.newest().lines();
  std::optional<std::int64_t> found;
  if (lines == nullptr) return found;
  for (const EdgeLine& line : *lines)
    for (const EdgePoint& point : line.points)
      if (const double away = glm::distance(point.position, place); away <= radius) {
        radius = away;
        found = line.id;
      }
  return found;
}

void LineTool::drag(MarkEdit& edit, std::int64_t id, glm::dvec2 from, glm::dvec2 to) const {
  edit.ask(textOf("Drag edge line"),
           [=, options = options](const engine::Version& base, engine::JobControl& job) {
             return dragLine(base, id, from, to, options, job);
           });
}

void LineTool::removeChosen(const LoopClient& client, MarkEdit& edit) const {
  if (const auto id = chosen(client))
    edit.ask(textOf("Remove edge line"),
             [id](const engine::Version& base, engine::JobControl&) -> engine::Result<engine::Version> {
               return removeLines(base, id);
             });
}

void LineTool::joinChosen(const LoopClient& client, MarkEdit& edit) const {
  if (const auto id = chosen(client))
    edit.ask(textOf("Join edge lines"),
             [id = *id, options = options](const engine::Version& base, engine::JobControl& job) {
               return joinLine(base, id, options, job);
             });
}

const std::vector<LineFigures>& LineTool::figures(const engine::Version& field) {
  if (field.lines() == figures_of_) return figures_;
  figures_of_ = field.lines();
  figures_.clear();
  if (figures_of_ != nullptr)
    for (const EdgeLine& line : *figures_of_) figures_.push_back(figuresOf(line, field.grid()));
  return figures_;
}

}  // namespace fettle::app

#include "app/work/line_edits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "app/work/edge_strokes.h"
#include "app/work/line_pieces.h"
#include "engine/edges/corners.h"
#include "engine/field/live_field.h"
#include "engine/field/piece.h"
#include "engine/inspect/noise.h"
#include "engine/marks/edge_traces.h"

namespace fettle::app {

namespace {

using engine::EdgeLine;
using engine::EdgePoint;
using engine::EdgeStroke;
using engine::Version;

constexpr double kNear = 24.0;  // [samples] lines within are located together
constexpr std::ptrdiff_t kLongestBridge =
    8;                                     // points: shorter unlocated runs between located ones are no marks
constexpr double kDragWidth = 4.0;         // [samples] along a dragged line, more for longer drags
constexpr double kLongestGap = 60.0;       // [samples] between ends that are joined
constexpr std::int32_t kNoiseMargin = 32;  // [samples] around a stroke, for its noise
constexpr std::int32_t kNoiseSide = 2048;  // most of them in a row or column

struct Box {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};

  void add(glm::dvec2 p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  [[nodiscard]] bool contains(glm::dvec2 p, double margin) const {
    return p.x >= low.x - margin && p.y >= low.y - margin && p.x <= high.x + margin && p.y <= high.y + margin;
  }
};

Box boxOf(std::span<const glm::dvec2> points) {
  Box box;
  for (const glm::dvec2& p : points) box.add(p);
  return box;
}

std::span<const EdgeLine> linesOf(const Version& version) {
  return version.lines() ? std::span<const EdgeLine>(*version.lines()) : std::span<const EdgeLine>();
}

bool isSound(const EdgePoint& p) {
  for (const double value : {p.step, p.step_deviation, p.slope_change, p.slope_deviation, p.deviation})
    if (!std::isfinite(value)) return false;
  return p.deviation >= 0.0 && p.step_deviation >= 0.0 && p.slope_deviation >= 0.0;
}

// What a session can hold: ids that differ, located points whose figures are numbers.
Version withLines(const Version& version, std::vector<EdgeLine> lines) {
  std::unordered_set<std::int64_t> ids;
  for (EdgeLine& line : lines) {
    if (!ids.insert(line.id).second) ids.insert(line.id = nextId(lines));
    for (EdgePoint& p : line.points)
      if (p.located && !isSound(p)) {
        const glm::dvec2 position = p.position;
        p = {};
        p.position = position;
      }
  }
  return version.withLines(lines.empty() ? nullptr
                                         : std::make_shared<const std::vector<EdgeLine>>(std::move(lines)));
}

// A field without noise still has rounding: a hundred-thousandth of its heights.
double leastNoise(const Version& field, double sigma) {
  const engine::HeightBounds bounds = field.reader().bounds();
  const double least = std::max(1e-5 * (static_cast<double>(bounds.max) - static_cast<double>(bounds.min)),
                                std::numeric_limits<double>::min());
  return std::max(std::isfinite(sigma) ? sigma : least, least);
}

// The samples around a stroke, clipped to the field and to kNoiseSide around the middle.
engine::Result<double> noiseAround(const Version& field, const Box& box, engine::JobControl& job) {
  const engine::Grid& grid = field.grid();
  const auto range = [](double low, double high, std::int32_t side) {
    const double most = side - 1.0;
    auto first = static_cast<std::int32_t>(std::clamp(low - kNoiseMargin, 0.0, most));
    auto last = static_cast<std::int32_t>(std::clamp(high + kNoiseMargin, 0.0, most));
    if (const std::int32_t beyond = last - first + 1 - kNoiseSide; beyond > 0) {
      first += beyond / 2;
      last = first + kNoiseSide - 1;
    }
    return std::pair(first, last - first + 1);
  };
  const auto [column, columns] = range(box.low.x, box.high.x, grid.width);
  const auto [row, rows] = range(box.low.y, box.high.y, grid.height);
  const auto noise = engine::estimateNoise(engine::pieceOf(field, column, row, columns, rows), job);
  if (!noise) return tl::unexpected(noise.error());
  return leastNoise(field, noise->sigma);
}
// The parts of the lines near a box, as strokes along their edges.
std::vector<EdgeStroke> strokesNear(std::span<const EdgeLine> lines, const Box& box) {
  std::vector<EdgeStroke> strokes;
  for (const EdgeLine& line : lines) {
    EdgeStroke stroke;
    const auto end = [&] {
      if (stroke.points.size() >= kLeastPoints) strokes.push_back(std::move(stroke));
      stroke = {};
    };
    for (const EdgePoint& p : line.points) {
      if (box.contains(p.position, kNear))
        stroke.points.push_back(p.position);
      else
        end();
    }
    stroke.closed = line.closed && stroke.points.size() == line.points.size();
    end();
  }
  return strokes;
}

// Sets what the marks of the samples around a point are to be.
bool setMarks(engine::LiveField& live, glm::dvec2 centre, double radius, auto&& chosen) {
  const engine::Grid& grid = live.grid();
  const auto first = [](double at, double most) { return std::ceil(std::clamp(at, 0.0, most)); };
  const auto last = [](double at, double most) { return std::floor(std::clamp(at, -1.0, most)); };
  const auto rows = static_cast<std::int32_t>(last(centre.y + radius, grid.height - 1.0));
  const auto columns = static_cast<std::int32_t>(last(centre.x + radius, grid.width - 1.0));
  for (auto row = static_cast<std::int32_t>(first(centre.y - radius, grid.height)); row <= rows; ++row)
    for (auto column = static_cast<std::int32_t>(first(centre.x - radius, grid.width)); column <= columns;
         ++column) {
      if (glm::distance(glm::dvec2(column, row), centre) > radius) continue;
      const std::optional<bool> marked = chosen(column, row);
      if (marked && live.reader().markedAt(column, row) != *marked && !live.setMark(column, row, *marked))
        return false;
    }
  return true;
}

// Calls visit(point) for the points that are not located, but for short runs of them. False when a call is.
bool forEachUnlocated(const EdgeLine& line, auto&& visit) {
  for (auto from = line.points.begin(); from != line.points.end();) {
    from = std::ranges::find(from, line.points.end(), false, &EdgePoint::located);
    const auto to = std::ranges::find(from, line.points.end(), true, &EdgePoint::located);
    if (to - from >= kLongestBridge && !std::all_of(from, to, visit)) return false;
    from = to;
  }
  return true;
}

// Without the marks that the stroke has set where its line was located.
engine::Result<Version> withoutMarks(const Version& base, const LineStroke& stroke, const EdgeLine& line,
                                     const engine::LocateOptions& options) {
  engine::LiveField live(base, engine::Growth::kAllowed);
  const engine::FieldReader before = stroke.before.reader(), after = stroke.after.reader();
  const engine::FieldReader now = base.reader();
  const auto is_new = [&](std::int32_t column, std::int32_t row) {
    return now.markedAt(column, row) && after.markedAt(column, row) && !before.markedAt(column, row);
  };
  const double brush = stroke.mark_radius + 1.0;
  const double around = brush + std::ceil(2.75 * options.hand_deviation);
  const auto set = [&](const EdgePoint& p, double radius, bool marked) {
    return setMarks(live, p.position, radius, [&](std::int32_t column, std::int32_t row) {
      return is_new(column, row) ? std::optional(marked) : std::nullopt;
    });
  };
  const bool done =
      std::ranges::all_of(line.points,
                          [&](const EdgePoint& p) { return !p.located || set(p, around, false); }) &&
      forEachUnlocated(line, [&](const EdgePoint& p) { return set(p, brush, true); });
  if (!done) return engine::failure("there is not enough memory for the marks", "edge line");
  return live.snapshot();
}

bool isLocated(const EdgeLine& line) {
  return std::ranges::any_of(line.points, &EdgePoint::located);
}

// Locates a stroke; the others are there so that their edges are not taken.
engine::Result<EdgeLine> locateAmong(const Version& field, const EdgeStroke& stroke, double noise,
                                     std::vector<EdgeStroke> others, const engine::LocateOptions& options,
                                     engine::JobControl& job) {
  others.insert(others.begin(), stroke);
  auto located = engine::locateEdgeLines(field.reader(), noise, others, options, job);
  if (!located) return tl::unexpected(located.error());
  return std::move(located->front());
}

// With further points where two are too far apart: copies of the one before, at even distances.
EdgeLine filledUp(EdgeLine line) {
  std::vector<EdgePoint> points;
  for (const EdgePoint& next : line.points) {
    if (!points.empty()) {
      const EdgePoint before = points.back();
      const double apart = glm::distance(before.position, next.position);
      const int steps = apart > EdgeLine::kMostApart ? static_cast<int>(std::ceil(apart)) : 1;
      for (int k = 1; k < steps; ++k) {
        points.push_back(before);
        points.back().position =
            before.position + static_cast<double>(k) / steps * (next.position - before.position);
      }
    }
    points.push_back(next);
  }
  line.points = std::move(points);
  return line;
}

// `lines` and the line of a stroke among them, as `finish` makes it of what was located.
engine::Result<Version> withLocated(const Version& base, std::vector<EdgeLine> lines,
                                    const EdgeStroke& stroke, const engine::LocateOptions& options,
                                    const char* edit, engine::JobControl& job, auto&& finish) {
  const Box box = boxOf(stroke.points);
  const auto noise = noiseAround(base, box, job);
  if (!noise) return tl::unexpected(noise.error());
  auto line = locateAmong(base, stroke, *noise, strokesNear(lines, box), options, job);
  if (!line) return tl::unexpected(line.error());
  if (!isLocated(*line))
    return engine::inputError("no edge was found along the line", edit, "draw the edge instead");
  lines.push_back(finish(std::move(*line)));
  engine::extendEnds(lines, lines.size() - 1, base.grid().width, base.grid().height);
  return withLines(base, std::move(lines));
}

}  // namespace

engine::Result<Version> drawLine(const Version& base, const LineStroke& stroke,
                                 const engine::LocateOptions& options, engine::JobControl& job) {
  if (stroke.points.size() < 2) return base;
  EdgeStroke drawn;
  drawn.points.assign(stroke.points.begin(), stroke.points.end());
  drawn.closed = isClosedStroke(drawn.points);
  drawn.id = nextId(linesOf(base));
  const Box box = boxOf(drawn.points);
  const auto noise = noiseAround(base, box, job);
  if (!noise) return tl::unexpected(noise.error());
  auto line = locateAmong(base, drawn, *noise, {}, options, job);
  if (!line) return tl::unexpected(line.error());
  std::vector<EdgeLine> lines = linesNotRedrawn(linesOf(base), *line);
  if (std::vector<EdgeStroke> others = strokesNear(lines, box); !others.empty()) {
    line = locateAmong(base, drawn, *noise, std::move(others), options, job);
    if (!line) return tl::unexpected(line.error());
  }
  if (!isLocated(*line)) return base;
  auto marked = withoutMarks(base, stroke, *line, options);
  if (!marked) return marked;
  line->id = nextId(lines);  // pieces of a line that was drawn again may have taken its own
  lines.push_back(std::move(*line));
  engine::extendEnds(lines, lines.size() - 1, base.grid().width, base.grid().height);
  return withLines(*marked, std::move(lines));
}

engine::Result<Version> drawSuggestion(const Version& base, const engine::EdgeMap& map,
                                       const engine::EdgeChoice& choice, engine::JobControl& job) {
  const auto traces = engine::traceEdges(base.grid(), map, choice, job);
  if (!traces) return tl::unexpected(traces.error());
  const auto noise = engine::estimateNoise(base, job);
  if (!noise) return tl::unexpected(noise.error());
  std::vector<EdgeLine> lines(linesOf(base).begin(), linesOf(base).end());
  std::vector<EdgeStroke> strokes;
  std::int64_t id = nextId(lines);
  for (const engine::EdgeTrace& trace : *traces) strokes.push_back({id++, trace.points, trace.closed});
  const std::size_t traced = strokes.size();
  for (const EdgeLine& line : lines) {
    EdgeStroke& stroke = strokes.emplace_back(EdgeStroke{line.id, {}, line.closed});
    for (const EdgePoint& p : line.points) stroke.points.push_back(p.position);
  }
  const auto located = engine::locateEdgeLines(base.reader(), leastNoise(base, noise->sigma), strokes,
                                               engine::LocateOptions{}, job);
  if (!located) return tl::unexpected(located.error());
  const NearPoints present = pointsOf(lines);
  std::vector<EdgeLine> found;
  for (std::size_t k = 0; k < traced; ++k)
    if (!mostlyAmong((*located)[k], present)) found.push_back((*located)[k]);
  engine::LiveField live(base, engine::Growth::kAllowed);
  for (const EdgeLine& line : linesOfOneEdgeEach(found, lines)) {
    if (job.cancelled()) return engine::cancelled();
    if (isLocated(line)) lines.push_back(line);
    const bool marked = forEachUnlocated(line, [&](const EdgePoint& p) {
      return setMarks(live, p.position, std::max(choice.thickness, 0.5),
                      [&](std::int32_t column, std::int32_t row) -> std::optional<bool> {
                        if (std::isnan(live.reader().heightAt(column, row))) return std::nullopt;
                        return true;
                      });
    });
    if (!marked) return engine::failure("there is not enough memory for the marks", "edge lines");
  }
  engine::extendEnds(lines, linesOf(base).size(), base.grid().width, base.grid().height);
  return lines.size() == linesOf(base).size() ? live.snapshot()
                                              : withLines(live.snapshot(), std::move(lines));
}

Version eraseLines(const Version& base, std::span<const glm::dvec2> path, double radius) {
  NearPoints under(radius);
  for (const glm::dvec2& p : path) under.add(p);
  const auto covered = [&](const EdgePoint& p) { return under.any(p.position); };
  const bool any = std::ranges::any_of(
      linesOf(base), [&](const EdgeLine& line) { return std::ranges::any_of(line.points, covered); });
  return any ? withLines(base, linesWithout(linesOf(base), covered)) : base;
}

Version removeLines(const Version& base, std::optional<std::int64_t> id) {
  std::vector<EdgeLine> lines;
  for (const EdgeLine& line : linesOf(base))
    if (id && line.id != *id) lines.push_back(line);
  return lines.size() == linesOf(base).size() ? base : withLines(base, std::move(lines));
}

engine::Result<Version> dragLine(const Version& base, std::int64_t id, glm::dvec2 from, glm::dvec2 to,
                                 const engine::LocateOptions& options, engine::JobControl& job) {
  const std::span<const EdgeLine> all = linesOf(base);
  const auto dragged = std::ranges::find(all, id, &EdgeLine::id);
  if (dragged == all.end() || dragged->points.empty())
    return engine::inputError("there is no such edge line", "drag", "choose one of the list");
  EdgeLine line = engine::withoutExtensions(*dragged);
  std::vector<EdgePoint>& points = line.points;
  const auto nearest = [&] {
    return std::ranges::min_element(points, {},
                                    [&](const EdgePoint& p) { return glm::distance(p.position, from); });
  };
  // Of a closed line the held point comes to the middle.
  if (line.closed)
    std::rotate(points.begin(),
                points.begin() + (nearest() - points.begin() + std::ssize(points) / 2) % std::ssize(points),
                points.end());
  const auto held = static_cast<double>(nearest() - points.begin());
  const double width = kDragWidth + glm::distance(from, to);  // points are about a sample apart
  const auto count = static_cast<double>(points.size());
  // What moves by less than a quarter of a sample stays as it is.
  const double moved =
      width * std::sqrt(2.0 * std::log(std::max(1.0, 4.0 * glm::distance(from, to)))) + kDragWidth;
  const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(held - moved)));
  const auto end = static_cast<std::size_t>(std::min(count, std::floor(held + moved) + 1.0));
  EdgeStroke stroke{id, {}, line.closed && first == 0 && end == points.size()};
  for (std::size_t i = first; i < end; ++i) {
    const double along = (static_cast<double>(i) - held) / width;
    stroke.points.push_back(points[i].position + std::exp(-0.5 * along * along) * (to - from));
  }
  std::vector<EdgeLine> lines;
  for (const EdgeLine& other : all)
    if (other.id != id) lines.push_back(other);
  return withLocated(base, std::move(lines), stroke, options, "drag", job, [&](EdgeLine piece) {
    piece.points.insert(piece.points.begin(), points.begin(),
                        points.begin() + static_cast<std::ptrdiff_t>(first));
    piece.points.insert(piece.points.end(), points.begin() + static_cast<std::ptrdiff_t>(end), points.end());
    piece.closed = line.closed;
    return filledUp(std::move(piece));
  });
}

engine::Result<Version> joinLine(const Version& base, std::int64_t id, const engine::LocateOptions& options,
                                 engine::JobControl& job) {
  const std::span<const EdgeLine> all = linesOf(base);
  const auto chosen = std::ranges::find(all, id, &EdgeLine::id);
  if (chosen == all.end() || chosen->points.empty())
    return engine::inputError("there is no such edge line", "join", "choose one of the list");
  if (chosen->closed)
    return engine::inputError("a closed line has no ends to be joined", "join", "choose a line with ends");
  const glm::dvec2 front = chosen->points.front().position, back = chosen->points.back().position;
  struct Joint {
    double length = std::numeric_limits<double>::infinity();
    const EdgeLine* other = nullptr;
    bool at_front = false;    // of the chosen line
    bool other_back = false;  // which end of the other
  };
  double length_of_line = 0.0;
  for (std::size_t i = 1; i < chosen->points.size(); ++i)
    length_of_line += glm::distance(chosen->points[i - 1].position, chosen->points[i].position);
  Joint best;
  for (const EdgeLine& other : all) {
    if (other.closed || other.points.empty()) continue;
    for (const bool at_front : {false, true})
      for (const bool other_back : {false, true}) {
        const bool own = &other == &*chosen;
        if (own && (at_front || other_back)) continue;  // its back to its front
        const double length = glm::distance(
            at_front ? front : back, (other_back ? other.points.back() : other.points.front()).position);
        // A line is closed over a gap that is small beside it.
        if (own && length > 0.25 * length_of_line) continue;
        if (length < best.length) best = {length, &other, at_front, other_back};
      }
  }
  if (best.length > kLongestGap)
    return engine::inputError("no end of an edge line is within 60 samples of this one's ends", "join",
                              "draw the edge between them");
  EdgeStroke stroke;
  stroke.id = id;
  const auto append = [&](const EdgeLine& line, bool turned) {
    const auto first = static_cast<std::ptrdiff_t>(stroke.points.size());
    for (const EdgePoint& p : engine::withoutExtensions(line).points) stroke.points.push_back(p.position);
    if (turned) std::reverse(stroke.points.begin() + first, stroke.points.end());
  };
  append(*chosen, best.at_front);
  stroke.closed = best.other == &*chosen;
  if (!stroke.closed) append(*best.other, best.other_back);
  std::vector<EdgeLine> lines;
  for (const EdgeLine& line : all)
    if (&line != &*chosen && &line != best.other) lines.push_back(line);
  return withLocated(base, std::move(lines), stroke, options, "join", job,
                     [](EdgeLine line) { return line; });
}

}  // namespace fettle::app

#include "app/work/line_edits.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "app/work/edge_strokes.h"
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

constexpr double kSameEdge = 1.0;        // [samples] lines located this near to each other are of one edge
constexpr std::size_t kLeastPoints = 5;  // of a line
constexpr double kNear = 24.0;           // [samples] lines within are located together
constexpr std::ptrdiff_t kLongestBridge =
    8;                                     // points: shorter unlocated runs between located ones are no marks
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

Version withLines(const Version& version, std::vector<EdgeLine> lines) {
  return version.withLines(lines.empty() ? nullptr
                                         : std::make_shared<const std::vector<EdgeLine>>(std::move(lines)));
}

std::int64_t nextId(std::span<const EdgeLine> lines) {
  std::int64_t next = 1;
  for (const EdgeLine& line : lines) next = std::max(next, line.id + 1);
  return next;
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
// The lines without the points that `covered` holds for.
template <class Covered>
std::vector<EdgeLine> linesWithout(std::span<const EdgeLine> all, Covered&& covered) {
  std::int64_t id = nextId(all);
  std::vector<EdgeLine> lines;
  for (const EdgeLine& line : all) {
    const auto cut = std::ranges::find_if(line.points, covered);
    if (cut == line.points.end()) {
      lines.push_back(line);
      continue;
    }
    // A closed line is opened where it is cut first.
    std::vector<EdgePoint> points = line.points;
    if (line.closed) std::rotate(points.begin(), points.begin() + (cut - line.points.begin()), points.end());
    bool first = true;
    for (auto from = points.begin(); from != points.end();) {
      from = std::find_if_not(from, points.end(), covered);
      const auto to = std::find_if(from, points.end(), covered);
      if (static_cast<std::size_t>(to - from) >= kLeastPoints) {
        lines.push_back({first ? line.id : id++, false, {from, to}});
        first = false;
      }
      from = to;
    }
  }
  return lines;
}

bool isNear(const EdgePoint& point, std::span<const EdgePoint> points, double distance) {
  return std::ranges::any_of(
      points, [&](const EdgePoint& p) { return glm::distance(p.position, point.position) <= distance; });
}

Box boxOf(const EdgeLine& line) {
  Box box;
  for (const EdgePoint& p : line.points) box.add(p.position);
  return box;
}

// Whether most of what is located of a line lies on other ones.
bool mostlyAmong(const EdgeLine& line, std::span<const EdgePoint> others) {
  const Box box = boxOf(line);
  std::vector<EdgePoint> near;
  std::ranges::copy_if(others, std::back_inserter(near),
                       [&](const EdgePoint& p) { return box.contains(p.position, kSameEdge); });
  std::ptrdiff_t located = 0, among = 0;
  for (const EdgePoint& p : line.points) {
    if (!p.located) continue;
    ++located;
    among += isNear(p, near, kSameEdge) ? 1 : 0;
  }
  return 2 * among > located;
}

// The lines without what a stroke draws again, where that is most of what was located along it; all of them where it is
// an edge of its own.
std::vector<EdgeLine> linesNotRedrawn(std::span<const EdgeLine> all, const EdgeLine& drawn) {
  const Box box = boxOf(drawn);
  std::vector<EdgePoint> present;
  for (const EdgeLine& line : all) present.insert(present.end(), line.points.begin(), line.points.end());
  if (!mostlyAmong(drawn, present)) return {all.begin(), all.end()};
  return linesWithout(all, [&](const EdgePoint& p) {
    return box.contains(p.position, kSameEdge) && isNear(p, drawn.points, kSameEdge);
  });
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
template <class Chosen>
bool setMarks(engine::LiveField& live, glm::dvec2 centre, double radius, Chosen&& chosen) {
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

// Without the marks that the stroke has set where its line was located.
engine::Result<Version> withoutMarks(const Version& base, const LineStroke& stroke, const EdgeLine& line,
                                     const engine::LocateOptions& options) {
  engine::LiveField live(base, engine::Growth::kAllowed);
  const engine::FieldReader before = stroke.before.reader(), now = base.reader();
  const auto is_new = [&](std::int32_t column, std::int32_t row) {
    return now.markedAt(column, row) && !before.markedAt(column, row);
  };
  const double brush = stroke.mark_radius + 1.0;
  const double around = brush + std::ceil(2.75 * options.hand_deviation);
  const auto set = [&](const EdgePoint& p, double radius, bool marked) {
    return setMarks(live, p.position, radius, [&](std::int32_t column, std::int32_t row) {
      return is_new(column, row) ? std::optional(marked) : std::nullopt;
    });
  };
  bool done = std::ranges::all_of(line.points,
                                  [&](const EdgePoint& p) { return !p.located || set(p, around, false); });
  for (auto from = line.points.begin(); done && from != line.points.end();) {
    from = std::ranges::find(from, line.points.end(), false, &EdgePoint::located);
    const auto to = std::ranges::find(from, line.points.end(), true, &EdgePoint::located);
    if (to - from >= kLongestBridge)
      done = std::all_of(from, to, [&](const EdgePoint& p) { return set(p, brush, true); });
    from = to;
  }
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
  lines.push_back(std::move(*line));
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
  std::vector<EdgePoint> present;
  for (const EdgeLine& line : lines) present.insert(present.end(), line.points.begin(), line.points.end());
  engine::LiveField live(base, engine::Growth::kAllowed);
  for (std::size_t k = 0; k < traced; ++k) {
    const EdgeLine& line = (*located)[k];
    if (mostlyAmong(line, present)) continue;
    if (isLocated(line)) {
      lines.push_back(line);
      continue;
    }
    for (const glm::dvec2& p : strokes[k].points)
      if (!setMarks(live, p, std::max(choice.thickness, 0.5),
                    [&](std::int32_t column, std::int32_t row) -> std::optional<bool> {
                      if (std::isnan(live.reader().heightAt(column, row))) return std::nullopt;
                      return true;
                    }))
        return engine::failure("there is not enough memory for the marks", "edge lines");
  }
  return lines.size() == linesOf(base).size() ? live.snapshot()
                                              : withLines(live.snapshot(), std::move(lines));
}

Version eraseLines(const Version& base, std::span<const glm::dvec2> path, double radius) {
  const Box box = boxOf(path);
  const auto covered = [&](const EdgePoint& p) {
    return box.contains(p.position, radius) && std::ranges::any_of(path, [&](const glm::dvec2& at) {
             return glm::distance(at, p.position) <= radius;
           });
  };
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
  Joint best;
  for (const EdgeLine& other : all) {
    if (other.closed || other.points.empty()) continue;
    for (const bool at_front : {false, true})
      for (const bool other_back : {false, true}) {
        const bool own = &other == &*chosen;
        if (own && (at_front || other_back)) continue;  // its back to its front
        const double length = glm::distance(
            at_front ? front : back, (other_back ? other.points.back() : other.points.front()).position);
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
    for (const EdgePoint& p : line.points) stroke.points.push_back(p.position);
    if (turned) std::reverse(stroke.points.begin() + first, stroke.points.end());
  };
  append(*chosen, best.at_front);
  stroke.closed = best.other == &*chosen;
  if (!stroke.closed) append(*best.other, best.other_back);
  std::vector<EdgeLine> lines;
  for (const EdgeLine& line : all)
    if (&line != &*chosen && &line != best.other) lines.push_back(line);
  const Box box = boxOf(stroke.points);
  const auto noise = noiseAround(base, box, job);
  if (!noise) return tl::unexpected(noise.error());
  auto joined = locateAmong(base, stroke, *noise, strokesNear(lines, box), options, job);
  if (!joined) return tl::unexpected(joined.error());
  lines.push_back(std::move(*joined));
  return withLines(base, std::move(lines));
}

}  // namespace fettle::app

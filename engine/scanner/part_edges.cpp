#include <algorithm>
#include <cmath>

#include "engine/scanner/part.h"

namespace fettle::engine {

namespace {

// Distance from the line at which its two sides are sampled [mm]: far above the rounding of a position, and
// so small that even a fillet, vertical where it meets its wall, adds less than 0.01 mm to a step.
constexpr double kAside = 1e-6;

// Properties of a line at one of its points.
struct Crossing {
  bool edge = false;
  EdgeKind kind = EdgeKind::kStep;
  bool high_inside = true;
  double strength = 0.0;

  [[nodiscard]] bool joins(const Crossing& next) const noexcept {
    return edge && next.edge && kind == next.kind && high_inside == next.high_inside;
  }
};

Crossing cross(const Part& part, const Outline::Point& at) {
  const auto height = [&](double outward) { return part.heightAt(at.position + at.outward * outward); };
  const double in1 = height(-kAside);
  const double in2 = height(-2.0 * kAside);
  const double out1 = height(kAside);
  const double out2 = height(2.0 * kAside);
  Crossing crossing;
  if (std::isnan(in1 + in2 + out1 + out2)) return crossing;
  if (std::abs(in1 - out1) >= kLeastEdge) return {true, EdgeKind::kStep, in1 > out1, std::abs(in1 - out1)};
  const double slope_in = (in1 - in2) / kAside;
  const double slope_out = (out2 - out1) / kAside;
  if (std::abs(slope_in - slope_out) >= kLeastEdge)
    return {true, EdgeKind::kCrease, std::abs(slope_in) <= std::abs(slope_out),
            std::abs(slope_in - slope_out)};
  return crossing;
}

// Cuts a line into runs of one kind and one high side. Counter-clockwise, inside is on the left.
void cutIntoEdges(const std::vector<Outline::Point>& line, const std::vector<Crossing>& crossings,
                  bool closed, glm::dvec2 shift, std::vector<Edge>& edges) {
  const std::size_t n = line.size();
  std::size_t start = 0;
  if (closed) {  // start at the start of a run, so that none is cut at the line's arbitrary first point
    while (start < n && crossings[(start + n - 1) % n].joins(crossings[start])) ++start;
    if (start == n) start = 0;
  }
  const bool whole = closed && n > 2 && [&] {
    for (std::size_t i = 0; i < n; ++i)
      if (!crossings[i].joins(crossings[(i + 1) % n])) return false;
    return true;
  }();
  Edge edge;
  const auto flush = [&] {
    if (edge.points_mm.size() >= 2) edges.push_back(edge);
    edge = {};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = (start + i) % n;
    const Crossing& here = crossings[k];
    if (i > 0 && !crossings[(k + n - 1) % n].joins(here)) flush();
    if (!here.edge) continue;
    edge.kind = here.kind;
    edge.high_side_left = here.high_inside;
    edge.closed = whole;
    edge.points_mm.push_back(line[k].position + shift);
    edge.strength.push_back(here.strength);
  }
  flush();
}

void addLine(const Part& part, const std::vector<Outline::Point>& line, bool closed, glm::dvec2 shift,
             glm::dvec2 extent, std::vector<Edge>& edges) {
  std::vector<Crossing> crossings(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    const glm::dvec2 p = line[i].position + shift;
    if (p.x >= 0.0 && p.y >= 0.0 && p.x <= extent.x && p.y <= extent.y) crossings[i] = cross(part, line[i]);
  }
  cutIntoEdges(line, crossings, closed, shift, edges);
}

// The straight line of a roof's ridge, from one end to the other.
std::vector<Outline::Point> ridge(const Outline& outline, double step) {
  const int pieces = std::max(1, static_cast<int>(std::ceil(2.0 * outline.half_length / step)));
  std::vector<Outline::Point> line;
  for (int i = 0; i <= pieces; ++i) {
    const double u = outline.half_length * (2.0 * i / pieces - 1.0);
    line.push_back({outline.centre + outline.turned({u, 0.0}), outline.turned({0.0, -1.0})});
  }
  return line;
}

}  // namespace

std::vector<Edge> edgesOf(const Part& part, double step, glm::dvec2 shift, glm::dvec2 extent) {
  std::vector<Edge> edges;
  for (const Feature& f : part.features) {
    if (f.kind == FeatureKind::kBump) continue;
    addLine(part, f.outline.points(step), true, shift, extent, edges);
    if (f.rim != Rim::kSharp || (f.kind == FeatureKind::kThrough && f.rim_mm > 0.0))
      addLine(part, f.outline.inset(f.rim_mm).points(step), true, shift, extent, edges);
    if (f.kind == FeatureKind::kRoof) addLine(part, ridge(f.outline, step), false, shift, extent, edges);
  }
  return edges;
}

}  // namespace fettle::engine

#include "app/work/line_pieces.h"

#include <cstddef>

namespace fettle::app {

std::int64_t nextId(std::span<const engine::EdgeLine> lines) {
  std::int64_t next = 1;
  for (const engine::EdgeLine& line : lines) next = std::max(next, line.id + 1);
  return next;
}

bool mostlyAmong(const engine::EdgeLine& line, const NearPoints& others) {
  std::ptrdiff_t located = 0, among = 0;
  for (const engine::EdgePoint& p : line.points) {
    if (!p.located) continue;
    ++located;
    among += others.any(p.position) ? 1 : 0;
  }
  return 2 * among > located;
}

NearPoints pointsOf(std::span<const engine::EdgeLine> lines) {
  NearPoints points(kSameEdge);
  for (const engine::EdgeLine& line : lines)
    for (const engine::EdgePoint& p : line.points) points.add(p.position);
  return points;
}

std::vector<engine::EdgeLine> linesNotRedrawn(std::span<const engine::EdgeLine> all,
                                              const engine::EdgeLine& drawn) {
  if (all.empty() || !mostlyAmong(drawn, pointsOf(all))) return {all.begin(), all.end()};
  NearPoints again(kSameEdge);
  for (const engine::EdgePoint& p : drawn.points)
    if (p.located) again.add(p.position);
  return linesWithout(all, [&](const engine::EdgePoint& p) { return again.any(p.position); });
}

}  // namespace fettle::app

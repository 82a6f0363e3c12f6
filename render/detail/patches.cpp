#include "render/detail/patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace fettle::render {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Reserves two seams or walls per patch: fewer exist on average, since only the finer side of two patches has
// the seam, and four finer patches share the edges of a coarser one.
constexpr std::int64_t kVerticesPerPatch = gpu::kPatchVertices + 2 * gpu::kSeamVertices;

engine::HeightBounds heightsWithin(const engine::FieldReader& reader, glm::ivec2 first, glm::ivec2 last) {
  int level = 0;
  std::int32_t side = engine::kBlockSide;
  while (side * 4 < std::max(last.x - first.x, last.y - first.y) && level < reader.topLevel()) {
    side *= 8;
    ++level;
  }
  const glm::ivec2 end(reader.width() - 1, reader.height() - 1);
  engine::HeightBounds all{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  for (std::int32_t y = std::min(first.y, end.y) / side; y <= std::min(last.y, end.y) / side; ++y)
    for (std::int32_t x = std::min(first.x, end.x) / side; x <= std::min(last.x, end.x) / side; ++x) {
      const engine::HeightBounds b = reader.bounds(level, x, y);
      if (b.empty()) continue;
      all.min = std::min(all.min, b.min);
      all.max = std::max(all.max, b.max);
    }
  return all;
}

namespace {

// Of the children of `node`, whose first tile is `at`, in tiles low .. high.
bool holeBelow(const engine::Node& node, glm::ivec2 at, glm::ivec2 first, glm::ivec2 last) {
  const int shift = 3 * (node.level - 2);  // log2 of a child's side in tiles
  for (std::uint64_t left = node.holed_children; left != 0; left &= left - 1) {
    const int k = std::countr_zero(left);
    const glm::ivec2 child = at + (glm::ivec2(k & 7, k >> 3) << shift);
    const glm::ivec2 low = glm::max(first - child * engine::kTileSide, 0);
    const glm::ivec2 high = last - child * engine::kTileSide;
    const int side = engine::kTileSide << shift;
    if (low.x >= side || low.y >= side || high.x < 0 || high.y < 0) continue;
    const void* below = node.children[static_cast<std::size_t>(k)];
    if (shift > 0) {
      if (holeBelow(*static_cast<const engine::Node*>(below), child, first, last)) return true;
      continue;
    }
    const auto& samples = static_cast<const engine::Tile*>(below)->samples;
    for (int r = low.y; r <= std::min(high.y, side - 1); ++r)
      for (int c = low.x; c <= std::min(high.x, side - 1); ++c)
        if (std::isnan(samples[static_cast<std::size_t>(r * side + c)])) return true;
  }
  return false;
}

}  // namespace

bool holeWithin(const engine::FieldReader& reader, glm::ivec2 first, glm::ivec2 last) {
  const glm::ivec2 end(reader.width() - 1, reader.height() - 1);
  return holeBelow(reader.root(), {0, 0}, glm::min(first, end), glm::min(last, end));
}

PatchTree::PatchTree(const PatchQuery& query) : q_(query) {
  if (add(q_.measure->topLevel(), 0, 0) >= 0) refine();
}

PatchTree::PatchTree(const PatchQuery& query, const PatchTree& chosen)
    : q_(query), nodes_(chosen.nodes_), within_budget_(chosen.within_budget_) {}

// `shade_step` does not affect the choice.
bool PatchTree::matches(const PatchQuery& query) const {
  const auto facts = [](const PatchQuery& q) {
    return std::tie(q.placing, q.camera, q.other_eye, q.parts, q.mm_per_unit, q.reference, q.lowest,
                    q.highest, q.floor_z, q.error_px, q.vertex_budget);
  };
  return facts(q_) == facts(query);
}

void PatchTree::refine() {
  const auto less = [this](std::int32_t a, std::int32_t b) {
    // Ties are broken by the index, so that the order, and with it the picture, is deterministic.
    const double ea = node(a).error_px, eb = node(b).error_px;
    return ea != eb ? ea < eb : a > b;
  };
  std::priority_queue<std::int32_t, std::vector<std::int32_t>, decltype(less)> waiting(less);
  waiting.push(0);
  std::int64_t leaves = 1;
  while (!waiting.empty()) {
    const std::int32_t worst = waiting.top();
    if (!(node(worst).error_px > q_.error_px)) break;
    if ((leaves + 3) * kVerticesPerPatch > q_.vertex_budget) {
      within_budget_ = false;
      break;
    }
    waiting.pop();
    const Node parent = node(worst);
    --leaves;
    std::array<std::int32_t, 4> children{};
    for (int i = 0; i < 4; ++i) {
      children[static_cast<std::size_t>(i)] =
          add(parent.level - 1, 2 * parent.x + (i & 1), 2 * parent.y + (i >> 1));
      if (children[static_cast<std::size_t>(i)] < 0) continue;
      waiting.push(children[static_cast<std::size_t>(i)]);
      ++leaves;
    }
    node(worst).children = children;
    node(worst).leaf = false;
  }
}

bool PatchTree::misses(const Box& box) const noexcept {
  if (!q_.parts.empty())
    return std::all_of(q_.parts.begin(), q_.parts.end(), [&](const Camera& c) { return c.misses(box); });
  return q_.camera.misses(box) && (!q_.other_eye || q_.other_eye->misses(box));
}

double PatchTree::movesAtMost(const glm::dvec3& step, const Box& box) const noexcept {
  const double px = q_.camera.movesAtMost(step, box);
  return q_.other_eye ? std::max(px, q_.other_eye->movesAtMost(step, box)) : px;
}

// `raw`: the heights of samples first .. last, which the patch covers.
DetailMeasure::Error PatchTree::errorOf(int level, glm::ivec2 patch, glm::ivec2 first, glm::ivec2 last,
                                        const engine::HeightBounds& raw) const {
  const DetailMeasure::Error error = q_.measure->error(level, patch.x, patch.y);
  if (std::isfinite(error.deviation) || (q_.up_to_date && !q_.up_to_date(first, last)) ||
      holeWithin(q_.reader, first, last))
    return error;
  // Both surfaces lie between the lowest and the highest sample, apart from the roundings counted in
  // detail.h.
  const float range =
      raw.max - raw.min +
      4.0F * std::numeric_limits<float>::epsilon() * std::max(std::fabs(raw.min), std::fabs(raw.max));
  return range < 1e28F ? DetailMeasure::Error{range, range} : error;
}

// Appends a patch; -1 when there is nothing to draw.
std::int32_t PatchTree::add(int level, std::int32_t x, std::int32_t y) {
  const std::int32_t side = DetailMeasure::side(level);
  const glm::ivec2 first = glm::ivec2(x, y) * side;
  if (first.x >= q_.placing.size.x - 1 || first.y >= q_.placing.size.y - 1) return -1;
  const glm::ivec2 last = glm::min(first + side, q_.placing.size - 1);
  const engine::HeightBounds raw = heightsWithin(q_.reader, first, last);
  if (raw.empty()) return -1;
  const double low = std::clamp<double>(raw.min, q_.lowest, q_.highest);
  const double high = std::clamp<double>(raw.max, q_.lowest, q_.highest);
  const glm::dvec2 a = q_.placing.first + q_.placing.spacing * glm::dvec2(first);
  const glm::dvec2 b = q_.placing.first + q_.placing.spacing * glm::dvec2(last);
  const bool rim = x == 0 || y == 0 || last.x == q_.placing.size.x - 1 || last.y == q_.placing.size.y - 1;
  const DetailMeasure::Error error = errorOf(level, {x, y}, first, last, raw);
  // The vertex of a hole may take its height from outside the patch.
  const bool holed = !(error.excess < std::numeric_limits<float>::infinity());
  const double drawn_low = holed ? q_.lowest : low, drawn_high = holed ? q_.highest : high;
  Box box{{a.x, a.y, (drawn_low - q_.reference) * q_.mm_per_unit},
          {b.x, b.y, (drawn_high - q_.reference) * q_.mm_per_unit}};
  Box seen = box;
  if (rim || holed) seen.low.z = std::min(seen.low.z, q_.floor_z);
  if (misses(seen)) return -1;

  Node n;
  n.level = level;
  n.x = x;
  n.y = y;
  n.holed = holed;
  n.depth = q_.camera.depthOf(0.5 * (box.low + box.high));
  if (level > 0) {
    const bool cut = raw.min < q_.lowest || raw.max > q_.highest;
    const double upright = cut ? drawn_high - drawn_low : error.deviation;
    n.error_px = upright < 1e30 ? movesAtMost({0.0, 0.0, upright * q_.mm_per_unit}, box) : kUnbounded;
    if (n.error_px > q_.error_px && !holed) {
      const double stride = std::ldexp(1.0, level);
      const glm::dvec3 along_x{q_.placing.spacing.x, 0.0, 0.0}, along_y{0.0, q_.placing.spacing.y, 0.0};
      const double sideways = movesAtMost(stride * along_x, box) + movesAtMost(stride * along_y, box);
      n.error_px =
          std::min(n.error_px, sideways + movesAtMost({0.0, 0.0, error.excess * q_.mm_per_unit}, box));
    }
  }
  nodes_.push_back(n);
  return static_cast<std::int32_t>(nodes_.size() - 1);
}

// The level of the leaf that contains patch (x, y) of `level`; `level` itself when finer leaves do, or none.
int PatchTree::levelAt(int level, std::int32_t x, std::int32_t y) const {
  if (x < 0 || y < 0) return level;
  std::int32_t at = 0;
  const int top = node(0).level;
  if ((x >> (top - level)) != 0 || (y >> (top - level)) != 0) return level;
  while (!node(at).leaf && node(at).level > level) {
    const int down = node(at).level - 1 - level;
    at = node(at).children[static_cast<std::size_t>(((y >> down) & 1) * 2 + ((x >> down) & 1))];
    if (at < 0) return level;
  }
  return node(at).leaf ? std::max(level, node(at).level) : level;
}

std::vector<std::int32_t> PatchTree::sorted() const {
  std::vector<std::int32_t> leaves;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].leaf) leaves.push_back(static_cast<std::int32_t>(i));
  std::sort(leaves.begin(), leaves.end(), [this](std::int32_t a, std::int32_t b) {
    return node(a).depth != node(b).depth ? node(a).depth < node(b).depth : a < b;
  });
  return leaves;
}

std::vector<PatchLeaf> PatchTree::leaves() const {
  std::vector<PatchLeaf> all;
  for (const std::int32_t i : sorted()) all.push_back({node(i).level, {node(i).x, node(i).y}, node(i).holed});
  return all;
}

std::vector<PatchLeaf> PatchTree::parts(int log2_side) const {
  int level = 0;
  while (DetailMeasure::side(level + 1) <= 1 << log2_side) ++level;
  std::vector<PatchLeaf> all;
  for (const PatchLeaf& leaf : leaves()) {
    // The surface drawn over a part may be as high as any vertex of the whole patch.
    const glm::ivec2 first = leaf.patch * DetailMeasure::side(leaf.level);
    const engine::HeightBounds raw = heightsWithin(
        q_.reader, first, glm::min(first + DetailMeasure::side(leaf.level), q_.placing.size - 1));
    const auto z = [&](double height) {
      return (std::clamp(height, q_.lowest, q_.highest) - q_.reference) * q_.mm_per_unit;
    };
    split(leaf, std::min(q_.floor_z, z(leaf.holed ? q_.lowest : raw.min)),
          z(leaf.holed ? q_.highest : raw.max), level, all);
  }
  return all;
}

void PatchTree::split(const PatchLeaf& leaf, double low_z, double high_z, int lowest_level,
                      std::vector<PatchLeaf>& out) const {
  const glm::ivec2 first = leaf.patch * DetailMeasure::side(leaf.level);
  if (first.x >= q_.placing.size.x - 1 || first.y >= q_.placing.size.y - 1) return;
  const glm::ivec2 last = glm::min(first + DetailMeasure::side(leaf.level), q_.placing.size - 1);
  const glm::dvec2 a = q_.placing.first + q_.placing.spacing * glm::dvec2(first);
  const glm::dvec2 b = q_.placing.first + q_.placing.spacing * glm::dvec2(last);
  if (misses({{a.x, a.y, low_z}, {b.x, b.y, high_z}})) return;
  if (leaf.level <= lowest_level) {
    out.push_back(leaf);
    return;
  }
  for (int i = 0; i < 4; ++i)
    split({leaf.level - 1, 2 * leaf.patch + glm::ivec2(i & 1, i >> 1), leaf.holed}, low_z, high_z,
          lowest_level, out);
}

bool PatchTree::prune(const std::function<bool(const PatchLeaf&)>& drawable) {
  bool replaced = false;
  if (nodes_.empty() || pruneBelow(0, drawable, replaced)) return replaced;
  drop(0);
  node(0).leaf = true;
  return true;
}

// Whether the subtree is drawable now.
bool PatchTree::pruneBelow(std::int32_t at, const std::function<bool(const PatchLeaf&)>& drawable,
                           bool& replaced) {
  const auto self = [&] { return drawable({node(at).level, {node(at).x, node(at).y}, node(at).holed}); };
  if (node(at).leaf) return self();
  bool all = true;
  for (const std::int32_t child : node(at).children)
    if (child >= 0 && !pruneBelow(child, drawable, replaced)) all = false;
  if (all) return true;
  if (!self()) return false;
  drop(at);
  node(at).leaf = true;
  replaced = true;
  return true;
}

void PatchTree::drop(std::int32_t at) {
  for (const std::int32_t child : node(at).children)
    if (child >= 0) drop(child);
  node(at).leaf = false;
}

// Whether a fragment of the patch may read a hole. From the measure, which knows of holes from level 1 up.
bool PatchTree::mayShowHole(const Node& n) const {
  const int top = q_.measure->topLevel();
  if (top == 0) return true;
  int level = std::max(n.level, 1);
  const bool reaches_out = q_.shade_step > 1;
  while (reaches_out && level < top && DetailMeasure::side(level) < q_.shade_step) ++level;
  const glm::ivec2 at = glm::ivec2(n.x, n.y) >> (level - n.level);
  const int reach = reaches_out ? 1 : 0;
  const glm::ivec2 low = glm::max(at - reach, 0), high = glm::min(at + reach, q_.measure->patches(level) - 1);
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x)
      if (!(q_.measure->error(level, x, y).excess < kUnbounded)) return true;
  return false;
}

// The sides of the field whose wall faces the viewer.
std::array<bool, 4> PatchTree::wallsSeen(const Camera& camera) const {
  // The viewer's position, or the direction to it when it is infinitely far. Each side of the field is one
  // plane.
  glm::dvec4 eye = glm::inverse(camera.clipFromScene()) * glm::dvec4(0.0, 0.0, 1.0, 0.0);
  eye = std::abs(eye.w) > 1e-12 * glm::length(glm::dvec3(eye)) ? eye / eye.w
                                                               : glm::dvec4(camera.toViewer(), 0.0);
  const glm::dvec2 low = q_.placing.first, high = low + q_.placing.extent();
  // The inner side of a wall may be visible through a hole.
  const bool holed = q_.reader.root().holed_children != 0;
  return {holed || eye.y < eye.w * low.y, holed || eye.x > eye.w * high.x, holed || eye.y > eye.w * high.y,
          holed || eye.x < eye.w * low.x};
}

PatchChoice PatchTree::list() const {
  PatchChoice choice;
  choice.within_budget = within_budget_;
  if (nodes_.empty()) return choice;
  const glm::ivec2 end = q_.placing.size - 1;
  std::array<bool, 4> walls_seen = wallsSeen(q_.camera);
  if (q_.other_eye) {
    const std::array<bool, 4> other = wallsSeen(*q_.other_eye);
    for (std::size_t k = 0; k < 4; ++k) walls_seen[k] = walls_seen[k] || other[k];
  }
  std::vector<std::int32_t> leaves = sorted();
  const auto holed = std::stable_partition(leaves.begin(), leaves.end(),
                                           [this](std::int32_t leaf) { return !mayShowHole(node(leaf)); });
  choice.whole = static_cast<std::size_t>(holed - leaves.begin());
  for (const std::int32_t leaf : leaves) {
    const Node& n = node(leaf);
    choice.bound_px = std::max(choice.bound_px, n.error_px);
    const std::int32_t side = DetailMeasure::side(n.level);
    const glm::ivec2 first = glm::ivec2(n.x, n.y) * side, last = glm::min(first + side, end);
    choice.patches.push_back({{first.x, first.y, n.level, n.level}});
    const std::array<glm::ivec2, 4> begins{first, {last.x, first.y}, {first.x, last.y}, first};
    const std::array<bool, 4> rim{first.y == 0, last.x == end.x, last.y == end.y, first.x == 0};
    const std::array<glm::ivec2, 4> steps{{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
    for (int s = 0; s < 4; ++s) {
      const auto k = static_cast<std::size_t>(s);
      if (rim[k]) {
        if (!walls_seen[k]) continue;
        choice.walls.push_back({{begins[k].x, begins[k].y, n.level, n.level | s << 8}});
        continue;
      }
      const int other = levelAt(n.level, n.x + steps[k].x, n.y + steps[k].y);
      if (other > n.level) choice.seams.push_back({{begins[k].x, begins[k].y, n.level | other << 8, s}});
    }
  }
  return choice;
}

std::int64_t PatchChoice::vertices() const noexcept {
  return static_cast<std::int64_t>(patches.size()) * gpu::kPatchVertices +
         static_cast<std::int64_t>(seams.size()) * gpu::kSeamVertices +
         static_cast<std::int64_t>(walls.size()) * gpu::kWallVertices;
}

std::int64_t PatchChoice::triangles() const noexcept {
  return static_cast<std::int64_t>(patches.size()) * 2 * gpu::kPatchCells * gpu::kPatchCells +
         static_cast<std::int64_t>(2 * seams.size() + walls.size()) * 2 * gpu::kPatchCells;
}

PatchChoice choosePatches(const PatchQuery& query) {
  return PatchTree(query).list();
}

}  // namespace fettle::render

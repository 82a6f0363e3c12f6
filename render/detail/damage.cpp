#include "render/detail/damage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/vec4.hpp>

#include "render/config.h"
#include "render/detail/tile_span.h"

namespace fettle::render {
namespace {

// A rectangle of samples, last ones included.
struct Samples {
  glm::ivec2 first{0}, last{-1};
  [[nodiscard]] bool empty() const noexcept { return last.x < first.x || last.y < first.y; }
  [[nodiscard]] Samples grown(int by) const noexcept { return {first - by, last + by}; }
  [[nodiscard]] Samples cut(const Samples& to) const noexcept {
    return {glm::max(first, to.first), glm::min(last, to.last)};
  }
};

void join(Rectangle& a, const Rectangle& b) {
  if (empty(b)) return;
  if (empty(a)) {
    a = b;
    return;
  }
  const int right = std::max(a.x + a.width, b.x + b.width), low = std::max(a.y + a.height, b.y + b.height);
  a.x = std::min(a.x, b.x);
  a.y = std::min(a.y, b.y);
  a.width = right - a.x;
  a.height = low - a.y;
}

// Screen rectangles of the surface over some samples.
class Screen {
 public:
  Screen(const PatchQuery& q, const engine::FieldReader* before, const Rectangle& visible)
      : q_(q), before_(before), visible_(visible), all_{glm::ivec2(0), q.placing.size - 1} {
    holed_ = holed(q.reader) || (before != nullptr && holed(*before));
  }
  [[nodiscard]] const Samples& all() const noexcept { return all_; }
  [[nodiscard]] bool holed() const noexcept { return holed_; }
  // Whether a sample is a hole in either state.
  [[nodiscard]] bool holeAt(const glm::ivec2& sample) const {
    const glm::ivec2 s = glm::min(sample, q_.placing.true_size - 1);
    return std::isnan(q_.reader.heightAt(s.x, s.y)) ||
           (before_ != nullptr && std::isnan(before_->heightAt(s.x, s.y)));
  }
  // Samples of a patch, its upper and right rim included.
  [[nodiscard]] Samples square(const gpu::Patch& patch) const {
    const glm::ivec2 first(patch.place.x, patch.place.y);
    return Samples{first, first + DetailMeasure::side(patch.place.z)}.cut(all_);
  }

  // Pixels of what is drawn over `s`, and of the wall below where it is at the rim. Heights may be taken from
  // `reach` samples around.
  [[nodiscard]] Rectangle pixels(const Samples& s, int reach) const {
    if (s.empty()) return {};
    const Samples from = s.grown(reach).cut(all_);
    double low = q_.highest, high = q_.lowest;
    bool any = false;
    for (const engine::FieldReader* reader : {&q_.reader, before_}) {
      if (reader == nullptr) continue;
      const engine::HeightBounds b = heightsWithin(*reader, from.first, from.last);
      if (b.empty()) continue;
      any = true;
      low = std::min(low, std::clamp<double>(b.min, q_.lowest, q_.highest));
      high = std::max(high, std::clamp<double>(b.max, q_.lowest, q_.highest));
    }
    if (!any) return {};
    Box box{{0.0, 0.0, (low - q_.reference) * q_.mm_per_unit},
            {0.0, 0.0, (high - q_.reference) * q_.mm_per_unit}};
    const bool rim = s.first.x == 0 || s.first.y == 0 || s.last.x == all_.last.x || s.last.y == all_.last.y;
    // A vertex with no height around it is drawn on the plate.
    if (rim || holed_) box.low.z = std::min(box.low.z, q_.floor_z);
    const glm::dvec2 a = q_.placing.first + q_.placing.spacing * glm::dvec2(s.first);
    const glm::dvec2 b = q_.placing.first + q_.placing.spacing * glm::dvec2(s.last);
    box.low.x = a.x, box.low.y = a.y, box.high.x = b.x, box.high.y = b.y;
    glm::dvec2 least(1e9), most(-1e9);
    for (const glm::dvec3& corner : corners(box)) {
      const glm::dvec4 clip = q_.camera.clipFromScene() * glm::dvec4(corner, 1.0);
      if (!(clip.w > 0.0) || clip.z < 0.0) return visible_;
      const glm::dvec2 at = q_.camera.pixelOf(corner);
      least = glm::min(least, at);
      most = glm::max(most, at);
    }
    const glm::dvec2 edge(visible_.x, visible_.y), end = edge + glm::dvec2(visible_.width, visible_.height);
    least = glm::clamp(glm::floor(least - kDamageMarginPx), edge, end);
    most = glm::clamp(glm::ceil(most + kDamageMarginPx), edge, end);
    const glm::ivec2 first(least), size = glm::ivec2(most) - first;
    return {first.x, first.y, size.x, size.y};
  }

 private:
  static bool holed(const engine::FieldReader& reader) { return reader.root().holed_children != 0; }

  const PatchQuery& q_;
  const engine::FieldReader* before_;
  Rectangle visible_;
  Samples all_;
  bool holed_ = false;
};

// Samples of a tile in which heights or marks differ; empty where none does.
Samples changedIn(const engine::TileChange& change) {
  TileSpan span = changedHeights(*change.before, *change.after);
  span.join(changedMarks(*change.before, *change.after));
  if (span.empty()) return {};
  const glm::ivec2 tile = glm::ivec2(change.tile_column, change.tile_row) * engine::kTileSide;
  return {tile + glm::ivec2(span.first_column, span.first_row),
          tile + glm::ivec2(span.last_column, span.last_row)};
}

// Of the samples at whose vertices heights are read from `read`: every `stride`-th, and the last ones of the field.
Samples verticesIn(const Samples& read, int stride, const Samples& all) {
  const auto up = [stride](int s) { return (s + stride - 1) / stride * stride; };
  const Samples in = read.cut(all);
  if (in.empty()) return in;
  Samples v{{up(in.first.x), up(in.first.y)}, in.last / stride * stride};
  for (int axis = 0; axis < 2; ++axis)
    if (in.last[axis] == all.last[axis]) {
      v.last[axis] = all.last[axis];
      v.first[axis] = std::min(v.first[axis], all.last[axis]);
    }
  return v;
}

// The same where there are holes: a vertex over one searches a stride around it, on the field's last column and row an eighth of
// one farther.
Samples verticesSearching(const Samples& changed, int stride, const Screen& screen) {
  constexpr int kFine = 8;  // below it, looking for holes costs more than it saves
  const Samples near = verticesIn(changed.grown(stride + stride / 8), stride, screen.all());
  if (stride < kFine || near.empty()) return near;
  Samples all = verticesIn(changed, stride, screen.all());
  const auto next = [stride](int s, int last) { return s == last ? last + 1 : std::min(s + stride, last); };
  for (int y = near.first.y; y <= near.last.y; y = next(y, near.last.y))
    for (int x = near.first.x; x <= near.last.x; x = next(x, near.last.x))
      if (const glm::ivec2 s{x, y}; screen.holeAt(s)) {
        if (all.empty()) all = {s, s};
        all = {glm::min(all.first, s), glm::max(all.last, s)};
      }
  return all;
}

// Position, level, and whether it may hold holes: a patch drawn by another pipeline may differ in the last
// bit.
using Key = std::array<int, 4>;

std::vector<Key> keysOf(const PatchChoice& choice) {
  std::vector<Key> keys;
  for (std::size_t i = 0; i < choice.patches.size(); ++i) {
    const gpu::Patch& p = choice.patches[i];
    keys.push_back({p.place.x, p.place.y, p.place.z, i < choice.whole ? 0 : 1});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

Rectangle damageOf(const DamageQuery& query) {
  if (query.tiles.size() >= kManyTiles) return query.visible;
  const PatchQuery& q = query.now;
  const Screen screen(q, &query.before, query.visible);
  Rectangle damage{};
  const auto reachOf = [&](int level) { return screen.holed() ? 1 << level : 0; };

  const std::vector<Key> before = keysOf(*query.chosen_before), after = keysOf(*query.chosen_after);
  std::vector<Key> differ;
  std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                std::back_inserter(differ));
  for (const auto& [x, y, level, holed] : differ)
    join(damage, screen.pixels(screen.square({{x, y, level, level}}), reachOf(level)));

  for (const engine::TileChange& tile : query.tiles) {
    Samples changed = changedIn(tile);
    if (changed.empty()) continue;
    // A field of one column or row is drawn two wide: its samples are read twice.
    for (int axis = 0; axis < 2; ++axis)
      if (changed.last[axis] == q.placing.true_size[axis] - 1) changed.last[axis] = screen.all().last[axis];
    for (const gpu::Patch& patch : query.chosen_after->patches) {
      const int level = patch.place.z, stride = 1 << level, heights = std::max(reachOf(level), stride);
      const Samples square = screen.square(patch);
      // A colour reads its cell and some samples beyond on each side, among those that colours come from.
      const Samples coloured = changed.grown(q.shade_reach * q.shade_step).cut(square);
      join(damage, screen.pixels(coloured, heights));
      // A vertex has cells of a stride around it. Where a patch is coarse - a plain one, or any seen from above - most
      // strokes pass between its vertices.
      const Samples vertices = screen.holed() ? verticesSearching(changed, stride, screen)
                                              : verticesIn(changed, stride, screen.all());
      if (!vertices.empty()) join(damage, screen.pixels(vertices.grown(stride).cut(square), heights));
    }
  }
  if (empty(damage)) return {};
  // Whole squares of two by two: fragments compare themselves within those, and outside of them the depth of
  // walls and plate is already in the image.
  const int right = damage.x + damage.width, low = damage.y + damage.height;
  damage.x &= ~1;
  damage.y &= ~1;
  damage.width = ((right + 1) & ~1) - damage.x;
  damage.height = ((low + 1) & ~1) - damage.y;
  return cut(damage, query.visible);
}

PatchChoice within(const PatchChoice& choice, const PatchQuery& query, const Rectangle& pixels) {
  const Screen screen(query, nullptr, pixels);
  const auto seen = [&](const Samples& s, int reach) { return !empty(screen.pixels(s, reach)); };
  // An edge of a patch, from the sample where it begins.
  const auto edge = [&](const gpu::Patch& p, int level, int side) {
    const glm::ivec2 first(p.place.x, p.place.y);
    const glm::ivec2 along = (side & 1) == 0 ? glm::ivec2(1, 0) : glm::ivec2(0, 1);
    return Samples{first, first + along * DetailMeasure::side(level)}.cut(screen.all());
  };
  PatchChoice part;
  part.bound_px = choice.bound_px;
  part.within_budget = choice.within_budget;
  if (empty(pixels)) return part;
  for (std::size_t i = 0; i < choice.patches.size(); ++i) {
    const gpu::Patch& p = choice.patches[i];
    if (!seen(screen.square(p), screen.holed() ? 1 << p.place.z : 0)) continue;
    part.patches.push_back(p);
    part.whole += i < choice.whole ? 1 : 0;
  }
  for (const gpu::Patch& p : choice.seams) {
    const int level = p.place.z & 255, other = p.place.z >> 8;
    if (seen(edge(p, level, p.place.w), (screen.holed() ? 2 : 1) << other)) part.seams.push_back(p);
  }
  for (const gpu::Patch& p : choice.walls) {
    const int level = p.place.z;
    if (seen(edge(p, level, p.place.w >> 8), screen.holed() ? 1 << level : 0)) part.walls.push_back(p);
  }
  return part;
}

}  // namespace fettle::render

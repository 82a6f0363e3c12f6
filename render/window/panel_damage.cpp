#include "render/window/panel_damage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace fettle::render {
namespace {

// A triangle of a list, with what it is cut to.
struct Triangle {
  std::array<const ImDrawVert*, 3> corners{};
  const ImDrawCmd* command = nullptr;
};

bool sameLook(const ImDrawCmd& a, const ImDrawCmd& b) {
  const ImVec4 &p = a.ClipRect, &q = b.ClipRect;
  return p.x == q.x && p.y == q.y && p.z == q.z && p.w == q.w && a.TextureId == b.TextureId;
}

bool sameLook(const ImDrawVert& a, const ImDrawVert& b) {
  return a.pos.x == b.pos.x && a.pos.y == b.pos.y && a.uv.x == b.uv.x && a.uv.y == b.uv.y && a.col == b.col;
}

bool operator==(const Triangle& a, const Triangle& b) {
  if (!sameLook(*a.command, *b.command)) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (!sameLook(*a.corners[k], *b.corners[k])) return false;
  return true;
}

Rectangle placeOf(const Triangle& t) {
  const ImVec4& clip = t.command->ClipRect;
  ImVec2 low = t.corners[0]->pos, high = low;
  for (const ImDrawVert* corner : t.corners) {
    low = {std::min(low.x, corner->pos.x), std::min(low.y, corner->pos.y)};
    high = {std::max(high.x, corner->pos.x), std::max(high.y, corner->pos.y)};
  }
  // A pixel more on each side: whatever the rounding.
  const int x0 = static_cast<int>(std::floor(std::max(low.x, clip.x))) - 1;
  const int y0 = static_cast<int>(std::floor(std::max(low.y, clip.y))) - 1;
  const int x1 = static_cast<int>(std::ceil(std::min(high.x, clip.z))) + 1;
  const int y1 = static_cast<int>(std::ceil(std::min(high.y, clip.w))) + 1;
  return {x0, y0, std::max(x1 - x0, 0), std::max(y1 - y0, 0)};
}

// All triangles of a panel.
std::vector<Triangle> trianglesOf(const ImDrawCmd* commands, int count, const ImDrawVert* corners,
                                  const ImDrawIdx* order) {
  std::vector<Triangle> all;
  for (const ImDrawCmd* c = commands; c != commands + count; ++c)
    for (unsigned int i = 0; i + 3 <= c->ElemCount; i += 3) {
      const ImDrawIdx* const at = order + c->IdxOffset + i;
      const ImDrawVert* const first = corners + c->VtxOffset;
      all.push_back({{first + at[0], first + at[1], first + at[2]}, c});
    }
  return all;
}

bool sameBytes(const void* a, const void* b, std::size_t bytes) {
  return bytes == 0 || std::memcmp(a, b, bytes) == 0;
}

}  // namespace

bool PanelDamage::Panel::same(const ImDrawList& now) const noexcept {
  const auto count = [](const auto& v) { return static_cast<std::size_t>(v.Size); };
  if (commands.size() != count(now.CmdBuffer) || corners.size() != count(now.VtxBuffer) ||
      order.size() != count(now.IdxBuffer))
    return false;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const ImDrawCmd &a = commands[i], &b = now.CmdBuffer[static_cast<int>(i)];
    if (!sameLook(a, b) || a.ElemCount != b.ElemCount || a.IdxOffset != b.IdxOffset ||
        a.VtxOffset != b.VtxOffset)
      return false;
  }
  return sameBytes(corners.data(), now.VtxBuffer.Data, corners.size() * sizeof(ImDrawVert)) &&
         sameBytes(order.data(), now.IdxBuffer.Data, order.size() * sizeof(ImDrawIdx));
}

void PanelDamage::Panel::keep(const ImDrawList& now) {
  commands.assign(now.CmdBuffer.begin(), now.CmdBuffer.end());
  corners.assign(now.VtxBuffer.begin(), now.VtxBuffer.end());
  order.assign(now.IdxBuffer.begin(), now.IdxBuffer.end());
}

void PanelDamage::compare(const Panel& before, const ImDrawList& now, Places& places) {
  const std::vector<Triangle> old =
      trianglesOf(before.commands.data(), static_cast<int>(before.commands.size()), before.corners.data(),
                  before.order.data());
  const std::vector<Triangle> fresh =
      trianglesOf(now.CmdBuffer.Data, now.CmdBuffer.Size, now.VtxBuffer.Data, now.IdxBuffer.Data);
  std::size_t first = 0, old_end = old.size(), fresh_end = fresh.size();
  if (old.size() == fresh.size()) {
    for (; first < old_end; ++first)
      if (!(old[first] == fresh[first])) {
        places.add(placeOf(old[first]));
        places.add(placeOf(fresh[first]));
      }
    return;
  }
  while (first < old_end && first < fresh_end && old[first] == fresh[first]) ++first;
  while (old_end > first && fresh_end > first && old[old_end - 1] == fresh[fresh_end - 1]) {
    --old_end;
    --fresh_end;
  }
  for (std::size_t i = first; i < old_end; ++i) places.add(placeOf(old[i]));
  for (std::size_t i = first; i < fresh_end; ++i) places.add(placeOf(fresh[i]));
}

bool PanelDamage::next(const ImDrawData& panels, Places& places) {
  const bool known = std::exchange(known_, true);
  const auto count = static_cast<std::size_t>(panels.CmdListsCount);
  const std::size_t before = known ? panels_.size() : 0;
  panels_.resize(std::max(count, panels_.size()));
  static const ImDrawList kNothing(nullptr);
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    const ImDrawList& now = i < count ? *panels.CmdLists[i] : kNothing;
    if (i < before && panels_[i].same(now)) continue;
    if (known) compare(i < before ? panels_[i] : Panel{}, now, places);
    panels_[i].keep(now);
  }
  panels_.resize(count);
  return known;
}

ImVector<ImDrawCmd> cutTo(const ImVector<ImDrawCmd>& commands, const std::vector<Rectangle>& places) {
  ImVector<ImDrawCmd> cut;
  for (const ImDrawCmd& command : commands)
    for (const Rectangle& place : places) {
      ImDrawCmd part = command;
      part.ClipRect.x = std::max(command.ClipRect.x, static_cast<float>(place.x));
      part.ClipRect.y = std::max(command.ClipRect.y, static_cast<float>(place.y));
      part.ClipRect.z = std::min(command.ClipRect.z, static_cast<float>(place.x + place.width));
      part.ClipRect.w = std::min(command.ClipRect.w, static_cast<float>(place.y + place.height));
      if (part.ClipRect.x < part.ClipRect.z && part.ClipRect.y < part.ClipRect.w) cut.push_back(part);
    }
  return cut;
}

}  // namespace fettle::render

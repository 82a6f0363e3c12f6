#include "render/live/live_redraw.h"

#include <algorithm>
#include <cstring>

#include "engine/base/same_bits.h"
#include "engine/field/difference.h"
#include "render/detail/damage.h"
#include "render/live/live_fields.h"

namespace fettle::render {

namespace {

// Whether two panels are equal except for samples and patches, so that damageOf finds where they differ.
bool onlyFieldDiffers(const DrawnFrame::Panel& a, const DrawnFrame::Panel& b) {
  return related(a.field, b.field) && a.variant == b.variant && a.shade_level == b.shade_level &&
         a.pages == b.pages && engine::sameBits(a.uniforms, b.uniforms);
}

bool sameList(const std::vector<gpu::Patch>& a, const std::vector<gpu::Patch>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(gpu::Patch)) == 0);
}

// Whether everything but the panels' surfaces is the same.
bool sameAround(const DrawnFrame& before, const DrawnFrame& now) {
  if (before.panels.size() != now.panels.size() || before.ground != now.ground ||
      !(before.original == now.original) || !(before.accepted == now.accepted) ||
      before.decorations.size() != now.decorations.size())
    return false;
  // Plain numbers without padding: equal bits draw equal pictures.
  if (!now.decorations.empty() && std::memcmp(before.decorations.data(), now.decorations.data(),
                                              now.decorations.size() * sizeof(gpu::Quad)) != 0)
    return false;
  for (std::size_t i = 0; i < now.panels.size(); ++i)
    if (!(before.panels[i].plot == now.panels[i].plot) ||
        !(before.panels[i].visible == now.panels[i].visible))
      return false;
  return true;
}

}  // namespace

bool showTheSame(const DrawnFrame& before, const DrawnFrame& now) {
  return sameButDetail(before, now) &&
         std::equal(before.panels.begin(), before.panels.end(), now.panels.begin(), sameDetail);
}

bool sameButDetail(const DrawnFrame& before, const DrawnFrame& now) {
  if (!sameAround(before, now)) return false;
  for (std::size_t i = 0; i < now.panels.size(); ++i) {
    const DrawnFrame::Panel &a = before.panels[i], &b = now.panels[i];
    if (!(a.field == b.field) || a.variant != b.variant || a.shade_level != b.shade_level ||
        !engine::sameBits(a.uniforms, b.uniforms))
      return false;
  }
  return true;
}

bool sameButPixels(const DrawnFrame& fewer, const DrawnFrame& now) {
  if (!sameAround(fewer, now)) return false;
  for (std::size_t i = 0; i < now.panels.size(); ++i) {
    const DrawnFrame::Panel &a = fewer.panels[i], &b = now.panels[i];
    gpu::PanelUniforms uniforms = a.uniforms;
    // By the size of the pixels that are drawn.
    uniforms.seam.x = b.uniforms.seam.x;
    uniforms.footprint = b.uniforms.footprint;
    uniforms.pages = b.uniforms.pages;
    if (!related(a.field, b.field) || a.variant != b.variant || a.shade_level != b.shade_level ||
        !engine::sameBits(uniforms, b.uniforms))
      return false;
  }
  return true;
}

bool sameDetail(const DrawnFrame::Panel& a, const DrawnFrame::Panel& b) {
  return a.pages == b.pages && sameList(a.choice.patches, b.choice.patches) &&
         sameList(a.choice.seams, b.choice.seams) && sameList(a.choice.walls, b.choice.walls);
}

bool canContinue(const DrawnFrame& before, const DrawnFrame& now) {
  if (!sameAround(before, now)) return false;
  bool some = now.panels.empty();
  for (std::size_t i = 0; i < now.panels.size(); ++i)
    some = some || onlyFieldDiffers(before.panels[i], now.panels[i]);
  return some;
}

std::vector<PatchChoice> cutToDamage(const DrawnFrame& before, const DrawnFrame& now,
                                     std::span<const PatchQuery> queries, Pages pages,
                                     std::vector<LivePanel>& panels) {
  std::vector<PatchChoice> parts(panels.size());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (!onlyFieldDiffers(before.panels[i], now.panels[i])) {
      panels[i].redraw = panels[i].visible;
      continue;
    }
    const std::vector<engine::TileChange> tiles =
        engine::changedTiles(before.panels[i].field, now.panels[i].field);
    DamageQuery q;
    q.now = queries[i];
    // Colours come from any coarser level until those are there.
    if (pages == Pages::kWaitedFor)
      q.now.shade_step = std::max(q.now.shade_step, 1 << LiveTexture::shift(LiveTexture::kLevels - 1));
    q.before = before.panels[i].field.reader();
    q.tiles = tiles;
    q.chosen_before = &before.panels[i].choice;
    q.chosen_after = panels[i].choice;
    q.visible = panels[i].visible;
    panels[i].redraw = damageOf(q);
    parts[i] = within(*panels[i].choice, queries[i], panels[i].redraw);
    panels[i].choice = &parts[i];
  }
  return parts;
}

namespace {

std::vector<PatchChoice> cutToRows(int first, int last, std::span<const PatchQuery> queries,
                                   std::vector<LivePanel>& panels) {
  std::vector<PatchChoice> parts(panels.size());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    LivePanel& panel = panels[i];
    panel.redraw = cut(panel.visible, {panel.visible.x, first, panel.visible.width, last - first});
    if (!empty(panel.redraw)) parts[i] = within(*panel.choice, queries[i], panel.redraw);
  }
  return parts;
}

}  // namespace

CutBands cutToBands(const Bands& bands, std::span<const PatchQuery> queries, std::vector<LivePanel>& panels) {
  CutBands next;
  const auto take = [&](int count) {
    next.bands = count;
    next.parts = cutToRows(bands.row(bands.next), bands.row(bands.next + count), queries, panels);
  };
  take(1);
  std::int64_t all = 0, taken = 0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    all += panels[i].choice->vertices();
    taken += next.parts[i].vertices();
  }
  const int most = std::min({bands.left, bands.all - bands.next, bands.all / kRoundsOfSteep});
  if (most > 1 && taken > kFrameVertices && 2 * taken > all) take(most);
  for (std::size_t i = 0; i < panels.size(); ++i)
    if (!empty(panels[i].redraw)) panels[i].choice = &next.parts[i];
  return next;
}

}  // namespace fettle::render

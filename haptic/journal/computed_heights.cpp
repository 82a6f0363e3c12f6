#include "haptic/journal/computed_heights.h"

#include <utility>

#include "engine/field/sample_rect.h"
#include "engine/measure/levelled_lines.h"

namespace fettle::haptic {

namespace {

engine::Result<ComputedHeights> made(const engine::Version& before, const engine::FillOptions& options,
                                     engine::JobControl& job) {
  auto filled = engine::fillHoles(before, options, job);
  if (!filled) return tl::unexpected(filled.error());
  ComputedHeights result;
  result.field = std::exchange(filled->field, {});
  result.filled = *std::move(filled);
  return result;
}

engine::Result<ComputedHeights> made(const engine::Version& before, const engine::LineOptions& options,
                                     engine::JobControl& job) {
  const auto offsets = engine::findLineOffsets(before, options, job);
  if (!offsets) return tl::unexpected(offsets.error());
  const auto apart = engine::linesApart(before, *offsets, job);
  if (!apart) return tl::unexpected(apart.error());
  auto levelled = engine::levelledLines(before, *offsets, engine::allTiles(before.grid()), job);
  if (!levelled) return tl::unexpected(levelled.error());
  ComputedHeights result;
  result.field = *std::move(levelled);
  result.rows_rms = offsets->rms;
  result.rows_form_rms = offsets->form_rms;
  result.rows_apart = *apart;
  return result;
}

engine::Result<ComputedHeights> made(const engine::Version& before, const engine::RemoveOptions& options,
                                     engine::JobControl& job) {
  auto removed = engine::removeSamples(before, options, job);
  if (!removed) return tl::unexpected(removed.error());
  ComputedHeights result;
  result.field = std::move(removed->field);
  result.removed = removed->counts;
  return result;
}

}  // namespace

engine::Result<ComputedHeights> computeHeights(const engine::Version& before, const HeightsMaker& maker,
                                               engine::JobControl& job) {
  return std::visit([&](const auto& options) { return made(before, options, job); }, maker);
}

}  // namespace fettle::haptic

#include "app/window/colour_range.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fettle::app {
namespace {

using render::Quantity;
using RuleKind = RangeRule::Kind;

bool isTurned(const std::vector<engine::Version>& versions) {
  return !versions.empty() && versions.front().reader().sign() < 0.0F;
}

bool isInverted(const render::Shown& shown) {
  return isTurned(shown.versions);
}

render::ValueRange turnedOver(const render::ValueRange& range) {
  return {-range.high, -range.low};
}

render::ValueRange rangeOfShare(const render::ValueSample& values, Quantity quantity, double share) {
  if (ColourRange::isChange(quantity)) return values.symmetric(share);
  const render::ValueRange middle = values.middle(share);
  if (middle.low < middle.high || !(values.extreme.low < values.extreme.high)) return middle;
  // So many samples have one height that it is all of the share: a little on both sides of it.
  const double half = 1e-3 * (values.extreme.high - values.extreme.low);
  return {middle.low - half, middle.high + half};
}

// Of all panels, which share one range.
engine::Result<render::ValueSample> sampleOf(const std::vector<engine::Version>& versions,
                                             const std::optional<engine::Version>& original,
                                             const engine::JobControl& job) {
  render::ValueSample all;
  for (const engine::Version& version : versions) {
    if (job.cancelled()) return engine::cancelled();
    render::ValueSample one =
        original ? render::deviationSample(version, *original, &job) : render::heightSample(version);
    if (job.cancelled()) return engine::cancelled();
    if (one.empty()) continue;
    if (all.empty()) {
      all = std::move(one);
      continue;
    }
    const auto first = static_cast<std::ptrdiff_t>(all.sorted.size());
    all.sorted.insert(all.sorted.end(), one.sorted.begin(), one.sorted.end());
    std::inplace_merge(all.sorted.begin(), all.sorted.begin() + first, all.sorted.end());
    all.extreme = {std::min(all.extreme.low, one.extreme.low), std::max(all.extreme.high, one.extreme.high)};
  }
  return all;
}

}  // namespace

void ColourRange::clear(Display& display) {
  measuring_.cancel();
  measured_ = {};
  sample_.reset();
  heights_.reset();
  limit_.reset();
  drag.reset();
  typed = {};
  for (RangeRule* rule : {&display.heights, &display.changes})
    if (rule->kind == RuleKind::kTyped) rule->kind = RuleKind::kAutomatic;
}

bool ColourRange::poll(const render::Shown& shown, bool needed, bool working) {
  if (working) return false;
  const bool dropped = measuring_.cancelling();
  bool changed = false;
  if (auto done = measuring_.take(); done && !dropped && isOfForm(shown)) {
    // Without memory for one: an empty sample, and the picture finds the range.
    sample_ = *done ? *std::move(*done) : render::ValueSample{};
    sampled_ = measured_.original.has_value();
    turned_ = isTurned(measured_.versions);
    changed = true;
  }
  if (!needed && !measuring_.busy()) {
    // Else it would keep fields in memory that nothing else shows.
    measured_ = {};
    sample_.reset();
  }
  if (!needed || measuring_.busy() || shown.versions.empty()) return changed;
  Values now{shown.versions, shown.original};
  if (now == measured_) return changed;
  measured_ = std::move(now);
  measuring_.replace([versions = measured_.versions, original = measured_.original](engine::JobControl& job) {
    return sampleOf(versions, original, job);
  });
  return changed;
}

bool ColourRange::isOfForm(const render::Shown& shown) const {
  return !measured_.versions.empty() && !shown.versions.empty() &&
         measured_.versions.front().formOver() == shown.versions.front().formOver();
}

Quantity ColourRange::quantityOf(const render::Shown& shown) noexcept {
  if (!shown.original) return Quantity::kHeight;
  return shown.difference.one_sign ? Quantity::kOneSign : Quantity::kDeviation;
}

RangeRule& ColourRange::ruleOf(Display& display, Quantity quantity) noexcept {
  return isChange(quantity) ? display.changes : display.heights;
}

const RangeRule& ColourRange::ruleOf(const Display& display, Quantity quantity) noexcept {
  return isChange(quantity) ? display.changes : display.heights;
}

bool ColourRange::needsSample(const Display& display, const render::Shown& shown) noexcept {
  const RuleKind kind = ruleOf(display, quantityOf(shown)).kind;
  return kind == RuleKind::kShare || kind == RuleKind::kAll;
}

std::optional<render::ValueRange> ColourRange::range(const Display& display,
                                                     const render::Shown& shown) const {
  const Quantity quantity = quantityOf(shown);
  const RangeRule& rule = ruleOf(display, quantity);
  std::optional<render::ValueRange> range;
  if (rule.kind == RuleKind::kTyped && isChange(quantity) && limit_)
    range = render::ValueRange{-*limit_, *limit_};
  if (rule.kind == RuleKind::kTyped && quantity == Quantity::kHeight && heights_)
    range = isInverted(shown) ? turnedOver(*heights_) : *heights_;
  if (const render::ValueSample* const values = sample(quantity); values != nullptr && !values->empty()) {
    if (rule.kind == RuleKind::kAll) range = values->extreme;
    if (rule.kind == RuleKind::kShare) range = rangeOfShare(*values, quantity, rule.share);
    // Until those turned over are counted.
    if (quantity == Quantity::kHeight && range && rule.kind != RuleKind::kTyped &&
        turned_ != isInverted(shown))
      range = turnedOver(*range);
  }
  // All equal: the picture opens the range.
  return range && range->low < range->high ? range : std::nullopt;
}

render::Colouring ColourRange::colouring(const Display& display, Quantity quantity) const {
  render::Colouring colouring;
  // What has a sign has the map with a middle: in another one nobody sees where zero is.
  colouring.map = quantity == Quantity::kDeviation ? render::ColourMap::kDiverging : display.map;
  colouring.steps = display.colour_steps;
  colouring.tolerance = typed.tolerance;
  colouring.contour_step = isChange(quantity) ? typed.change_contours : typed.height_contours;
  return colouring;
}

void ColourRange::type(Display& display, const render::Shown& shown, const render::ValueRange& range) {
  const Quantity quantity = quantityOf(shown);
  ruleOf(display, quantity).kind = RuleKind::kTyped;
  if (isChange(quantity))
    limit_ = std::max(std::abs(range.low), std::abs(range.high));
  else
    heights_ = isInverted(shown) ? turnedOver(range) : range;
}

}  // namespace fettle::app

#include "app/window/colour_range.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fettle::app {
namespace {

using render::Quantity;
using RuleKind = RangeRule::Kind;

bool isInverted(const render::Shown& shown) {
  return !shown.versions.empty() && shown.versions.front().reader().sign() < 0.0F;
}

render::ValueRange turnedOver(const render::ValueRange& range) {
  return {-range.high, -range.low};
}

// Of all panels, which share one range.
engine::Result<render::ValueSample> sampleOf(const std::vector<engine::Version>& versions,
                                             const std::optional<engine::Version>& original,
                                             const engine::JobControl& job) {
  render::ValueSample all;
  for (const engine::Version& version : versions) {
    if (job.cancelled()) return engine::cancelled();
    render::ValueSample one =
        original ? render::deviationSample(version, *original) : render::heightSample(version);
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
  const bool dropped = measuring_.cancelling();
  bool changed = false;
  if (auto done = measuring_.take(); done && *done && !dropped) {
    sample_ = *std::move(*done);
    sampled_ = measured_.original ? Quantity::kDeviation : Quantity::kHeight;
    changed = true;
  }
  if (!needed || working || measuring_.busy() || shown.versions.empty()) return changed;
  Values now{shown.versions, shown.original};
  if (now == measured_) return changed;
  measured_ = std::move(now);
  measuring_.start([versions = measured_.versions, original = measured_.original](engine::JobControl& job) {
    return sampleOf(versions, original, job);
  });
  return changed;
}

Quantity ColourRange::quantityOf(const render::Shown& shown) noexcept {
  return shown.original ? Quantity::kDeviation : Quantity::kHeight;
}

RangeRule& ColourRange::ruleOf(Display& display, Quantity quantity) noexcept {
  return quantity == Quantity::kDeviation ? display.changes : display.heights;
}

const RangeRule& ColourRange::ruleOf(const Display& display, Quantity quantity) noexcept {
  return quantity == Quantity::kDeviation ? display.changes : display.heights;
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
  if (rule.kind == RuleKind::kTyped && quantity == Quantity::kDeviation && limit_)
    range = render::ValueRange{-*limit_, *limit_};
  if (rule.kind == RuleKind::kTyped && quantity == Quantity::kHeight && heights_)
    range = isInverted(shown) ? turnedOver(*heights_) : *heights_;
  if (const render::ValueSample* const values = sample(quantity); values != nullptr && !values->empty()) {
    if (rule.kind == RuleKind::kAll) range = values->extreme;
    if (rule.kind == RuleKind::kShare)
      range = quantity == Quantity::kDeviation ? values->symmetric(rule.share) : values->middle(rule.share);
  }
  // All equal: the picture opens the range.
  return range && range->low < range->high ? range : std::nullopt;
}

render::Colouring ColourRange::colouring(const Display& display, Quantity quantity) const {
  render::Colouring colouring;
  colouring.map = display.map;
  colouring.steps = display.colour_steps;
  colouring.tolerance = typed.tolerance;
  colouring.contour_step = quantity == Quantity::kDeviation ? typed.change_contours : typed.height_contours;
  return colouring;
}

void ColourRange::type(Display& display, const render::Shown& shown, const render::ValueRange& range) {
  const Quantity quantity = quantityOf(shown);
  ruleOf(display, quantity).kind = RuleKind::kTyped;
  if (quantity == Quantity::kDeviation)
    limit_ = range.high;
  else
    heights_ = isInverted(shown) ? turnedOver(range) : range;
}

}  // namespace fettle::app

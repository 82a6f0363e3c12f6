#include "app/view/filter_preview.h"

#include <chrono>

#include <fmt/format.h>

namespace fettle::app {
namespace {

// Rounds of adoption: each leaves only what a hand edited in some milliseconds, so a still hand needs one.
constexpr int kMostRounds = 50;

bool same(const engine::FilterSpec& a, const engine::FilterSpec& b) {
  return a.kind == b.kind && a.window == b.window && a.sigma == b.sigma && a.passes == b.passes &&
         a.scope == b.scope && a.max_change == b.max_change;
}

}  // namespace

std::string filterName(const engine::FilterSpec& spec) {
  std::string text = spec.kind == engine::FilterKind::kBox        ? "Box"
                     : spec.kind == engine::FilterKind::kGaussian ? "Gaussian"
                                                                  : "Median";
  text += fmt::format(" {} x {}", spec.window, spec.window);
  if (spec.passes > 1) text += fmt::format(", {} passes", spec.passes);
  if (spec.scope == engine::FilterScope::kOnlyMarks) text += ", only marks";
  return text;
}

void FilterPreview::compute(const Touch& touch, Keep keep) {
  keep_ = keep;
  apply_when_done_ = false;
  computing_.start([base = touch.field(), original = touch.original(), what = spec,
                    inverted = touch.scene().invert](engine::JobControl& job) -> engine::Result<Variant> {
    auto result = engine::applyFilter(base, inverted ? original.inverted() : original, what, job);
    if (!result) return tl::unexpected(result.error());
    return Variant{what, base, std::move(*result)};
  });
}

void FilterPreview::apply(Touch& touch) {
  if (applying()) return;
  if (!variants_.empty() && same(variants_.back().spec, spec)) {
    adopt(touch, variants_.back());
    return;
  }
  if (!computing()) compute(touch, Keep::kReplace);
  apply_when_done_ = true;
}

void FilterPreview::adopt(Touch& touch, Variant variant) {
  touch.nameAdoption(filterName(variant.spec));
  touch.allowPort();
  applying_.start([port = &touch, original = touch.original(), inverted = touch.scene().invert,
                   v = std::move(variant)](engine::JobControl& job) {
    return haptic::adoptFiltered(*port, v.base, v.result.field, inverted ? original.inverted() : original,
                                 v.spec, kMostRounds, job);
  });
}

void FilterPreview::cancel(Touch& touch) {
  computing_.cancel();
  applying_.cancel();
  if (applying_.busy()) touch.closePort();
  apply_when_done_ = false;
  variants_.clear();
}

void FilterPreview::drop(std::size_t variant) {
  if (variant < variants_.size()) variants_.erase(variants_.begin() + static_cast<std::ptrdiff_t>(variant));
}

bool FilterPreview::poll(Touch& touch, std::vector<Notice>& notices) {
  bool changed = false;
  if (auto done = computing_.take()) {
    changed = true;
    if (*done) {
      if (keep_ == Keep::kReplace) variants_.clear();
      if (variants_.size() == kMostVariants) variants_.erase(variants_.begin());
      variants_.push_back(std::move(**done));
      if (apply_when_done_) adopt(touch, variants_.back());
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
    apply_when_done_ = false;
  }
  if (auto done = applying_.take()) {
    changed = true;
    if (*done) {
      ++applied_;
      variants_.clear();
      if (!(*done)->rest.empty())
        notices.push_back({fmt::format("{} tiles under the brush are not filtered", (*done)->rest.size()),
                           "apply again when the stroke has ended"});
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  return changed;
}

}  // namespace fettle::app

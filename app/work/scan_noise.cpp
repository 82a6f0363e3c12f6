#include "app/work/scan_noise.h"

#include <utility>

namespace fettle::app {

bool ScanNoise::poll(const engine::Version& original) {
  bool changed = false;
  const bool dropped = measuring_.cancelling();
  if (auto done = measuring_.take(); done && !dropped && *done) {
    noise_ = **done;
    changed = true;
  }
  if (!std::exchange(wanted_, false) || of_ == original) return changed;
  noise_.reset();
  measuring_.cancel();
  if (measuring_.busy()) return true;
  of_ = original;
  measuring_.start([original](engine::JobControl& job) { return engine::estimateNoise(original, job); });
  return true;
}

const engine::NoiseEstimate* ScanNoise::of(const engine::Version& original) const noexcept {
  const bool same = noise_ && (of_ == original || of_ == original.inverted());
  return same ? &*noise_ : nullptr;
}

void ScanNoise::clear() {
  measuring_.cancel();
  wanted_ = false;
  of_ = {};
  noise_.reset();
}

}  // namespace fettle::app

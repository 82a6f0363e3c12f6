#include "app/work/removal_count.h"

#include <utility>

namespace fettle::app {

bool RemovalCount::poll(const LoopClient& client) {
  bool changed = false;
  const bool dropped = counting_.cancelling();
  if (auto done = counting_.take(); done && !dropped && *done) {
    counts_ = **done;
    changed = true;
  }
  const auto wanted = std::exchange(wanted_, std::nullopt);
  // Under a stroke the field is another one every tick.
  if (!wanted || client.strokeIsUnderWay()) return changed;
  Counted now{client.newest(), *wanted};
  if (of_ == now) return changed;
  counts_.reset();
  // One of other values ends first: nothing waits for it here.
  counting_.cancel();
  if (counting_.busy()) return true;
  of_ = now;
  counting_.start([now = std::move(now)](engine::JobControl& job) {
    return engine::countRemoved(now.field, now.options, job);
  });
  return true;
}

void RemovalCount::clear() {
  counting_.cancel();
  wanted_.reset();
  of_.reset();
  counts_.reset();
}

}  // namespace fettle::app

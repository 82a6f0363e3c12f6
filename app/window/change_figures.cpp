#include "app/window/change_figures.h"

namespace fettle::app {

void ChangeFigures::begin(const engine::Version& original) {
  begun_ = original;
  live_.begin(original);
  measured_ = original;
  exact_.reset();
}

bool ChangeFigures::poll(const LoopClient& client, bool working) {
  // Under another form the original is another.
  if (!(begun_ == client.original())) {
    measuring_.cancel();
    begin(client.original());
  }
  const bool changed = live_.poll(client);
  const bool cancelled = measuring_.cancelling();
  if (auto done = measuring_.take(); done && *done && !cancelled) exact_ = **done;
  const engine::Version now = client.upright();
  if (!measuring_.busy() && !(measured_ == now) && !working) {
    measured_ = now;
    measuring_.replace([original = client.original(), now](engine::JobControl& job) {
      return engine::compareFields(original, now, job);
    });
  }
  return changed;
}

const engine::Deviation* ChangeFigures::exact(const engine::Version& upright) const {
  return exact_ && !measuring_.busy() && measured_ == upright ? &*exact_ : nullptr;
}

}  // namespace fettle::app

#include "haptic/journal/recorder.h"

namespace fettle::haptic {

void Recorder::endBlock() {
  if (ticks_.count() == 0) return;
  const journal::Ticks ticks{ticks_.count()};
  entries_.push_back({journalText(ticks), ticks_.take(), engine::stepTimeNow(), 0});
}

void Recorder::add(const journal::Entry& entry, std::string data) {
  endBlock();
  entries_.push_back({journalText(entry), std::move(data), engine::stepTimeNow(), 0});
}

void Recorder::beginFilter(const journal::FilterBegun& filter) {
  if (offer_open_)
    begun_.push_back(filter);
  else
    add(filter);
}

void Recorder::offerAnswered(const journal::Offered& offered) {
  offer_open_ = false;
  add(offered);
  for (const journal::FilterBegun& filter : std::exchange(begun_, {})) add(filter);
}

std::vector<engine::JournalEntry> Recorder::take() {
  endBlock();
  return std::exchange(entries_, {});
}

}  // namespace fettle::haptic

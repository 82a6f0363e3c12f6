#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/tick_codec.h"

namespace fettle::haptic {

/// Collects the events of a loop as journal entries until they are taken for a session. Ticks are ordered
/// before entries that were added after them. Threading: main.
class Recorder {
 public:
  /// Number of waiting ticks that are written even without another event: some seconds of them.
  static constexpr std::int64_t kDue = 4096;

  void tick(const haptic::StrokeSample& input) { ticks_.add(input); }
  void add(const journal::Entry& entry, std::string data = {});
  /// A filter that begins while the offer of a cancelled one has no answer yet is recorded after that answer.
  void beginFilter(const journal::FilterBegun& filter);
  void offerMade() { offer_open_ = true; }
  void offerAnswered(const journal::Offered& offered);

  [[nodiscard]] bool due() const noexcept { return ticks_.count() >= kDue; }
  [[nodiscard]] bool empty() const noexcept { return entries_.empty() && ticks_.count() == 0; }
  /// All so far, in order.
  [[nodiscard]] std::vector<engine::JournalEntry> take();

 private:
  void endBlock();

  TickPacker ticks_;
  std::vector<engine::JournalEntry> entries_;
  bool offer_open_ = false;
  std::vector<journal::FilterBegun> begun_;
};

}  // namespace fettle::haptic

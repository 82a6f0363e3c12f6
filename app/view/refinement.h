#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace fettle::app {

/// How many vertices the picture may take: those the user chose while it changes as a whole, and as many as
/// the screen error asks for once it has not for a while. That costs one slow frame, after which only what a
/// hand changes is drawn anew, as quickly as ever; the next change of the whole picture goes back to the
/// chosen number.
class Refinement {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{250};
  static constexpr std::int64_t kMost = std::int64_t{1} << 20;

  /// Whether the fine picture is due now: its frame has to be drawn, whatever else happens.
  [[nodiscard]] bool due(Clock::time_point now) const noexcept {
    return state_ == State::kChosen && now - whole_ >= kQuiet;
  }
  /// Whether it is still to come.
  [[nodiscard]] bool owed() const noexcept { return state_ == State::kChosen; }

  /// What the next frame may take. `chosen`: vertices.
  [[nodiscard]] std::int64_t vertices(std::int64_t chosen, Clock::time_point now) noexcept {
    if (due(now)) state_ = State::kBegins;
    return state_ == State::kChosen ? chosen : std::max(chosen, kMost);
  }
  /// That frame was drawn; `whole`: nothing of the one before was left, or `coming`: more is on its way.
  void drawn(bool whole, bool coming, Clock::time_point now) noexcept {
    if (coming || (whole && state_ != State::kBegins)) {
      state_ = State::kChosen;
      whole_ = now;
    } else if (state_ == State::kBegins) {
      state_ = State::kFine;
    }
  }

 private:
  enum class State : std::uint8_t {
    kChosen,
    kBegins,  ///< the frame that is drawn now is the first fine one
    kFine,
  };
  State state_ = State::kChosen;
  Clock::time_point whole_{};
};

}  // namespace fettle::app

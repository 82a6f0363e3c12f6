#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fettle::app {

/// How many vertices each panel of the picture may take: together those the user chose while the picture
/// changes as a whole, and each as many as the screen error asks for once it has not for a while.
///
///   chosen --- nothing changed for kQuiet --> begins: panel 1, panel 2, ... --> fine
///      ^---------------- the picture changes as a whole ------------------------'
///
/// A panel a frame: a slow frame costs as much as that of a single picture, and input is taken between two of
/// them. After that only what a hand changes is drawn again. Panels that cannot be drawn one without the
/// other (a picture for two eyes) follow in one frame.
class Refinement {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{250};
  static constexpr std::int64_t kMost = std::int64_t{1} << 20;  ///< of a panel

  /// Whether a frame of the fine picture is due now: it has to be drawn, whatever else happens.
  [[nodiscard]] bool due(Clock::time_point now) const noexcept {
    return state_ == State::kBegins || (state_ == State::kChosen && now - whole_ >= kQuiet);
  }
  /// Whether some of it is still to come.
  [[nodiscard]] bool pending() const noexcept { return state_ != State::kFine; }

  /// The next frame changes the picture as a whole, as is known before it is drawn.
  void restart(Clock::time_point now) noexcept {
    state_ = State::kChosen;
    fine_ = 0;
    whole_ = now;
  }

  /// What each of `panels` panels may take in the next frame. `chosen`: vertices, all panels together.
  [[nodiscard]] std::vector<std::int64_t> vertices(std::int64_t chosen, std::size_t panels,
                                                   Clock::time_point now) {
    if (panels != panels_ && state_ != State::kChosen) restart(now);
    panels_ = panels;
    if (due(now)) state_ = State::kBegins;
    const std::int64_t share = std::max<std::int64_t>(1, chosen / static_cast<std::int64_t>(panels));
    std::vector<std::int64_t> each(panels, share);
    const std::size_t fine = state_ == State::kFine     ? panels
                             : state_ == State::kBegins ? (at_once_ ? panels : fine_ + 1)
                                                        : 0;
    std::fill_n(each.begin(), fine, std::max(chosen, kMost));
    return each;
  }

  /// What a frame of these vertices was.
  struct Drawn {
    bool whole = false;         ///< all of the picture was drawn
    bool continued = true;      ///< it went on from the frame before
    bool tiles_coming = false;  ///< samples that changed are still on their way
    bool pages_coming = false;  ///< finer samples, which this frame asked for, are
  };
  void drawn(const Drawn& frame, Clock::time_point now) noexcept {
    const bool coming = frame.tiles_coming || (frame.pages_coming && state_ == State::kChosen);
    if (coming || (frame.whole && state_ != State::kBegins)) {
      restart(now);
    } else if (state_ == State::kBegins) {
      if (panels_ > 1 && !at_once_ && !frame.continued) {
        // Another change, or panels that are always drawn together.
        at_once_ = true;
        restart(now);
      } else if (!frame.pages_coming && (at_once_ || ++fine_ == panels_)) {
        state_ = State::kFine;
        at_once_ = false;
      }
    }
  }

 private:
  enum class State : std::uint8_t {
    kChosen,
    kBegins,  ///< the frame that is drawn now refines panel `fine_`
    kFine,
  };
  State state_ = State::kChosen;
  std::size_t panels_ = 1;
  std::size_t fine_ = 0;  ///< panels that are refined, the first ones
  bool at_once_ = false;  ///< the next refinement is of all panels in one frame
  Clock::time_point whole_{};
};

}  // namespace fettle::app

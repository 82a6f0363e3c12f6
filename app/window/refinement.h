#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fettle::app {

/// How many vertices each panel of the picture may use: together the user's number while the picture changes
/// as a whole, and each as many as the screen error requires after it has not changed for a while.
///
///   chosen --- nothing changed for kQuiet --> begins: panel 1, panel 2, ... --> fine
///      ^---------------- the picture changes as a whole ------------------------'
///
/// One panel after the other, each in bands of rows: so no frame takes long, and input is processed between two of them. After
/// that only edited parts are drawn again. Panels that cannot be drawn independently (a picture for two eyes) are refined in one
/// frame.
class Refinement {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{250};
  static constexpr std::int64_t kMost = std::int64_t{1} << 20;  ///< of a panel

  /// Whether a frame of the refined picture is due now: it must be drawn in any case.
  [[nodiscard]] bool due(Clock::time_point now) const noexcept {
    return state_ == State::kBegins || (state_ == State::kChosen && now - whole_ >= kQuiet);
  }
  /// Whether a frame with the vertices() asked for last makes the picture finer, in bands.
  [[nodiscard]] bool inBands() const noexcept { return state_ == State::kBegins; }
  /// Whether some refinement is left.
  [[nodiscard]] bool pending() const noexcept { return state_ != State::kFine; }

  /// The next frame changes the picture as a whole, as known before it is drawn.
  void restart(Clock::time_point now) noexcept {
    state_ = State::kChosen;
    fine_ = 0;
    whole_ = now;
  }

  /// Vertices of each of `panels` panels in the next frame. `chosen`: vertices, all panels together.
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

  /// The result of a frame with these vertices.
  struct Drawn {
    bool whole = false;         ///< all of the picture was drawn
    bool continued = true;      ///< it reused the frame before
    bool tiles_coming = false;  ///< changed samples are not uploaded yet
    bool pages_coming = false;  ///< finer samples that this frame requested are not uploaded yet
    int bands_left = 0;         ///< frames that must follow until all of the panel is finer
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
      } else if (!frame.pages_coming && frame.bands_left == 0 && (at_once_ || ++fine_ == panels_)) {
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

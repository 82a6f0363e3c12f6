#pragma once

#include <algorithm>
#include <cstdint>

namespace fettle::app {

/// Whether frames of one kind are drawn with less, decided by the time that the last ones took. The mean of them counts, the newest
/// ones most, and a single one that is longer by far - a pipeline that was compiled - changes nothing.
///
///   all --- mean above slow_ms, `few` frames at least, the last two above it; of one: that one above it --> less
///    ^--- mean below quick_ms, calm() frames in a row ---'
///
/// Where it is assumed that frames are slow, they are drawn with less at first, until
///   - `kFew` of those in a row have a mean below quick_ms, or
///   - tell() says how long one with all takes.
///
/// Where frames with all are slow again soon after that, calm() doubles: so the picture does not keep changing between the two
/// under a load that is the same.
///
/// Deterministic: a sequence of times gives a sequence of decisions.
class FrameBudget {
 public:
  /// Two frames lie between an edit and its pixel at worst, of 33 ms together; with less there must be time for what all
  /// would take in addition.
  static constexpr double kSlow_ms = 25.0, kQuick_ms = 12.0;
  /// Of frames in which a brush works: between an edit and its pixel lie the loop's 4 ms and two of them at worst, of 33 ms together,
  /// and one in a hundred takes half as long again. Without the pen's shadow there must be time for it.
  static constexpr double kSlowStroke_ms = 10.0, kQuickStroke_ms = 4.5;
  /// Of frames that change as a whole: between a key and its effect lie two at worst, of 100 ms together, and a third of that is for
  /// what a busy machine adds.
  static constexpr double kSlowWhole_ms = 33.0, kQuickWhole_ms = 16.0;
  static constexpr int kFew = 3, kCalm = 20, kMostCalm = 320, kSoon = 60;
  /// So many times slow_ms is longer by far.
  static constexpr double kFar = 3.0;
  /// One of them decides, whatever those before took: what is drawn with less is sharp a quarter of a second later, and no frame of that
  /// takes long.
  static constexpr int kFewWhole = 1;

  /// Before the first frame. kSlow: a key must not wait for a frame of which nobody knows how long it takes; a few quick ones show
  /// that there is time for all.
  enum class Assumed : std::uint8_t { kQuick, kSlow };

  explicit constexpr FrameBudget(double slow_ms = kSlow_ms, double quick_ms = kQuick_ms, int few = kFew,
                                 Assumed assumed = Assumed::kQuick) noexcept
      : slow_ms_(slow_ms),
        quick_ms_(quick_ms),
        few_(few),
        known_(assumed == Assumed::kQuick),
        less_(assumed == Assumed::kSlow) {}

  /// Of frames that change as a whole.
  [[nodiscard]] static constexpr FrameBudget ofWhole() noexcept {
    return FrameBudget{kSlowWhole_ms, kQuickWhole_ms, kFewWhole, Assumed::kSlow};
  }

  /// A frame of this kind took so long, from its beginning until it was passed to the window system, without waiting for the display.
  void note(double ms) noexcept {
    if (!known_ && ms > kFar * slow_ms_) return;
    constexpr double kWeight = 0.25;
    const double counted = std::min(ms, 2.0 * slow_ms_);
    mean_ms_ = frames_ == 0 ? counted : mean_ms_ + kWeight * (counted - mean_ms_);
    ++frames_;
    slow_ = ms > slow_ms_ ? slow_ + 1 : 0;
    last_ms_ = ms;
    if (less_)
      noteLess();
    else
      noteAll();
  }

  /// A frame with all takes at least and at most so long. Counts while nothing is known.
  void tell(double at_least_ms, double at_most_ms) noexcept {
    if (known_ || at_least_ms > kFar * slow_ms_) return;
    if (at_most_ms <= slow_ms_)
      change(false);
    else if (at_least_ms > slow_ms_)
      change(true);
  }

  /// Whether frames decide, and no assumption.
  [[nodiscard]] bool known() const noexcept { return known_; }
  /// Whether the next frame of this kind is drawn with less.
  [[nodiscard]] bool less() const noexcept { return less_; }
  /// Quick frames in a row after which all is drawn again.
  [[nodiscard]] int calm() const noexcept { return calm_; }

 private:
  void noteAll() noexcept {
    if (frames_ >= kSoon) calm_ = kCalm;
    const int needed = last_ms_ > kFar * slow_ms_ ? 2 : std::min(few_, 2);
    if (frames_ < few_ || slow_ < needed || (few_ > 1 && mean_ms_ <= slow_ms_)) return;
    if (returned_ && frames_ < kSoon) calm_ = std::min(2 * calm_, kMostCalm);
    change(true);
  }
  void noteLess() noexcept {
    quick_ = mean_ms_ < quick_ms_ ? quick_ + 1 : 0;
    if (quick_ < (known_ ? calm_ : kFew)) return;
    returned_ = known_;
    change(false);
  }
  void change(bool less) noexcept {
    known_ = true;
    less_ = less;
    frames_ = quick_ = slow_ = 0;
  }

  double slow_ms_, quick_ms_;
  int few_;
  bool known_, less_, returned_ = false;
  double mean_ms_ = 0.0, last_ms_ = 0.0;
  int frames_ = 0;  // since the last change
  int quick_ = 0;   // in a row
  int slow_ = 0;    // in a row
  int calm_ = kCalm;
};

}  // namespace fettle::app

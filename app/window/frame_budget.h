#pragma once

#include <algorithm>

namespace fettle::app {

/// Whether frames of one kind are drawn with less, decided by the time that the last ones took. The mean of them counts, the newest
/// ones most, and a single long one - a pipeline that was compiled - changes nothing.
///
///   all --- mean above kSlow_ms, kFew frames at least, the last two above it --> less
///    ^--- mean below kQuick_ms, calm() frames in a row ---'
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
  static constexpr int kFew = 3, kCalm = 20, kMostCalm = 320, kSoon = 60;

  /// A frame of this kind took so long, from its beginning until it was passed to the window system, without waiting for the display.
  void note(double ms) noexcept {
    constexpr double kWeight = 0.25;
    const double counted = std::min(ms, 2.0 * kSlow_ms);
    mean_ms_ = frames_ == 0 ? counted : mean_ms_ + kWeight * (counted - mean_ms_);
    ++frames_;
    slow_ = ms > kSlow_ms ? slow_ + 1 : 0;
    if (less_)
      noteLess();
    else
      noteAll();
  }

  /// Whether the next frame of this kind is drawn with less.
  [[nodiscard]] bool less() const noexcept { return less_; }
  /// Quick frames in a row after which all is drawn again.
  [[nodiscard]] int calm() const noexcept { return calm_; }

 private:
  void noteAll() noexcept {
    if (frames_ >= kSoon) calm_ = kCalm;
    if (frames_ < kFew || slow_ < 2 || mean_ms_ <= kSlow_ms) return;
    if (returned_ && frames_ < kSoon) calm_ = std::min(2 * calm_, kMostCalm);
    change(true);
  }
  void noteLess() noexcept {
    quick_ = mean_ms_ < kQuick_ms ? quick_ + 1 : 0;
    if (quick_ < calm_) return;
    returned_ = true;
    change(false);
  }
  void change(bool less) noexcept {
    less_ = less;
    frames_ = quick_ = slow_ = 0;
  }

  bool less_ = false, returned_ = false;
  double mean_ms_ = 0.0;
  int frames_ = 0;  // since the last change
  int quick_ = 0;   // in a row
  int slow_ = 0;    // in a row
  int calm_ = kCalm;
};

}  // namespace fettle::app

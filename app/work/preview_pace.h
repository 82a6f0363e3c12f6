#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace fettle::app {

/// How soon previews of one kind are seen, measured on the last one, so that it is known whether they may follow the fields
/// that they are of. Threading: one thread at a time.
class PreviewPace {
 public:
  using Clock = std::chrono::steady_clock;
  /// A preview that was seen within this follows its fields by itself; a longer one is asked for.
  static constexpr Clock::duration kSoon = std::chrono::milliseconds(500);
  /// Between the last change of a field and the preview of what it says.
  static constexpr Clock::duration kRest = std::chrono::milliseconds(150);
  /// Between two looks at what the camera shows and at what there is of it: each is drawn.
  static constexpr Clock::duration kLookAgain = std::chrono::milliseconds(200);

  /// One is begun; `tiles`: of the field that are in view.
  void begin(Clock::time_point now, std::int64_t tiles) noexcept {
    begun_ = now;
    begun_tiles_ = tiles;
  }
  /// Something of it is seen; the first time counts.
  void see(Clock::time_point now) noexcept {
    if (!begun_) return;
    took_ = now - *begun_;
    tiles_ = begun_tiles_;
    begun_.reset();
  }
  /// It was cancelled before anything was seen of it.
  void drop() noexcept { begun_.reset(); }
  /// Whether the next one will be seen soon. Of more in view it is expected to take longer in proportion.
  [[nodiscard]] bool isSoon(std::int64_t tiles) const noexcept {
    if (!took_) return false;
    const double more =
        tiles > tiles_ && tiles_ > 0 ? static_cast<double>(tiles) / static_cast<double>(tiles_) : 1.0;
    return std::chrono::duration<double>(*took_).count() * more <
           std::chrono::duration<double>(kSoon).count();
  }

 private:
  std::optional<Clock::time_point> begun_;
  std::int64_t begun_tiles_ = 0, tiles_ = 0;
  std::optional<Clock::duration> took_;
};

/// When the fields of a preview rest after a change. `Fields`: can be compared. Threading: one thread at a time.
template <class Fields>
class RestingFields {
 public:
  using Clock = PreviewPace::Clock;

  /// Looks at them, once a frame. True when they are others than at the last look.
  bool look(const Fields& fields, Clock::time_point now) {
    const bool changed = last_ && !(*last_ == fields);
    last_ = fields;
    if (changed) changed_ = now;
    return changed;
  }
  /// None is wanted.
  void settle() noexcept { changed_.reset(); }
  /// A preview of these is begun.
  void settle(const Fields& fields) {
    last_ = fields;
    changed_.reset();
  }
  [[nodiscard]] bool changed() const noexcept { return changed_.has_value(); }
  [[nodiscard]] bool rest(Clock::time_point now) const noexcept {
    return changed_ && now - *changed_ >= PreviewPace::kRest;
  }

 private:
  std::optional<Fields> last_;
  std::optional<Clock::time_point> changed_;
};

}  // namespace fettle::app

#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace fettle::haptic {

[[nodiscard]] constexpr double microseconds(std::int64_t ns) noexcept {
  return 1e-3 * static_cast<double>(ns);
}

/// Figures of a histogram, in nanoseconds. A percentile is the upper end of its class: never too low, and too
/// high by at most 1/32.
struct TimingFigures {
  std::uint64_t count = 0;
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t p9999_ns = 0;
  std::int64_t worst_ns = 0;  ///< exact
  double mean_ns = 0.0;       ///< exact apart from rounding

  friend bool operator==(const TimingFigures&, const TimingFigures&) = default;
};

/// Counts times in classes whose width is 1/32 of their octave (log-linear, as in G. Tene's HdrHistogram):
/// exact below 32 ns, within 3.1 % above, up to 2^40 ns (18 min), longer ones in the last class.
///
/// Threading: one writer (add), any number of readers at any time. All accesses are relaxed: each class is
/// independent, and figures() of a running histogram may miss the newest few; after the writer was joined
/// they are exact. add() is wait-free and uses no read-modify-write instruction, since there is no other
/// writer.
class TimingHistogram {
  static constexpr int kSubBits = 5;
  static constexpr int kOctaves = 40;
  static constexpr std::size_t kClasses = std::size_t{kOctaves - kSubBits + 1} << kSubBits;
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

 public:
  /// A time below zero counts as zero.
  void add(std::int64_t ns) noexcept {
    const std::uint64_t v = ns > 0 ? static_cast<std::uint64_t>(ns) : 0;
    bump(classes_[classOf(v)], 1);
    bump(sum_, v);
    if (v > worst_.load(std::memory_order_relaxed)) worst_.store(v, std::memory_order_relaxed);
  }

  /// Adds all times of another histogram; called by this one's writer.
  void add(const TimingHistogram& other) noexcept {
    for (std::size_t i = 0; i < kClasses; ++i)
      bump(classes_[i], other.classes_[i].load(std::memory_order_relaxed));
    bump(sum_, other.sum_.load(std::memory_order_relaxed));
    const std::uint64_t worst = other.worst_.load(std::memory_order_relaxed);
    if (worst > worst_.load(std::memory_order_relaxed)) worst_.store(worst, std::memory_order_relaxed);
  }

  [[nodiscard]] TimingFigures figures() const noexcept {
    TimingFigures f;
    std::array<std::uint64_t, kClasses> counts;
    for (std::size_t i = 0; i < kClasses; ++i) {
      counts[i] = classes_[i].load(std::memory_order_relaxed);
      f.count += counts[i];
    }
    if (f.count == 0) return f;
    f.worst_ns = static_cast<std::int64_t>(worst_.load(std::memory_order_relaxed));
    f.mean_ns = static_cast<double>(sum_.load(std::memory_order_relaxed)) / static_cast<double>(f.count);
    f.p50_ns = percentile(counts, f.count, 5000, f.worst_ns);
    f.p99_ns = percentile(counts, f.count, 9900, f.worst_ns);
    f.p999_ns = percentile(counts, f.count, 9990, f.worst_ns);
    f.p9999_ns = percentile(counts, f.count, 9999, f.worst_ns);
    return f;
  }

  /// Number of times in classes that lie wholly at or above `ns`: times above a limit, too low by at most the
  /// class that contains the limit.
  [[nodiscard]] std::uint64_t countAbove(std::int64_t ns) const noexcept {
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < kClasses; ++i)
      if (lowerEnd(i) >= static_cast<std::uint64_t>(ns)) n += classes_[i].load(std::memory_order_relaxed);
    return n;
  }

 private:
  static void bump(std::atomic<std::uint64_t>& a, std::uint64_t by) noexcept {
    a.store(a.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
  }
  static std::size_t classOf(std::uint64_t v) noexcept {
    constexpr std::uint64_t kLongest = (std::uint64_t{1} << kOctaves) - 1;
    if (v > kLongest) v = kLongest;
    const int shift = v < (1U << kSubBits) ? 0 : static_cast<int>(std::bit_width(v)) - 1 - kSubBits;
    return (static_cast<std::size_t>(shift) << kSubBits) + static_cast<std::size_t>(v >> shift);
  }
  static std::uint64_t lowerEnd(std::size_t c) noexcept {
    if (c < (2U << kSubBits)) return c;
    const std::size_t shift = (c >> kSubBits) - 1;
    return static_cast<std::uint64_t>(c - (shift << kSubBits)) << shift;
  }
  static std::int64_t percentile(const std::array<std::uint64_t, kClasses>& counts, std::uint64_t total,
                                 std::uint64_t per_10000, std::int64_t worst) noexcept {
    // The smallest time that at least this share of all times does not exceed.
    const std::uint64_t rank = (total * per_10000 + 9999) / 10000;
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kClasses; ++i) {
      seen += counts[i];
      if (seen < rank) continue;
      const auto upper = i + 1 < kClasses ? static_cast<std::int64_t>(lowerEnd(i + 1) - 1) : worst;
      return upper < worst ? upper : worst;
    }
    return worst;
  }

  std::array<std::atomic<std::uint64_t>, kClasses> classes_{};
  std::atomic<std::uint64_t> sum_{0};
  std::atomic<std::uint64_t> worst_{0};
};

/// Timing of a loop. Written by the loop, read by any thread at any time; relaxed as above.
struct LoopTiming {
  TimingHistogram lateness;              ///< wake-up after the scheduled time
  TimingHistogram compute;               ///< from wake-up to the force written
  std::atomic<std::uint64_t> missed{0};  ///< periods without a tick of their own, skipped

  /// Called by the one writer, as add() of the histograms.
  void addMissed(std::int64_t periods) noexcept {
    missed.store(missed.load(std::memory_order_relaxed) + static_cast<std::uint64_t>(periods),
                 std::memory_order_relaxed);
  }
};

}  // namespace fettle::haptic

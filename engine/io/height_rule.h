#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/io/import.h"

namespace fettle::engine {

/// Counts from converting numbers to heights; tallies of strips are merged, in any order.
struct HeightTally {
  std::int64_t holes = 0;  ///< by no-data value or NaN
  std::int64_t said =
      0;  ///< of these with HeightRule::user_no_data; a reader that leaves them out before counts one
  std::int64_t infinite = 0;  ///< infinities, also those caused only by rounding to float
  double rounding = 0.0;      ///< largest |float height - double height|
  /// Of the heights whose rounding was looked at, before it.
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  bool decimals =
      false;  ///< numbers that are no floats at any size: their rounding counts beside the range alone

  void rounded(double height, float to) noexcept {
    rounding = std::fmax(rounding, std::abs(static_cast<double>(to) - height));
    least = std::fmin(least, height);
    most = std::fmax(most, height);
  }
  void merge(const HeightTally& other) noexcept {
    holes += other.holes;
    said += other.said;
    infinite += other.infinite;
    rounding = std::fmax(rounding, other.rounding);
    least = std::fmin(least, other.least);
    most = std::fmax(most, other.most);
    decimals = decimals || other.decimals;
  }
};

/// Converts the numbers of a file to heights: height = number * scale + offset in double, rounded once.
struct HeightRule {
  double scale = 1.0;
  double offset = 0.0;
  std::optional<double> declared_no_data;  ///< the file's
  std::optional<double> user_no_data;      ///< ImportOptions::no_data

  /// As the user wants it, where the file says nothing.
  [[nodiscard]] static HeightRule of(const ImportOptions& options) noexcept {
    HeightRule rule;
    rule.scale = options.z_scale.value_or(1.0);
    rule.user_no_data = options.no_data;
    return rule;
  }

  /// Whether a stored number means "hole".
  template <class T>
  [[nodiscard]] bool hole(T number) const noexcept {
    if constexpr (std::is_floating_point_v<T>)
      if (std::isnan(number)) return true;
    return (declared_no_data && same(number, *declared_no_data)) ||
           (user_no_data && same(number, *user_no_data));
  }

  /// Converts `count` numbers; holes and infinities come out as NaN.
  template <class T>
  void convert(const T* numbers, float* heights, std::size_t count, HeightTally& tally) const noexcept {
    if constexpr (std::is_same_v<T, float>) {
      if (scale == 1.0 && offset == 0.0) {
        convertPlain(numbers, heights, count, tally);
        return;
      }
    }
    convertEach(numbers, heights, count, tally);
  }

 private:
  // Floats that are not changed: runs without a possible hole are copied, the loop has no branch and so uses
  // vector instructions.
  void convertPlain(const float* numbers, float* heights, std::size_t count,
                    HeightTally& tally) const noexcept {
    constexpr std::size_t kRun = 1024;
    constexpr float kHuge = 3.4028e38F;  // see same()
    // NaN equals nothing, as intended: NaN samples are found by the comparison with kHuge.
    const auto mark = [](const std::optional<double>& value) {
      return value ? toFloat(*value) : std::numeric_limits<float>::quiet_NaN();
    };
    const float declared = mark(declared_no_data);
    const float user = mark(user_no_data);
    for (std::size_t begin = 0; begin < count; begin += kRun) {
      const std::size_t run = count - begin < kRun ? count - begin : kRun;
      const float* from = numbers + begin;
      float* to = heights + begin;
      int suspects = 0;
      for (std::size_t i = 0; i < run; ++i) {
        const float v = from[i];
        to[i] = v;
        suspects += static_cast<int>(!(std::abs(v) < kHuge)) | static_cast<int>(v == declared) |
                    static_cast<int>(v == user);
      }
      if (suspects != 0) convertEach(from, to, run, tally);
    }
  }

  template <class T>
  void convertEach(const T* numbers, float* heights, std::size_t count, HeightTally& tally) const noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      if (hole(numbers[i])) {
        heights[i] = std::numeric_limits<float>::quiet_NaN();
        ++tally.holes;
        tally.said += static_cast<std::int64_t>(user_no_data && same(numbers[i], *user_no_data));
        continue;
      }
      double height = static_cast<double>(numbers[i]);
      if (scale != 1.0) height *= scale;
      if (offset != 0.0) height += offset;  // nothing is added to -0, otherwise it would lose its sign
      const float rounded = toFloat(height);
      if (std::isfinite(rounded)) {
        if constexpr (sizeof(T) > 2 && !std::is_same_v<T, float>) tally.rounded(height, rounded);
        heights[i] = rounded;
      } else {
        heights[i] = std::numeric_limits<float>::quiet_NaN();
        ++tally.infinite;
      }
    }
  }

 public:
  /// double to float, infinity where the float's range ends (the plain cast is undefined there).
  [[nodiscard]] static float toFloat(double value) noexcept {
    constexpr double kLimit =
        3.4028235677973366e38;  // FLT_MAX + half an ulp: from here on rounds to infinity
    if (std::abs(value) >= kLimit)
      return std::copysign(std::numeric_limits<float>::infinity(),
                           static_cast<float>(std::copysign(1.0, value)));
    return static_cast<float>(value);
  }

 private:
  template <class T>
  [[nodiscard]] static bool same(T number, double value) noexcept {
    if constexpr (std::is_floating_point_v<T>) {
      if (static_cast<double>(number) == value) return true;
      // Writers print the lowest float as -3.402823e+38, which differs from it by 2 ulp as a float: any
      // number that large, with the same sign, is the mark and not a height.
      constexpr double kHuge = 3.4028e38;
      if (std::abs(value) >= kHuge && std::abs(static_cast<double>(number)) >= kHuge)
        return std::signbit(value) == std::signbit(static_cast<double>(number));
      return toFloat(static_cast<double>(number)) == toFloat(value);
    } else {
      // An integer equals a double only if the double is integral; both directions are exact up to 2^53 and a
      // comparison in long double (64 bits of fraction) is exact for all 64-bit integers.
      return static_cast<long double>(number) == static_cast<long double>(value);
    }
  }
};

/// The warnings of a tally. `unit` is the height unit's name.
void describeTally(const HeightTally& tally, const std::string& unit, std::vector<std::string>& warnings);

}  // namespace fettle::engine

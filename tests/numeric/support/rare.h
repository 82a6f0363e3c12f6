#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace fettle::tests {

/// Counts a rare but legal event and states how often it may be: pbrt's CHECK_RARE (Pharr, Jakob, Humphreys,
/// src/pbrt/util/check.h). At the end of its scope it fails the test when the event came more often, and
/// prints the count when it came at all, so that a change of the share is seen before it is too large.
class Rare {
 public:
  /// `what`: a sentence of what happens; `at_most`: share of all looks, 0 .. 1.
  Rare(std::string what, double at_most) : what_(std::move(what)), at_most_(at_most) {}
  Rare(const Rare&) = delete;
  Rare& operator=(const Rare&) = delete;
  ~Rare() {
    EXPECT_LE(static_cast<double>(events_), at_most_ * static_cast<double>(looks_))
        << what_ << ": " << events_ << " of " << looks_;
    if (events_ > 0) fmt::print("rare: {}: {} of {}\n", what_, events_, looks_);
  }

  void saw(bool happened) {
    ++looks_;
    events_ += happened ? 1 : 0;
  }
  [[nodiscard]] std::int64_t events() const { return events_; }

 private:
  std::string what_;
  double at_most_;
  std::int64_t events_ = 0;
  std::int64_t looks_ = 0;
};

}  // namespace fettle::tests

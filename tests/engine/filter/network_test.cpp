// Networks sort and merge what they say: by the 0-1 principle (D. E. Knuth, The Art of Computer Programming,
// vol. 3, 5.3.4, theorem Z) zeros and ones are enough.
#include "engine/filter/sorting_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fettle::engine {
namespace {

template <class List>
void apply(const List& list, std::vector<int>& wires) {
  for (std::size_t i = 0; i < list.count; ++i) {
    const Comparator& step = list.steps[i];
    const int a = wires[static_cast<std::size_t>(step.low)];
    const int b = wires[static_cast<std::size_t>(step.high)];
    // What is not wanted is spoilt, so that it shows if somebody looks at it after all.
    wires[static_cast<std::size_t>(step.low)] = step.wants_low ? std::min(a, b) : 7;
    wires[static_cast<std::size_t>(step.high)] = step.wants_high ? std::max(a, b) : -7;
  }
}

TEST(SortingNetworks, SortEveryRowOfZerosAndOnes) {
  for (const int n : {2, 3, 5, 7, 9, 11}) {
    const auto list = sortingNetwork(n);
    for (unsigned bits = 0; bits < 1U << n; ++bits) {
      std::vector<int> wires;
      for (int i = 0; i < n; ++i) wires.push_back(static_cast<int>(bits >> i & 1U));
      apply(list, wires);
      EXPECT_TRUE(std::ranges::is_sorted(wires)) << n << ", " << bits;
    }
  }
}

TEST(MergingNetworks, GiveTheRanksThatAreWantedOfEveryTwoRowsOfZerosAndOnes) {
  struct Case {
    int a, b, begin, end;
  };
  for (const Case& c : {Case{5, 5, 0, 10},
                        {10, 10, 7, 13},
                        {11, 11, 0, 22},
                        {22, 22, 0, 44},
                        {44, 44, 27, 61},
                        {34, 22, 22, 34},
                        {36, 18, 13, 41},
                        {3, 14, 5, 6},
                        {14, 1, 0, 15},
                        {1, 1, 0, 2}}) {
    const auto list = mergingNetwork(c.a, c.b, c.begin, c.end);
    for (int zeros_a = 0; zeros_a <= c.a; ++zeros_a)
      for (int zeros_b = 0; zeros_b <= c.b; ++zeros_b) {
        std::vector<int> wires;
        for (int i = 0; i < c.a; ++i) wires.push_back(i < zeros_a ? 0 : 1);
        for (int i = 0; i < c.b; ++i) wires.push_back(i < zeros_b ? 0 : 1);
        apply(list, wires);
        for (int w = c.begin; w < c.end; ++w)
          EXPECT_EQ(wires[static_cast<std::size_t>(w)], w < zeros_a + zeros_b ? 0 : 1)
              << c.a << " + " << c.b << ", zeros " << zeros_a << " + " << zeros_b << ", wire " << w;
      }
  }
}

TEST(MergingNetworks, LeaveOutWhatNobodyWants) {
  EXPECT_LT(mergingNetwork(44, 44, 27, 61).count, mergingNetwork(44, 44, 0, 88).count);
  EXPECT_EQ(mergingNetwork(1, 1, 0, 2).count, 1U);
}

}  // namespace
}  // namespace fettle::engine

#pragma once

#include <array>
#include <cstddef>

namespace fettle::engine {

/// Compares two wires and puts the smaller value on `low`, the greater on `high`; what nobody looks at later
/// is not worked out.
struct Comparator {
  int low = 0, high = 0;
  bool wants_low = true, wants_high = true;
};

/// Comparators one after the other, made when the program is compiled.
template <std::size_t kMost>
struct ComparatorList {
  std::array<Comparator, kMost> steps{};
  std::size_t count = 0;

  constexpr void add(int low, int high) { steps[count++] = {low, high, true, true}; }

  /// Drops what the wires [begin, end) do not need at the end.
  constexpr void prune(int begin, int end, int wires) {
    std::array<bool, 256> wanted{};
    for (int w = 0; w < wires; ++w) wanted[static_cast<std::size_t>(w)] = w >= begin && w < end;
    std::size_t kept = count;
    for (std::size_t i = count; i-- > 0;) {
      Comparator step = steps[i];
      step.wants_low = wanted[static_cast<std::size_t>(step.low)];
      step.wants_high = wanted[static_cast<std::size_t>(step.high)];
      if (!step.wants_low && !step.wants_high) continue;
      wanted[static_cast<std::size_t>(step.low)] = wanted[static_cast<std::size_t>(step.high)] = true;
      steps[--kept] = step;
    }
    for (std::size_t i = kept; i < count; ++i) steps[i - kept] = steps[i];
    count -= kept;
  }
};

/// Sorts n <= 32 values: merge exchange (D. E. Knuth, The Art of Computer Programming, vol. 3, 5.2.2, algorithm M,
/// after K. E. Batcher).
constexpr ComparatorList<256> sortingNetwork(int n) {
  ComparatorList<256> list;
  int top = 1;
  while (2 * top < n) top *= 2;
  for (int p = top; p > 0; p /= 2) {
    int q = top;
    int r = 0;
    for (int d = p; d > 0;) {
      for (int i = 0; i + d < n; ++i)
        if ((i & p) == r) list.add(i, i + d);
      d = q - p;
      q /= 2;
      r = p;
      if (q < p) break;
    }
  }
  return list;
}

namespace detail {

// Batcher's odd-even merge of every `step`-th of n wires from `first` on; wires outside [begin, end) hold
// infinities that stay where they are.
constexpr void oddEvenMerge(auto& list, int first, int n, int step, int begin, int end) {
  const auto add = [&](int low, int high) {
    if (low >= begin && high < end) list.add(low - begin, high - begin);
  };
  if (2 * step < n) {
    oddEvenMerge(list, first, n, 2 * step, begin, end);
    oddEvenMerge(list, first + step, n, 2 * step, begin, end);
    for (int i = first + step; i + step < first + n; i += 2 * step) add(i, i + step);
  } else {
    add(first, first + step);
  }
}

}  // namespace detail

/// Merges the ascending wires 0 .. a - 1 with the ascending wires a .. a + b - 1, as far as the wires
/// [begin, end) of the result need it (K. E. Batcher, Sorting networks and their applications, 1968).
constexpr ComparatorList<1024> mergingNetwork(int a, int b, int begin, int end) {
  int half = 1;
  while (half < a || half < b) half *= 2;
  ComparatorList<1024> list;
  detail::oddEvenMerge(list, 0, 2 * half, 1, half - a, half + b);
  list.prune(begin, end, a + b);
  return list;
}

}  // namespace fettle::engine

"""array_copy.py [SIDE] [REPEATS]: time of an array into a Field and out of it, beside numpy's own copy (memcpy).

Each is measured in turn, so that all meet the same load; the figures are medians, and ratios of the same turn. `copy` is
into new memory, as a field and an array that come out are new, too; `copy, warm` into memory that was used before, where
the system has no pages to clear."""

import statistics
import sys
import time

import numpy as np

import fettle


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 8192
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    heights = np.random.default_rng(0).random((side, side), dtype=np.float32)
    warm = np.empty_like(heights)
    warm[:] = heights
    field = fettle.Field(heights)

    def timed(work):
        begins = time.perf_counter()
        kept = work()
        took = time.perf_counter() - begins
        del kept
        return took

    ways = {
        "copy": heights.copy,
        "copy, warm": lambda: np.copyto(warm, heights),
        "in: Field(array)": lambda: fettle.Field(heights),
        "out: np.asarray(field)": lambda: np.asarray(field),
    }
    times = {name: [] for name in ways}
    for _ in range(repeats):
        for name, work in ways.items():
            times[name].append(timed(work))
    assert np.array_equal(np.asarray(field), heights)
    print(f"{side} x {side} samples, {heights.nbytes / 1e6:.0f} MB, median of {repeats} turns")
    print(f"{'':<26}{'ms':>9}{'GB/s':>8}{'to copy':>10}{'to warm copy':>14}")
    for name, taken in times.items():
        median = statistics.median(taken)
        ratios = [
            statistics.median(a / b for a, b in zip(taken, times[other])) for other in ("copy", "copy, warm")
        ]
        print(
            f"{name:<26}{1000 * median:9.1f}{heights.nbytes / median / 1e9:8.2f}{ratios[0]:10.2f}{ratios[1]:14.2f}"
        )


if __name__ == "__main__":
    main()

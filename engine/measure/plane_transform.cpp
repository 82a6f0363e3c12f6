#include "engine/measure/plane_transform.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <unsupported/Eigen/FFT>

namespace fettle::engine {

namespace {

using Value = std::complex<double>;

// What a thread needs for lines: Eigen's transforms keep their factors.
struct LineTransform {
  Eigen::FFT<double> transform;
  std::vector<Value> in, out;

  LineTransform() { transform.SetFlag(Eigen::FFT<double>::Unscaled); }
  void run(Transform direction, std::int32_t length) {
    out.resize(in.size());
    if (direction == Transform::kForward)
      transform.fwd(out.data(), in.data(), length);
    else
      transform.inv(out.data(), in.data(), length);
  }
};

}  // namespace

std::int32_t transformLength(std::int32_t least) noexcept {
  for (std::int32_t length = std::max(least, 1);; ++length) {
    std::int32_t rest = length;
    for (const std::int32_t factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return length;
  }
}

void transformPlane(std::vector<std::complex<double>>& values, std::int32_t width, std::int32_t height,
                    Transform direction, JobControl& job, std::int32_t rows) {
  tbb::enumerable_thread_specific<LineTransform> lines;
  const auto wide = static_cast<std::size_t>(width), high = static_cast<std::size_t>(height);
  const std::int32_t used = rows > 0 ? std::min(rows, height) : height;
  if (width > 1)
    tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, used), [&](const auto& range) {
      LineTransform& line = lines.local();
      for (std::int32_t r = range.begin(); r < range.end() && !job.cancelled(); ++r) {
        Value* const row = values.data() + static_cast<std::size_t>(r) * wide;
        line.in.assign(row, row + wide);
        line.run(direction, width);
        std::copy(line.out.begin(), line.out.end(), row);
      }
    });
  if (height == 1) return;
  // Some columns side by side, so that a cache line is read once.
  constexpr std::size_t kColumns = 8;
  const std::size_t groups = (wide + kColumns - 1) / kColumns;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups), [&](const auto& range) {
    LineTransform& line = lines.local();
    std::vector<Value> block(kColumns * high);
    for (std::size_t group = range.begin(); group < range.end() && !job.cancelled(); ++group) {
      const std::size_t first = group * kColumns, count = std::min(kColumns, wide - first);
      for (std::size_t r = 0; r < high; ++r)
        for (std::size_t c = 0; c < count; ++c) block[c * high + r] = values[r * wide + first + c];
      for (std::size_t c = 0; c < count; ++c) {
        Value* const column = block.data() + c * high;
        line.in.assign(column, column + high);
        line.run(direction, height);
        std::copy(line.out.begin(), line.out.end(), column);
      }
      for (std::size_t r = 0; r < high; ++r)
        for (std::size_t c = 0; c < count; ++c) values[r * wide + first + c] = block[c * high + r];
    }
  });
}

}  // namespace fettle::engine

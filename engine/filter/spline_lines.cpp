#include "engine/filter/spline_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/spline_lines-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr std::int32_t kLines = 32;  // side by side in takeRough

}  // namespace

// Variances of height and slope about the prediction, with noise of variance 1 on each sample and of a^-4 on each second
// difference. Slopes are multiplied by `step`, so that both have the same size.
SplineAxis::SplineAxis(double cut_off, std::int32_t count) : samples(count) {
  const double a = 0.5 / std::sin(std::numbers::pi / std::max(cut_off, 2.0)), a2 = a * a;
  step = std::clamp(a, 1.0, static_cast<double>(count));
  const auto size = static_cast<std::size_t>(count);
  to_height.resize(size), to_slope.resize(size), over_variance.resize(size);
  // After two samples: those of the second one, and of the difference.
  double height = 1.0, both = step, slope = 2.0 * step * step;
  const double bend = 1.0 / (a2 * a2);
  for (std::size_t i = 2; i < size; ++i) {
    height += (2.0 * both + slope / step) / step + bend;
    both += slope / step + bend * step;
    slope += bend * step * step;
    const double over = 1.0 / (height + 1.0);
    over_variance[i] = over;
    to_height[i] = height * over;
    to_slope[i] = both * over;
    slope -= both * to_slope[i];
    both *= over;
    height *= over;
  }
}

bool smoothPlane(const SplineAxis& x, const SplineAxis& y, SplinePlane& plane, CpuLevel level,
                 const JobControl& job) {
  const auto rough = FETTLE_AT_LEVEL(level, takeRough);
  tbb::enumerable_thread_specific<std::vector<double>> scratches;
  const auto lines = [&](const SplineAxis& axis, std::int32_t across, std::ptrdiff_t along,
                         std::ptrdiff_t next) {
    if (axis.samples < 3) return;
    tbb::parallel_for(std::int32_t{0}, (across + kLines - 1) / kLines, [&](std::int32_t part) {
      if (job.cancelled()) return;
      std::vector<double>& z = scratches.local();
      z.resize(static_cast<std::size_t>(axis.samples) * kLines);
      const std::int32_t first = part * kLines, count = std::min(kLines, across - first);
      double* const from = plane.z.data() + first * next;
      const auto each = [&](const auto& f) {
        // Whichever way values lie side by side.
        if (next == 1) {
          for (std::int32_t i = 0; i < axis.samples; ++i)
            for (std::int32_t k = 0; k < count; ++k)
              f(z[static_cast<std::size_t>(i) * kLines + k], from[i * along + k]);
        } else {
          constexpr std::int32_t kAtOnce = 8;
          for (std::int32_t i = 0; i < axis.samples; i += kAtOnce)
            for (std::int32_t k = 0; k < count; ++k)
              for (std::int32_t j = i; j < std::min(i + kAtOnce, axis.samples); ++j)
                f(z[static_cast<std::size_t>(j) * kLines + k], from[j * along + k * next]);
        }
      };
      // Beside the last lines the places keep what was in them: it is worked on too, and not read.
      each([](double& to, double value) { to = value; });
      rough(z.data(), axis.samples, axis.step, axis.to_height.data(), axis.to_slope.data(),
            axis.over_variance.data());
      each([](double taken, double& value) { value -= taken; });
    });
  };
  lines(x, plane.height, 1, plane.width);
  lines(y, plane.width, plane.width, 1);
  return !job.cancelled();
}

}  // namespace fettle::engine

#include "bench/accuracy/approximate_filters.h"

#include <algorithm>
#include <cmath>

namespace fettle::bench {
namespace {

// The plane transposed.
Plane turned(const Plane& in) {
  Plane out{in.height, in.width, std::vector<double>(in.z.size())};
  constexpr std::int32_t kBlock = 32;
  for (std::int32_t r0 = 0; r0 < in.height; r0 += kBlock)
    for (std::int32_t c0 = 0; c0 < in.width; c0 += kBlock)
      for (std::int32_t r = r0; r < std::min(r0 + kBlock, in.height); ++r)
        for (std::int32_t c = c0; c < std::min(c0 + kBlock, in.width); ++c) out.at(r, c) = in.at(c, r);
  return out;
}

Plane floatRows(const Plane& in, const std::vector<float>& weights) {
  Plane out = in;
  const int radius = static_cast<int>(weights.size()) - 1;
  for (std::int32_t r = 0; r < in.height; ++r)
    for (std::int32_t c = 0; c < in.width; ++c) {
      float sum = 0.0F, weight = 0.0F;
      for (int d = std::max(-radius, -c); d <= std::min(radius, in.width - 1 - c); ++d) {
        const float w = weights[static_cast<std::size_t>(std::abs(d))];
        sum += w * static_cast<float>(in.at(c + d, r));
        weight += w;
      }
      out.at(c, r) = sum / weight;
    }
  return out;
}

struct Recursion {
  double gain, b1, b2, b3;
};

Recursion recursionOf(double sigma) {
  const double q =
      sigma >= 2.5 ? 0.98711 * sigma - 0.96330 : 3.97156 - 4.14554 * std::sqrt(1.0 - 0.26891 * sigma);
  const double b0 = 1.57825 + 2.44413 * q + 1.4281 * q * q + 0.422205 * q * q * q;
  const double b1 = (2.44413 * q + 2.85619 * q * q + 1.26661 * q * q * q) / b0;
  const double b2 = -(1.4281 * q * q + 1.26661 * q * q * q) / b0;
  const double b3 = 0.422205 * q * q * q / b0;
  return {1.0 - (b1 + b2 + b3), b1, b2, b3};
}

void recursiveRows(Plane& plane, const Recursion& f) {
  for (std::int32_t r = 0; r < plane.height; ++r) {
    double* z = &plane.at(0, r);
    double y1 = z[0], y2 = z[0], y3 = z[0];
    for (std::int32_t c = 0; c < plane.width; ++c) {
      const double y = f.gain * z[c] + f.b1 * y1 + f.b2 * y2 + f.b3 * y3;
      y3 = y2;
      y2 = y1;
      y1 = z[c] = y;
    }
    y1 = y2 = y3 = z[plane.width - 1];
    for (std::int32_t c = plane.width - 1; c >= 0; --c) {
      const double y = f.gain * z[c] + f.b1 * y1 + f.b2 * y2 + f.b3 * y3;
      y3 = y2;
      y2 = y1;
      y1 = z[c] = y;
    }
  }
}

Plane medianRows(const Plane& in, int radius) {
  Plane out = in;
  std::vector<double> window;
  for (std::int32_t r = 0; r < in.height; ++r)
    for (std::int32_t c = 0; c < in.width; ++c) {
      const double* from = &in.z[static_cast<std::size_t>(r) * static_cast<std::size_t>(in.width)];
      window.assign(from + std::max(0, c - radius), from + std::min(in.width, c + radius + 1));
      const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
      std::nth_element(window.begin(), middle, window.end());
      out.at(c, r) = *middle;
    }
  return out;
}

}  // namespace

Plane gaussianInFloat(const Plane& in, double sigma, int radius) {
  std::vector<float> weights;
  for (int d = 0; d <= radius; ++d)
    weights.push_back(static_cast<float>(std::exp(-d * d / (2 * sigma * sigma))));
  return turned(floatRows(turned(floatRows(in, weights)), weights));
}

Plane gaussianRecursive(const Plane& in, double sigma) {
  const Recursion f = recursionOf(sigma);
  Plane out = in;
  recursiveRows(out, f);
  out = turned(out);
  recursiveRows(out, f);
  return turned(out);
}

Plane medianSeparable(const Plane& in, int radius) {
  return turned(medianRows(turned(medianRows(in, radius)), radius));
}

Plane medianOfLevels(const Plane& in, int radius, int levels) {
  const auto [low_at, high_at] = std::minmax_element(in.z.begin(), in.z.end());
  const double low = *low_at, step = (*high_at - low) / (levels - 1);
  std::vector<std::int32_t> level(in.z.size());
  for (std::size_t i = 0; i < in.z.size(); ++i)
    level[i] = step > 0.0 ? static_cast<std::int32_t>(std::lround((in.z[i] - low) / step)) : 0;
  Plane out = in;
  std::vector<std::int32_t> counts(static_cast<std::size_t>(levels));
  for (std::int32_t r = 0; r < in.height; ++r) {
    std::fill(counts.begin(), counts.end(), 0);
    const std::int32_t top = std::max(0, r - radius), bottom = std::min(in.height - 1, r + radius);
    std::int32_t total = 0, below = 0, middle = 0;  // below: of levels under `middle`
    const auto column = [&](std::int32_t c, std::int32_t by) {
      for (std::int32_t y = top; y <= bottom; ++y) {
        const std::int32_t at = level[static_cast<std::size_t>(y) * static_cast<std::size_t>(in.width) +
                                      static_cast<std::size_t>(c)];
        counts[static_cast<std::size_t>(at)] += by;
        below += at < middle ? by : 0;
      }
      total += by * (bottom - top + 1);
    };
    for (std::int32_t c = 0; c < std::min(radius, in.width); ++c) column(c, 1);
    for (std::int32_t c = 0; c < in.width; ++c) {
      if (c + radius < in.width) column(c + radius, 1);
      if (c - radius - 1 >= 0) column(c - radius - 1, -1);
      const std::int32_t rank = (total - 1) / 2;
      while (below > rank) below -= counts[static_cast<std::size_t>(--middle)];
      while (below + counts[static_cast<std::size_t>(middle)] <= rank)
        below += counts[static_cast<std::size_t>(middle++)];
      out.at(c, r) = low + step * middle;
    }
  }
  return out;
}

}  // namespace fettle::bench

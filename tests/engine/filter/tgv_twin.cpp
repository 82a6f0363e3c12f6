#include "tests/engine/filter/tgv_twin.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fettle::engine::tests {
namespace {

constexpr double kCutLink = 1e-18;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

struct Map {
  int w, h;
  std::vector<double> v;
  Map(int width, int height, double value = 0.0)
      : w(width), h(height), v(static_cast<std::size_t>(width) * height, value) {}
  double& operator()(int c, int r) { return v[static_cast<std::size_t>(r) * w + c]; }
  // NaN beyond the border.
  [[nodiscard]] double get(int c, int r) const {
    return c >= 0 && r >= 0 && c < w && r < h ? v[static_cast<std::size_t>(r) * w + c] : kNone;
  }
  [[nodiscard]] double orZero(int c, int r) const { return c >= 0 && r >= 0 ? get(c, r) : 0.0; }
};

// Whether z continues the nearer of two groups of heights, which their largest gap divides.
bool joinsASide(std::vector<float> next, float z) {
  const int n = static_cast<int>(next.size());
  if (n < 4) return false;
  std::ranges::sort(next);
  float widest = 0.0F;
  for (int i = 1; i < n; ++i) widest = std::max(widest, next[i] - next[i - 1]);
  for (int i = 1; i < n; ++i)
    for (const bool low : {true, false}) {
      if (next[i] - next[i - 1] < widest) continue;
      const float in_gap = low ? z - next[i - 1] : next[i] - z, other = low ? next[i] - z : z - next[i - 1];
      if (in_gap > other) continue;
      std::vector<float> side = low ? std::vector<float>(next.begin(), next.begin() + i)
                                    : std::vector<float>(next.rbegin(), next.rend() - i);
      const float past = low ? side.front() - z : z - side.front();
      if (in_gap <= 0.0F && past <= 0.0F) {
        if (side.size() > 1) return true;
        continue;
      }
      if (side.size() < 2) continue;
      const float spread = std::fabs(side[side.size() - (side.size() > 3 ? 2 : 1)] - side.front());
      if (in_gap <= 2.0F * spread && past < spread) return true;
    }
  return false;
}

bool sticksOut(const Map& f, int c, int r) {
  int above = 0, below = 0, all = 0;
  const float z = static_cast<float>(f.get(c, r));
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const float near = static_cast<float>(f.get(c + x, r + y));
      if (std::isnan(near)) continue;
      ++all;
      above += !(near > z + 4.0F);
      below += !(near < z - 4.0F);
    }
  return above == all || below == all;
}

// In float, as a field of whole numbers has many samples just at the bounds.
bool isLone(const Map& f, int c, int r) {
  const auto at = [&f](int column, int row) { return static_cast<float>(f.get(column, row)); };
  const float z = at(c, r);
  int count = 0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      if (x != 0 || y != 0) count += std::fabs(at(c + x, r + y) - z) <= 4.0F;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      if (x == 0 && y == 0) continue;
      const float a = at(c + x, r + y), b = at(c + 2 * x, r + 2 * y), d = at(c + 3 * x, r + 3 * y);
      const float slope = std::fabs(a - b);
      const float line = std::fabs(2.0F * a - b - z), parabola = std::fabs(3.0F * (a - b) + d - z);
      if (line <= 4.0F + 0.1F * slope || parabola <= 6.0F + 0.1F * slope)
        count += 2;
      else if (line <= 8.0F + 0.3F * slope || parabola <= 12.0F + 0.3F * slope)
        count += 1;
    }
  std::vector<float> next;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      if ((x != 0 || y != 0) && !std::isnan(at(c + x, r + y))) next.push_back(at(c + x, r + y));
  const bool twin = std::ranges::any_of(next, [z](float near) { return std::fabs(near - z) <= 4.0F; });
  return count < 3 && !joinsASide(next, z) && !(twin && sticksOut(f, c, r));
}

// Of heights in noises over a middle one, of one square and its halo, the surface; lone samples become holes of f.
Map solve(Map& f, const TgvTwin& twin) {
  const int w = f.w, h = f.h;
  Map u(w, h), u2(w, h), x(w, h), y(w, h), p(w, h), q(w, h), xx(w, h), yy(w, h), xy(w, h), wp(w, h), wq(w, h),
      wv(w, h, 4.4);
  const Map scan = f;
  for (int r = 0; r < h; ++r)
    for (int c = 0; c < w; ++c) {
      const bool here = !std::isnan(scan.get(c, r));
      u(c, r) = here ? scan.get(c, r) : 0.0;
      wp(c, r) = here && !std::isnan(scan.get(c + 1, r)) ? 2.2 : 0.0;
      wq(c, r) = here && !std::isnan(scan.get(c, r + 1)) ? 2.2 : 0.0;
    }
  std::vector<std::vector<int>> cut(h, std::vector<int>(w, 0));
  for (int r = 0; r < h && twin.cuts != nullptr; ++r)
    for (const LineCut& each : twin.cuts->row(r)) {
      cut[r][each.column] = each.links;
      if ((each.links & LineCut::kRight) != 0) wp(each.column, r) = kCutLink;
      if ((each.links & LineCut::kUp) != 0) wq(each.column, r) = kCutLink;
    }
  // Whether a window has both ends of a cut link.
  const auto isOverLine = [&](int c, int r, int radius) {
    for (int b = std::max(r - radius, 0); b <= std::min(r + radius, h - 1); ++b)
      for (int a = std::max(c - radius, 0); a <= std::min(c + radius, w - 1); ++a)
        if ((a < c + radius && (cut[b][a] & LineCut::kRight) != 0) ||
            (b < r + radius && (cut[b][a] & LineCut::kUp) != 0))
          return true;
    return false;
  };
  std::vector<std::pair<int, int>> lone;
  for (int r = 0; r < h && twin.lone; ++r)
    for (int c = 0; c < w; ++c)
      if (!std::isnan(scan.get(c, r)) && isLone(scan, c, r)) lone.emplace_back(c, r);
  const auto between = [&](const auto& at) { return !sticksOut(scan, at.first, at.second); };
  if (std::ranges::count_if(lone, between) < 4) std::erase_if(lone, between);
  for (const auto& [c, r] : lone) f(c, r) = kNone;
  for (const auto& [c, r] : lone) {
    std::vector<double> around;
    for (int b = r - 2; b <= r + 2; ++b)
      for (int a = c - 2; a <= c + 2; ++a)
        if (!std::isnan(f.get(a, b))) around.push_back(f.get(a, b));
    if (!around.empty()) u(c, r) = median(around);
  }
  u2 = u;
  for (const int radius : {2, 3}) {
    const double n = (2 * radius + 1) * (2 * radius + 1), spread = n * radius * (radius + 1) / 3.0;
    Map fitted_x(w, h, kNone), fitted_y(w, h, kNone);
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c) {
        if (isOverLine(c, r, radius)) continue;
        double m = 0, mm = 0, mx = 0, my = 0;
        for (int b = -radius; b <= radius; ++b)
          for (int a = -radius; a <= radius; ++a) {
            const double z = f.get(c + a, r + b) - f.get(c, r);
            m += z, mm += z * z, mx += a * z, my += b * z;
          }
        if (!(mm - m * m / n - (mx * mx + my * my) / spread <= n - 3 + 2.5 * std::sqrt(2 * (n - 3))))
          continue;
        fitted_x(c, r) = mx / spread;
        fitted_y(c, r) = my / spread;
      }
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c) {
        double mx = fitted_x(c, r), my = fitted_y(c, r), count = 1;
        if (std::isnan(mx)) {
          mx = my = count = 0;
          for (int b = r - radius; b <= r + radius; ++b)
            for (int a = c - radius; a <= c + radius; ++a)
              if (!std::isnan(fitted_x.get(a, b))) mx += fitted_x(a, b), my += fitted_y(a, b), ++count;
          if (isOverLine(c, r, radius) ? count < 2 * radius + 1 : 2 * count < n) continue;
        }
        x(c, r) = mx / count;
        y(c, r) = my / count;
      }
  }
  Map x2 = x, y2 = y;
  const double primal = twin.balance / std::sqrt(12.0), dual = 1.0 / (twin.balance * std::sqrt(12.0));
  const auto bent = [&](const Map& a, const Map& b, int c, int r, double(&e)[3]) {
    const bool right = wp(c, r) > 0, up = wq(c, r) > 0;
    e[0] = right ? a.get(c + 1, r) - a.get(c, r) : 0.0;
    e[1] = up ? b.get(c, r + 1) - b.get(c, r) : 0.0;
    e[2] = 0.5 * ((right ? b.get(c + 1, r) - b.get(c, r) : 0.0) + (up ? a.get(c, r + 1) - a.get(c, r) : 0.0));
  };
  const auto steps = [&](int count) {
    for (int k = 0; k < count; ++k) {
      for (int r = 0; r < h; ++r)
        for (int c = 0; c < w; ++c) {
          const double a = wp(c, r) > 0 ? u2.get(c + 1, r) - u2(c, r) - x2(c, r) : 0.0;
          const double b = wq(c, r) > 0 ? u2.get(c, r + 1) - u2(c, r) - y2(c, r) : 0.0;
          p(c, r) = std::clamp(p(c, r) + dual * a, -wp(c, r), wp(c, r));
          q(c, r) = std::clamp(q(c, r) + dual * b, -wq(c, r), wq(c, r));
          double e[3];
          bent(x2, y2, c, r, e);
          const double s = xx(c, r) + dual * e[0], t = yy(c, r) + dual * e[1], d = xy(c, r) + dual * e[2];
          const double shorter = wv(c, r) / std::max(wv(c, r), std::sqrt(s * s + t * t + 2 * d * d));
          xx(c, r) = s * shorter, yy(c, r) = t * shorter, xy(c, r) = d * shorter;
        }
      for (int r = 0; r < h; ++r)
        for (int c = 0; c < w; ++c) {
          const double flow = p(c, r) - p.orZero(c - 1, r) + q(c, r) - q.orZero(c, r - 1);
          const double moved = u(c, r) + primal * flow;
          const double is = std::isnan(f(c, r)) ? moved : (moved + primal * f(c, r)) / (1 + primal);
          u2(c, r) = 2 * is - u(c, r);
          u(c, r) = is;
          const double is_x =
              x(c, r) + primal * (p(c, r) + xx(c, r) - xx.orZero(c - 1, r) + xy(c, r) - xy.orZero(c, r - 1));
          const double is_y =
              y(c, r) + primal * (q(c, r) + xy(c, r) - xy.orZero(c - 1, r) + yy(c, r) - yy.orZero(c, r - 1));
          x2(c, r) = 2 * is_x - x(c, r), y2(c, r) = 2 * is_y - y(c, r);
          x(c, r) = is_x, y(c, r) = is_y;
        }
    }
  };
  steps(twin.first_steps);
  for (int round = 0; round < twin.rounds; ++round) {
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c) {
        double e[3];
        bent(x, y, c, r, e);
        if (wp(c, r) > kCutLink)
          wp(c, r) = 2.2 * 0.5 / (std::fabs(u.get(c + 1, r) - u(c, r) - x(c, r)) + 0.5);
        if (wq(c, r) > kCutLink)
          wq(c, r) = 2.2 * 0.5 / (std::fabs(u.get(c, r + 1) - u(c, r) - y(c, r)) + 0.5);
        wv(c, r) = 4.4 * 0.1 / (std::sqrt(e[0] * e[0] + e[1] * e[1] + 2 * e[2] * e[2]) + 0.1);
      }
    steps(twin.round_steps);
  }
  return u;
}

}  // namespace

std::vector<double> tgvTwin(const PlainField& field, double noise, const TgvTwin& twin) {
  std::vector<double> out(field.z.size(), kNone);
  const int side = twin.side > 0 ? twin.side : std::max(field.width, field.height);
  for (int r0 = 0; r0 < field.height; r0 += side)
    for (int c0 = 0; c0 < field.width; c0 += side) {
      const int left = std::max(c0 - twin.halo, 0), low = std::max(r0 - twin.halo, 0);
      const int c1 = std::min(c0 + side, field.width), r1 = std::min(r0 + side, field.height);
      Map f(std::min(c1 + twin.halo, field.width) - left, std::min(r1 + twin.halo, field.height) - low);
      std::vector<double> known;
      for (int r = 0; r < f.h; ++r)
        for (int c = 0; c < f.w; ++c) {
          f(c, r) = field.at(left + c, low + r);
          if (!std::isnan(f(c, r))) known.push_back(f(c, r));
        }
      if (known.empty()) continue;
      const double middle = median(known);
      for (double& z : f.v)
        z = std::isnan(z) ? z : static_cast<float>(std::clamp((z - middle) / noise, -1e15, 1e15));
      const Map u = solve(f, twin);
      for (int r = r0; r < r1; ++r)
        for (int c = c0; c < c1; ++c)
          if (!std::isnan(field.at(c, r))) {
            const double known_here = f.get(c - left, r - low), is = u.get(c - left, r - low);
            out[static_cast<std::size_t>(r) * field.width + c] =
                std::isnan(known_here) ? middle + noise * is : field.at(c, r) + noise * (is - known_here);
          }
    }
  return out;
}

}  // namespace fettle::engine::tests

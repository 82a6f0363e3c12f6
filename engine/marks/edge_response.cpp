// Derivatives by Gaussian kernels: Canny, A Computational Approach to Edge Detection (1986), section VI, for
// steps; Steger, An Unbiased Detector of Curvilinear Structures (1998), section 2, for lines of curvature.
// Departures: a step is measured against the slope around it, since a height field has slopes that are not
// edges; both are in units of the field's own noise (edge_suggestion.h).
#include "engine/marks/edge_response.h"

#include <algorithm>
#include <cmath>

namespace fettle::engine {

EdgeResponse::EdgeResponse(double sigma, Scatter scatter)
    : scatter_(scatter),
      side_(std::max(1, static_cast<int>(std::lround(2.0 * sigma)))),
      kernels_(edgeKernels(sigma)),
      surface_(sigma, kernels_.radius),
      margin_(side_ + 1 + kernels_.radius + surface_.fillReach()) {}

bool EdgeResponse::run(const FieldReader& field, std::int32_t column, std::int32_t row, int columns, int rows,
                       const JobControl& job) {
  const int wide = columns + 2 * margin_, tall = rows + 2 * margin_;
  if (!surface_.read(field, column - margin_, row - margin_, wide, tall, job) || job.cancelled())
    return false;
  derivatives_.take(surface_, kernels_, wide, tall);
  measure(columns, rows);
  return true;
}

void EdgeResponse::measure(int columns, int rows) {
  const std::vector<float>&gx_all = derivatives_.gx, &gy_all = derivatives_.gy;
  const int wide = columns + 2 * margin_;
  const auto at = [wide](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(wide) + static_cast<std::size_t>(c);
  };
  const std::size_t n = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (std::vector<float>* v : {&step, &crease, &step_x, &step_y, &crease_x, &crease_y}) v->assign(n, 0.0F);
  whole.assign(n, 0);
  const bool scatter = scatter_ == Scatter::kMeasure;
  if (scatter)
    for (std::vector<float>* v : {&step_in_x, &step_in_y, &bend_in_x, &bend_in_y}) v->assign(n, 0.0F);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int x = c + margin_, y = r + margin_;
      const std::size_t i = at(x, y);
      if (surface_.valid[i] == 0) continue;
      const std::size_t o = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + c;
      // The last half per mille of the share is rounding.
      const float share = surface_.holes ? derivatives_.share[i] : 1.0F;
      whole[o] = share > 0.9995F;
      const float gx = gx_all[i], gy = gy_all[i];
      const float slope = std::sqrt(gx * gx + gy * gy);
      if (slope > 0.0F) {
        const float nx = gx / slope, ny = gy / slope;
        const int dx = static_cast<int>(std::lround(nx * static_cast<float>(side_)));
        const int dy = static_cast<int>(std::lround(ny * static_cast<float>(side_)));
        // Without a surface there, the slope of the surroundings is taken as that of the sample.
        const auto slopeAt = [&](std::size_t j) {
          return surface_.valid[j] ? gx_all[j] * nx + gy_all[j] * ny : slope;
        };
        step[o] = share *
                  std::max(0.0F, slope - 0.5F * (slopeAt(at(x + dx, y + dy)) + slopeAt(at(x - dx, y - dy))));
        step_x[o] = nx;
        step_y[o] = ny;
      }
      if (scatter) {
        step_in_x[o] = gx - 0.5F * (gx_all[at(x + side_, y)] + gx_all[at(x - side_, y)]);
        step_in_y[o] = gy - 0.5F * (gy_all[at(x, y + side_)] + gy_all[at(x, y - side_)]);
        bend_in_x[o] = derivatives_.hxx[i];
        bend_in_y[o] = derivatives_.hyy[i];
      }
      const float mean = 0.5F * (derivatives_.hxx[i] + derivatives_.hyy[i]),
                  half = 0.5F * (derivatives_.hxx[i] - derivatives_.hyy[i]), mixed = derivatives_.hxy[i];
      const float root = std::sqrt(half * half + mixed * mixed);
      crease[o] = share * (std::fabs(mean) + root);
      // Eigenvector of mean + root or mean - root, whichever is larger in size; from the larger of its two
      // forms, since the other may be zero.
      const float l = mean >= 0.0F ? root : -root;  // eigenvalue less the mean
      float vx = mixed, vy = l - half;
      if (std::fabs(l + half) > std::fabs(vy)) vx = l + half, vy = mixed;
      const float length = std::sqrt(vx * vx + vy * vy);
      if (length > 0.0F) {
        crease_x[o] = vx / length;
        crease_y[o] = vy / length;
      } else {
        crease_x[o] = 1.0F;
      }
    }
}

}  // namespace fettle::engine

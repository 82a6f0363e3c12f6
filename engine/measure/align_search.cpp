#include "engine/measure/align_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <Eigen/Dense>
#include <glm/vec2.hpp>

#include "engine/measure/plane_transform.h"

namespace fettle::engine {

namespace {

using Plane = std::vector<std::complex<double>>;

// A map on square cells, with 0 and mask 0 at holes.
struct Raster {
  std::int32_t width = 0, height = 0;
  glm::dvec2 first{0.0};  // position of cell (0, 0) [mm]
  std::vector<double> z, mask;
};

constexpr double kLeastShare = 0.2;  // of the smaller map that both have in common
constexpr double kRadian = std::numbers::pi / 180.0;

// A map without its plane, or without its long waves, without spikes.
HeightMap flattened(const HeightMap& map, bool long_waves_too) {
  HeightMap out = map;
  if (long_waves_too) {
    const double sigma = 0.1 * std::max(map.width * map.spacing_x, map.height * map.spacing_y);
    const SmoothMap waves = smoothed(map, sigma, AtHoles::kStay, Borders::kStay);
    for (std::size_t i = 0; i < out.z.size(); ++i) out.z[i] -= waves.value.z[i];
  } else {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::int32_t r = 0; r < map.height; ++r)
      for (std::int32_t c = 0; c < map.width; ++c) {
        const double z = map.at(c, r);
        if (std::isnan(z)) continue;
        const Eigen::Vector3d row(1.0, c - 0.5 * (map.width - 1), r - 0.5 * (map.height - 1));
        normal += row * row.transpose();
        right += row * z;
      }
    const Eigen::Vector3d plane = normal.completeOrthogonalDecomposition().solve(right);
    for (std::int32_t r = 0; r < map.height; ++r)
      for (std::int32_t c = 0; c < map.width; ++c)
        out.z[map.index(c, r)] -=
            plane[0] + plane[1] * (c - 0.5 * (map.width - 1)) + plane[2] * (r - 0.5 * (map.height - 1));
  }
  clipSpikes(out);
  return out;
}

// A map, turned about its middle, on cells of `cell` mm.
Raster rasterOf(const MapSpline& spline, const HeightMap& map, double cell, double angle) {
  const glm::dvec2 size((map.width - 1) * map.spacing_x, (map.height - 1) * map.spacing_y);
  const glm::dvec2 middle = glm::dvec2(map.x0, map.y0) + 0.5 * size;
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const glm::dvec2 turned(std::abs(cosine) * size.x + std::abs(sine) * size.y,
                          std::abs(sine) * size.x + std::abs(cosine) * size.y);
  Raster raster;
  raster.width = static_cast<std::int32_t>(turned.x / cell) + 1;
  raster.height = static_cast<std::int32_t>(turned.y / cell) + 1;
  raster.first = -0.5 * cell * glm::dvec2(raster.width - 1, raster.height - 1);
  const auto cells = static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
  raster.z.assign(cells, 0.0);
  raster.mask.assign(cells, 0.0);
  for (std::int32_t r = 0; r < raster.height; ++r)
    for (std::int32_t c = 0; c < raster.width; ++c) {
      const glm::dvec2 at = raster.first + cell * glm::dvec2(c, r);
      const MapSpline::Place place =
          spline.at(middle.x + cosine * at.x + sine * at.y, middle.y - sine * at.x + cosine * at.y);
      if (!place.there) continue;
      const std::size_t i =
          static_cast<std::size_t>(r) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(c);
      raster.z[i] = place.z;
      raster.mask[i] = 1.0;
    }
  return raster;
}

// Transforms of mask, heights and squares of a raster; with `kMirrored` conjugated, so that products correlate.
struct Transforms {
  Plane mask, z, square;
};
Transforms transformsOf(const Raster& raster, std::int32_t width, std::int32_t height, JobControl& job) {
  const auto places = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Transforms out{Plane(places), Plane(places), Plane(places)};
  for (std::int32_t r = 0; r < raster.height; ++r)
    for (std::int32_t c = 0; c < raster.width; ++c) {
      const std::size_t from = static_cast<std::size_t>(r) * static_cast<std::size_t>(raster.width) +
                               static_cast<std::size_t>(c),
                        to = static_cast<std::size_t>(r) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(c);
      out.mask[to] = raster.mask[from];
      out.z[to] = raster.z[from];
      out.square[to] = raster.z[from] * raster.z[from];
    }
  for (Plane* plane : {&out.mask, &out.z, &out.square})
    transformPlane(*plane, width, height, Transform::kForward, job, raster.height);
  return out;
}

struct Candidate {
  double score = 0.0, angle = 0.0;
  glm::dvec2 middle{0.0};  // to which the second map's middle is moved [mm]
};

class Correlator {
 public:
  Correlator(const Raster& first, double cell, std::int32_t most_columns, std::int32_t most_rows,
             JobControl& job)
      : cell_(cell),
        first_(first),
        width_(transformLength(first.width + most_columns)),
        height_(transformLength(first.height + most_rows)),
        job_(job),
        transforms_(transformsOf(first, width_, height_, job)) {
    for (const double m : first.mask) places_ += m;
  }

  // The greatest correlations with a raster, each the greatest among its neighbours.
  void add(const Raster& second, double angle, std::vector<Candidate>& out) const {
    const Transforms other = transformsOf(second, width_, height_, job_);
    double own = 0.0;
    for (const double m : second.mask) own += m;
    const std::size_t places = transforms_.z.size();
    // Two real planes a transform: products of the first's with the second's conjugates.
    const auto correlated = [&](const Plane& a, const Plane& b, const Plane& c, const Plane& d) {
      Plane product(places);
      for (std::size_t i = 0; i < places; ++i)
        product[i] = a[i] * std::conj(b[i]) + std::complex<double>(0.0, 1.0) * c[i] * std::conj(d[i]);
      transformPlane(product, width_, height_, Transform::kBackward, job_);
      for (std::complex<double>& value : product) value /= static_cast<double>(places);
      return product;
    };
    const Transforms& t = transforms_;
    const Plane counts = correlated(t.mask, other.mask, t.z, other.z);
    const Plane sums = correlated(t.z, other.mask, t.mask, other.z);
    const Plane squares = correlated(t.square, other.mask, t.mask, other.square);
    const double least = kLeastShare * std::min(places_, own), whole = std::min(places_, own);
    std::vector<double> score(places, -1.0);
    for (std::size_t i = 0; i < places; ++i) {
      const double n = counts[i].real();
      if (n < std::max(least, 9.0)) continue;
      const double a = squares[i].real() - sums[i].real() * sums[i].real() / n;
      const double b = squares[i].imag() - sums[i].imag() * sums[i].imag() / n;
      const double ab = counts[i].imag() - sums[i].real() * sums[i].imag() / n;
      // What rounding leaves of a flat part is no variance.
      if (!(a > 1e-9 * squares[i].real() && b > 1e-9 * squares[i].imag())) continue;
      score[i] = ab / std::sqrt(a * b) * std::pow(n / whole, 0.25);
    }
    const auto at = [&](std::int32_t c, std::int32_t r) {
      c = (c + width_) % width_;
      r = (r + height_) % height_;
      return score[static_cast<std::size_t>(r) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(c)];
    };
    for (std::int32_t r = 0; r < height_; ++r)
      for (std::int32_t c = 0; c < width_; ++c) {
        const double here = at(c, r);
        if (!(here > 0.0)) continue;
        bool greatest = true;
        for (std::int32_t j = -1; j <= 1 && greatest; ++j)
          for (std::int32_t i = -1; i <= 1 && greatest; ++i) greatest = at(c + i, r + j) <= here;
        if (!greatest) continue;
        const glm::dvec2 cells(c < first_.width ? c : c - width_, r < first_.height ? r : r - height_);
        out.push_back({here, angle, first_.first + cell_ * cells - second.first});
      }
  }

 private:
  double cell_;
  const Raster& first_;
  std::int32_t width_, height_;
  JobControl& job_;
  Transforms transforms_;
  double places_ = 0.0;
};

}  // namespace

void clipSpikes(HeightMap& map) {
  constexpr double kClip = 3.0 * 1.4826;
  std::vector<double> sizes;
  for (const double z : map.z)
    if (!std::isnan(z)) sizes.push_back(std::abs(z));
  if (sizes.empty()) return;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  // Most of a plate is flat: then what stands out is all there is.
  if (const double limit = kClip * *middle; limit > 0.0)
    for (double& z : map.z) z = std::clamp(z, -limit, limit);
}

std::vector<RigidMotion> likelyMotions(const HeightMap& first, const HeightMap& second,
                                       double most_rotation_deg, const glm::dvec3& centre, JobControl& job) {
  constexpr double kCells = 64.0, kMostCells = 160.0, kStepDeg = 3.0;
  constexpr std::size_t kMostOfOne = 4, kMost = 8;
  const auto sideOf = [](const HeightMap& map) {
    return std::max((map.width - 1) * map.spacing_x, (map.height - 1) * map.spacing_y);
  };
  const double longer = std::max(sideOf(first), sideOf(second)),
               shorter = std::max(std::min(sideOf(first), sideOf(second)), 1e-9 * longer);
  const double cell = longer / std::clamp(kCells * longer / shorter, kCells, kMostCells);
  const glm::dvec2 first_middle =
      glm::dvec2(first.x0, first.y0) +
      0.5 * glm::dvec2((first.width - 1) * first.spacing_x, (first.height - 1) * first.spacing_y);
  const glm::dvec2 second_middle =
      glm::dvec2(second.x0, second.y0) +
      0.5 * glm::dvec2((second.width - 1) * second.spacing_x, (second.height - 1) * second.spacing_y);
  const int steps = static_cast<int>(std::ceil(most_rotation_deg / kStepDeg));
  std::vector<Candidate> chosen;
  job.begin("searching", static_cast<std::uint64_t>(2 * (2 * steps + 1)));
  for (const bool long_waves_too : {false, true}) {
    const HeightMap a = flattened(first, long_waves_too), b = flattened(second, long_waves_too);
    const auto splineOf = [&](const HeightMap& map) {
      return MapSpline(smoothed(map, 0.6 * cell, AtHoles::kFill, Borders::kStay).value);
    };
    const MapSpline of_first = splineOf(a), of_second = splineOf(b);
    const Raster still = rasterOf(of_first, a, cell, 0.0);
    const auto most = static_cast<std::int32_t>(std::numbers::sqrt2 * sideOf(second) / cell) + 2;
    const Correlator correlator(still, cell, most, most, job);
    std::vector<Candidate> found;
    for (int step = -steps; step <= steps && !job.cancelled(); ++step) {
      const double angle = steps == 0 ? 0.0 : step * most_rotation_deg / steps * kRadian;
      std::vector<Candidate> here;
      correlator.add(rasterOf(of_second, b, cell, angle), angle, here);
      std::ranges::stable_sort(here, std::greater<>(), &Candidate::score);
      here.resize(std::min(here.size(), kMostOfOne));
      found.insert(found.end(), here.begin(), here.end());
      job.advance();
    }
    std::ranges::stable_sort(found, std::greater<>(), &Candidate::score);
    std::size_t taken = 0;
    for (const Candidate& candidate : found) {
      const bool near_another = std::ranges::any_of(chosen, [&](const Candidate& other) {
        return std::abs(candidate.middle.x - other.middle.x) < 3.0 * cell &&
               std::abs(candidate.middle.y - other.middle.y) < 3.0 * cell &&
               std::abs(candidate.angle - other.angle) < 1.5 * kStepDeg * kRadian;
      });
      if (near_another) continue;
      chosen.push_back(candidate);
      if (++taken == kMost) break;
    }
  }
  std::vector<RigidMotion> motions;
  motions.reserve(chosen.size());
  for (const Candidate& candidate : chosen) {
    RigidMotion motion = RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), centre}.then(
        glm::dvec3(0.0), glm::dvec3(0.0, 0.0, candidate.angle));
    const glm::dvec3 middle(second_middle, centre.z);
    const glm::dvec2 to = first_middle + candidate.middle;
    const glm::dvec3 moved = motion.moved(middle);
    motion.shift = glm::dvec3(to.x - moved.x, to.y - moved.y, 0.0);
    motions.push_back(motion);
  }
  return motions;
}

}  // namespace fettle::engine

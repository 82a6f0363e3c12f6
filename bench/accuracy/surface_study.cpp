#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "engine/base/statistics.h"
#include "engine/base/stopwatch.h"
#include "haptic/contact/certified.h"
#include "haptic/contact/patch.h"

namespace fettle::bench {
namespace {

template <class T>
using Vec = glm::vec<3, T, glm::defaultp>;

// Closest point of a triangle: Ericson, Real-Time Collision Detection (2005), section 5.1.5.
template <class T>
Vec<T> closestOnTriangle(const Vec<T>& p, const Vec<T>& a, const Vec<T>& b, const Vec<T>& c) {
  const Vec<T> ab = b - a, ac = c - a, ap = p - a;
  const T d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec<T> bp = p - b;
  const T d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const T vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec<T> cp = p - c;
  const T d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const T vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const T va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const T scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

// The four corners of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
template <class T>
using Corners = std::array<Vec<T>, 4>;

template <class T>
Corners<T> cornersOf(const haptic::Patch& p) {
  const auto at = [&](double u, double v) { return Vec<T>(p.at(u, v)); };
  return {at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
}

template <class T>
glm::dvec3 ofTriangles(const haptic::Patch& patch, const glm::dvec3& e) {
  const Corners<T> c = cornersOf<T>(patch);
  const Vec<T> p(e);
  const Vec<T> one = closestOnTriangle(p, c[0], c[1], c[3]), two = closestOnTriangle(p, c[0], c[3], c[2]);
  const Vec<T> to_one = one - p, to_two = two - p;
  return glm::dvec3(glm::dot(to_one, to_one) <= glm::dot(to_two, to_two) ? one : two);
}

// Newton's method on the bilinear patch, clamped to the unit square one coordinate at a time: the computation
// of a tick inside one cell, with `steps` steps, in T throughout.
template <class T>
glm::dvec3 ofBilinear(const haptic::Patch& patch, const glm::dvec3& e, int steps) {
  const Corners<T> k = cornersOf<T>(patch);
  const Vec<T> p(e), b = k[1] - k[0], c = k[2] - k[0], d = k[3] - k[1] - c;
  T u = T(0.5), v = T(0.5);
  for (int i = 0; i < steps; ++i) {
    const Vec<T> along_u = b + v * d, r = k[0] + u * b + v * c + u * v * d - p;
    u = std::clamp(u - glm::dot(r, along_u) / glm::dot(along_u, along_u), T(0), T(1));
    const Vec<T> along_v = c + u * d, s = k[0] + u * b + v * c + u * v * d - p;
    v = std::clamp(v - glm::dot(s, along_v) / glm::dot(along_v, along_v), T(0), T(1));
  }
  return glm::dvec3(k[0] + u * b + v * c + u * v * d);
}

struct Case {
  haptic::Patch patch;
  glm::dvec3 endpoint;
};

// Cells 0.05 mm wide with noise of `sigma_mm` at their corners, `away_mm` from the field's corner.
std::vector<Case> casesOf(double sigma_mm, double away_mm, std::size_t count) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, sigma_mm);
  std::uniform_real_distribution<double> within(0.0, 1.0);
  std::vector<Case> cases;
  for (std::size_t i = 0; i < count; ++i) {
    const double z[4] = {noise(random), noise(random), noise(random), noise(random)};
    const haptic::Patch patch{away_mm, away_mm,     0.05,        0.05,
                              z[0],    z[1] - z[0], z[2] - z[0], z[3] - z[2] - z[1] + z[0]};
    const double u = within(random), v = within(random);
    cases.push_back({patch, patch.at(u, v) - glm::dvec3(0.0, 0.0, 0.3 * within(random))});
  }
  return cases;
}

// Coordinate descent in long double from 5 x 5 starts and the best of them: slow, and independent of the
// reference's quintic. Returns the distance.
double bruteDistance(const Case& c) {
  double best = 1e300;
  for (int i = 0; i < 25; ++i) {
    const int row = i / 5;
    long double u = i % 5 / 4.0L, v = row / 4.0L;
    const auto& p = c.patch;
    const long double ex = c.endpoint.x - p.x0, ey = c.endpoint.y - p.y0, ez = c.endpoint.z - p.a;
    for (int k = 0; k < 400; ++k) {
      const long double gu = p.b + p.d * v;
      u = std::clamp((ex * p.sx + (ez - p.c * v) * gu) / (p.sx * p.sx + gu * gu), 0.0L, 1.0L);
      const long double gv = p.c + p.d * u;
      v = std::clamp((ey * p.sy + (ez - p.b * u) * gv) / (p.sy * p.sy + gv * gv), 0.0L, 1.0L);
    }
    const long double z = p.b * u + p.c * v + p.d * u * v - ez;
    best = std::min(best, static_cast<double>(std::hypot(u * p.sx - ex, v * p.sy - ey, z)));
  }
  return best;
}

}  // namespace

engine::Result<Study> surfaceStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"surface",
              "Surface: what a cell is taken for",
              "Would two triangles per cell, or float, be as good?",
              {"time per cell", "ns"},
              {"mean distance from the closest point", "mm"}};
  const struct {
    const char* name;
    glm::dvec3 (*closest)(const haptic::Patch&, const glm::dvec3&);
  } methods[] = {
      {"bilinear, all stationary points, double",
       [](const haptic::Patch& p, const glm::dvec3& e) {
         const haptic::PatchPoint at = haptic::closestOnWholePatch(p, e);
         return p.at(at.u, at.v);
       }},
      {"bilinear, a coordinate at a time, 1 step",
       [](const haptic::Patch& p, const glm::dvec3& e) { return ofBilinear<double>(p, e, 1); }},
      {"bilinear, a coordinate at a time, 8 steps",
       [](const haptic::Patch& p, const glm::dvec3& e) { return ofBilinear<double>(p, e, 8); }},
      {"bilinear, a coordinate at a time, 8 steps, float",
       [](const haptic::Patch& p, const glm::dvec3& e) { return ofBilinear<float>(p, e, 8); }},
      {"two triangles",
       [](const haptic::Patch& p, const glm::dvec3& e) { return ofTriangles<double>(p, e); }},
      {"two triangles, float",
       [](const haptic::Patch& p, const glm::dvec3& e) { return ofTriangles<float>(p, e); }},
  };
  const struct {
    const char* name;
    double sigma_mm, away_mm;
  } subjects[] = {
      {"noise 2 um", 0.002, 0.0}, {"noise 20 um", 0.02, 0.0}, {"noise 20 um, 8 m away", 0.02, 8000.0}};
  const auto count = static_cast<std::size_t>(std::max(500.0, 40'000 * options.effort));
  job.begin("surface of a cell", std::size(subjects) * std::size(methods));
  double check = 0.0;
  for (const auto& subject : subjects) {
    const std::vector<Case> cases = casesOf(subject.sigma_mm, subject.away_mm, count);
    std::vector<glm::dvec3> truth(count);
    std::vector<std::vector<glm::dvec3>> found;
    for (const auto& method : methods) {
      if (job.cancelled()) return engine::cancelled();
      std::vector<glm::dvec3> points(count);
      std::vector<double> ns;
      for (int k = 0; k < 5; ++k) {
        const engine::Stopwatch watch;
        for (std::size_t i = 0; i < count; ++i) points[i] = method.closest(cases[i].patch, cases[i].endpoint);
        ns.push_back(watch.ns() / static_cast<double>(count));
      }
      if (found.empty()) truth = points;  // the first method is the reference
      AccuracyRow row{subject.name, method.name};
      spread(std::move(ns), row);
      std::vector<double> errors, flat;
      for (std::size_t i = 0; i < count; ++i) {
        errors.push_back(glm::length(points[i] - truth[i]));
        flat.insert(flat.end(), {points[i].x, points[i].y, points[i].z});
      }
      row.hash = engine::hashOf(flat);
      row.wrong = std::numeric_limits<double>::quiet_NaN();
      summarise(std::move(errors), row);
      // A method in float comes after the same in double.
      if (std::string_view(method.name).ends_with("float")) {
        double off = 0.0;
        for (std::size_t i = 0; i < count; ++i) off += glm::length(points[i] - found.back()[i]);
        row.note = fmt::format("{:.2g} um from the same in double, on average",
                               1e3 * off / static_cast<double>(count));
      }
      study.rows.push_back(std::move(row));
      found.push_back(std::move(points));
      job.advance();
    }
    for (std::size_t i = 0; i < count; i += count / 100)
      check = std::max(check, glm::length(truth[i] - cases[i].endpoint) - bruteDistance(cases[i]));
  }
  study.reference = fmt::format(
      "Every stationary point of the bilinear patch (roots of a quintic), its edges and corners, in double. "
      "Checked here against coordinate descent in long double from 25 starts, a hundred cells of each "
      "subject: never farther by more than {:.1e} mm.",
      std::max(check, 0.0));
  const AccuracyRow& triangles = rowOf(study, "noise 20 um", "two triangles");
  const AccuracyRow& patch = rowOf(study, "noise 20 um", "bilinear, all stationary points, double");
  const AccuracyRow& floats = rowOf(study, "noise 20 um, 8 m away", "two triangles, float");
  study.answer = fmt::format(
      "Two triangles take {:.0f} ns where all stationary points of the patch take {:.0f}, but they are "
      "another surface: on noise of 20 um their closest point lies {:.1f} um from the patch's on average, "
      "{:.0f} um at worst, because the diagonal is a choice that the scan did not make. 8 m from the field's "
      "corner float is off: {}. Hence the tick is in double.",
      triangles.cost, patch.cost, 1e3 * triangles.error, 1e3 * triangles.error_worst, floats.note);
  return study;
}

}  // namespace fettle::bench

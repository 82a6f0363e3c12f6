#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/nominal/nominal_mesh.h"

namespace fettle::engine {

using Triangles = std::vector<TriangleCorners>;

inline NominalMesh meshOf(Triangles triangles) {
  JobControl job;
  auto mesh = NominalMesh::create(std::move(triangles), "nominal.stl", job);
  EXPECT_TRUE(mesh) << mesh.error().line();
  return *std::move(mesh);
}

/// z(x, y) over width x height mm, as columns x rows cells of two triangles, seen from above from their outside.
inline Triangles surfaceOver(double width, double height, int columns, int rows,
                             const std::function<double(double, double)>& z, double x0 = 0.0,
                             double y0 = 0.0) {
  Triangles out;
  const auto at = [&](int c, int r) {
    const double x = width * c / columns, y = height * r / rows;
    return glm::dvec3(x0 + x, y0 + y, z(x, y));
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      out.push_back({at(c, r), at(c + 1, r), at(c + 1, r + 1)});
      out.push_back({at(c, r), at(c + 1, r + 1), at(c, r + 1)});
    }
  return out;
}

/// A closed sphere, wound so that outside is outside; `steps` from pole to pole.
inline Triangles sphereOf(const glm::dvec3& centre, double radius, int steps) {
  Triangles out;
  const auto at = [&](int i, int j) {
    const double polar = std::numbers::pi * i / steps, around = std::numbers::pi * (j % (2 * steps)) / steps;
    // The poles are one place each, whatever rounding makes of sin(pi).
    const double across = i == 0 || i == steps ? 0.0 : radius * std::sin(polar);
    return centre +
           glm::dvec3(across * std::cos(around), across * std::sin(around), radius * std::cos(polar));
  };
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < 2 * steps; ++j) {
      if (i > 0) out.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < steps) out.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  return out;
}

/// The other way round: outside is inside.
inline Triangles turnedRound(Triangles triangles) {
  for (TriangleCorners& t : triangles) std::swap(t[1], t[2]);
  return triangles;
}

}  // namespace fettle::engine

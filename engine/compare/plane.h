#pragma once

#include <cstdint>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

/// First moments of the samples (column, row, height) of a field.
struct PlaneMeans {
  std::int64_t samples = 0;
  std::int64_t columns = 0;  ///< sum of columns; below 2^63 for any field
  std::int64_t rows = 0;
  CompensatedSum height;

  void add(std::int32_t column, std::int32_t row, double z) noexcept {
    ++samples;
    columns += column;
    rows += row;
    height.add(z);
  }
  void add(const PlaneMeans& other) noexcept {
    samples += other.samples;
    columns += other.columns;
    rows += other.rows;
    height.add(other.height);
  }
};

/// Where the centre of a field's samples lies.
struct Centre {
  double column = 0.0;
  double row = 0.0;
  double height = 0.0;

  [[nodiscard]] static Centre of(const PlaneMeans& means) noexcept {
    const auto n = static_cast<double>(means.samples);
    return {static_cast<double>(means.columns) / n, static_cast<double>(means.rows) / n,
            means.height.value() / n};
  }
};

/// Second moments about the centre.
struct PlaneMoments {
  CompensatedSum cc, cr, rr, cz, rz;

  void add(double c, double r, double z) noexcept {
    cc.add(c * c);
    cr.add(c * r);
    rr.add(r * r);
    cz.add(c * z);
    rz.add(r * z);
  }
  void add(const PlaneMoments& other) noexcept {
    cc.add(other.cc);
    cr.add(other.cr);
    rr.add(other.rr);
    cz.add(other.cz);
    rz.add(other.rz);
  }
};

/// The least-squares plane through a field's samples: height + by_column * (c - column) + by_row * (r - row).
/// The spacing cancels in the fit, so it is done in samples.
struct Plane {
  Centre centre;
  double by_column = 0.0;
  double by_row = 0.0;

  /// Samples on one line do not determine the tilt across it: then the plane is level across it.
  [[nodiscard]] static Plane fit(const Centre& centre, const PlaneMoments& m) noexcept {
    Plane plane{centre, 0.0, 0.0};
    const double cc = m.cc.value();
    const double cr = m.cr.value();
    const double rr = m.rr.value();
    const double determinant = cc * rr - cr * cr;
    if (determinant > 1e-12 * cc * rr) {
      plane.by_column = (rr * m.cz.value() - cr * m.rz.value()) / determinant;
      plane.by_row = (cc * m.rz.value() - cr * m.cz.value()) / determinant;
    } else if (cc + rr > 0.0) {
      plane.by_column = m.cz.value() / (cc + rr);
      plane.by_row = m.rz.value() / (cc + rr);
    }
    return plane;
  }

  [[nodiscard]] double residual(double column, double row, double z) const noexcept {
    return (z - centre.height) - by_column * (column - centre.column) - by_row * (row - centre.row);
  }
};

}  // namespace fettle::engine

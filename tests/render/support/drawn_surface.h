// The twin of DetailMeasure: the two surfaces themselves, in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "engine/field/version.h"
#include "render/detail/detail.h"

namespace fettle::render {

/// The surface that is drawn at a level, at any place, by its definition (render/detail/detail.h).
class DrawnSurface {
 public:
  DrawnSurface(const engine::Version& field, int level) : reader_(field.reader()), stride_(1 << level) {
    last_ = glm::ivec2(std::max(2, reader_.width()) - 1, std::max(2, reader_.height()) - 1);
  }
  double vertex(glm::ivec2 s) const { return drawnHeight(reader_, glm::min(s, last_), stride_); }
  double at(double x, double y) const {
    const auto low = [&](double v, int last) {
      return std::min(static_cast<int>(v) / stride_ * stride_, (last - 1) / stride_ * stride_);
    };
    const glm::ivec2 a(low(x, last_.x), low(y, last_.y)), b = glm::min(a + stride_, last_);
    const double u = (x - a.x) / (b.x - a.x), v = (y - a.y) / (b.y - a.y);
    const double z00 = vertex(a), z10 = vertex({b.x, a.y}), z01 = vertex({a.x, b.y}), z11 = vertex(b);
    // A missing vertex counts where it bears on the place.
    const auto part = [](double w, double z) { return w == 0.0 ? 0.0 : w * z; };
    if (u + v <= 1.0) return part(1 - u - v, z00) + part(u, z10) + part(v, z01);
    return part(u + v - 1, z11) + part(1 - u, z01) + part(1 - v, z10);
  }

 private:
  engine::FieldReader reader_;
  int stride_;
  glm::ivec2 last_;
};

/// Every patch of every level: no point of the fine cells without a hole, on a grid finer than the samples,
/// is farther from the coarse surface than measured; and what is measured is at most `tightness` times that.
inline void expectBound(const engine::Version& field, double tightness) {
  DetailMeasure measure;
  measure.measure(field.reader());
  const engine::FieldReader reader = field.reader();
  const glm::ivec2 last(std::max(2, reader.width()) - 1, std::max(2, reader.height()) - 1);
  const DrawnSurface fine(field, 0);
  const double scale = std::max(std::abs(double{reader.bounds().min}), std::abs(double{reader.bounds().max}));
  const auto sample = [&](int c, int r) {
    return reader.heightAt(std::min(c, reader.width() - 1), std::min(r, reader.height() - 1));
  };
  for (int level = 1; level <= measure.topLevel(); ++level) {
    const DrawnSurface coarse(field, level);
    const int side = DetailMeasure::side(level);
    const glm::ivec2 count = measure.patches(level);
    for (int py = 0; py < count.y; ++py)
      for (int px = 0; px < count.x; ++px) {
        const DetailMeasure::Error bound = measure.error(level, px, py);
        double worst = 0.0;
        for (int r = py * side; r < std::min((py + 1) * side, last.y); ++r)
          for (int c = px * side; c < std::min((px + 1) * side, last.x); ++c) {
            if (std::isnan(sample(c, r) + sample(c + 1, r) + sample(c, r + 1) + sample(c + 1, r + 1)))
              continue;
            for (const double fy : {0.0, 0.3, 0.5, 1.0})
              for (const double fx : {0.0, 0.5, 0.7, 1.0}) {
                const double d = std::abs(fine.at(c + fx, r + fy) - coarse.at(c + fx, r + fy));
                // NaN: a vertex without any height bears on it.
                if (std::isnan(d)) worst = HUGE_VAL;
                worst = std::max(worst, d);
              }
          }
        // 1e-12 of the heights: what the twin itself rounds.
        ASSERT_LE(worst, bound.deviation + 1e-12 * scale)
            << "level " << level << " patch " << px << ' ' << py;
        if (std::isfinite(bound.deviation) && level <= DetailMeasure::kTileLevels) {
          ASSERT_LE(bound.deviation, tightness * worst + 1e-3)
              << "level " << level << " patch " << px << ' ' << py;
        }
      }
  }
}

}  // namespace fettle::render

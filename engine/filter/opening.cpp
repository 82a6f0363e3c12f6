// Opening and closing of a surface: the ball or the horizontal disk of ISO 16610-41:2015 (for profiles) on an areal surface. An
// opening is an erosion and then a dilation (J. Serra, Image analysis and mathematical morphology, 1982); a dilation is the
// erosion of what is turned over, and so is a closing the opening.

#include "engine/filter/opening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/tile.h"
#include "engine/filter/ball_erosion.h"
#include "engine/filter/erosion.h"
#include "engine/filter/surface_pass.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/opening-inl.h"
#include "engine/simd/each_cpu-inl.h"

enum class Rolling { kBelow, kAbove };  // opening, closing

SampleRect grownWithin(const SampleRect& rect, std::int32_t columns, std::int32_t rows,
                       const FieldReader& field) {
  const std::int32_t c0 = std::max(rect.column - columns, 0), r0 = std::max(rect.row - rows, 0);
  return {c0, r0, std::min(rect.column + rect.columns + columns, field.width()) - c0,
          std::min(rect.row + rect.rows + rows, field.height()) - r0};
}

class Opening {
 public:
  Opening(const Version& input, const FilterSpec& spec, Rolling rolling, CpuLevel level)
      : reader_(input.reader()),
        // The scan's own heights: turned over, its peaks are the same.
        sign_((rolling == Rolling::kBelow ? 1.0F : -1.0F) * reader_.sign()),
        level_(level) {
    const HeightBounds bounds = reader_.bounds();
    const auto low = static_cast<double>(bounds.min), high = static_cast<double>(bounds.max);
    if (spec.element != Element::kBall)
      flat_.emplace(spec.element, spec.nesting_mm, input.grid());
    else if (bounds.empty())
      ball_.emplace(spec.nesting_mm, 0.0, 0.0, input.grid());
    else
      ball_.emplace(spec.nesting_mm, sign_ < 0.0F ? -high : low, sign_ < 0.0F ? -low : high, input.grid());
  }

  [[nodiscard]] std::int32_t columns() const noexcept { return ball_ ? ball_->columns() : flat_->columns; }
  [[nodiscard]] std::int32_t rows() const noexcept { return ball_ ? ball_->rows() : flat_->rows; }

  // False when cancelled.
  bool prepare(const JobControl& job) {
    if (std::max(columns(), rows()) <= kMostReachInBlocks) return true;
    const SampleRect all{0, 0, reader_.width(), reader_.height()};
    whole_ = std::make_unique<Patch<float>>();
    Scratch scratch;
    whole_->resize(all);
    return work(all, true, scratch, whole_->values.data(), whole_->stride, job);
  }

  bool fill(const SampleRect& rect, float* out, std::ptrdiff_t stride, const JobControl& job) {
    if (!whole_) return work(rect, false, scratches_.local(), out, stride, job);
    for (std::int32_t r = 0; r < rect.rows; ++r)
      std::copy_n(whole_->row(rect.row + r) + rect.column, rect.columns, out + r * stride);
    return true;
  }

 private:
  struct Scratch {
    Patch<float> heights, eroded, opened;
    Patch<double> wide_eroded, wide_opened;
    ErosionScratch erosion;
    BallScratch ball;
  };

  bool work(const SampleRect& rect, bool parallel, Scratch& scratch, float* out, std::ptrdiff_t stride,
            const JobControl& job) {
    Patch<float>& heights = scratch.heights;
    heights.resize(grownWithin(rect, 2 * columns(), 2 * rows(), reader_));
    // Tile by tile, so that large fields are read by all workers.
    eachRow(heights.rect.rows, parallel, [&](std::int32_t begin, std::int32_t end) {
      float* const from = heights.values.data() + begin * heights.stride;
      reader_.readHeights(heights.rect.column, heights.rect.row + begin, heights.rect.columns, end - begin,
                          from, heights.stride);
      for (std::int32_t r = 0; r < end - begin; ++r)
        FETTLE_AT_LEVEL(level_, readyRow)(from + r * heights.stride, sign_, heights.rect.columns);
    });
    return ball_ ? rollBall(rect, parallel, scratch, out, stride, job)
                 : rollFlat(rect, parallel, scratch, out, stride, job);
  }

  bool rollFlat(const SampleRect& rect, bool parallel, Scratch& scratch, float* out, std::ptrdiff_t stride,
                const JobControl& job) const {
    const Patch<float>& heights = scratch.heights;
    Patch<float>&eroded = scratch.eroded, &opened = scratch.opened;
    eroded.resize(grownWithin(rect, columns(), rows(), reader_));
    if (!erode(*flat_, heights, eroded, parallel, level_, scratch.erosion, job)) return false;
    eachRow(eroded.rect.rows, parallel, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t r = eroded.rect.row + begin; r < eroded.rect.row + end; ++r) {
        const float* const z = heights.row(r) + (eroded.rect.column - heights.rect.column);
        float* const low = eroded.row(r);
        // The middle of an element lies on a sample.
        for (std::int32_t c = 0; c < eroded.rect.columns; ++c)
          low[c] = z[c] < std::numeric_limits<float>::infinity() ? -low[c] : z[c];
      }
    });
    opened.resize(rect);
    if (!erode(*flat_, eroded, opened, parallel, level_, scratch.erosion, job)) return false;
    eachRow(rect.rows, parallel, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t r = begin; r < end; ++r) {
        const float* const low = opened.row(rect.row + r);
        // Of zeros of both signs the one that is found first is not the same for all cuts of the field.
        for (std::int32_t c = 0; c < rect.columns; ++c) out[r * stride + c] = sign_ * (0.0F - low[c]);
      }
    });
    return true;
  }

  bool rollBall(const SampleRect& rect, bool parallel, Scratch& scratch, float* out, std::ptrdiff_t stride,
                const JobControl& job) const {
    const Patch<float>& heights = scratch.heights;
    Patch<double>&eroded = scratch.wide_eroded, &opened = scratch.wide_opened;
    eroded.resize(grownWithin(rect, columns(), rows(), reader_));
    if (!erode(*ball_, heights, eroded, parallel, level_, scratch.ball, job)) return false;
    // Where there is no sample, infinite.
    eachRow(eroded.rect.rows, parallel, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t r = eroded.rect.row + begin; r < eroded.rect.row + end; ++r) {
        double* const low = eroded.row(r);
        for (std::int32_t c = 0; c < eroded.rect.columns; ++c) low[c] = -low[c];
      }
    });
    opened.resize(rect);
    if (!erode(*ball_, eroded, opened, parallel, level_, scratch.ball, job)) return false;
    eachRow(rect.rows, parallel, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t r = begin; r < end; ++r) {
        const double* const low = opened.row(rect.row + r);
        const float* const z = heights.row(rect.row + r) + (rect.column - heights.rect.column);
        FETTLE_AT_LEVEL(level_, settleRow)(low, z, ball_->deepest(), sign_, out + r * stride, rect.columns);
      }
    });
    return true;
  }

  static void eachRow(std::int32_t rows, bool parallel, const auto& f) {
    if (!parallel) return f(0, rows);
    tbb::parallel_for(std::int32_t{0}, (rows + kTileSide - 1) / kTileSide,
                      [&](std::int32_t i) { f(i * kTileSide, std::min((i + 1) * kTileSide, rows)); });
  }

  FieldReader reader_;
  float sign_;
  CpuLevel level_;
  std::optional<FlatElement> flat_;
  std::optional<BallElement> ball_;
  std::unique_ptr<Patch<float>> whole_;
  tbb::enumerable_thread_specific<Scratch> scratches_;
};

Result<PassResult> rollingPass(Rolling rolling, const Version& input, const Version& original,
                               const FilterSpec& spec, const FilterTuning& tuning, JobControl& job) {
  Opening opening(input, spec, rolling, std::min(tuning.level, bestCpuLevel()));
  if (!opening.prepare(job)) return cancelled();
  const std::int32_t reach = 2 * std::max(opening.columns(), opening.rows());
  return passOfSurface([&](const SampleRect& rect, float* out,
                           std::ptrdiff_t stride) { return opening.fill(rect, out, stride, job); },
                       std::max(reach, 1), input, original, spec, tuning, job);
}

}  // namespace

std::int32_t openingReach(const FilterSpec& spec, const Grid& grid) noexcept {
  const auto reach = [&](double spacing) {
    return std::min(2.0 * std::ceil(spec.nesting_mm / spacing), 1.0 * Grid::kMaxSide);
  };
  return static_cast<std::int32_t>(std::max(reach(grid.spacingXMm()), reach(grid.spacingYMm())));
}

Result<PassResult> openingPass(const Version& input, const Version& original, const FilterSpec& spec,
                               const FilterTuning& tuning, JobControl& job) {
  return rollingPass(Rolling::kBelow, input, original, spec, tuning, job);
}

Result<PassResult> closingPass(const Version& input, const Version& original, const FilterSpec& spec,
                               const FilterTuning& tuning, JobControl& job) {
  return rollingPass(Rolling::kAbove, input, original, spec, tuning, job);
}

}  // namespace fettle::engine

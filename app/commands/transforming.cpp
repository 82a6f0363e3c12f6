#include "app/commands/transforming.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/field/grid.h"
#include "engine/field/piece.h"
#include "engine/field/sample_rect.h"
#include "engine/field/tile_store.h"
#include "engine/marks/chosen_marks.h"
#include "engine/measure/form_kind.h"
#include "engine/transform/rearrange.h"

namespace fettle::app {

namespace {

// The rectangle of samples that is kept, rows counted from the lowest.
engine::Result<engine::SampleRect> cropOf(const TransformArguments& options, const engine::Grid& grid) {
  if (!options.crop_samples.empty()) {
    const int row = options.crop_samples[0], column = options.crop_samples[1];
    const int rows = options.crop_samples[2], columns = options.crop_samples[3];
    if (row < 0 || column < 0 || rows < 1 || columns < 1 || row > grid.height - rows ||
        column > grid.width - columns)
      return engine::inputError(fmt::format("{},{},{},{} is no part of {} rows and {} columns", row, column,
                                            rows, columns, grid.height, grid.width),
                                "--crop-samples", "give ROW,COLUMN,ROWS,COLUMNS, counted from 0 at the top");
    return engine::SampleRect{column, grid.height - row - rows, columns, rows};
  }
  if (std::ranges::any_of(options.crop, [](double v) { return !std::isfinite(v); }))
    return engine::inputError("a corner is no number", "--crop", "give X,Y,X,Y in mm, or as 12.5mm,3mm");
  if (options.crop.empty()) return engine::SampleRect{0, 0, grid.width, grid.height};
  const engine::SampleRect rect =
      engine::samplesBetween(grid, {options.crop[0], options.crop[1]}, {options.crop[2], options.crop[3]});
  if (rect.empty())
    return engine::inputError(
        "no sample is in the rectangle", "--crop",
        fmt::format("the scan is from 0,0 to {:.6g},{:.6g} mm", (grid.width - 1) * grid.spacingXMm(),
                    (grid.height - 1) * grid.spacingYMm()));
  return rect;
}

engine::Turning turningOf(const TransformArguments& options) {
  engine::Turning turning;
  turning.mirror_x = options.mirror == "x";
  turning.mirror_y = options.mirror == "y";
  turning.quarters = options.turn == "90" ? 1 : options.turn == "180" ? 2 : options.turn == "270" ? 3 : 0;
  // An angle of whole quarters is one without a new height.
  if (!options.resamples()) {
    const int quarters = static_cast<int>(std::fmod(options.angle / 90.0, 4.0));
    turning.quarters = (turning.quarters + quarters + 4) % 4;
  }
  return turning;
}

engine::Result<engine::ResampleOptions> resamplingOf(const TransformArguments& options,
                                                     const engine::Grid& grid) {
  engine::ResampleOptions resampling;
  resampling.angle_deg = options.angle;
  resampling.spacing_x = grid.spacing_x;
  resampling.spacing_y = grid.spacing_y;
  if (!options.to_spacing.empty()) {
    // Lengths across the field, not heights.
    engine::Grid lateral = grid;
    lateral.height_unit = grid.lateral_unit;
    for (const std::string& typed : options.to_spacing) {
      const auto length = parseHeight(typed, lateral, "--to-spacing");
      if (!length) return tl::unexpected(length.error());
      if (*length <= 0.0)
        return engine::inputError("samples cannot be that near to each other", "--to-spacing",
                                  "give a length above 0");
      (&typed == &options.to_spacing.front() ? resampling.spacing_x : resampling.spacing_y) = *length;
    }
    if (options.to_spacing.size() == 1) resampling.spacing_y = resampling.spacing_x;
  }
  if (options.to_spacing.size() > 2)
    return engine::inputError("a field has two spacings", "--to-spacing", "give X or X,Y");
  const bool coarser = resampling.spacing_x > grid.spacing_x || resampling.spacing_y > grid.spacing_y;
  resampling.method = options.method == "area" || (options.method.empty() && coarser)
                          ? engine::Resampling::kArea
                      : options.method == "linear" ? engine::Resampling::kLinear
                                                   : engine::Resampling::kCubic;
  return resampling;
}

}  // namespace

bool TransformArguments::resamples() const {
  return !to_spacing.empty() || std::fmod(angle, 90.0) != 0.0;
}

engine::Status checkTransform(const TransformArguments& options) {
  if (options.crop.empty() && options.crop_samples.empty() && options.mirror.empty() &&
      options.turn.empty() && options.angle == 0.0 && options.to_spacing.empty())
    return engine::inputError("nothing is to be done", "transform",
                              "give --crop, --crop-samples, --mirror, --turn, --angle or --to-spacing");
  if (!options.method.empty() && !options.resamples())
    return engine::inputError("no sample comes between others", "--method",
                              "add --to-spacing, or an --angle that is no multiple of 90");
  return {};
}

engine::Result<Transformed> transformed(const engine::Version& field, const TransformArguments& options,
                                        engine::JobControl& job) {
  engine::Version now = field;
  if (!options.crop.empty() || !options.crop_samples.empty()) {
    const auto rect = cropOf(options, field.grid());
    if (!rect) return tl::unexpected(rect.error());
    auto piece = engine::cropped(now, *rect, job);
    if (!piece) return tl::unexpected(piece.error());
    now = *std::move(piece);
  }
  if (const engine::Turning turning = turningOf(options); !turning.none()) {
    auto moved = engine::turned(now, turning, job);
    if (!moved) return tl::unexpected(moved.error());
    now = *std::move(moved);
  }
  if (options.resamples()) {
    const auto resampling = resamplingOf(options, now.grid());
    if (!resampling) return tl::unexpected(resampling.error());
    auto result = engine::resampled(now, *resampling, job);
    if (!result) return tl::unexpected(result.error());
    return Transformed{*std::move(result), resampling->method};
  }
  return Transformed{std::move(now), std::nullopt};
}

void warnOfFormLeft(const engine::Version& field, const engine::Version& made, const std::string& scan) {
  if (field.formOver() == nullptr || made.formOver() != nullptr) return;
  warn(fmt::format(
      "{}: the form {} that lies over it has no place over the new samples: they have their heights with it",
      shownInput(scan), engine::infoOf(*field.formOver()).word));
}

engine::Result<engine::Grid> transformedGrid(const engine::Grid& grid, const TransformArguments& options) {
  const auto rect = cropOf(options, grid);
  if (!rect) return tl::unexpected(rect.error());
  engine::Grid now = grid;
  now.width = rect->columns;
  now.height = rect->rows;
  if (turningOf(options).quarters % 2 != 0) {
    std::swap(now.width, now.height);
    std::swap(now.spacing_x, now.spacing_y);
  }
  if (!options.resamples()) return now;
  const auto resampling = resamplingOf(options, now);
  if (!resampling) return tl::unexpected(resampling.error());
  return engine::resampledGrid(now, *resampling);
}

PlannedOnPieces plannedTransform(const engine::Version& field, const engine::Version& original,
                                 const TransformArguments& options, const engine::Grid& before,
                                 WithOriginal with) {
  TransformArguments whole = options;
  whole.crop.clear();
  whole.crop_samples.clear();
  const auto piece = [whole](const engine::Version& of, const engine::SampleRect& r,
                             engine::JobControl& job) -> engine::Result<engine::Version> {
    // A piece of what is seen under a form is seen under it, too.
    const auto cut =
        of.formOver() == nullptr
            ? engine::Result<engine::Version>(engine::pieceOf(of, r.column, r.row, r.columns, r.rows))
            : engine::cropped(of, r, job);
    if (!cut) return tl::unexpected(cut.error());
    auto done = transformed(*cut, whole, job);
    if (!done) return tl::unexpected(done.error());
    return std::move(done->field);
  };
  const auto cropped = cropOf(options, before);
  const double kept =
      cropped ? static_cast<double>(cropped->columns) * cropped->rows : static_cast<double>(before.samples());
  PlannedOnPieces planned{
      .work =
          [piece, &field, &original, with](const engine::SampleRect& r, engine::JobControl& job) {
            auto done = piece(field, r, job);
            if (!done || with == WithOriginal::kNo) return done;
            const auto other = piece(original, r, job);
            return other ? done : other;
          },
      .fields = field.formOver() == nullptr ? 1 : 2,  // samples, and what is seen of them
      .share = kept / static_cast<double>(field.grid().samples())};
  // How many fields are made at once small pieces do not show, as most tiles of a turned one have samples and holes. Under a form: what is made of heights, with
  // the form again, and what is seen of that, beside what was made of the field before the original. Else the result, and another one of an original
  // that differs, with 5 % for tiles that stand over its ends.
  const bool both = with == WithOriginal::kYes, formed = field.formOver() != nullptr;
  const double together = formed ? (both ? 5.0 : 3.0) : 1.05 * (both && !(original == field) ? 2.0 : 1.0);
  const auto made = transformedGrid(before, options);
  const double larger = made ? static_cast<double>(made->samples()) / kept : 1.0;
  planned.memory_each = together * (formed ? std::max(1.0, larger) : larger) *
                        static_cast<double>(engine::fieldBytes(static_cast<std::uint64_t>(before.width),
                                                               static_cast<std::uint64_t>(before.height))) /
                        static_cast<double>(before.samples());
  if (with == WithOriginal::kYes)
    planned.of_original = [piece, &original](const engine::SampleRect& r, engine::JobControl& job) {
      return piece(original, r, job);
    };
  return planned;
}

}  // namespace fettle::app

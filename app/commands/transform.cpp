#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/transform/rearrange.h"
#include "engine/transform/resample.h"

namespace fettle::app {

namespace {

struct TransformArguments {
  BatchOptions files;
  std::vector<double> crop;       // x0, y0, x1, y1 [mm]; empty: all
  std::vector<int> crop_samples;  // row from the top, column, rows, columns; empty: all
  std::string mirror;
  std::string turn;
  double angle = 0.0;
  std::vector<std::string> to_spacing;
  std::string method;
  ScanOptions reading;
  engine::ExportOptions writing;

  [[nodiscard]] bool resamples() const { return !to_spacing.empty() || std::fmod(angle, 90.0) != 0.0; }
};

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
    return engine::inputError("a corner is no number", "--crop", "give X,Y,X,Y in mm");
  if (options.crop.empty()) return engine::SampleRect{0, 0, grid.width, grid.height};
  // Samples in the rectangle; one that is on its side but for rounding is in it.
  constexpr double kRounding = 1e-6;
  const auto range = [](double from, double to, double spacing, std::int32_t count) {
    const double first = std::ceil(std::min(from, to) / spacing - kRounding);
    const double last = std::floor(std::max(from, to) / spacing + kRounding);
    return std::pair{static_cast<std::int32_t>(std::clamp(first, 0.0, static_cast<double>(count))),
                     static_cast<std::int32_t>(std::clamp(last, -1.0, count - 1.0))};
  };
  const auto columns = range(options.crop[0], options.crop[2], grid.spacingXMm(), grid.width);
  const auto rows = range(options.crop[1], options.crop[3], grid.spacingYMm(), grid.height);
  if (columns.first > columns.second || rows.first > rows.second)
    return engine::inputError(
        "no sample is in the rectangle", "--crop",
        fmt::format("the scan is from 0,0 to {:.6g},{:.6g} mm", (grid.width - 1) * grid.spacingXMm(),
                    (grid.height - 1) * grid.spacingYMm()));
  return engine::SampleRect{columns.first, rows.first, columns.second - columns.first + 1,
                            rows.second - rows.first + 1};
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

struct Transformed {
  engine::Version field;
  std::optional<engine::Resampling> method;  // where samples came between others
};

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

engine::Result<Report> transformOne(const TransformArguments& options, const BatchTask& task,
                                    engine::JobControl& job) {
  const auto imported = loadSamples(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto result = transformed(imported->field, options, job);
  if (!result) return tl::unexpected(result.error());
  engine::ExportOptions writing = options.writing;
  if (imported->original) {
    // What the session began with goes along, so that changes and filled samples stay known.
    auto original = transformed(*imported->original, options, job);
    if (!original) return tl::unexpected(original.error());
    writing.original = std::move(original->field);
  }
  const engine::Grid& grid = result->field.grid();
  if (grid.crs_wkt.empty() && !imported->field.grid().crs_wkt.empty())
    warn(
        fmt::format("{}: turned, its samples are no longer where its coordinate system says: it is written "
                    "without one",
                    shownInput(task.in)));
  if (auto status = saveField(result->field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  const engine::FieldSummary summary = engine::summarize(result->field);
  Report report{{"width", grid.width},
                {"height", grid.height},
                {"spacing_x", grid.spacing_x},
                {"spacing_y", grid.spacing_y},
                {"spacing_unit", grid.lateral_unit.name},
                {"origin_x", grid.origin_x},
                {"origin_y", grid.origin_y},
                {"no_data", summary.no_data},
                {"marked", summary.marked}};
  if (result->method)
    report["method"] = *result->method == engine::Resampling::kArea     ? "area"
                       : *result->method == engine::Resampling::kLinear ? "linear"
                                                                        : "cubic";
  report["hash"] = hashOf(result->field);
  return report;
}

engine::Result<Report> transform(const TransformArguments& options, engine::JobControl& job) {
  if (options.crop.empty() && options.crop_samples.empty() && options.mirror.empty() &&
      options.turn.empty() && options.angle == 0.0 && options.to_spacing.empty())
    return engine::inputError("nothing is to be done", "transform",
                              "give --crop, --crop-samples, --mirror, --turn, --angle or --to-spacing");
  if (!options.method.empty() && !options.resamples())
    return engine::inputError("no sample comes between others", "--method",
                              "add --to-spacing, or an --angle that is no multiple of 90");
  const auto tasks = batchTasks(options.files, {}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    return transformOne(options, task, j);
  };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addTransform(Command root, Chosen& chosen) {
  auto options = std::make_shared<TransformArguments>();
  Command command = addCommand(
      root, chosen, "transform", "Crop, mirror, turn and resample scans",
      [options](engine::JobControl& job) { return transform(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--crop",
       .to = &options->crop,
       .text = "Keep the samples in this rectangle: two corners, from the lower left sample",
       .unit = "mm",
       .shown = "X,Y,X,Y",
       .values = 4,
       .between = ','},
      {.name = "--crop-samples",
       .to = &options->crop_samples,
       .text = "Keep these samples, counted from 0 at the top left, as info --at does",
       .shown = "ROW,COLUMN,ROWS,COLUMNS",
       .values = 4,
       .between = ',',
       .excludes = {"--crop"}},
      {.name = "--mirror",
       .to = &options->mirror,
       .text = "Then mirror",
       .words = {{"x", "left and right change places"}, {"y", "top and bottom change places"}}},
      {.name = "--turn",
       .to = &options->turn,
       .text = "Then turn counter-clockwise about the middle, every height as it is",
       .unit = "degrees",
       .words = {"90", "180", "270"}},
      {.name = "--angle",
       .to = &options->angle,
       .text = "Then turn counter-clockwise about the middle by any angle; the result holds all of the scan",
       .range = Range{-360.0, 360.0},
       .unit = "degrees"},
      {.name = "--to-spacing",
       .to = &options->to_spacing,
       .text = "New distance of samples, the same along x and y or one each: in the scan's unit, or as 20um",
       .shown = "X[,Y]",
       .otherwise = "as it is",
       .between = ','},
      {.name = "--method",
       .to = &options->method,
       .text = "How heights between samples come about",
       .words = {{"area", "mean of the cells that the new one covers"},
                 {"linear", "the bilinear patch between four samples"},
                 {"cubic", "cubic convolution of 4 x 4 samples, which may overshoot at steps"}},
       .otherwise = "area where samples get farther apart, else cubic"},
  });
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "Steps are done in the order of this list. Where samples get farther apart by a factor s, every kernel "
      "is "
      "s times as wide, so that what is finer than the new spacing is averaged.\n"
      "Marks, edge lines, and of a session the scan that it began with go along. A new sample is a hole "
      "where the "
      "old one nearest to it is; elsewhere holes do not count, and cubic becomes linear beside them. It is "
      "marked "
      "where an old marked one lies in its cell. A crop and a new spacing keep the place in the world; a "
      "turned "
      "or mirrored scan keeps its middle there and has no coordinate system.");
  command.examples(
      {{"fettle transform scan.tif part.tif --crop 10,10,30,20", "The samples from 10,10 to 30,20 mm"},
       {"fettle transform scan.tif coarse.tif --to-spacing 0.1mm",
        "A sample every 0.1 mm, by means of areas"},
       {"fettle transform scan.tif level.tif --angle -3.5", "Turned clockwise by 3.5 degrees"}});
}

}  // namespace fettle::app

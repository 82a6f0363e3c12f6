#include "app/work/field_features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/work/layer_over.h"
#include "engine/field/builder.h"
#include "engine/marks/change_marks.h"
#include "engine/measure/areal.h"

namespace fettle::app {

namespace {

// A number for each sample of the surface as a field of the whole grid; holes outside of it.
engine::Result<engine::Version> fieldOf(const FieldFeatures& features, const engine::Grid& of,
                                        const char* name, const auto& numberAt, engine::JobControl& job) {
  engine::Grid grid = of;
  grid.height_per_count = 0.0;
  auto builder = engine::FieldBuilder::create(std::move(grid), name);
  if (!builder) return tl::unexpected(builder.error());
  const engine::Surface& surface = features.surface;
  std::vector<float> row(static_cast<std::size_t>(surface.width));
  for (std::int32_t r = 0; r < surface.height; ++r) {
    if (job.cancelled()) return engine::cancelled();
    for (std::size_t c = 0; c < row.size(); ++c)
      row[c] = numberAt(static_cast<std::size_t>(r) * row.size() + c);
    builder->writeHeights(surface.first_column, surface.first_row + r, surface.width, 1, row.data(),
                          surface.width);
  }
  return std::move(*builder).build();
}

// Of those of which a word is not true; null without one.
Report meanWithout(const Report& features, const char* key, const char* word) {
  double sum = 0.0;
  int count = 0;
  for (const Report& feature : features)
    if (!feature[word].get<bool>()) {
      sum += feature[key].get<double>();
      ++count;
    }
  return count > 0 ? Report(sum / count) : Report();
}

}  // namespace

engine::Result<FieldFeatures> featuresOf(const engine::Version& field, const engine::NominalForm& form,
                                         const FeatureOptions& options, const std::string& where,
                                         engine::JobControl& job) {
  engine::ArealOptions height;
  height.region = options.region;
  height.hybrid = height.functional = height.spatial = height.feature = false;
  const auto measured = engine::measureAreal(field, form, height, job);
  if (!measured) return tl::unexpected(measured.error());
  auto surface = engine::surfaceOf(field, form, measured->mean, height.region, job);
  if (!surface) return tl::unexpected(surface.error());
  if (surface->heights.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    return engine::inputError("more than 2 147 483 647 samples", where, "crop it first");
  FieldFeatures features;
  features.dales = options.dales;
  if (features.dales)
    for (float& z : surface->heights) z = -z;
  // Of a surface that is nothing but rounding there is none.
  if (std::isnan(measured->sz)) std::ranges::fill(surface->heights, std::numeric_limits<float>::quiet_NaN());
  features.sz = std::isnan(measured->sz) ? 0.0 : measured->sz;
  features.least = 0.01 * options.prune * features.sz;
  auto map = engine::mapHills(*surface, features.least, job);
  if (!map) return tl::unexpected(map.error());
  features.figures = engine::figuresOfHills(*surface, *map);
  features.surface = *std::move(surface);
  features.map = *std::move(map);
  return features;
}

engine::Result<engine::Version> featureLabels(const FieldFeatures& features, const engine::Grid& of,
                                              engine::JobControl& job) {
  // Labels are samples, and those are floats: above this, neighbours would share a number.
  constexpr std::size_t kMostLabels = std::size_t{1} << std::numeric_limits<float>::digits;
  if (features.figures.size() > kMostLabels)
    return engine::inputError(
        fmt::format("{} segments, and a label has {} values", features.figures.size(), kMostLabels),
        "--labels", "give a larger --prune");
  return fieldOf(
      features, of, "the labels",
      [&](std::size_t i) {
        const std::int32_t number = features.map.of[i];
        return number == engine::HillMap::kNone ? std::numeric_limits<float>::quiet_NaN()
                                                : static_cast<float>(number + 1);
      },
      job);
}

engine::Result<engine::Version> featureHeights(const FieldFeatures& features, const engine::Grid& of,
                                               engine::JobControl& job) {
  const double sign = features.dales ? -1.0 : 1.0;
  return fieldOf(
      features, of, "the heights of features",
      [&](std::size_t i) {
        const std::int32_t number = features.map.of[i];
        if (number == engine::HillMap::kNone) return std::numeric_limits<float>::quiet_NaN();
        const engine::Hill& hill = features.map.hills[static_cast<std::size_t>(number)];
        const double above = static_cast<double>(features.surface.heights[i]) - (hill.peak - hill.height);
        return above >= 0.0 ? static_cast<float>(sign * above) : std::numeric_limits<float>::quiet_NaN();
      },
      job);
}

engine::Result<engine::Version> featureOutlines(const FieldFeatures& features, const engine::Version& field,
                                                engine::JobControl& job) {
  const engine::Surface& surface = features.surface;
  const auto number = [&](std::int32_t column, std::int32_t row) {
    const std::int32_t c = column - surface.first_column, r = row - surface.first_row;
    if (c < 0 || r < 0 || c >= surface.width || r >= surface.height) return engine::HillMap::kNone;
    return features.map.of[static_cast<std::size_t>(r) * static_cast<std::size_t>(surface.width) +
                           static_cast<std::size_t>(c)];
  };
  const auto on_edge = [&](std::int32_t column, std::int32_t row) {
    const std::int32_t own = number(column, row);
    if (own == engine::HillMap::kNone) return false;
    for (const auto& [c, r] :
         {std::pair(column + 1, row), {column, row + 1}, {column - 1, row}, {column, row - 1}})
      if (number(c, r) > own) return true;
    return false;
  };
  return engine::changeMarks(
      field, engine::allTiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const engine::Tile&, engine::MarkRows& rows) {
        for (int r = 0; r < engine::kTileSide; ++r) {
          std::uint64_t bits = 0;
          for (int c = 0; c < engine::kTileSide; ++c)
            if (on_edge(tc * engine::kTileSide + c, tr * engine::kTileSide + r))
              bits |= std::uint64_t{1} << c;
          rows[static_cast<std::size_t>(r)] = bits;
        }
      },
      job);
}

Report featureReport(const FieldFeatures& features, const engine::Grid& grid) {
  Report report;
  report["kind"] = features.dales ? "dales" : "hills";
  report["unit"] = grid.height_unit.name;
  report["unit_mm"] = grid.height_unit.mm;
  report["lateral_unit"] = grid.lateral_unit.name;
  report["lateral_unit_mm"] = grid.lateral_unit.mm;
  report["spacing"] = std::max(grid.spacing_x, grid.spacing_y);
  report["sz"] = features.sz;
  report["least_height"] = features.least;
  report["count"] = features.figures.size();
  Report& rows = report["features"] = Report::array();
  const double mm = grid.lateral_unit.mm, sign = features.dales ? -1.0 : 1.0;
  for (std::size_t i = 0; i < features.figures.size(); ++i) {
    const engine::HillFigures& of = features.figures[i];
    rows.push_back({{"number", i + 1},
                    {"x", (of.hill.column + features.surface.first_column) * grid.spacing_x},
                    {"y", (of.hill.row + features.surface.first_row) * grid.spacing_y},
                    {"z", sign * of.hill.peak},
                    {"height", of.hill.height},
                    {"samples", of.samples},
                    {"area", of.area_mm2 / (mm * mm)},
                    {"area_above", of.area_above_mm2 / (mm * mm)},
                    {"volume", of.volume_mm3 / (mm * mm * grid.height_unit.mm)},
                    {"open", of.open},
                    {"cut", of.cut}});
  }
  // As Sha, Sda, Shv and Sdv: an area is not whole once the border cuts it, a volume only above the saddle.
  report["mean_height"] = meanWithout(rows, "height", "open");
  report["mean_area"] = meanWithout(rows, "area", "cut");
  report["mean_volume"] = meanWithout(rows, "volume", "open");
  return report;
}

std::string featureCsv(const Report& report) {
  const std::string height = report["unit"], length = report["lateral_unit"];
  std::string text = fmt::format(
      "number,x [{1}],y [{1}],z [{0}],height [{0}],samples,area [{1}2],area above saddle [{1}2],volume above "
      "saddle "
      "[{1}2 {0}],open,cut,layer\n",
      height, length);
  for (const Report& f : report["features"])
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.9g},{:.9g},{:.9g},{},{},{}\n",
                        f["number"].get<int>(), f["x"].get<double>(), f["y"].get<double>(),
                        f["z"].get<double>(), f["height"].get<double>(), f["samples"].get<std::int64_t>(),
                        f["area"].get<double>(), f["area_above"].get<double>(), f["volume"].get<double>(),
                        f["open"].get<bool>() ? "yes" : "no", f["cut"].get<bool>() ? "yes" : "no",
                        layerOf(report));
  return text;
}

FeatureUnits featureUnits(const Report& report) {
  return {readLengthAs(report["sz"], report["unit_mm"], report["unit"]),
          readAcrossAs(report["spacing"], report["lateral_unit_mm"], report["lateral_unit"])};
}

}  // namespace fettle::app

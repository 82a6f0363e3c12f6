#include "engine/io/tiff_metadata.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

constexpr const char* kLateral = "FETTLE_LATERAL_UNIT";
constexpr const char* kHeight = "FETTLE_HEIGHT_UNIT";
constexpr const char* kPerCount = "FETTLE_HEIGHT_PER_COUNT";

std::optional<double> positiveNumber(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value <= 0.0)
    return std::nullopt;
  return value;
}

std::optional<LengthUnit> unitItem(GDALDatasetH dataset, const char* key) {
  const char* item = GDALGetMetadataItem(dataset, key, nullptr);
  if (item == nullptr) return std::nullopt;
  const std::string_view text = item;
  const std::size_t space = text.rfind(' ');
  if (space == std::string_view::npos || space == 0) return std::nullopt;
  const auto mm = positiveNumber(text.substr(space + 1));
  if (!mm) return std::nullopt;
  return LengthUnit{std::string(text.substr(0, space)), *mm};
}

}  // namespace

void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, bool lateral_unit_is_stated) {
  const auto text = [](const LengthUnit& unit) { return fmt::format("{} {}", unit.name, unit.mm); };
  if (!lateral_unit_is_stated)
    GDALSetMetadataItem(dataset, kLateral, text(grid.lateral_unit).c_str(), nullptr);
  GDALSetMetadataItem(dataset, kHeight, text(grid.height_unit).c_str(), nullptr);
  if (grid.height_per_count > 0.0)
    GDALSetMetadataItem(dataset, kPerCount, fmt::format("{}", grid.height_per_count).c_str(), nullptr);
}

void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, double& height_per_count) {
  if (auto unit = unitItem(dataset, kLateral)) units.lateral = unit;
  if (auto unit = unitItem(dataset, kHeight)) units.height = unit;
  if (const char* item = GDALGetMetadataItem(dataset, kPerCount, nullptr); item != nullptr)
    height_per_count = positiveNumber(item).value_or(height_per_count);
}

}  // namespace fettle::engine

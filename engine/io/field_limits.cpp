#include "engine/io/field_limits.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/field/tile_store.h"
#include "engine/io/lone_value.h"

namespace fettle::engine {

Status checkFieldSides(std::uint64_t width, std::uint64_t height, const std::string& path) {
  constexpr std::uint64_t kMaxSide = Grid::kMaxSide;
  if (width == 0 || height == 0)
    return inputError(fmt::format("the header states {} x {} samples", width, height), path,
                      "the file is damaged or empty");
  if (width > kMaxSide || height > kMaxSide)
    return inputError(fmt::format("{} x {} samples are too many", width, height), path,
                      fmt::format("a side may have {} at most: cut the scan into parts", kMaxSide));
  return {};
}

Status checkFieldSize(std::uint64_t width, std::uint64_t height, std::uint64_t extra_bytes,
                      const std::string& path) {
  if (Status sides = checkFieldSides(width, height, path); !sides) return sides;
  if (const auto place = placeOf(width, height, extra_bytes, path); !place)
    return tl::unexpected(place.error());
  return {};
}

Status checkPromise(std::uint64_t raw_bytes, std::uint64_t stored_bytes, double ratio,
                    const std::string& path) {
  constexpr double kBenefitOfDoubt = 64 << 20;
  if (static_cast<double>(raw_bytes) <= kBenefitOfDoubt + ratio * static_cast<double>(stored_bytes))
    return {};
  return inputError(fmt::format("the header states {} MB of samples, the file holds {} bytes of them",
                                raw_bytes >> 20, stored_bytes),
                    path, "the file is cut short or damaged");
}

Status checkPacking(std::uint64_t raw_bytes, std::uint64_t stored_bytes, const std::string& path) {
  constexpr std::uint64_t kTrusted = std::uint64_t{240} << 20;
  constexpr std::uint64_t kMostPacked = 200;
  if (raw_bytes <= kTrusted || raw_bytes / kMostPacked <= stored_bytes) return {};
  return inputError(
      fmt::format("the file states {} MB of heights in {} bytes", raw_bytes >> 20, stored_bytes), path,
      "the file is damaged or made to fill memory");
}

void describeTally(const HeightTally& tally, const std::string& unit, std::vector<std::string>& warnings) {
  if (tally.infinite > 0)
    warnings.push_back(fmt::format("{} heights are infinite or outside the range of a float, read as holes",
                                   tally.infinite));
  if (tally.rounding > 0.0)
    warnings.push_back(
        fmt::format("heights have more digits than a float holds, the largest rounding is {:.2g} {}",
                    tally.rounding, unit));
}

// Of decimals only what is seen beside their range: 1e-6 of it takes an offset of 16 times the range. The floats may have
// lost the range, and not all heights may have been looked at.
HeightTally noticed(HeightTally tally, const HeightBounds& floats) {
  constexpr double kNoticed = 1e-6;
  double range = tally.most - tally.least;
  if (!floats.empty())
    range = std::fmax(range, static_cast<double>(floats.max) - static_cast<double>(floats.min));
  if (tally.decimals && (tally.rounding <= kNoticed * range || range == 0.0)) tally.rounding = 0.0;
  return tally;
}

Result<Imported> finishImport(FieldBuilder&& builder, const HeightRule& rule, const HeightTally& tally,
                              std::string format, std::vector<std::string> warnings) {
  Imported imported;
  imported.field = std::move(builder).build();
  describeTally(noticed(tally, imported.field.reader().bounds()), imported.field.grid().height_unit.name,
                warnings);
  if (imported.field.reader().bounds().empty())
    warnings.emplace_back("there is no height: every sample is no-data; check the file and --no-data");
  HeightRule doubted = rule;
  if (rule.user_no_data && tally.said == 0) {
    warnings.push_back(
        fmt::format("no sample has the no-data value {}: check --no-data", *rule.user_no_data));
    doubted.user_no_data.reset();  // it has explained nothing
  }
  imported.lone_values = doubtLoneValues(imported.field, doubted, warnings);
  imported.format = std::move(format);
  imported.warnings = std::move(warnings);
  return imported;
}

}  // namespace fettle::engine

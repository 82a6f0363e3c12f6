#include "app/files/scan_thumbnail.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "engine/formats/formats.h"
#include "render/plan/colour_map.h"
#include "render/plan/value_range.h"

namespace fettle::app {
namespace {

constexpr std::int64_t kPreviewSamples = std::int64_t{1} << 18;
// Slopes are exaggerated so that the usual one is seen: a part is flat beside its length.
constexpr double kUsualSlope = 0.5;

// Mean height of each pixel's samples; at most kMostPerSide by kMostPerSide of them, evenly spread.
std::vector<float> meanHeights(const engine::FieldReader& field, int width, int height) {
  constexpr int kMostPerSide = 8;
  std::vector<float> means(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto edge = [](int pixel, int pixels, std::int32_t samples) {
    return static_cast<std::int32_t>(std::int64_t{samples} * pixel / pixels);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::int32_t left = edge(x, width, field.width()), right = edge(x + 1, width, field.width());
      const std::int32_t low = edge(y, height, field.height()), high = edge(y + 1, height, field.height());
      const std::int32_t across = std::max(1, (right - left) / kMostPerSide);
      const std::int32_t up = std::max(1, (high - low) / kMostPerSide);
      double sum = 0.0;
      int count = 0;
      for (std::int32_t row = low; row < high; row += up)
        for (std::int32_t column = left; column < right; column += across)
          if (const float h = field.heightAt(column, row); std::isfinite(h)) {
            sum += static_cast<double>(h);
            ++count;
          }
      // Row 0 of a field is the lowest, that of a picture the highest.
      means[static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)] = count > 0 ? static_cast<float>(sum / count) : std::nanf("");
    }
  return means;
}

// Differences to the right and up of pixel (x, y); 0 beside holes and at the border.
struct Slope {
  double right = 0.0, up = 0.0;
};

Slope slopeAt(const ScanThumbnail& picture, int x, int y) {
  const auto at = [&](int i, int j) {
    const int column = std::clamp(i, 0, picture.width - 1), row = std::clamp(j, 0, picture.height - 1);
    return static_cast<double>(picture.heights[static_cast<std::size_t>(row * picture.width + column)]);
  };
  const double right = at(x + 1, y) - at(x - 1, y), up = at(x, y - 1) - at(x, y + 1);
  return {std::isfinite(right) ? right : 0.0, std::isfinite(up) ? up : 0.0};
}

// The slope that nine of ten pixels stay below: light is scaled by it.
double usualSlope(const ScanThumbnail& picture) {
  std::vector<double> slopes;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Slope s = slopeAt(picture, x, y);
      if (const double steep = std::hypot(s.right, s.up); steep > 0.0 && std::isfinite(steep))
        slopes.push_back(steep);
    }
  if (slopes.empty()) return 1.0;
  const auto ninth = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() * 9 / 10);
  std::nth_element(slopes.begin(), ninth, slopes.end());
  return *ninth;
}

std::uint32_t packed(const glm::vec3& light) {
  std::uint32_t colour = 0xFF000000U;
  for (int channel = 0; channel < 3; ++channel) {
    const double code = render::srgbFromLinear(std::clamp(static_cast<double>(light[channel]), 0.0, 1.0));
    colour |= static_cast<std::uint32_t>(std::lround(255.0 * code)) << (8 * channel);
  }
  return colour;
}

void colour(ScanThumbnail& picture) {
  const render::ColourTable& table =
      render::colourTable(render::resolve(render::ColourMap::kAuto, render::Quantity::kHeight));
  const render::ValueRange range{picture.low, picture.high};
  const double scale = kUsualSlope / usualSlope(picture);
  picture.colours.resize(picture.heights.size(), 0U);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto i = static_cast<std::size_t>(y * picture.width + x);
      if (!std::isfinite(picture.heights[i])) continue;
      const Slope slope = slopeAt(picture, x, y);
      // Lambert's law, light from the upper left at 45 degrees.
      const double nx = -scale * slope.right, ny = -scale * slope.up;
      const double lit = (-0.5 * nx + 0.5 * ny + std::sqrt(0.5)) / std::sqrt(nx * nx + ny * ny + 1.0);
      const float shade = 0.25F + static_cast<float>(std::clamp(lit, 0.0, 1.0));
      picture.colours[i] =
          packed(render::mapped(table, static_cast<double>(picture.heights[i]), range) * shade);
    }
}

}  // namespace

ScanThumbnail thumbnailOf(const engine::Version& field, int side) {
  const engine::Grid& grid = field.grid();
  // As long as it is in millimetres, so that rows twice as far apart are drawn so; one row is still a line.
  const double across = grid.width * grid.spacingXMm(), up = grid.height * grid.spacingYMm();
  const double longest = std::max(across, up);
  const auto pixels = [&](double mm) {
    return std::clamp(static_cast<int>(std::lround(side * mm / longest)), 1, side);
  };
  ScanThumbnail picture;
  picture.width = std::min(pixels(across), grid.width);
  picture.height = std::min(pixels(up), grid.height);
  picture.heights = meanHeights(field.reader(), picture.width, picture.height);
  picture.grid = grid;
  const render::ValueSpan span = render::heightSpan(field);
  picture.low = static_cast<float>(span.robust.low);
  picture.high = static_cast<float>(span.robust.high);
  picture.lowest = static_cast<float>(span.extreme.low);
  picture.highest = static_cast<float>(span.extreme.high);
  colour(picture);
  return picture;
}

engine::Result<ScanThumbnail> readThumbnail(const std::string& path, const engine::ImportOptions& options,
                                            int side, engine::JobControl& job) {
  auto grid = engine::importGrid(path, options);
  if (!grid) return tl::unexpected(grid.error());
  auto coarse = engine::importPreview(path, options, kPreviewSamples, job);
  if (!coarse) return tl::unexpected(coarse.error());
  if (*coarse) {
    ScanThumbnail picture = thumbnailOf((*coarse)->field, side);
    picture.grid = *grid;
    return picture;
  }
  std::error_code unknown;
  if (std::filesystem::file_size(path, unknown) > kMostThumbnailBytes && !unknown) {
    ScanThumbnail without;
    without.grid = *grid;
    return without;
  }
  auto imported = engine::importField(path, options, job);
  if (!imported) return tl::unexpected(imported.error());
  ScanThumbnail picture = thumbnailOf(imported->field, side);
  picture.format = std::move(imported->format);
  picture.warnings = std::move(imported->warnings);
  picture.lone_values = std::move(imported->lone_values);
  picture.whole = true;
  return picture;
}

}  // namespace fettle::app

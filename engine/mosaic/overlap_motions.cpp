#include "engine/mosaic/overlap_motions.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/field/builder.h"
#include "engine/field/sample_rect.h"
#include "engine/measure/height_map.h"

namespace fettle::engine {

namespace {

glm::dvec2 sizeOf(const Version& scan) {
  const Grid& grid = scan.grid();
  return {(grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm()};
}

// The samples of a scan between two places in its own coordinates [mm], `play` more on each side.
SampleRect rectOf(const Version& scan, const glm::dvec2& low, const glm::dvec2& high, double play) {
  const Grid& grid = scan.grid();
  const auto from = [play](double v, double spacing, std::int32_t count) {
    return std::clamp(static_cast<std::int32_t>(std::floor((v - play) / spacing)), 0, count - 1);
  };
  const auto to = [play](double v, double spacing, std::int32_t count) {
    return std::clamp(static_cast<std::int32_t>(std::ceil((v + play) / spacing)), 0, count - 1);
  };
  const std::int32_t c = from(low.x, grid.spacingXMm(), grid.width),
                     r = from(low.y, grid.spacingYMm(), grid.height);
  return {c, r, to(high.x, grid.spacingXMm(), grid.width) - c + 1,
          to(high.y, grid.spacingYMm(), grid.height) - r + 1};
}

// Part of a scan as a field whose position in the world is `place` [mm]. Marks do not count in an alignment of all samples.
Version pieceAt(const Version& scan, const SampleRect& rect, const glm::dvec2& place) {
  Grid grid = scan.grid();
  grid.width = rect.columns;
  grid.height = rect.rows;
  grid.origin_x = place.x / grid.lateral_unit.mm;
  grid.origin_y = place.y / grid.lateral_unit.mm;
  std::vector<float> heights(static_cast<std::size_t>(grid.samples()));
  scan.reader().readHeights(rect.column, rect.row, rect.columns, rect.rows, heights.data(), rect.columns);
  return makeField(grid, heights);
}

glm::dvec2 lowerLeft(const Version& scan, const SampleRect& rect) {
  return {rect.column * scan.grid().spacingXMm(), rect.row * scan.grid().spacingYMm()};
}

// The motion of whole fields by that of pieces of them.
RigidMotion ofWholes(const RigidMotion& of_pieces, const glm::dvec2& first, const glm::dvec2& second) {
  const glm::dvec3 a(first, 0.0), b(second, 0.0);
  return {of_pieces.rotation, of_pieces.shift + of_pieces.rotation * (a - b), of_pieces.centre + a};
}

}  // namespace

Result<std::vector<glm::dvec3>> middlesOf(const std::vector<Version>& scans, JobControl& job) {
  std::vector<glm::dvec3> middles;
  for (const Version& scan : scans) {
    const auto around = heightsAround(scan, Region::kAll, job);
    if (!around) return tl::unexpected(around.error());
    middles.emplace_back(0.5 * sizeOf(scan), around->middle);
  }
  return middles;
}

std::optional<std::vector<glm::dvec2>> statedPlaces(const std::vector<Version>& scans) {
  std::vector<glm::dvec2> places;
  bool differ = false;
  for (const Version& scan : scans) {
    const Grid& grid = scan.grid();
    // From the first scan's: lengths of the world lose no digit of those of scans.
    const Grid& zero = scans[0].grid();
    places.emplace_back(grid.origin_x * grid.lateral_unit.mm - zero.origin_x * zero.lateral_unit.mm,
                        grid.origin_y * grid.lateral_unit.mm - zero.origin_y * zero.lateral_unit.mm);
    differ = differ || places.back() != places.front();
  }
  return differ ? std::optional(places) : std::nullopt;
}

std::vector<glm::dvec2> placesInRows(const std::vector<Version>& scans, std::size_t columns, double overlap) {
  std::vector<glm::dvec2> places;
  double y = 0.0;
  for (std::size_t first = 0; first < scans.size(); first += columns) {
    double x = 0.0, highest = 0.0;
    for (std::size_t k = first; k < std::min(first + columns, scans.size()); ++k) {
      const glm::dvec2 size = sizeOf(scans[k]);
      places.emplace_back(x, y);
      x += (1.0 - overlap) * size.x;
      highest = std::max(highest, size.y);
    }
    y += (1.0 - overlap) * highest;
  }
  return places;
}

Result<OverlapMotions> overlapMotions(const std::vector<Version>& scans,
                                      const std::optional<std::vector<glm::dvec2>>& places, double play,
                                      const AlignOptions& options, const std::vector<std::string>& names,
                                      JobControl& job) {
  constexpr std::int32_t kFewest = 12;  // samples a side
  assert(names.empty() || names.size() == scans.size());
  AlignOptions how = options;
  OverlapMotions out;
  for (std::size_t i = 0; i < scans.size(); ++i)
    for (std::size_t j = i + 1; j < scans.size(); ++j) {
      const Version &a = scans[i], &b = scans[j];
      SampleRect rect_a{0, 0, a.grid().width, a.grid().height}, rect_b{0, 0, b.grid().width, b.grid().height};
      glm::dvec2 place_a(0.0), place_b(0.0);
      if (places) {
        const glm::dvec2 at_a = (*places)[i], at_b = (*places)[j];
        const glm::dvec2 low(std::max(at_a.x, at_b.x), std::max(at_a.y, at_b.y)),
            high(std::min(at_a.x + sizeOf(a).x, at_b.x + sizeOf(b).x),
                 std::min(at_a.y + sizeOf(a).y, at_b.y + sizeOf(b).y));
        const Grid& grid = a.grid();
        if (high.x - low.x < kFewest * grid.spacingXMm() || high.y - low.y < kFewest * grid.spacingYMm())
          continue;
        rect_a = rectOf(a, low - at_a, high - at_a, play);
        rect_b = rectOf(b, low - at_b, high - at_b, play);
        place_a = at_a + lowerLeft(a, rect_a);
        place_b = at_b + lowerLeft(b, rect_b);
      }
      if (!names.empty()) how.words.first = names[i], how.words.second = names[j];
      const auto found = alignFields(pieceAt(a, rect_a, place_a), pieceAt(b, rect_b, place_b), how, job);
      if (!found && found.error().kind != ErrorKind::kInput) return tl::unexpected(found.error());
      if (!found) {
        out.failed.push_back({i, j, found.error()});
        continue;
      }
      out.pairs.push_back(
          {i, j, ofWholes(found->motion, lowerLeft(a, rect_a), lowerLeft(b, rect_b)), found->covariance});
      out.alignments.push_back(*found);
      if (!found->repeat) continue;
      // Where scans lie to `play` only a shorter period leaves the place open.
      const glm::dvec2 off = glm::dvec2(found->motion.shift) - (place_b - place_a), &shift = *found->repeat;
      const auto allowed = [&](const glm::dvec2& from_place) {
        return std::abs(from_place.x) <= play && std::abs(from_place.y) <= play;
      };
      if (!places || allowed(off + shift) || allowed(off - shift)) out.repeated.push_back({i, j, shift});
    }
  return out;
}

}  // namespace fettle::engine

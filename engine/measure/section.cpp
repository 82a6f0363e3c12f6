#include "engine/measure/section.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <new>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();
// Bilinear patches of places farther apart than this share no sample [samples, along either axis].
constexpr double kReachOfPatch = 2.0;
constexpr int kMostBand = 256;

// A sample and its weight in the height of a place.
struct Share {
  std::int64_t sample = 0;
  double weight = 0.0;
};

// Heights at places of a field, with the samples that they are made of.
class PlaceReader {
 public:
  PlaceReader(const Version& field, const SectionOptions& options)
      : field_(field.reader()), options_(options) {}

  // Height [height_unit] at (column, row), NaN for none; adds the shares of its samples.
  double heightAt(glm::dvec2 at, std::vector<Share>& shares) const {
    const Grid& grid = field_.grid();
    // A place on the border belongs to the field, whatever rounding did to it.
    constexpr double kRounding = 1e-9;
    if (!(at.x >= -kRounding && at.y >= -kRounding && at.x <= grid.width - 1 + kRounding &&
          at.y <= grid.height - 1 + kRounding))
      return kNoHeight;
    at = glm::dvec2(snapped(at.x), snapped(at.y));
    if (options_.interpolation == Interpolation::kNearest)
      at = glm::dvec2(std::floor(at.x + 0.5), std::floor(at.y + 0.5));
    const auto column = static_cast<std::int32_t>(at.x), row = static_cast<std::int32_t>(at.y);
    const double u = at.x - column, v = at.y - row;
    const std::size_t before = shares.size();
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double weight = ((k & 1) != 0 ? u : 1.0 - u) * ((k & 2) != 0 ? v : 1.0 - v);
      if (weight == 0.0) continue;
      const std::int32_t c = column + (k & 1), r = row + (k >> 1);
      const double z = sampleAt(c, r);
      if (std::isnan(z)) {
        shares.resize(before);
        return kNoHeight;
      }
      sum += weight * z;
      shares.push_back({std::int64_t{r} * grid.width + c, weight});
    }
    return sum;
  }

 private:
  // A place that rounding moved off a row or column of samples lies on it.
  static double snapped(double at) noexcept {
    const double whole = std::round(at);
    return std::abs(at - whole) < 1e-9 ? whole : at;
  }
  double sampleAt(std::int32_t column, std::int32_t row) const noexcept {
    const bool wanted = options_.region == Region::kAll ||
                        field_.markedAt(column, row) == (options_.region == Region::kMarked);
    return wanted ? double{field_.heightAt(column, row)} : kNoHeight;
  }

  FieldReader field_;
  SectionOptions options_;
};

// Each sample once, in the order of the samples.
void merge(std::vector<Share>& shares) {
  std::ranges::sort(shares, {}, &Share::sample);
  std::size_t kept = 0;
  for (const Share& share : shares) {
    if (kept > 0 && shares[kept - 1].sample == share.sample)
      shares[kept - 1].weight += share.weight;
    else
      shares[kept++] = share;
  }
  shares.resize(kept);
}

double productOf(const std::vector<Share>& a, const std::vector<Share>& b) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].sample < b[j].sample)
      ++i;
    else if (b[j].sample < a[i].sample)
      ++j;
    else
      sum += a[i++].weight * b[j++].weight;
  }
  return sum;
}

// A polyline without repeated points [mm].
struct Path {
  std::vector<glm::dvec2> points;
  std::vector<double> until;  // length up to each point

  // Place and unit tangent at a length.
  std::pair<glm::dvec2, glm::dvec2> at(double length) const noexcept {
    const auto next = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(until, length) - until.begin(), 1,
                                                 static_cast<std::ptrdiff_t>(points.size()) - 1);
    const auto i = static_cast<std::size_t>(next);
    const glm::dvec2 along = points[i] - points[i - 1];
    const double whole = until[i] - until[i - 1];
    return {points[i - 1] + along * ((length - until[i - 1]) / whole), along / whole};
  }
};

Path pathOf(std::span<const glm::dvec2> points) {
  Path path;
  path.points.reserve(points.size());
  path.until.reserve(points.size());
  for (const glm::dvec2& p : points) {
    const double step = path.points.empty() ? 0.0 : glm::length(p - path.points.back());
    if (!path.points.empty() && !(step > 0.0)) continue;
    path.until.push_back(path.points.empty() ? 0.0 : path.until.back() + step);
    path.points.push_back(p);
  }
  return path;
}

// One sample in a direction of the field [mm].
double sampleAlong(glm::dvec2 unit, glm::dvec2 spacing) noexcept {
  return 1.0 / glm::length(unit / spacing);
}

// Lines side by side along a path, whose heights are averaged.
struct Lanes {
  Path path;
  double apart_mm = std::numeric_limits<double>::infinity();  // one sample
  double count = 1.0;
};

Lanes lanesOf(const SectionSource& source) {
  const Grid& grid = source.field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  Lanes lanes{pathOf(source.points)};
  const Path& path = lanes.path;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const glm::dvec2 unit = (path.points[i] - path.points[i - 1]) / (path.until[i] - path.until[i - 1]);
    lanes.apart_mm = std::min(lanes.apart_mm, sampleAlong({-unit.y, unit.x}, spacing));
  }
  lanes.count = std::floor(source.options.width_mm / lanes.apart_mm + 1e-6) + 1.0;
  return lanes;
}

// A place of a section: the sum of the heights of its lanes [height_unit], of how many, and their samples.
struct TakenPlace {
  glm::dvec2 position{0.0};
  double sum = 0.0;
  int found = 0;
  std::vector<Share>
      shares;  // of the mean, each sample once; none where fewer than half of the lanes have a height
};

TakenPlace takenAt(const PlaceReader& reader, const Lanes& lanes, glm::dvec2 spacing, double along) {
  TakenPlace taken;
  const auto [place, tangent] = lanes.path.at(std::min(along, lanes.path.until.back()));
  taken.position = place;
  const glm::dvec2 across(-tangent.y, tangent.x);
  for (int lane = 0; lane < static_cast<int>(lanes.count); ++lane) {
    const double offset = (lane - 0.5 * (lanes.count - 1.0)) * lanes.apart_mm;
    const double z = reader.heightAt((place + across * offset) / spacing, taken.shares);
    if (std::isnan(z)) continue;
    taken.sum += z;
    ++taken.found;
  }
  if (2 * taken.found < static_cast<int>(lanes.count)) taken.shares.clear();
  merge(taken.shares);
  for (Share& share : taken.shares) share.weight /= taken.found;
  return taken;
}

Status checkPoints(std::span<const glm::dvec2> points, const SectionOptions& options) {
  for (const glm::dvec2& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y))
      return inputError("a point of the section is not a number", "section");
  if (!(options.width_mm >= 0.0) || !std::isfinite(options.width_mm))
    return inputError(fmt::format("a width of {} mm cannot be used", options.width_mm), "section",
                      "give 0 or more");
  return {};
}

// Why no place of a section has a height; `beneath`: the line alone has some.
Error noHeight(const Grid& grid, const Path& path, const SectionOptions& options, bool beneath) {
  const glm::dvec2 end((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  const auto error = [](std::string what, std::string remedy) {
    return Error{ErrorKind::kInput, std::move(what), "section", std::move(remedy)};
  };
  if (beneath)
    return error("fewer than half of the width have a height at every place of the section",
                 "give a smaller width");
  const bool inside = std::ranges::any_of(path.points, [&](const glm::dvec2& p) {
    return p.x >= 0.0 && p.y >= 0.0 && p.x <= end.x && p.y <= end.y;
  });
  if (!inside)
    return error("the section meets no sample",
                 fmt::format("the scan reaches from 0,0 to {:.6g},{:.6g} mm, from the lower left sample",
                             end.x, end.y));
  if (options.region != Region::kAll)
    return error("the section meets no sample of the region", "give another line, or take all samples");
  return error("the section runs through holes alone", "give another line");
}

}  // namespace

double Section::variance(std::span<const double> weights) const noexcept {
  return covarianceOf(weights, weights);
}

double Section::covarianceOf(std::span<const double> a, std::span<const double> b) const noexcept {
  const auto reach = static_cast<std::size_t>(band);
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    sum += a[i] * b[i] * covariance[i * reach];
    for (std::size_t k = 1; k < reach && i + k < size(); ++k)
      sum += (a[i] * b[i + k] + a[i + k] * b[i]) * covariance[i * reach + k];
  }
  return sum;
}

Section::LineVariance Section::lineVariance(std::span<const double> weights) const {
  const std::vector<double> sum(weights.begin(), weights.end());
  const LineCovariance of = lineCovariance({&sum, 1});
  return {of.rows.front(), of.columns.front()};
}

Section::LineCovariance Section::lineCovariance(std::span<const std::vector<double>> sums) const {
  const std::size_t n = sums.size();
  LineCovariance result;
  result.rows.resize(n * n);
  result.columns.resize(n * n);
  if (source.field.empty()) return result;
  const Grid& grid = source.field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  const PlaceReader reader(source.field, source.options);
  const Lanes side_by_side = lanesOf(source);
  // What each sum has of each line, and what a place has.
  struct Lines {
    std::vector<double> sums, place;
    std::vector<bool> met;
    std::vector<std::size_t> of_place;

    Lines(std::int32_t side, std::size_t of)
        : sums(static_cast<std::size_t>(side) * of),
          place(static_cast<std::size_t>(side)),
          met(place.size()) {}
    void add(std::size_t line, double weight) {
      if (place[line] == 0.0) of_place.push_back(line);
      place[line] += weight;
    }
    double finishPlace(std::span<const std::vector<double>> of, std::size_t i) {
      double squares = 0.0;
      for (const std::size_t line : of_place) {
        for (std::size_t k = 0; k < of.size(); ++k) sums[line * of.size() + k] += of[k][i] * place[line];
        squares += place[line] * place[line];
        place[line] = 0.0;
        met[line] = true;
      }
      of_place.clear();
      return squares;
    }
    void covariance(std::vector<double>& out, std::size_t of) const {
      for (std::size_t at = 0; at < sums.size(); at += of)
        for (std::size_t a = 0; a < of; ++a)
          for (std::size_t b = 0; b < of; ++b) out[a * of + b] += sums[at + a] * sums[at + b];
    }
  };
  Lines rows(grid.height, n), columns(grid.width, n);
  for (std::size_t i = 0; i < size(); ++i) {
    if (std::ranges::all_of(sums, [i](const std::vector<double>& sum) { return sum[i] == 0.0; })) continue;
    for (const Share& part : takenAt(reader, side_by_side, spacing, along(i)).shares) {
      rows.add(static_cast<std::size_t>(part.sample / grid.width), part.weight);
      columns.add(static_cast<std::size_t>(part.sample % grid.width), part.weight);
    }
    result.heights.rows += rows.finishPlace(sums, i);
    result.heights.columns += columns.finishPlace(sums, i);
  }
  rows.covariance(result.rows, n);
  columns.covariance(result.columns, n);
  result.rows_met = static_cast<int>(std::ranges::count(rows.met, true));
  result.columns_met = static_cast<int>(std::ranges::count(columns.met, true));
  return result;
}

std::vector<std::vector<double>> Section::offBy(std::span<const LineOffsets> offsets) const {
  std::vector<std::vector<double>> heights(offsets.size(), std::vector<double>(size(), 0.0));
  if (source.field.empty()) return heights;
  const Grid& grid = source.field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  const PlaceReader reader(source.field, source.options);
  const Lanes side_by_side = lanesOf(source);
  for (std::size_t i = 0; i < size(); ++i)
    for (const Share& part : takenAt(reader, side_by_side, spacing, along(i)).shares) {
      const auto row = static_cast<std::size_t>(part.sample / grid.width),
                 column = static_cast<std::size_t>(part.sample % grid.width);
      for (std::size_t k = 0; k < offsets.size(); ++k) {
        const LineOffsets& off = offsets[k];
        heights[k][i] += part.weight * ((off.rows.empty() ? 0.0 : off.rows[row]) +
                                        (off.columns.empty() ? 0.0 : off.columns[column]));
      }
    }
  return heights;
}

Result<Section> sectionAlong(const Version& field, std::span<const glm::dvec2> points,
                             const SectionOptions& options, JobControl& job) try {
  if (auto status = checkPoints(points, options); !status) return tl::unexpected(status.error());
  Section section;
  section.source = {field, {points.begin(), points.end()}, options};
  const Lanes side_by_side = lanesOf(section.source);
  const Path& path = side_by_side.path;
  if (path.points.size() < 2)
    return inputError("a section needs two different points", "section", "give two or more");
  const Grid& grid = field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  const double length = path.until.back();
  double wanted = length;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const glm::dvec2 unit = (path.points[i] - path.points[i - 1]) / (path.until[i] - path.until[i - 1]);
    wanted = std::min(wanted, sampleAlong(unit, spacing));
  }
  // Rounded up a little less than exactly: a line of whole samples has a place on each.
  const double steps = std::max(1.0, std::ceil(length / wanted - 1e-6));
  if (!std::isfinite(length) || !(steps < static_cast<double>(Section::kMostPlaces)))
    return inputError(
        fmt::format("a section of {:.6g} mm has more than {} places", length, Section::kMostPlaces),
        "section", "give a shorter line");
  if (!(side_by_side.count <= SectionOptions::kMostLanes))
    return inputError(fmt::format("a width of {:.6g} mm is more than {} samples", options.width_mm,
                                  SectionOptions::kMostLanes),
                      "section", "give a smaller width");
  const auto places = static_cast<std::size_t>(steps) + 1;
  section.step_mm = length / steps;
  section.lanes = static_cast<int>(side_by_side.count);
  section.band = static_cast<int>(std::clamp<double>(
      std::ceil(std::numbers::sqrt2 * kReachOfPatch * std::max(spacing.x, spacing.y) / section.step_mm), 1.0,
      kMostBand));
  section.position.reserve(places);
  section.height.reserve(places);
  section.share.reserve(places);
  const auto band = static_cast<std::size_t>(section.band);
  section.covariance.assign(places * band, 0.0);
  const PlaceReader reader(field, options);
  const double mm = grid.height_unit.mm;
  std::deque<std::vector<Share>> latest;  // of the last places, this one last
  bool any = false, beneath = false;      // a height at a place, with its width or on the line itself
  job.begin("taking the section", places);
  for (std::size_t i = 0; i < places; ++i) {
    if (job.cancelled()) return cancelled();
    TakenPlace taken = takenAt(reader, side_by_side, spacing, section.along(i));
    const bool counts = 2 * taken.found >= section.lanes && taken.found > 0;
    section.position.push_back(taken.position);
    section.share.push_back(static_cast<double>(taken.found) / section.lanes);
    section.height.push_back(counts ? mm * taken.sum / taken.found : kNoHeight);
    any = any || counts;
    if (!any && !beneath && section.lanes > 1) {
      std::vector<Share> unused;
      beneath = !std::isnan(reader.heightAt(taken.position / spacing, unused));
    }
    if (latest.size() == band) latest.pop_front();
    latest.push_back(std::move(taken.shares));
    for (std::size_t k = 0; k < latest.size(); ++k)
      section.covariance[(i - k) * band + k] = productOf(latest[latest.size() - 1 - k], latest.back());
    job.advance();
  }
  if (!any) return tl::unexpected(noHeight(grid, path, options, beneath));
  return section;
} catch (const std::bad_alloc&) {
  return failure("there is not enough memory for the section", "section", "give a shorter line");
}

}  // namespace fettle::engine

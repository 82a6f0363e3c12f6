#include "engine/measure/align.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/base/stopwatch.h"
#include "engine/measure/align_level.h"
#include "engine/measure/align_repeat.h"
#include "engine/measure/align_search.h"
#include "engine/measure/align_spread.h"
#include "engine/measure/height_map.h"
#include "engine/measure/region.h"

namespace fettle::engine {

namespace {

using Point = AlignLevel::Point;
using Under = AlignLevel::Under;

constexpr int kBlocks = AlignLevel::kBlocks;
constexpr double kSigmas = 1.25;  // of the window, in spacings of the coarser map
constexpr double kMostPlaces = 1 << 20;
constexpr double kCoarser = 4.0;         // a resolution than the next
constexpr std::size_t kFinerStarts = 3;  // of a resolution that are refined in the next one
constexpr double kTukey = 4.685;

// How the height at a point follows a shift x, y, z and a turn about x, y, z that moves the surface.
Vector6 followed(const glm::dvec3& from_centre, double slope_x, double slope_y) noexcept {
  Vector6 row;
  row << -slope_x, -slope_y, 1.0, from_centre.y + slope_y * from_centre.z,
      -from_centre.x - slope_x * from_centre.z, slope_x * from_centre.y - slope_y * from_centre.x;
  return row;
}

double medianResidual(const std::vector<Under>& under) {
  std::vector<double> values;
  values.reserve(under.size());
  for (const Under& u : under)
    if (!std::isnan(u.residual)) values.push_back(u.residual);
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Turns are counted as shifts at the rim: `arm` mm from the centre.
struct Frame {
  glm::dvec3 centre{0.0};
  double arm = 1.0;
  std::vector<int> free;  // of the six

  [[nodiscard]] Vector6 row(const Point& point, double z, double slope_x, double slope_y) const noexcept {
    Vector6 all = followed(glm::dvec3(point.x, point.y, z) - centre, slope_x, slope_y);
    all.tail<3>() /= arm;
    return all;
  }
};

Frame frameOf(const glm::dvec3& centre, double arm, const AlignMoves& moves) {
  Frame frame{centre, arm, {2}};
  if (moves.shift) frame.free.insert(frame.free.end(), {0, 1});
  if (moves.tilt) frame.free.insert(frame.free.end(), {3, 4});
  if (moves.rotation) frame.free.push_back(5);
  return frame;
}

struct Refined {
  RigidMotion motion;
  AlignSpread spread;                                      // of the residuals
  double gain = -std::numeric_limits<double>::infinity();  // in logarithmic likelihood over a plane
  std::size_t common = 0;
};

// Gauss-Newton on Tukey's biweight, each round with the scale of its residuals.
Refined refine(const AlignLevel& level, const RigidMotion& start, const Frame& frame, int rounds,
               double least, JobControl& job) {
  Refined result{start, {}, -std::numeric_limits<double>::infinity(), 0};
  const auto n = static_cast<Eigen::Index>(frame.free.size());
  if (const double offset = medianResidual(level.under(result.motion)); !std::isnan(offset))
    result.motion.shift.z += offset;
  for (int round = 0; round < rounds && !job.cancelled(); ++round) {
    const std::vector<Under> under = level.under(result.motion);
    result.spread = spreadOf(under, level.leastSpacing(), least);
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    result.common = 0;
    for (std::size_t i = 0; i < under.size(); ++i) {
      const Under& u = under[i];
      if (std::isnan(u.residual)) continue;
      ++result.common;
      const double size = result.spread.at(u), share = result.spread.level / size;
      const double x = u.residual / (kTukey * size);
      if (std::abs(x) >= 1.0) continue;
      const double weight = share * share * (1.0 - x * x) * (1.0 - x * x);
      const Vector6 row = frame.row(level.points()[i], u.z, u.slope_x, u.slope_y);
      normal += weight * row * row.transpose();
      right += weight * u.residual * row;
    }
    if (result.common < 12) break;
    Eigen::MatrixXd some(n, n);
    Eigen::VectorXd wanted(n);
    for (Eigen::Index a = 0; a < n; ++a) {
      wanted[a] = right[frame.free[static_cast<std::size_t>(a)]];
      for (Eigen::Index b = 0; b < n; ++b)
        some(a, b) = normal(frame.free[static_cast<std::size_t>(a)], frame.free[static_cast<std::size_t>(b)]);
    }
    // What the surface does not decide stays small.
    some.diagonal().array() += 1e-10 * some.trace() + 1e-300;
    Eigen::VectorXd step = some.ldlt().solve(wanted);
    Vector6 all = Vector6::Zero();
    for (Eigen::Index a = 0; a < n; ++a) all[frame.free[static_cast<std::size_t>(a)]] = step[a];
    const double lateral = std::max({std::abs(all[0]), std::abs(all[1]), std::abs(all[5])});
    const double limit = 3.0 * level.leastSpacing();
    if (lateral > limit) all *= limit / lateral;
    result.motion =
        result.motion.then({all[0], all[1], all[2]}, glm::dvec3(all[3], all[4], all[5]) / frame.arm);
    // Until a step is a thousandth of its standard error.
    if (step.dot(some * step) < 1e-6 * result.spread.level * result.spread.level * static_cast<double>(n))
      break;
  }
  const std::vector<Under> under = level.under(result.motion);
  result.spread = spreadOf(under, level.leastSpacing(), least);
  // Against the plane under the same points: what shape explains.
  std::vector<Under> heights = under;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  result.common = 0;
  for (std::size_t i = 0; i < under.size(); ++i) {
    const Point& p = level.points()[i];
    if (std::isnan(under[i].residual)) continue;
    ++result.common;
    const Eigen::Vector3d row(1.0, p.x - frame.centre.x, p.y - frame.centre.y);
    normal += row * row.transpose();
    right += row * (p.z - frame.centre.z);
  }
  if (result.common < 12) return result;
  const Eigen::Vector3d plane = normal.completeOrthogonalDecomposition().solve(right);
  for (std::size_t i = 0; i < under.size(); ++i)
    if (!std::isnan(under[i].residual)) {
      const Point& p = level.points()[i];
      heights[i].residual = p.z - frame.centre.z - plane[0] - plane[1] * (p.x - frame.centre.x) -
                            plane[2] * (p.y - frame.centre.y);
    }
  // Sums of squares, clipped at the size that one in a hundred exceeds: a few tall features count, spikes do not.
  const double cap = std::max(residualAt(heights, 0.99), least);
  double of_plane = 0.0, of_motion = 0.0;
  for (std::size_t i = 0; i < under.size(); ++i) {
    if (std::isnan(under[i].residual)) continue;
    of_plane += std::pow(std::min(std::abs(heights[i].residual), cap), 2);
    of_motion += std::pow(std::min(std::abs(under[i].residual), cap), 2);
  }
  const double floor = static_cast<double>(result.common) * least * least;
  result.gain = 0.5 * static_cast<double>(result.common) * std::log((of_plane + floor) / (of_motion + floor));
  return result;
}

// Directions as words, each motion once: where as many motions as directions are moved, every mixture of them is open, as
// a shift along x and one along y of a flat field; else a direction is a mixture, as a shift with a tilt of a sphere.
std::string movesOf(const std::vector<Vector6>& directions) {
  constexpr const char* kNames[] = {"a shift along x", "a shift along y", "the height",
                                    "a tilt about x",  "a tilt about y",  "the rotation about z"};
  constexpr int kOrder[] = {0, 1, 5, 3, 4, 2};
  const auto moves = [](const Vector6& direction, int k) {
    return std::abs(direction[k]) >= 0.35 * direction.cwiseAbs().maxCoeff();
  };
  std::vector<std::string> all, mixtures;
  for (const int k : kOrder)
    if (std::ranges::any_of(directions, [&](const Vector6& direction) { return moves(direction, k); }))
      all.emplace_back(kNames[k]);
  for (const Vector6& direction : directions) {
    std::string text;
    for (const int k : kOrder)
      if (moves(direction, k)) text += text.empty() ? kNames[k] : std::string(" with ") + kNames[k];
    if (std::ranges::find(mixtures, text) == mixtures.end()) mixtures.push_back(std::move(text));
  }
  const std::vector<std::string>& named = all.size() <= directions.size() ? all : mixtures;
  std::string text;
  for (std::size_t k = 0; k < named.size(); ++k)
    text += (k == 0 ? "" : k + 1 == named.size() ? " and " : ", ") + named[k];
  return text;
}

// Block sums at the last motion, over which everything that is stated is taken.
struct BlockSum {
  // Products of both fields' slopes, of the first's, of the second's.
  Matrix6 cross = Matrix6::Zero(), first = Matrix6::Zero(), second = Matrix6::Zero();
  Vector6 score = Vector6::Zero();
  double slope = 0.0;  // squares of slopes
  std::int64_t samples = 0, left_out = 0;
  double residuals = 0.0, scores = 0.0;  // squares of residuals, and of these with their weight
};

// `rows`: how each point's height follows the motion; 0 for those that do not count.
std::vector<BlockSum> blockSums(const AlignLevel& level, const Refined& refined, const Frame& frame,
                                std::vector<Vector6>& rows) {
  std::vector<BlockSum> blocks(static_cast<std::size_t>(kBlocks * kBlocks));
  rows.assign(level.points().size(), Vector6::Zero());
  const std::vector<Under> under = level.under(refined.motion);
  for (std::size_t i = 0; i < under.size(); ++i) {
    const Under& u = under[i];
    if (std::isnan(u.residual)) continue;
    const Point& point = level.points()[i];
    BlockSum& block = blocks[static_cast<std::size_t>(point.block)];
    const double size = refined.spread.at(u), share = refined.spread.level / size;
    const double x = u.residual / (kTukey * size);
    if (std::abs(x) >= 1.0) {
      ++block.left_out;
      continue;
    }
    const double weight = share * (1.0 - x * x) * (1.0 - x * x);
    const double derivative = share * share * (1.0 - x * x) * (1.0 - 5.0 * x * x);
    const Vector6 second = frame.row(point, u.z, u.slope_x, u.slope_y);
    const Vector6 first = frame.row(point, point.z, point.slope_x, point.slope_y);
    const Matrix6 product = first * second.transpose();
    block.cross += 0.5 * derivative * (product + product.transpose());
    block.first += derivative * first * first.transpose();
    block.second += derivative * second * second.transpose();
    block.score += share * weight * u.residual * second;
    block.slope += derivative * (u.slope_x * point.slope_x + u.slope_y * point.slope_y);
    block.residuals += u.residual * u.residual;
    block.scores += weight * weight * u.residual * u.residual;
    rows[i] = share * second;
    ++block.samples;
  }
  return blocks;
}

Eigen::MatrixXd freeOf(const Matrix6& all, const std::vector<int>& free) {
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd some(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b)
      some(a, b) = all(free[static_cast<std::size_t>(a)], free[static_cast<std::size_t>(b)]);
  return some;
}

// The directions in which both fields' slopes have no more in common than noise gives, or than a thousandth of all slopes,
// as words. In common: the sum of their products is five standard errors, by its scatter from block to block, or, where it
// comes from a few edges, the slopes' correlation is above a half over `independent` places, at least 50: then noise
// reaches 0.5 as rarely as 3.5 standard deviations.
std::string undecided(const std::vector<BlockSum>& blocks, const Frame& frame, double rounding,
                      double independent) {
  constexpr double kErrors = 5.0, kOfSlopes = 1e-3, kCorrelation = 0.5, kFewest = 50.0;
  std::vector<Vector6> open;
  Matrix6 cross = Matrix6::Zero();
  double samples = 0.0, slopes = 0.0, used = 0.0;
  for (const BlockSum& block : blocks) {
    cross += block.cross;
    slopes += std::max(0.0, block.slope);
    samples += static_cast<double>(block.samples);
    used += block.samples > 0 ? 1.0 : 0.0;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(freeOf(cross, frame.free));
  for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
    Vector6 direction = Vector6::Zero();
    for (std::size_t a = 0; a < frame.free.size(); ++a)
      direction[frame.free[a]] = eigen.eigenvectors()(static_cast<Eigen::Index>(a), k);
    double sum = 0.0, squares = 0.0, first = 0.0, second = 0.0;
    for (const BlockSum& block : blocks) {
      const double part = direction.dot(block.cross * direction);
      first += direction.dot(block.first * direction);
      second += direction.dot(block.second * direction);
      sum += part;
      squares += part * part;
    }
    const double error = std::sqrt(std::max(0.0, squares - sum * sum / std::max(1.0, used)));
    const double least =
        samples * (rounding * rounding + kOfSlopes * kOfSlopes * slopes / std::max(1.0, samples));
    const bool alike = independent >= kFewest &&
                       sum > kCorrelation * std::sqrt(std::max(0.0, first) * std::max(0.0, second));
    if (!(sum > kErrors * error || alike) || !(sum > least)) open.push_back(direction);
  }
  return movesOf(open);
}

// Samples in a direction that become one height, for the spacing `side` that is wished for.
std::int32_t blockFor(double side, double spacing) noexcept {
  return std::max(1, static_cast<std::int32_t>(side / spacing * (1.0 + 1e-9)));
}

// Both fields at one resolution; `side` is the spacing that is wished for.
struct Maps {
  HeightMap first, second;
  double sigma = 0.0;
};
Result<Maps> mapsAt(const Version& first, const Version& second, const AlignOptions& options, double side,
                    double base_first, double base_second, JobControl& job) {
  Maps maps;
  for (const bool of_first : {true, false}) {
    const Version& field = of_first ? first : second;
    const Grid& grid = field.grid();
    auto map = heightMapOf(field, of_first ? options.region : Region::kAll,
                           std::min(grid.width, blockFor(side, grid.spacingXMm())),
                           std::min(grid.height, blockFor(side, grid.spacingYMm())),
                           of_first ? base_first : base_second, job);
    if (!map) return tl::unexpected(map.error());
    dropSpikes(*map);
    maps.sigma = std::max({maps.sigma, kSigmas * map->spacing_x, kSigmas * map->spacing_y});
    (of_first ? maps.first : maps.second) = *std::move(map);
  }
  return maps;
}

// Spacings of the resolutions [mm], the finest last: a factor of 4 from one to the next.
std::vector<double> resolutionsOf(const Grid& first, const Grid& second) {
  const double finest = std::max(spacingFor(first, kMostPlaces), spacingFor(second, kMostPlaces));
  const double coarsest = std::max(spacingFor(first, 64.0 * 64.0), spacingFor(second, 64.0 * 64.0));
  std::vector<double> sides;
  for (double side = finest; side < 1.5 * coarsest || sides.empty(); side *= kCoarser)
    sides.insert(sides.begin(), side);
  return sides;
}

// Shifts of either field by which it may be like itself [mm], each along its own axes.
struct Repeats {
  std::vector<glm::dvec2> first, second;
};
Result<Repeats> repeatsOf(const Maps& maps, JobControl& job) {
  auto first = likelyRepeats(maps.first, job), second = likelyRepeats(maps.second, job);
  if (!first) return tl::unexpected(first.error());
  if (!second) return tl::unexpected(second.error());
  return Repeats{*std::move(first), *std::move(second)};
}

std::size_t commonIn(const std::vector<Under>& under) noexcept {
  return static_cast<std::size_t>(
      std::ranges::count_if(under, [](const Under& u) { return !std::isnan(u.residual); }));
}

// The shortest further shift by which the second field fits the first as well, of those by which either may be like itself; `error`: standard
// errors of the shift that was found, within which another one is the same.
std::optional<glm::dvec2> repeatBeside(const AlignLevel& level, const Refined& best, const Frame& frame,
                                       const Repeats& repeats, const glm::dvec3& error, double sigma,
                                       double least, JobControl& job) {
  constexpr int kRounds = 15;
  constexpr double kSigmasApart = 2.0, kErrorsApart = 5.0, kOfShift = 0.5;
  const glm::dmat3& turned = best.motion.rotation;
  std::vector<glm::dvec2> shifts = repeats.first;
  for (const glm::dvec2& own : repeats.second)
    shifts.emplace_back(turned[0][0] * own.x + turned[1][0] * own.y,
                        turned[0][1] * own.x + turned[1][1] * own.y);
  std::ranges::stable_sort(shifts, {}, [](const glm::dvec2& shift) { return glm::length(shift); });
  const std::vector<Under> under = level.under(best.motion);
  std::vector<glm::dvec2> tried;
  for (const glm::dvec2& shift : shifts) {
    if (job.cancelled()) break;
    const auto alike = [&](const glm::dvec2& other) {
      return std::min(glm::length(shift - other), glm::length(shift + other)) < kSigmasApart * sigma;
    };
    if (std::ranges::any_of(tried, alike)) continue;
    tried.push_back(shift);
    // There and back it is the same period: that which leaves more in common.
    const RigidMotion there = best.motion.then(glm::dvec3(shift, 0.0), glm::dvec3(0.0)),
                      back = best.motion.then(glm::dvec3(-shift, 0.0), glm::dvec3(0.0));
    const bool more_there = commonIn(level.under(there)) >= commonIn(level.under(back));
    const Refined other = refine(level, more_there ? there : back, frame, kRounds, least, job);
    const glm::dvec2 apart(other.motion.shift - best.motion.shift);
    const double same = std::max(kSigmasApart * sigma, kErrorsApart * glm::length(error));
    if (glm::length(apart) < std::max(same, kOfShift * glm::length(shift))) continue;
    if (fitsAsWell(level, under, level.under(other.motion), best.spread)) return apart;
  }
  return std::nullopt;
}

}  // namespace

FinestAlignment finestAlignment(const Grid& first, const Grid& second) {
  const std::vector<double> sides = resolutionsOf(first, second);
  FinestAlignment finest{.spacing_mm = sides.back(),
                         .starts = sides.size() > 1 ? kFinerStarts : 0,
                         .resolutions = static_cast<int>(sides.size())};
  const auto across = [&](double spacing, std::int32_t samples) {
    return std::max(1, samples / std::min(samples, blockFor(finest.spacing_mm, spacing)));
  };
  const std::int32_t columns = across(first.spacingXMm(), first.width),
                     rows = across(first.spacingYMm(), first.height);
  const auto places = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const std::int32_t stride = AlignLevel::strideFor(places);
  finest.places = places;
  finest.points = static_cast<std::size_t>((columns + stride - 1) / stride) *
                  static_cast<std::size_t>((rows + stride - 1) / stride);
  return finest;
}

Result<Alignment> alignFields(const Version& first, const Version& second, const AlignOptions& options,
                              JobControl& job) {
  for (const Version* field : {&first, &second})
    if (field->reader().bounds().empty())
      return inputError("a field without a height cannot be aligned",
                        field == &first ? options.words.first : options.words.second);
  if (!anyIn(first.reader(), options.region)) return nothingIn(options.region, options.words.first);
  const Grid &grid = first.grid(), &other = second.grid();
  // Heights less a height of each: what is small beside it keeps its digits.
  const auto of_first = heightsAround(first, options.region, job),
             of_second = heightsAround(second, Region::kAll, job);
  if (!of_first) return tl::unexpected(of_first.error());
  if (!of_second) return tl::unexpected(of_second.error());
  const double base_first = of_first->middle, base_second = of_second->middle;
  const double rounding_mm =
      std::numeric_limits<float>::epsilon() * std::max(of_first->size, of_second->size);
  const glm::dvec2 size(grid.spacingXMm() * (grid.width - 1), grid.spacingYMm() * (grid.height - 1));
  const double arm = std::max(0.5 * glm::length(size), 1e-9);
  Frame frame = frameOf(glm::dvec3(0.5 * size, 0.0), arm, options.moves);

  const std::vector<double> sides = resolutionsOf(grid, other);
  // Where the files place both, if that makes them overlap; else both begin at one corner.
  RigidMotion stated{glm::dmat3(1.0), glm::dvec3(0.0), frame.centre};
  const glm::dvec2 offset(other.origin_x * other.lateral_unit.mm - grid.origin_x * grid.lateral_unit.mm,
                          other.origin_y * other.lateral_unit.mm - grid.origin_y * grid.lateral_unit.mm);
  const glm::dvec2 other_size(other.spacingXMm() * (other.width - 1),
                              other.spacingYMm() * (other.height - 1));
  if (offset.x < size.x && offset.y < size.y && -offset.x < other_size.x && -offset.y < other_size.y)
    stated.shift = glm::dvec3(offset, 0.0);

  std::vector<Refined> candidates;
  std::optional<AlignLevel> level;
  std::size_t whole = 0;
  double sigma = 0.0;
  Repeats repeats;
  const double least = std::max(rounding_mm, 1e-12 * arm);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Stopwatch watch;
    const auto maps = mapsAt(first, second, options, sides[k], base_first, base_second, job);
    if (!maps) return tl::unexpected(maps.error());
    level.emplace(maps->first, maps->second, maps->sigma);
    sigma = maps->sigma;
    whole = level->points().size();
    const double map_seconds = watch.seconds();
    if (whole < 12)
      return inputError(fmt::format("{} heights of {} are whole after a Gaussian window of {:.3g} mm, which "
                                    "reaches over no border and "
                                    "no hole: too few to align by",
                                    whole, options.words.first, sigma),
                        options.words.first,
                        options.region == Region::kAll
                            ? "give a scan that is some 20 samples wide and high, or fill its holes"
                            : "let a larger part of it count, or all of it");
    const bool last = k + 1 == sides.size();
    if (last && options.search && options.moves.shift) {
      auto found = repeatsOf(*maps, job);
      if (!found) return tl::unexpected(found.error());
      repeats = *std::move(found);
    }
    std::vector<RigidMotion> starts;
    if (k == 0) {
      starts.push_back(stated);
      if (options.search && options.moves.shift)
        for (RigidMotion& motion :
             likelyMotions(maps->first, maps->second,
                           options.moves.rotation ? options.most_rotation_deg : 0.0, frame.centre, job))
          starts.push_back(motion);
    } else {
      for (const Refined& candidate : candidates) starts.push_back(candidate.motion);
    }
    if (job.cancelled()) return cancelled();
    job.begin("aligning", starts.size());
    const Stopwatch refining;
    std::vector<Refined> refined;
    refined.reserve(starts.size());
    for (const RigidMotion& start : starts) {
      refined.push_back(refine(*level, start, frame, last ? 60 : 30, least, job));
      job.advance();
    }
    if (job.cancelled()) return cancelled();
    if (options.stages != nullptr)
      options.stages->push_back({.resolution = static_cast<int>(k),
                                 .places = maps->first.z.size(),
                                 .points = whole,
                                 .starts = starts.size(),
                                 .map_seconds = map_seconds,
                                 .refine_seconds = refining.seconds()});
    std::ranges::stable_sort(refined, std::greater<>(), &Refined::gain);
    // Where shapes repeat, the finer heights decide.
    refined.resize(std::min<std::size_t>(refined.size(), last ? 1 : kFinerStarts));
    candidates = std::move(refined);
  }
  const Refined& best = candidates.front();
  constexpr double kLeastOverlap = 0.05;
  const double overlap = static_cast<double>(best.common) / static_cast<double>(whole);
  if (best.common < 12 || overlap < kLeastOverlap)
    return inputError(fmt::format("{} and {} have too little in common to be aligned", options.words.first,
                                  options.words.second),
                      options.words.second,
                      fmt::format("are they scans of one part? {}", options.words.wider));

  std::vector<Vector6> rows;
  const std::vector<BlockSum> blocks = blockSums(*level, best, frame, rows);
  const double rounding = 4.0 * rounding_mm / level->leastSpacing();
  if (const std::string moves = undecided(blocks, frame, rounding, level->independent(best.common));
      !moves.empty())
    return inputError(fmt::format("the surface does not decide {}", moves), "alignment",
                      options.moves.tilt || options.moves.rotation || options.moves.shift
                          ? fmt::format("allow fewer motions; {}; or are they scans of different parts?",
                                        options.words.wider)
                          : "are they scans of different parts?");
  Matrix6 cross = Matrix6::Zero(), spread = Matrix6::Zero();
  Alignment result;
  double squares = 0.0, scores = 0.0, used = 0.0;
  std::int64_t left_out = 0;
  for (const BlockSum& block : blocks) {
    cross += block.cross;
    squares += block.residuals;
    scores += block.scores;
    left_out += block.left_out;
    result.samples += block.samples;
    used += block.samples > 0 ? 1.0 : 0.0;
  }
  for (const BlockSum& block : blocks)
    if (block.samples > 0) spread += block.score * block.score.transpose();
  const auto n = static_cast<double>(frame.free.size());
  spread *= used / std::max(1.0, used - n);
  // Independent noise in every sample, as both windows leave it; where block sums scatter by more than that explains,
  // at three standard errors of theirs, their scatter counts.
  // Two alike files still have heights that were rounded to float.
  const double variance =
      std::max(scores / std::max(1.0, static_cast<double>(result.samples)), rounding_mm * rounding_mm / 12.0);
  const Matrix6 expected = variance * level->correlatedSum(rows, AlignLevel::Pairs::kAll);
  const Eigen::MatrixXd in_blocks =
      freeOf(variance * level->correlatedSum(rows, AlignLevel::Pairs::kWithinBlocks), frame.free);
  const double excess = in_blocks.ldlt().solve(freeOf(spread, frame.free)).trace() / n;
  const double factor = excess > 1.0 + 3.0 * std::sqrt(2.0 / (n * std::max(1.0, used - n))) ? excess : 1.0;
  spread = factor * expected;
  const Eigen::MatrixXd inverse =
      freeOf(cross, frame.free)
          .ldlt()
          .solve(Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n)));
  const Eigen::MatrixXd some = inverse * freeOf(spread, frame.free) * inverse;
  Matrix6 covariance = Matrix6::Zero();
  for (std::size_t a = 0; a < frame.free.size(); ++a)
    for (std::size_t b = 0; b < frame.free.size(); ++b) {
      const double turned = (frame.free[a] > 2 ? arm : 1.0) * (frame.free[b] > 2 ? arm : 1.0);
      covariance(frame.free[a], frame.free[b]) =
          some(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) / turned;
    }
  // Of absolute heights again: a point of B at height z was z - base_second here.
  result.motion = best.motion;
  result.motion.centre.z = base_first;
  result.motion.shift +=
      glm::dvec3(0.0, 0.0, base_first) - best.motion.rotation * glm::dvec3(0.0, 0.0, base_second) +
      best.motion.rotation * glm::dvec3(0.0, 0.0, base_first) - glm::dvec3(0.0, 0.0, base_first);
  result.angles = result.motion.angles();
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b) result.covariance[static_cast<std::size_t>(6 * a + b)] = covariance(a, b);
  // How shift and angles follow a small motion beyond.
  Matrix6 by;
  for (int k = 0; k < 6; ++k) {
    constexpr double kSmall = 1e-6;
    glm::dvec3 shift(0.0), turn(0.0);
    (k < 3 ? shift[k] : turn[k - 3]) = kSmall;
    const RigidMotion more = result.motion.then(shift, turn);
    const RigidMotion::Angles angles = more.angles();
    by.col(k) << more.shift.x - result.motion.shift.x, more.shift.y - result.motion.shift.y,
        more.shift.z - result.motion.shift.z, angles.tilt_x - result.angles.tilt_x,
        angles.tilt_y - result.angles.tilt_y, angles.rotation_z - result.angles.rotation_z;
    by.col(k) /= kSmall;
  }
  const Matrix6 stated_errors = by * covariance * by.transpose();
  const auto errorOf = [&](int k) { return std::sqrt(std::max(0.0, stated_errors(k, k))); };
  result.shift_error = {errorOf(0), errorOf(1), errorOf(2)};
  result.angle_error = {errorOf(3), errorOf(4), errorOf(5)};
  result.rms_mm = std::sqrt(squares / std::max(1.0, static_cast<double>(result.samples)));
  result.overlap = overlap;
  result.left_out =
      static_cast<double>(left_out) / static_cast<double>(std::max<std::size_t>(1, best.common));
  result.sigma_mm = sigma;
  result.repeat = repeatBeside(*level, best, frame, repeats, result.shift_error, sigma, least, job);
  if (job.cancelled()) return cancelled();
  return result;
}

}  // namespace fettle::engine

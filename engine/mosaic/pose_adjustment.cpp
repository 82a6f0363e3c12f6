#include "engine/mosaic/pose_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using SixBySix = Eigen::Matrix<double, 6, 6>;

// The same motion about another centre.
RigidMotion aboutPlace(const RigidMotion& motion, const glm::dvec3& centre) noexcept {
  return {motion.rotation, motion.moved(centre) - centre, centre};
}

RigidMotion inverseOf(const RigidMotion& motion) noexcept {
  const glm::dmat3 back = glm::transpose(motion.rotation);
  return {back, motion.movedBack(motion.centre) - motion.centre, motion.centre};
}

RigidMotion joinedMotions(const RigidMotion& first, const RigidMotion& second) noexcept {
  return {second.rotation * first.rotation, second.moved(first.moved(first.centre)) - first.centre,
          first.centre};
}

// The vector of a turn, its length the angle [rad].
glm::dvec3 turnOf(const glm::dmat3& r) noexcept {
  const glm::dvec3 twice(r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
  const double sine = 0.5 * glm::length(twice), cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0);
  const double angle = std::atan2(sine, cosine);
  return sine > 1e-12 ? (0.5 * angle / sine) * twice : 0.5 * twice;
}

// How a small motion of a scan about its middle moves a place: t + w x from_middle; turns in units of 1 / arm.
SixBySix movesPlace(const glm::dvec3& from_middle, double arm) {
  SixBySix j = SixBySix::Identity();
  const glm::dvec3 d = from_middle / arm;
  j.block<3, 3>(0, 3) << 0.0, d.z, -d.y, -d.z, 0.0, d.x, d.y, -d.x, 0.0;
  return j;
}

std::vector<int> freeOnes(const AlignMoves& moves) {
  std::vector<int> free{2};
  if (moves.shift) free.insert(free.end(), {0, 1});
  if (moves.tilt) free.insert(free.end(), {3, 4});
  if (moves.rotation) free.push_back(5);
  std::ranges::sort(free);
  return free;
}

Eigen::MatrixXd chosenOf(const SixBySix& all, const std::vector<int>& free) {
  return all(free, free);
}

// The tree of the surest pairs from the first scan (R. Prim 1957); false for scans that no pair reaches.
std::vector<bool> posesByTree(const std::vector<PairMotion>& pairs, std::vector<RigidMotion>& poses) {
  std::vector<bool> placed(poses.size(), false);
  placed[0] = true;
  for (;;) {
    const PairMotion* surest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const PairMotion& pair : pairs) {
      if (placed[pair.first] == placed[pair.second]) continue;
      const double size = pair.covariance[0] + pair.covariance[7] + pair.covariance[14];
      if (!(size < least)) continue;
      least = size;
      surest = &pair;
    }
    if (surest == nullptr) return placed;
    if (placed[surest->first])
      poses[surest->second] = joinedMotions(surest->motion, poses[surest->first]);
    else
      poses[surest->first] = joinedMotions(inverseOf(surest->motion), poses[surest->second]);
    placed[surest->first] = placed[surest->second] = true;
  }
}

struct PairTerm {
  Eigen::MatrixXd weight;  // of the free ones
  SixBySix first, second;  // how a small motion of each scan moves the place
  Six misfit;              // how much too far the second lies, turns times arm
};

PairTerm termOf(const PairMotion& pair, const std::vector<RigidMotion>& poses, double arm,
                const std::vector<int>& free) {
  constexpr double kLeast = 1e-9;  // [mm]
  const RigidMotion &a = poses[pair.first], &b = poses[pair.second];
  const glm::dvec3 place = a.moved(pair.motion.centre);
  const RigidMotion stated = joinedMotions(pair.motion, a);
  const glm::dvec3 off = b.moved(stated.movedBack(place)) - place,
                   turn = arm * turnOf(b.rotation * glm::transpose(stated.rotation));
  PairTerm term;
  term.misfit << off.x, off.y, off.z, turn.x, turn.y, turn.z;
  SixBySix covariance, turned = SixBySix::Zero();
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c)
      covariance(r, c) =
          pair.covariance[static_cast<std::size_t>(6 * r + c)] * (r > 2 ? arm : 1.0) * (c > 2 ? arm : 1.0);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) turned(r, c) = turned(r + 3, c + 3) = a.rotation[c][r];
  covariance = turned * covariance * turned.transpose();
  covariance.diagonal().array() += kLeast * kLeast;
  const auto n = static_cast<Eigen::Index>(free.size());
  term.weight = chosenOf(covariance, free).ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  term.first = movesPlace(place - (a.centre + a.shift), arm);
  term.second = movesPlace(place - (b.centre + b.shift), arm);
  return term;
}

}  // namespace

std::array<double, 36> AdjustedPoses::between(std::size_t a, std::size_t b, const glm::dvec3& place) const {
  const auto blockOf = [this](std::size_t p, std::size_t q) {
    SixBySix block = SixBySix::Zero();
    const std::size_t side = 6 * (poses.size() - 1);
    if (p > 0 && q > 0)
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t c = 0; c < 6; ++c)
          block(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
              covariance[(6 * (p - 1) + r) * side + 6 * (q - 1) + c];
    return block;
  };
  const SixBySix of_a = movesPlace(place - (poses[a].centre + poses[a].shift), arm),
                 of_b = movesPlace(place - (poses[b].centre + poses[b].shift), arm);
  const SixBySix cross = of_a * blockOf(a, b) * of_b.transpose();
  const SixBySix all = of_a * blockOf(a, a) * of_a.transpose() + of_b * blockOf(b, b) * of_b.transpose() -
                       cross - cross.transpose();
  std::array<double, 36> out{};
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c)
      out[static_cast<std::size_t>(6 * r + c)] = all(r, c) / ((r > 2 ? arm : 1.0) * (c > 2 ? arm : 1.0));
  return out;
}

double AdjustedPoses::heightError(std::size_t a, std::size_t b, const glm::dvec3& place) const {
  return std::sqrt(std::max(0.0, between(a, b, place)[14]));
}

Result<AdjustedPoses> adjustPoses(const std::vector<glm::dvec3>& middles,
                                  const std::vector<PairMotion>& pairs, const AlignMoves& moves) {
  constexpr int kRounds = 20;
  const std::size_t scans = middles.size();
  const std::vector<int> free = freeOnes(moves);
  AdjustedPoses result;
  result.poses.assign(scans, RigidMotion{});
  const std::vector<bool> placed = posesByTree(pairs, result.poses);
  for (std::size_t k = 0; k < scans; ++k)
    if (!placed[k]) return inputError("a scan overlaps none of the others", std::to_string(k));
  result.arm = 1e-9;
  for (std::size_t k = 0; k < scans; ++k) {
    result.poses[k] = aboutPlace(result.poses[k], middles[k]);
    result.arm = std::max(result.arm, std::hypot(middles[k].x, middles[k].y));
  }
  const auto each = static_cast<Eigen::Index>(free.size());
  const Eigen::Index unknowns = each * static_cast<Eigen::Index>(scans - 1);
  Eigen::MatrixXd normal;
  for (int round = 0;; ++round) {
    normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    result.misfit = 0.0;
    for (const PairMotion& pair : pairs) {
      const PairTerm term = termOf(pair, result.poses, result.arm, free);
      const Eigen::VectorXd misfit = term.misfit(free);
      const Eigen::MatrixXd first = chosenOf(term.first, free), second = chosenOf(term.second, free);
      result.misfit += misfit.dot(term.weight * misfit);
      const auto add = [&](std::size_t p, const Eigen::MatrixXd& jp, double sign_p, std::size_t q,
                           const Eigen::MatrixXd& jq, double sign_q) {
        if (p == 0 || q == 0) return;
        normal.block(each * static_cast<Eigen::Index>(p - 1), each * static_cast<Eigen::Index>(q - 1), each,
                     each) += sign_p * sign_q * jp.transpose() * term.weight * jq;
      };
      add(pair.first, first, -1.0, pair.first, first, -1.0);
      add(pair.first, first, -1.0, pair.second, second, 1.0);
      add(pair.second, second, 1.0, pair.first, first, -1.0);
      add(pair.second, second, 1.0, pair.second, second, 1.0);
      if (pair.first > 0)
        right.segment(each * static_cast<Eigen::Index>(pair.first - 1), each) +=
            first.transpose() * term.weight * misfit;
      if (pair.second > 0)
        right.segment(each * static_cast<Eigen::Index>(pair.second - 1), each) -=
            second.transpose() * term.weight * misfit;
    }
    if (unknowns == 0 || round == kRounds) break;
    const Eigen::VectorXd step = normal.ldlt().solve(right);
    for (std::size_t k = 1; k < scans; ++k) {
      Six all = Six::Zero();
      for (Eigen::Index i = 0; i < each; ++i)
        all[free[static_cast<std::size_t>(i)]] = step[each * static_cast<Eigen::Index>(k - 1) + i];
      RigidMotion& pose = result.poses[k];
      const glm::dvec3 middle = pose.centre + pose.shift;
      // A turn about the scan's middle where it now lies.
      const RigidMotion more = RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), middle}.then(
          {all[0], all[1], all[2]}, glm::dvec3(all[3], all[4], all[5]) / result.arm);
      pose = joinedMotions(pose, more);
    }
    // Until a step is a thousandth of its standard error.
    if (step.dot(normal * step) < 1e-6 * static_cast<double>(unknowns)) break;
  }
  result.freedom = static_cast<int>(each) * (static_cast<int>(pairs.size()) - static_cast<int>(scans) + 1);
  if (result.freedom > 0) result.factor = std::max(1.0, std::sqrt(result.misfit / result.freedom));
  const Eigen::MatrixXd some =
      unknowns == 0 ? Eigen::MatrixXd()
                    : Eigen::MatrixXd(result.factor * result.factor *
                                      normal.ldlt().solve(Eigen::MatrixXd::Identity(unknowns, unknowns)));
  const std::size_t side = 6 * (scans - 1);
  result.covariance.assign(side * side, 0.0);
  for (Eigen::Index r = 0; r < unknowns; ++r)
    for (Eigen::Index c = 0; c < unknowns; ++c) {
      const auto at = [&](Eigen::Index i) {
        return static_cast<std::size_t>(6 * (i / each) + free[static_cast<std::size_t>(i % each)]);
      };
      result.covariance[at(r) * side + at(c)] = some(r, c);
    }
  return result;
}

}  // namespace fettle::engine

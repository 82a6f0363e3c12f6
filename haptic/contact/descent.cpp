#include "haptic/contact/descent.h"

#include <cmath>
#include <utility>

#include "haptic/contact/pair.h"
#include "haptic/contact/patch_inl.h"

namespace fettle::haptic {

namespace {

using namespace detail;

// The state of one call of searchDownhill. Everything is inlined into it: most of a tick's time is spent here.
class Descent {
 public:
  // `patches`: room for two; outside, so that the rest can be held in registers.
  Descent(Surface& surface, Patch* patches, const glm::dvec3& endpoint, CellIndex start, Pair at) noexcept
      : surface_(surface),
        endpoint_(endpoint),
        spacing_{surface.spacingX(), surface.spacingY()},
        here_(patches),
        beyond_(patches + 1),
        cell_(start),
        at_(at),
        last_(at) {}

  [[gnu::always_inline]] inline SearchResult run(int most_rounds) noexcept;

 private:
  // Outcome of a search around the present point.
  enum class Outcome : std::uint8_t { kMoved, kRests, kSlides };
  static constexpr int kNoSide = -1;

  [[gnu::always_inline]] inline bool retreat() noexcept;
  [[gnu::always_inline]] inline Outcome searchAcross(const PatchView& p, PairMask across, int side) noexcept;
  [[gnu::always_inline]] inline Outcome searchAround(const PatchView& p, int upper) noexcept;
  [[gnu::always_inline]] inline bool enter(int dc, int dr, double f) noexcept;

  // Makes the patch in `beyond_` the present one.
  [[gnu::always_inline]] inline void cross(CellIndex cell, Pair at, double f) noexcept {
    std::swap(here_, beyond_);
    cell_ = cell;
    at_ = last_ = at;
    last_f_ = crossed_f_ = f;
    newton_failed_ = false;
    shrinks_ = 0;
    rounds_here_ = 0;
    side_of_beyond_ = kNoSide;
    ++result_.cells;
  }

  Surface& surface_;
  const glm::dvec3& endpoint_;
  const Pair spacing_;
  Patch* here_;
  Patch* beyond_;                 // the neighbour examined
  int side_of_beyond_ = kNoSide;  // behind which side of the present cell beyond_ lies
  bool beyond_there_ = false;     // that neighbour exists
  CellIndex cell_;
  Pair at_;
  Pair last_;  // where distance was last seen to fall
  double last_f_ = HUGE_VAL;
  double crossed_f_ = HUGE_VAL;  // distance at the last crossing: to cross again it must have become smaller,
                                 // so that rounding cannot make the search alternate
  bool newton_failed_ = false;
  int shrinks_ = 0;
  int rounds_here_ = 0;
  SearchResult result_;
};

// Newton's step was too long: try a part of it, since it starts downhill; when even a small part is no
// better, one coordinate at a time; when that is no better either, only rounding is left, and it returns
// false.
bool Descent::retreat() noexcept {
  if (shrinks_ < kMostShrinks) {
    ++shrinks_;
    at_ = last_ + 0.25 * (at_ - last_);
    return true;
  }
  at_ = last_;
  if (newton_failed_) return false;
  newton_failed_ = true;
  last_f_ = HUGE_VAL;
  return true;
}

// On a side that stops the descent, in the lane that `across` names: does distance fall beyond it? Both
// patches have the same slope along their common side; only the slope across is the neighbour's own.
Descent::Outcome Descent::searchAcross(const PatchView& p, PairMask across, int side) noexcept {
  const bool first = (side & 4) != 0;
  const int way = (side & 3) != 0 ? 1 : -1;
  const CellIndex other{cell_.column + (first ? way : 0), cell_.row + (first ? 0 : way)};
  if (side_of_beyond_ != side) {
    side_of_beyond_ = side;
    beyond_there_ = surface_.hasCell(other) && surface_.patch(other, *beyond_);
  }
  if (!beyond_there_ || !(p.f < crossed_f_)) return Outcome::kSlides;
  const Pair slope = Pair{beyond_->b, beyond_->c} + Pair{beyond_->d, beyond_->d} * swapped(at_);
  const Pair g = spacing_ * p.away + Pair{p.z, p.z} * slope;
  const PairMask falls = way > 0 ? less(g, Pair{0.0, 0.0}) : less(Pair{0.0, 0.0}, g);
  if (lanes(both(across, falls)) == 0) return Outcome::kSlides;
  cross(other, chosen(across, Pair{1.0, 1.0} - at_, at_), p.f);
  return Outcome::kMoved;
}

bool Descent::enter(int dc, int dr, double f) noexcept {
  const CellIndex other{cell_.column + dc, cell_.row + dr};
  side_of_beyond_ = kNoSide;
  if (!surface_.hasCell(other) || !surface_.patch(other, *beyond_)) return false;
  cross(other, Pair{dc != 0 ? 1.0 - at_[0] : at_[0], dr != 0 ? 1.0 - at_[1] : at_[1]}, f);
  return true;
}

// At a vertex that stops the descent. Four edges meet there, along which the slopes of the four cells are
// those of the edges; the present cell has two of them and distance falls along neither.
Descent::Outcome Descent::searchAround(const PatchView& p, int upper) noexcept {
  const int up_u = upper & 1;
  const int up_v = upper >> 1;
  const int dc = 2 * up_u - 1;
  const int dr = 2 * up_v - 1;
  const Surface::Star star = surface_.star(cell_.column + up_u, cell_.row + up_v, dc, dr);
  const double height = here_->heightAt(at_[0], at_[1]);
  // A hole's NaN makes these false.
  const bool may_cross = p.f < crossed_f_;
  const bool falls_u = may_cross && spacing_[0] * p.away[0] * dc + p.z * (star.across_u - height) < 0.0;
  const bool falls_v = may_cross && spacing_[1] * p.away[1] * dr + p.z * (star.across_v - height) < 0.0;
  if ((falls_u && falls_v && enter(dc, dr, p.f)) || (falls_u && (enter(dc, 0, p.f) || enter(dc, dr, p.f))) ||
      (falls_v && (enter(0, dr, p.f) || enter(dc, dr, p.f))))
    return Outcome::kMoved;
  result_.ringed = !falls_u && !falls_v && star.complete();
  return Outcome::kRests;
}

SearchResult Descent::run(int most_rounds) noexcept {
  if (!surface_.patch(cell_, *here_)) return result_;
  const Pair zero{0.0, 0.0};
  const Pair one{1.0, 1.0};
  result_.cells = 1;
  result_.end = SearchEnd::kBound;
  bool settled = false;  // no step inside the patch makes the distance smaller
  for (int round = 0; round < most_rounds && result_.cells < kMaxCellsVisited; ++round) {
    const Patch& s = *here_;
    const Pair e = Pair{endpoint_.x, endpoint_.y} - Pair{s.x0, s.y0};
    const double ez = endpoint_.z - s.a;
    const PatchView p(s, spacing_, e, ez, at_);
    if (p.f > last_f_ * kSame) [[unlikely]] {
      settled = !retreat();
      continue;
    }
    shrinks_ = 0;
    last_ = at_;
    last_f_ = p.f;
    // After that many rounds in one cell only rounding moves it.
    if (++rounds_here_ > kNewtonSteps) [[unlikely]]
      settled = true;

    const Pair g = p.gradient(spacing_);
    const Pair h = p.curvature(spacing_);
    const PairMask low = equal(at_, zero);
    const PairMask high = equal(at_, one);
    int held = settled ? lanes(either(low, high))
                       : lanes(either(both(low, atMost(zero, g)), both(high, atMost(g, zero))));
    if (held == 0 && !settled) {
      const PatchStep step = stepInside(s, spacing_, ez, at_, p, g, h, newton_failed_);
      at_ = step.to;
      settled = step.last;
      if (!settled || lanes(either(equal(at_, zero), equal(at_, one))) != 0) continue;
    }
    if (held == 0) {
      result_.end = SearchEnd::kAtRest;
      result_.ringed = true;
      break;
    }
    if (held != 3) {
      const PairMask across = held == 1 ? firstLane() : secondLane();
      if (searchAcross(p, across, held << 2 | (lanes(high) & held)) == Outcome::kMoved) {
        settled = false;
        continue;
      }
      // Along an edge the distance is quadratic: one exact step, and the next round checks it. Both lanes are
      // stepped and one is discarded, because a branch predictor cannot predict which one.
      const Pair to = settled ? at_ : chosen(across, at_, unit(at_ - g / h));
      const Pair moved = absolute(to - at_);
      at_ = to;
      newton_failed_ = false;
      if (moved[0] + moved[1] > kLastCoordinateStep) continue;
      held = lanes(either(equal(at_, zero), equal(at_, one)));
      if (held != 3) {
        result_.end = SearchEnd::kAtRest;
        result_.ringed = beyond_there_;
        break;
      }
    }
    if (searchAround(p, lanes(equal(at_, one))) == Outcome::kRests) {
      result_.end = SearchEnd::kAtRest;
      break;
    }
    settled = false;
  }
  if (result_.end != SearchEnd::kAtRest) at_ = last_;
  const glm::dvec3 point = here_->at(at_[0], at_[1]);
  const glm::dvec3 d = point - endpoint_;
  result_.point = {cell_, at_[0], at_[1], point, d.x * d.x + d.y * d.y + d.z * d.z};
  return result_;
}

}  // namespace

SearchResult searchDownhill(Surface& surface, const glm::dvec3& endpoint, CellIndex start, double u, double v,
                            int most_rounds) noexcept {
  Patch patches[2];
  return Descent(surface, patches, endpoint, start, Pair{u, v}).run(most_rounds);
}

}  // namespace fettle::haptic

#include "haptic/contact/sphere_window.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "haptic/contact/normal.h"
#include "haptic/contact/sphere_collector.h"
#include "haptic/contact/sphere_valley.h"

namespace fettle::haptic {

namespace {

// Index of a coordinate, within [low, high] whatever the coordinate is.
std::int32_t indexWithin(double x, std::int32_t low, std::int32_t high) noexcept {
  return static_cast<std::int32_t>(
      std::clamp(std::floor(x), static_cast<double>(low), static_cast<double>(high)));
}

}  // namespace

void SphereWindow::load(const Surface& surface, const glm::dvec3& centre, double reach_mm,
                        double room_mm) noexcept {
  const engine::FieldReader& reader = surface.reader();
  sx_ = surface.spacingX();
  sy_ = surface.spacingY();
  const double around = reach_mm + room_mm;
  // One cell more than the ball reaches: its neighbour decides whether a side of a cell is a rim.
  const auto first = [&](double x, double s, std::int32_t samples) {
    return indexWithin((x - around) / s, -1, samples + 1) - 1;
  };
  const auto last = [&](double x, double s, std::int32_t samples) {
    return indexWithin((x + around) / s, -1, samples + 1) + 2;
  };
  column_ = first(centre.x, sx_, reader.width());
  row_ = first(centre.y, sy_, reader.height());
  columns_ = std::min(last(centre.x, sx_, reader.width()) - column_ + 1, kMostSide);
  rows_ = std::min(last(centre.y, sy_, reader.height()) - row_ + 1, kMostSide);
  low_x_ = centre.x - room_mm;
  high_x_ = centre.x + room_mm;
  low_y_ = centre.y - room_mm;
  high_y_ = centre.y + room_mm;

  reader.readHeights(column_, row_, columns_, rows_, raw_.data(), columns_);
  const double unit = surface.heightUnit();
  const std::int32_t samples = columns_ * rows_;
  double highest = -HUGE_VAL;
  double lowest = HUGE_VAL;
  double sum = 0.0;  // NaN when there is one; separate from the maximum, which ignores NaN
  for (std::int32_t k = 0; k < samples; ++k) {
    const double z = unit * static_cast<double>(raw_[static_cast<std::size_t>(k)]);
    z_[static_cast<std::size_t>(k)] = z;
    highest = z > highest ? z : highest;
    lowest = z < lowest ? z : lowest;
    sum += z * 0.0;
  }
  highest_ = highest;
  whole_ = sum == 0.0;
  gathered_ = false;
  // Farther from 0 than that, roundings of a height are not small beside the bounds' room for them.
  boundable_ = std::max(highest, -lowest) <= 1e8 * std::min(sx_, sy_);
  sphereContactKernels().prepare(laneWindow(), rows_, boundable_ ? 0.0 : HUGE_VAL, bounds_);
  markRims();
  // Twice the range of heights is the largest twist.
  has_steep_cells_ = steep(2.0 * (highest - lowest)) && markSteep();
}

bool SphereWindow::markSteep() noexcept {
  const auto steepAt = [&](std::int32_t i, std::int32_t j) {
    const Corners z = corners(i, j);
    return steep((z.z11 - z.z01) - (z.z10 - z.z00));
  };
  // Of most windows with high walls, no cell.
  const auto none = [&] {
    for (std::int32_t j = 0; j + 1 < rows_; ++j)
      for (std::int32_t i = 0; i + 1 < columns_; ++i)
        if (steepAt(i, j)) return false;
    return true;
  };
  if (none()) return false;
  for (std::int32_t j = 0; j < rows_; ++j) {
    const double* z = z_.data() + j * columns_;
    double highest = -HUGE_VAL;
    for (std::int32_t i = 0; i < columns_; ++i) highest = z[i] > highest ? z[i] : highest;
    row_top_[static_cast<std::size_t>(j)] = highest;
  }
  for (std::int32_t j = 0; j + 1 < rows_; ++j) {
    std::uint64_t row = 0;
    for (std::int32_t i = 0; i + 1 < columns_; ++i) row |= std::uint64_t{steepAt(i, j) ? 1U : 0U} << i;
    steep_[static_cast<std::size_t>(j)] = row;
  }
  return true;
}

bool SphereWindow::steepNear(const glm::dvec3& at, double reach_mm) const noexcept {
  if (!has_steep_cells_) return false;
  const Box box = boxAround(at, reach_mm);
  const std::uint64_t columns = columnsOf(box);
  for (std::int32_t j = box.j0; j <= box.j1; ++j)
    if ((steep_[static_cast<std::size_t>(j)] & columns) != 0) return true;
  return false;
}

int SphereWindow::steepCells(const glm::dvec3& at, double reach_mm) const noexcept {
  if (!has_steep_cells_) return 0;
  const Box box = boxAround(at, reach_mm);
  const std::uint64_t columns = columnsOf(box);
  const double reach2 = reach_mm * reach_mm;
  int cells = 0;
  for (std::int32_t j = box.j0; j <= box.j1; ++j) {
    std::uint64_t row = steep_[static_cast<std::size_t>(j)] & columns;
    const double dy = beyondRange(at.y, (row_ + j) * sy_, (row_ + j + 1) * sy_);
    const double left = reach2 - dy * dy;
    const auto at_j = static_cast<std::size_t>(j);
    const double row_gap = std::max(at.z - std::max(row_top_[at_j], row_top_[at_j + 1]), 0.0);
    if (!(row_gap * row_gap < left)) continue;
    for (; row != 0; row &= row - 1) {
      const std::int32_t i = std::countr_zero(row);
      const double gap = std::max(at.z - bounds_.top[static_cast<std::size_t>(j * columns_ + i)], 0.0);
      const double dx = beyondRange(at.x, (column_ + i) * sx_, (column_ + i + 1) * sx_);
      if (!(gap * gap + dx * dx < left)) continue;
      const Corners z = corners(i, j);
      cells += tooNarrow((z.z11 - z.z01) - (z.z10 - z.z00)) ? 0 : 1;
    }
  }
  return cells;
}

bool SphereWindow::columnWithin(const glm::dvec3& at, double distance_mm) const noexcept {
  if (!has_steep_cells_ || !(distance_mm > 0.0)) return false;
  const Box box = boxAround(at, distance_mm);
  for (std::int32_t j = box.j0; j <= box.j1 + 1; ++j) {
    const double dy = at.y - (row_ + j) * sy_;
    const double left = distance_mm * distance_mm - dy * dy;
    const double row_gap = std::max(at.z - row_top_[static_cast<std::size_t>(j)], 0.0);
    if (!(row_gap * row_gap < left)) continue;
    const double* z = z_.data() + j * columns_;
    for (std::int32_t i = box.i0; i <= box.i1 + 1; ++i) {
      const double dx = at.x - (column_ + i) * sx_;
      const double gap = at.z > z[i] ? at.z - z[i] : 0.0;
      if (!(dx * dx + gap * gap < left) || std::isnan(z[i])) continue;
      // A sample of no cell has no material below it.
      if (whole_ || valid(i, j) || valid(i - 1, j) || valid(i, j - 1) || valid(i - 1, j - 1)) return true;
    }
  }
  return false;
}

// Cells that the lanes cannot look at.
void SphereWindow::markRims() noexcept {
  const auto rim = [&](std::int32_t i, std::int32_t j) -> std::uint8_t& {
    return bounds_.rim[static_cast<std::size_t>(j * columns_ + i)];
  };
  if (whole_) {
    // Its border, which a ball that it holds does not reach: neighbours are missing there.
    std::fill_n(bounds_.rim.begin(), columns_ * rows_, std::uint8_t{0});
    for (std::int32_t i = 0; i + 1 < columns_; ++i) rim(i, 0) = rim(i, rows_ - 2) = 1;
    for (std::int32_t j = 0; j + 1 < rows_; ++j) rim(0, j) = rim(columns_ - 2, j) = 1;
    return;
  }
  // A bit per column: samples that are there, cells without a hole, and those among them without one around them.
  static_assert(kMostSide <= 64);
  const auto samplesOf = [&](std::int32_t j) {
    const double* z = z_.data() + j * columns_;
    std::uint64_t there = 0;
    for (std::int32_t i = 0; i < columns_; ++i) there |= std::uint64_t{std::isnan(z[i]) ? 0U : 1U} << i;
    return there;
  };
  cells_.fill(0);
  for (std::uint64_t j = 0, before = samplesOf(0); j + 1 < static_cast<std::uint64_t>(rows_); ++j) {
    const std::uint64_t after = samplesOf(static_cast<std::int32_t>(j) + 1);
    cells_[j + 1] = before & before >> 1 & after & after >> 1;
    before = after;
  }
  std::fill_n(bounds_.rim.begin(), columns_ * rows_, std::uint8_t{0});
  const std::uint64_t all = (std::uint64_t{1} << (columns_ - 1)) - 1;
  for (std::int32_t j = 0; j + 1 < rows_; ++j) {
    const auto at = static_cast<std::size_t>(j) + 1;
    const std::uint64_t column = cells_[at - 1] & cells_[at] & cells_[at + 1];
    const std::uint64_t inner = column & column << 1 & column >> 1;
    for (std::uint64_t left = all & ~inner; left != 0; left &= left - 1) {
      const std::int32_t i = std::countr_zero(left);
      rim(i, j) = 1;
      // It has walls below its plane; only its highest sample bounds them.
      if ((cells_[at] >> i & 1U) != 0) bounds_.margin[static_cast<std::size_t>(j * columns_ + i)] = HUGE_VAL;
    }
  }
}

bool SphereWindow::holds(const glm::dvec3& centre) const noexcept {
  return centre.x >= low_x_ && centre.x <= high_x_ && centre.y >= low_y_ && centre.y <= high_y_;
}

bool SphereWindow::valid(std::int32_t i, std::int32_t j) const noexcept {
  if (i < 0 || j < 0 || i + 1 >= columns_ || j + 1 >= rows_) return false;
  return whole_ || (cells_[static_cast<std::size_t>(j) + 1] >> i & 1U) != 0;
}

bool SphereWindow::under(const glm::dvec3& at, SphereContact& out) const noexcept {
  const double field_x = at.x / sx_;
  const double field_y = at.y / sy_;
  const double x = field_x - column_;
  const double y = field_y - row_;
  if (!within(x, y)) return false;
  auto i = static_cast<std::int32_t>(x);
  auto j = static_cast<std::int32_t>(y);
  if (from_field_) {
    // Next to the field's first samples column_ is below zero, and the difference above is rounded.
    i = static_cast<std::int32_t>(std::floor(field_x)) - column_;
    j = static_cast<std::int32_t>(std::floor(field_y)) - row_;
  }
  // On a line between cells the one without a hole counts.
  for (const std::int32_t jj : {j, y == j ? j - 1 : j})
    for (const std::int32_t ii : {i, x == i ? i - 1 : i}) {
      if (!valid(ii, jj)) continue;
      const Corners z = corners(ii, jj);
      const double b = z.z10 - z.z00;
      const double c = z.z01 - z.z00;
      const double d = (z.z11 - z.z01) - b;
      out.u = from_field_ ? field_x - (column_ + ii) : x - ii;
      out.v = from_field_ ? field_y - (row_ + jj) : y - jj;
      out.cell = {column_ + ii, row_ + jj};
      const Patch patch{(column_ + ii) * sx_, (row_ + jj) * sy_, sx_, sy_, z.z00, b, c, d};
      out.point_mm = patch.at(out.u, out.v);
      out.normal = patchNormal(patch, out.u, out.v);
      out.distance_mm = std::abs(at.z - out.point_mm.z);
      return true;
    }
  return false;
}

double SphereWindow::heightUnder(const glm::dvec3& at) const noexcept {
  const double x = at.x / sx_ - column_;
  const double y = at.y / sy_ - row_;
  if (whole_ && within(x, y)) [[likely]] {
    const auto i = static_cast<std::int32_t>(x);
    const auto j = static_cast<std::int32_t>(y);
    const Corners z = corners(i, j);
    const double u = x - i;
    const double v = y - j;
    return z.z00 + (z.z10 - z.z00) * u + ((z.z01 - z.z00) + (z.z11 - z.z10 - z.z01 + z.z00) * u) * v;
  }
  SphereContact point;
  return under(at, point) ? point.point_mm.z : -HUGE_VAL;
}

double SphereWindow::overSamples(const glm::dvec3& at, double radius_mm) const noexcept {
  const Box box = boxAround(at, radius_mm);
  double most = -HUGE_VAL;
  for (std::int32_t j = box.j0; j <= box.j1 + 1; ++j) {
    const double dy = at.y - (row_ + j) * sy_;
    const double left = radius_mm * radius_mm - dy * dy;
    const double* z = z_.data() + j * columns_;
    for (std::int32_t i = box.i0; i <= box.i1 + 1; ++i) {
      const double dx = at.x - (column_ + i) * sx_;
      const double up2 = left - dx * dx;
      const double lack = std::max(most - z[i], 0.0);
      if (up2 > lack * lack) most = std::max(most, z[i] + std::sqrt(up2));
    }
  }
  return most;
}

double SphereWindow::highestNear(const glm::dvec3& at, double radius_mm) const noexcept {
  const Box box = boxAround(at, radius_mm);
  double highest = -HUGE_VAL;
  for (std::int32_t j = box.j0; j <= box.j1 + 1; ++j)
    for (std::int32_t i = box.i0; i <= box.i1 + 1; ++i) {
      const double z = z_[static_cast<std::size_t>(j * columns_ + i)];
      highest = z > highest ? z : highest;
    }
  return highest;
}

// The squared distance to the nearest of S(u, v), halved, has the second derivative I - J H^-1 J^T (the foot
// moves with the centre): J the surface's derivatives that are free at the touch, H its own second
// derivatives in them. The distance is the root of twice that.
double SphereWindow::bend(const glm::dvec3& centre, const SphereContact& touch, const glm::dvec3& a,
                          const glm::dvec3& b) const noexcept {
  const glm::dvec3 m = centre - touch.point_mm;
  const double distance = glm::length(m);
  if (!(distance > 0.0)) return 0.0;
  const auto i = static_cast<std::int32_t>(touch.cell.column - column_);
  const auto j = static_cast<std::int32_t>(touch.cell.row - row_);
  double foot = 0.0;
  if (valid(i, j)) {
    const Corners z = corners(i, j);
    const double d = z.z11 - z.z10 - z.z01 + z.z00;
    const glm::dvec3 su{sx_, 0.0, z.z10 - z.z00 + d * touch.v};
    const glm::dvec3 sv{0.0, sy_, z.z01 - z.z00 + d * touch.u};
    const bool along_u = touch.u > 0.0 && touch.u < 1.0;
    const bool along_v = touch.v > 0.0 && touch.v < 1.0;
    const double uu = glm::dot(su, su);
    const double vv = glm::dot(sv, sv);
    const double au = glm::dot(a, su);
    const double av = glm::dot(a, sv);
    const double bu = glm::dot(b, su);
    const double bv = glm::dot(b, sv);
    if (along_u && along_v) {
      const double uv = glm::dot(su, sv) - m.z * d;
      const double det = uu * vv - uv * uv;
      if (!(det > 1e-6 * uu * vv)) return 0.0;
      foot = (au * bu * vv + av * bv * uu - (au * bv + av * bu) * uv) / det;
    } else if (along_u) {
      foot = au * bu / uu;
    } else if (along_v) {
      foot = av * bv / vv;
    }
  }
  return (glm::dot(a, b) - foot) / distance;
}

SphereWindow::Box SphereWindow::boxAround(const glm::dvec3& centre, double reach_mm) const noexcept {
  return {indexWithin((centre.x - reach_mm) / sx_ - column_, 0, columns_ - 2),
          indexWithin((centre.x + reach_mm) / sx_ - column_, 0, columns_ - 2),
          indexWithin((centre.y - reach_mm) / sy_ - row_, 0, rows_ - 2),
          indexWithin((centre.y + reach_mm) / sy_ - row_, 0, rows_ - 2)};
}

void SphereWindow::gather(const glm::dvec3& centre, double reach_mm, double room_mm) noexcept {
  gathered_at_ = centre;
  gathered_reach_ = reach_mm;
  gathered_room_ = room_mm;
  const double room = room_mm * (1.0 + 1e-5);  // far above rounding
  const Box box = boxAround(centre, reach_mm + room);
  gathered_ = boundable_ && sphereContactKernels().candidates(
                                laneWindow(), bounds_, laneProbe(centre, reach_mm + room, sx_, sy_), room,
                                box.i0, box.i1, box.j0, box.j1, candidates_);
}

// Gathering costs about one search. It pays when the next search is near: after two that were near each other,
// or while what was gathered before was used again.
void SphereWindow::contacts(const glm::dvec3& centre, double reach_mm, double room_mm,
                            SphereContactList& out) noexcept {
  const auto near = [&](const glm::dvec3& at) {
    const glm::dvec3 m = centre - at;
    return m.x * m.x + m.y * m.y + m.z * m.z <= room_mm * room_mm;
  };
  const bool near_last = near(searched_at_);
  searched_at_ = centre;
  if (gathered_ && gathered_reach_ == reach_mm && gathered_room_ == room_mm && near(gathered_at_)) {
    reused_ = true;
  } else if (near_last || reused_) {
    gather(centre, reach_mm, room_mm);
    reused_ = false;
  } else {
    gathered_ = false;
  }
  if (gathered_) {
    Collector(*this, centre, reach_mm, out).candidates(candidates_);
    return;
  }
  contactsSearched(centre, reach_mm, out);
}

void SphereWindow::contactsSearched(const glm::dvec3& centre, double reach_mm,
                                    SphereContactList& out) const noexcept {
  const Box box = boxAround(centre, reach_mm);
  Collector(*this, centre, reach_mm, out).vectorised(box.i0, box.i1, box.j0, box.j1);
}

void SphereWindow::contactsCellByCell(const glm::dvec3& centre, double reach_mm,
                                      SphereContactList& out) const noexcept {
  const double reach2 = reach_mm * reach_mm;
  const auto [i0, i1, j0, j1] = boxAround(centre, reach_mm);
  Collector collector(*this, centre, reach_mm, out);
  std::array<double, kMostSide> dx2;
  for (std::int32_t i = i0; i <= i1; ++i) {
    const double dx = beyondRange(centre.x, (column_ + i) * sx_, (column_ + i + 1) * sx_);
    dx2[static_cast<std::size_t>(i)] = dx * dx;
  }
  for (std::int32_t j = j0; j <= j1; ++j) {
    const double dy = beyondRange(centre.y, (row_ + j) * sy_, (row_ + j + 1) * sy_);
    const double left = reach2 - dy * dy;
    if (!(left > 0.0)) continue;
    const double* low = z_.data() + j * columns_;
    const double* high = low + columns_;
    double before = std::max(low[i0], high[i0]);
    for (std::int32_t i = i0; i <= i1; ++i) {
      // NaN may or may not pass through the maxima; cell() tests again.
      const double after = std::max(low[i + 1], high[i + 1]);
      const double gap = std::max(centre.z - std::max(before, after), 0.0);
      before = after;
      if (gap * gap + dx2[static_cast<std::size_t>(i)] < left)
        collector.cell(i, j, SphereSearch::kCellByCell);
    }
  }
}

}  // namespace fettle::haptic

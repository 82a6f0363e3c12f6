#include "engine/filter/line_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace fettle::engine {

constexpr int kReach = 2;
constexpr int kSide = 2 * kReach + 1;
constexpr int kRoundsOfSides = 3;
constexpr float kFits = 6.0F;   // of two heights on one surface, next to an edge
constexpr float kLeads = 8.0F;  // and of what two of them lead to, more where it is steep

// Measured on bracket and steps with 2 % mixed pixels, with true lines and with those of a hand:
constexpr std::size_t kFewestLone = 4;  // of a scan that has mixed pixels
constexpr float kDoubt =
    1.5F;  // within so many deviations the line may as well run on a lone sample's other side
constexpr float kCertain = 2.0F,
                kLeastCertain = 0.05F;  // farther from it a sample is surely on its own side,
constexpr float kKnown = 0.42F;         // or, where the line's deviation is no larger [samples],
constexpr int kStandsOut = 3;  // if so many more samples around it are on its own side than on the other

// The samples within 2 of one: which of them are on its side, which on the other.
struct LineSides::Around {
  enum : std::uint8_t { kNone, kOwn, kOther };
  std::array<std::uint8_t, kSide * kSide> side{};

  [[nodiscard]] static std::size_t place(std::int32_t dx, std::int32_t dy) noexcept {
    return static_cast<std::size_t>((dy + kReach) * kSide + dx + kReach);
  }
};

bool LineSides::take(const Block& block) {
  columns_ = block.columns;
  rows_ = block.rows;
  cut_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  bool any = false;
  if (block.cuts == nullptr) return false;
  cuts_ = block.cuts;
  left_ = block.left;
  low_ = block.low;
  for (std::int32_t r = 0; r < rows_; ++r)
    for (const LineCut& cut : block.cuts->row(block.low + r)) {
      const std::int32_t c = cut.column - block.left;
      if (c < 0 || c >= columns_) continue;
      std::uint8_t links = cut.links;
      if (c + 1 == columns_) links &= static_cast<std::uint8_t>(~LineCut::kRight);
      if (r + 1 == rows_) links &= static_cast<std::uint8_t>(~LineCut::kUp);
      cut_[placeOf(c, r)] = links;
      any = any || links != 0;
    }
  return any;
}

bool LineSides::joined(std::int32_t c, std::int32_t r, std::int32_t dx, std::int32_t dy) const noexcept {
  if (dx != 0) return (at(dx > 0 ? c : c - 1, r) & LineCut::kRight) == 0;
  return (at(c, dy > 0 ? r : r - 1) & LineCut::kUp) == 0;
}

bool LineSides::isAtCut(std::int32_t c, std::int32_t r) const noexcept {
  return at(c, r) != 0 || (c > 0 && !joined(c, r, -1, 0)) || (r > 0 && !joined(c, r, 0, -1));
}

// Its own side are those that whole links lead to, without leaving the 5 x 5.
LineSides::Around LineSides::sidesAround(std::int32_t c, std::int32_t r) const noexcept {
  constexpr std::array<std::array<std::int32_t, 2>, 4> kNext{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  Around around;
  std::array<std::array<std::int32_t, 2>, kSide * kSide> open{};
  std::size_t count = 0;
  around.side[Around::place(0, 0)] = Around::kOwn;
  open[count++] = {0, 0};
  while (count > 0) {
    const auto [x, y] = open[--count];
    for (const auto& [dx, dy] : kNext) {
      const std::int32_t tx = x + dx, ty = y + dy;
      if (std::abs(tx) > kReach || std::abs(ty) > kReach || !has(c + tx, r + ty)) continue;
      std::uint8_t& side = around.side[Around::place(tx, ty)];
      if (side != Around::kNone || !joined(c + x, r + y, dx, dy)) continue;
      side = Around::kOwn;
      open[count++] = {tx, ty};
    }
  }
  for (std::int32_t y = -kReach; y <= kReach; ++y)
    for (std::int32_t x = -kReach; x <= kReach; ++x)
      if (std::uint8_t& side = around.side[Around::place(x, y)]; side == Around::kNone && has(c + x, r + y))
        side = Around::kOther;
  return around;
}

namespace {

// Whether a height fits the samples of one side around it.
bool fits(const auto& around, std::uint8_t side, float z, auto&& height) {
  const auto on = [&](std::int32_t x, std::int32_t y) {
    return std::abs(x) <= kReach && std::abs(y) <= kReach && around.side[around.place(x, y)] == side &&
           (x != 0 || y != 0);
  };
  for (std::int32_t y = -kReach; y <= kReach; ++y)
    for (std::int32_t x = -kReach; x <= kReach; ++x) {
      if (!on(x, y)) continue;
      const float a = height(x, y);
      if (std::fabs(a - z) <= kFits) return true;
      if (std::max(std::abs(x), std::abs(y)) != 1 || !on(2 * x, 2 * y)) continue;
      const float b = height(2 * x, 2 * y);
      if (std::fabs(2.0F * a - b - z) <= kLeads + 0.3F * std::fabs(a - b)) return true;
    }
  return false;
}

}  // namespace

std::vector<std::uint32_t> LineSides::misfits(const float* heights, std::ptrdiff_t stride) const {
  std::vector<std::uint32_t> found;
  for (std::int32_t r = 0; r < rows_; ++r)
    for (std::int32_t c = 0; c < columns_; ++c) {
      if (!isAtCut(c, r)) continue;
      const float z = heights[r * stride + c];
      if (!(z == z)) continue;
      const auto height = [&](std::int32_t x, std::int32_t y) { return heights[(r + y) * stride + c + x]; };
      const Around around = sidesAround(c, r);
      if (fits(around, Around::kOwn, z, height) || !fits(around, Around::kOther, z, height)) continue;
      found.push_back(placeOf(c, r));
    }
  return found;
}

void LineSides::flip(std::uint32_t place) noexcept {
  const std::int32_t c = columnOf(place), r = rowOf(place);
  if (c + 1 < columns_) cut_[place] ^= LineCut::kRight;
  if (r + 1 < rows_) cut_[place] ^= LineCut::kUp;
  if (c > 0) cut_[placeOf(c - 1, r)] ^= LineCut::kRight;
  if (r > 0) cut_[placeOf(c, r - 1)] ^= LineCut::kUp;
}

// How many more samples around it are on its side than on the other.
int LineSides::inside(std::int32_t c, std::int32_t r) const noexcept {
  const Around around = sidesAround(c, r);
  return static_cast<int>(std::ranges::count(around.side, Around::kOwn) - 1 -
                          std::ranges::count(around.side, Around::kOther));
}

LineSides::Passage LineSides::passageAt(std::int32_t c, std::int32_t r) const noexcept {
  float across = 2.0F, up = 2.0F;  // to the line along row and column
  Passage passage;
  const auto look = [&](std::int32_t column, std::int32_t row, std::uint8_t link, bool from_next,
                        float& nearest) {
    const std::span<const LineCut> cuts = cuts_->row(row);
    const auto cut = std::ranges::lower_bound(cuts, column, {}, &LineCut::column);
    if (cut == cuts.end() || cut->column != column || (cut->links & link) == 0) return;
    const float at = link == LineCut::kRight ? cut->right_at : cut->up_at;
    nearest = std::min(nearest, from_next ? 1.0F - at : at);
    passage.deviation = std::max(passage.deviation, cut->deviation);
  };
  look(left_ + c, low_ + r, LineCut::kRight, false, across);
  look(left_ + c - 1, low_ + r, LineCut::kRight, true, across);
  look(left_ + c, low_ + r, LineCut::kUp, false, up);
  look(left_ + c, low_ + r - 1, LineCut::kUp, true, up);
  if (across > 0.0F && up > 0.0F) passage.distance = across * up / std::sqrt(across * across + up * up);
  return passage;
}

// Whether it is surely a sample with the height of the wrong side, and not the line that is off.
bool LineSides::hasWrongHeight(std::int32_t c, std::int32_t r) const noexcept {
  const Passage line = passageAt(c, r);
  if (line.distance > kCertain * line.deviation + kLeastCertain) return true;
  return line.deviation <= kKnown && inside(c, r) >= kStandsOut;
}

bool LineSides::isAlone(std::uint32_t place, const std::vector<std::uint32_t>& among) const noexcept {
  const std::int32_t c = columnOf(place), r = rowOf(place);
  for (std::int32_t y = r - 1; y <= r + 1; ++y)
    for (std::int32_t x = c - 1; x <= c + 1; ++x)
      if ((x != c || y != r) && has(x, y) && std::ranges::binary_search(among, placeOf(x, y))) return false;
  return true;
}

void LineSides::settle(const float* heights, std::ptrdiff_t stride, std::vector<LoneSample>& lone) {
  std::vector<LoneSample> wrong;
  for (int round = 1; round <= kRoundsOfSides; ++round) {
    const std::vector<std::uint32_t> found = misfits(heights, stride);
    std::vector<std::uint32_t> flips, alone;
    for (const std::uint32_t place : found)
      (lone.size() >= kFewestLone && isAlone(place, found) ? alone : flips).push_back(place);
    const bool last = flips.empty() || round == kRoundsOfSides;
    // All at once: of two next to each other that change side the link between them stays whole.
    std::ranges::for_each(flips, [this](std::uint32_t place) { flip(place); });
    if (!last) continue;
    for (const std::uint32_t place : alone)
      if (hasWrongHeight(columnOf(place), rowOf(place)))
        wrong.push_back({columnOf(place), rowOf(place), 0.0F});
      else
        flip(place);
    break;
  }
  // In doubt the samples around a lone one say more than the line.
  for (LoneSample& sample : lone)
    if (const Passage line = passageAt(sample.column, sample.row); line.distance < kDoubt * line.deviation)
      join(sample.column, sample.row);
    else
      sample.between = sideHeight(heights, stride, sample.column, sample.row);
  for (LoneSample& sample : wrong) sample.between = sideHeight(heights, stride, sample.column, sample.row);
  lone.insert(lone.end(), wrong.begin(), wrong.end());
}

void LineSides::join(std::int32_t c, std::int32_t r) noexcept {
  cut_[placeOf(c, r)] = 0;
  if (c > 0) cut_[placeOf(c - 1, r)] &= static_cast<std::uint8_t>(~LineCut::kRight);
  if (r > 0) cut_[placeOf(c, r - 1)] &= static_cast<std::uint8_t>(~LineCut::kUp);
}

float LineSides::sideHeight(const float* heights, std::ptrdiff_t stride, std::int32_t column,
                            std::int32_t row) const {
  const Around around = sidesAround(column, row);
  std::array<float, kSide * kSide> own{};
  std::size_t n = 0;
  for (std::int32_t y = -kReach; y <= kReach; ++y)
    for (std::int32_t x = -kReach; x <= kReach; ++x) {
      if ((x == 0 && y == 0) || around.side[Around::place(x, y)] != Around::kOwn) continue;
      const float z = heights[(row + y) * stride + column + x];
      if (z == z) own[n++] = z;
    }
  if (n == 0) return heights[row * stride + column];
  std::sort(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(n));
  return 0.5F * (own[(n - 1) / 2] + own[n / 2]);
}

}  // namespace fettle::engine

#include "engine/history/history.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "engine/field/difference_inl.h"

namespace fettle::engine {

namespace {

struct Extent {
  std::int32_t column0 = std::numeric_limits<std::int32_t>::max(), row0 = column0;  // tiles
  std::int32_t column1 = -1, row1 = -1;                                             // the last ones
};

bool runAlike(const EdgeLine& a, const EdgeLine& b) noexcept {
  return a.id == b.id && a.closed == b.closed &&
         std::ranges::equal(a.points, b.points, {}, &EdgePoint::position, &EdgePoint::position);
}

// Around the points of the lines that are not among the others, clipped to the field.
SampleRect rectOfOtherLines(const EdgeLines& lines, const EdgeLines& others, const Grid& grid) noexcept {
  SampleRect rect;
  if (lines == nullptr) return rect;
  std::size_t next = 0;  // lines keep their order: the search begins after the last one found
  const auto isAmong = [&](const EdgeLine& line) {
    const std::size_t n = others == nullptr ? 0 : others->size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = (next + i) % n;
      if (!runAlike(line, (*others)[at])) continue;
      next = at + 1;
      return true;
    }
    return false;
  };
  for (const EdgeLine& line : *lines) {
    if (isAmong(line)) continue;
    for (const EdgePoint& point : line.points) {
      const auto column = static_cast<std::int32_t>(std::clamp(point.position.x, 0.0, grid.width - 1.0));
      const auto row = static_cast<std::int32_t>(std::clamp(point.position.y, 0.0, grid.height - 1.0));
      rect = rect.joined({column, row, 1, 1});
    }
  }
  return rect;
}

}  // namespace

Change measureChange(const Version& before, const Version& after) noexcept {
  const Grid& grid = before.grid();
  assert(grid.width == after.grid().width && grid.height == after.grid().height);
  Change change;
  change.inverted = before.reader().sign() != after.reader().sign();
  change.lines = before.lines() != after.lines();
  change.form = before.formOver() != after.formOver();
  Extent extent;
  change.nodes = detail::walkChanges(before.reader().root(), after.reader().root(), 0, 0,
                                     [&](std::int32_t column, std::int32_t row, const Tile&, const Tile&) {
                                       ++change.tiles;
                                       extent.column0 = std::min(extent.column0, column);
                                       extent.row0 = std::min(extent.row0, row);
                                       extent.column1 = std::max(extent.column1, column);
                                       extent.row1 = std::max(extent.row1, row);
                                     });
  if (change.inverted || change.form) {
    change.rect = {0, 0, grid.width, grid.height};
  } else if (change.tiles != 0) {
    const std::int32_t column = extent.column0 * kTileSide;
    const std::int32_t row = extent.row0 * kTileSide;
    change.rect = {column, row, std::min((extent.column1 + 1) * kTileSide, grid.width) - column,
                   std::min((extent.row1 + 1) * kTileSide, grid.height) - row};
  }
  if (change.lines && after.lines() != nullptr)
    change.line_bytes = static_cast<std::size_t>(countPoints(*after.lines())) * sizeof(EdgePoint);
  if (change.lines)
    change.rect = change.rect.joined(rectOfOtherLines(before.lines(), after.lines(), grid))
                      .joined(rectOfOtherLines(after.lines(), before.lines(), grid));
  return change;
}

namespace {

using namespace std::string_view_literals;
constexpr std::array kKindNames{"stroke"sv, "filter"sv, "mark"sv, "invert"sv,
                                "import"sv, "lines"sv,  "form"sv};

}  // namespace

std::string_view stepKindName(StepKind kind) noexcept {
  return kKindNames[static_cast<std::size_t>(kind)];
}

std::optional<StepKind> stepKindFromName(std::string_view name) noexcept {
  const auto* found = std::ranges::find(kKindNames, name);
  if (found == kKindNames.end()) return std::nullopt;
  return static_cast<StepKind>(found - kKindNames.begin());
}

StepTime stepTimeNow() noexcept {
  return std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

History::History(Version start, std::size_t bound_bytes, std::int64_t number)
    : start_(std::move(start)), first_(number), number_(number), bound_(bound_bytes) {
  assert(!start_.empty());
}

History::History(Version state, std::int64_t number, std::int64_t first, std::vector<Step> steps,
                 std::size_t bound_bytes)
    : start_(steps.empty() ? std::move(state) : steps.front().before),
      first_(first),
      number_(number),
      bound_(bound_bytes) {
  for (Step& step : steps) {
    step.info.bytes = measureChange(step.before, step.after).bytes();
    bytes_ += step.info.bytes;
    steps_.push_back({std::move(step.info), std::move(step.after)});
  }
  assert(number_ >= first_ && number_ <= last());
}

const Version& History::state(std::int64_t number) const noexcept {
  assert(number >= first_ && number <= last());
  return number == first_ ? start_ : steps_[static_cast<std::size_t>(number - first_ - 1)].after;
}

const StepInfo& History::info(std::int64_t number) const noexcept {
  assert(number > first_ && number <= last());
  return steps_[static_cast<std::size_t>(number - first_ - 1)].info;
}

Step History::step(std::int64_t number) const {
  return {info(number), state(number - 1), state(number)};
}

bool History::push(StepInfo info, Version after, std::vector<Version>& dropped) {
  const Change change = measureChange(current(), after);
  if (change.none()) {
    // The same tiles below another root, as after the adoption of a filter that changed nothing: who compares the state with
    // the live field compares roots.
    (number_ == first_ ? start_ : steps_[static_cast<std::size_t>(number_ - first_ - 1)].after) =
        std::move(after);
    return false;
  }
  while (last() > number_) {
    bytes_ -= steps_.back().info.bytes;
    dropped.push_back(std::move(steps_.back().after));
    steps_.pop_back();
  }
  if (info.rect.empty()) info.rect = change.rect;
  info.bytes = change.bytes();
  bytes_ += info.bytes;
  steps_.push_back({std::move(info), std::move(after)});
  ++number_;
  keepBound(dropped);
  return true;
}

bool History::push(StepInfo info, Version after) {
  std::vector<Version> dropped;
  return push(std::move(info), std::move(after), dropped);
}

void History::keepBound(std::vector<Version>& dropped) {
  // Only earlier states: the current state and all later ones stay.
  while (bytes_ > bound_ && number_ > first_ + 1) {
    bytes_ -= steps_.front().info.bytes;
    dropped.push_back(std::exchange(start_, std::move(steps_.front().after)));
    steps_.pop_front();
    ++first_;
  }
}

void History::setBound(std::size_t bound_bytes, std::vector<Version>& dropped) {
  bound_ = bound_bytes;
  keepBound(dropped);
}

void History::prepend(Step step) {
  assert(step.after == start_ && first_ > 0);
  step.info.bytes = measureChange(step.before, step.after).bytes();
  bytes_ += step.info.bytes;
  steps_.push_front({std::move(step.info), std::move(start_)});
  start_ = std::move(step.before);
  --first_;
}

std::optional<Version> History::undo() noexcept {
  return goTo(number_ - 1);
}

std::optional<Version> History::redo() noexcept {
  return goTo(number_ + 1);
}

std::optional<Version> History::goTo(std::int64_t number) noexcept {
  if (number < first_ || number > last()) return std::nullopt;
  number_ = number;
  return current();
}

}  // namespace fettle::engine

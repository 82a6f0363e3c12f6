#include "app/work/height_tool.h"

#include <cstddef>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "app/work/read_units.h"

namespace fettle::app {

namespace {

struct MakerName {
  std::string operator()(const engine::FillOptions& fill) const {
    return fill.method == engine::FillMethod::kMembrane ? "Fill holes: membrane" : "Fill holes: curvature";
  }
  std::string operator()(const engine::LineOptions& lines) const {
    constexpr const char* kMethods[] = {"median", "polynomial", "difference", "matching"};
    const char* axis = lines.axis == engine::ScanAxis::kX ? "rows" : "columns";
    const std::string degree =
        lines.method == engine::LineMethod::kPolynomial ? fmt::format(" {}", lines.degree) : "";
    return fmt::format("Level {}: {}{}", axis, kMethods[static_cast<std::size_t>(lines.method)], degree);
  }
};

std::string foundIn(const haptic::ComputedHeights& heights, const haptic::HeightsMaker& maker,
                    const engine::Version& before) {
  const engine::Grid& grid = before.grid();
  if (std::holds_alternative<engine::LineOptions>(maker)) {
    const ReadAs as = readLengthAs(heights.rows_rms, grid.height_unit.mm, grid.height_unit.name);
    return fmt::format("lines were off by {:.3g} {} (rms)", heights.rows_rms / as.size, as.name);
  }
  const engine::Filled& filled = heights.filled;
  std::string text =
      fmt::format("{} of {} holes filled, {} samples", filled.filled_holes, filled.holes, filled.filled);
  const auto stay = [&](std::int64_t count, const char* why) {
    if (count > 0) text += fmt::format("; {} {}", count, why);
  };
  stay(filled.larger, "are larger");
  stay(filled.at_border, "reach the border");
  stay(filled.too_many, "have too many samples");
  stay(filled.no_rim, "have no height next to them");
  const engine::BeyondBefore beyond = engine::beyondBefore(before, heights.field);
  const ReadAs as =
      readLengthAs(beyond.below + beyond.above, before.grid().height_unit.mm, before.grid().height_unit.name);
  if (beyond.below > 0.0)
    text += fmt::format("; down to {:.3g} {} below all else: a membrane stays between the heights of the rim",
                        beyond.below / as.size, as.name);
  if (beyond.above > 0.0)
    text += fmt::format("; up to {:.3g} {} above all else: a membrane stays between the heights of the rim",
                        beyond.above / as.size, as.name);
  return text;
}

}  // namespace

std::string makerName(const haptic::HeightsMaker& maker) {
  return std::visit(MakerName(), maker);
}

void HeightTool::ask(const haptic::HeightsMaker& maker) {
  cancel();
  asked_ = maker;
}

void HeightTool::cancel() noexcept {
  working_.cancel();
  asked_.reset();
  done_.reset();
}

bool HeightTool::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  const bool dropped = working_.cancelling();
  if (auto result = working_.take()) {
    changed = true;
    if (!dropped && *result)
      done_ = *std::move(*result);
    else if (!dropped && result->error().kind != engine::ErrorKind::kCancelled)
      notices.push_back({result->error().what, result->error().remedy});
  }
  // Under a stroke the field is another one every tick.
  if (done_ && !client.strokeIsUnderWay()) {
    changed = true;
    found_ = foundIn(done_->heights, maker_, done_->base);
    if (!(done_->base == done_->heights.field) &&
        !client.changeHeights(done_->base, done_->heights.field, makerName(maker_), maker_))
      asked_ = maker_;
    done_.reset();
  }
  if (asked_ && !working_.busy() && !client.strokeIsUnderWay()) {
    maker_ = *std::exchange(asked_, std::nullopt);
    client.awaitRestored();
    working_.start([base = client.newest(), maker = maker_](engine::JobControl& job) -> engine::Result<Work> {
      auto heights = haptic::computeHeights(base, maker, job);
      if (!heights) return tl::unexpected(heights.error());
      return Work{base, *std::move(heights)};
    });
  }
  return changed;
}

void HeightTool::clear() {
  cancel();
  found_.clear();
}

}  // namespace fettle::app

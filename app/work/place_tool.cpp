#include "app/work/place_tool.h"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/texts/texts.h"
#include "engine/field/difference.h"
#include "engine/inspect/noise.h"

namespace fettle::app {

namespace {

using engine::EdgeLine;
using engine::EdgePoint;
using engine::WorthPlace;

constexpr double kAlong = 6.0;  // [samples] from a line to what it runs along

// Whether lines run along at least half of a place.
bool isDrawn(const WorthPlace& place, const std::vector<EdgeLine>& lines) {
  glm::dvec2 low = place.path.front(), high = low;
  for (const glm::dvec2& p : place.path) {
    low = glm::min(low, p - kAlong);
    high = glm::max(high, p + kAlong);
  }
  std::vector<bool> along(place.path.size(), false);
  for (const EdgeLine& line : lines)
    for (const EdgePoint& point : line.points) {
      const glm::dvec2 at = point.position;
      if (!point.located) continue;
      if (at.x < low.x || at.y < low.y || at.x > high.x || at.y > high.y) continue;
      for (std::size_t i = 0; i < along.size(); ++i)
        if (glm::distance(at, place.path[i]) <= kAlong) along[i] = true;
    }
  return 2 * std::ranges::count(along, true) >= std::ssize(along);
}

}  // namespace

void PlaceTool::search(const LoopClient& client) {
  drop();
  searched_ = compared_ = client.newest();
  searching_.replace([field = searched_](engine::JobControl& job) -> engine::Result<engine::WorthPlaces> {
    const auto noise = engine::estimateNoise(field, job);
    if (!noise) return tl::unexpected(noise.error());
    if (!(noise->sigma > 0.0)) return engine::WorthPlaces{};
    engine::WorthRequest request;
    request.noise = noise->sigma;
    return engine::findWorthPlaces(field, request, job);
  });
}

void PlaceTool::drop() {
  searching_.cancel();
  found_.reset();
  states_.clear();
  present_.reset();
  arrived_ = false;
  seen_ = {};
  searched_ = compared_ = {};
  outdated_ = false;
  ++revision_;
}

bool PlaceTool::next() {
  if (!found_) return false;
  const std::size_t n = states_.size();
  const std::size_t begin = present_ ? *present_ + 1 : 0;
  if (present_ && states_[*present_] == State::kOpen) states_[*present_] = State::kSkipped;
  present_.reset();
  ++revision_;
  for (std::size_t k = 0; k < n && !present_; ++k)
    if (states_[(begin + k) % n] == State::kOpen) present_ = (begin + k) % n;
  arrived_ = present_.has_value();
  return arrived_;
}

bool PlaceTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  const bool dropped = searching_.cancelling();
  if (auto done = searching_.take(); done && !dropped) {
    changed = true;
    if (*done) {
      found_ = std::move(**done);
      states_.assign(found_->places.size(), State::kOpen);
      lookAtLines(client.newest().lines());
      if (!next()) notices.push_back({textOf("a line by hand would gain next to nothing on this scan"), ""});
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  if (found_ && client.newest().lines() != seen_) {
    lookAtLines(client.newest().lines());
    changed = true;
  }
  if (found_ && client.newest() != compared_) {
    compared_ = client.newest();
    const bool outdated = !engine::sameHeights(searched_, compared_);
    changed |= std::exchange(outdated_, outdated) != outdated;
  }
  return changed;
}

void PlaceTool::lookAtLines(const engine::EdgeLines& lines) {
  seen_ = lines;
  ++revision_;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const bool drawn = lines != nullptr && isDrawn(found_->places[i], *lines);
    if (drawn)
      states_[i] = State::kDone;
    else if (states_[i] == State::kDone)
      states_[i] = State::kOpen;
  }
}

std::optional<std::size_t> PlaceTool::takeArrival() noexcept {
  return std::exchange(arrived_, false) ? present_ : std::nullopt;
}

std::size_t PlaceTool::count(State state) const noexcept {
  return static_cast<std::size_t>(std::ranges::count(states_, state));
}

}  // namespace fettle::app

#include "render/plan/places.h"

#include <algorithm>
#include <utility>

namespace fettle::render {
namespace {

Rectangle around(const Rectangle& a, const Rectangle& b) {
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y};
}

double area(const Rectangle& r) {
  return static_cast<double>(r.width) * r.height;
}

bool within(const Rectangle& inner, const Rectangle& outer) {
  return inner.x >= outer.x && inner.y >= outer.y && inner.x + inner.width <= outer.x + outer.width &&
         inner.y + inner.height <= outer.y + outer.height;
}

// Whether one pass over both is cheaper than two.
bool near(const Rectangle& a, const Rectangle& b) {
  constexpr double kSpare_px = 4096.0;  // as much as it costs to begin
  return !empty(cut(a, b)) || area(around(a, b)) <= area(a) + area(b) + kSpare_px;
}

}  // namespace

void Places::add(const Rectangle& place) {
  if (empty(place)) return;
  for (const Rectangle& known : places_)
    if (within(place, known)) return;
  Rectangle grown = place;
  // Each that is taken in may make it reach others.
  for (std::size_t k = 0; k < places_.size();) {
    if (!near(grown, places_[k])) {
      ++k;
      continue;
    }
    grown = around(grown, places_[k]);
    places_[k] = places_.back();
    places_.pop_back();
    k = 0;
  }
  places_.push_back(grown);
  if (places_.size() <= kMost) return;
  // The two whose common rectangle costs least.
  std::size_t a = 0, b = 1;
  const auto cost = [&](std::size_t i, std::size_t j) {
    return area(around(places_[i], places_[j])) - area(places_[i]) - area(places_[j]);
  };
  for (std::size_t i = 0; i < places_.size(); ++i)
    for (std::size_t j = i + 1; j < places_.size(); ++j)
      if (cost(i, j) < cost(a, b)) {
        a = i;
        b = j;
      }
  const Rectangle both = around(places_[a], places_[b]);
  places_.erase(places_.begin() + static_cast<std::ptrdiff_t>(b));
  places_.erase(places_.begin() + static_cast<std::ptrdiff_t>(a));
  add(both);
}

std::vector<Rectangle> Places::take() {
  return std::exchange(places_, {});
}

}  // namespace fettle::render

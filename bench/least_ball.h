#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "bench/plain_heights.h"
#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/contact/sphere_window.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// What a tick of a ball in contact cannot do without, and nothing else: the lower bound of its time, as LeastSearch is of a
/// point's. Which places hold the ball where it comes to rest, at most three samples, edges or insides of cells, is known
/// beforehand. It remains, from a plain array:
///   to go there: Newton's steps from the centre of the tick before, each with the distances to these places and their
///     curvatures, until one is as short as a rest. Where this does not lead to where the ball went, because its way led over
///     other places, from half of the way, a quarter ... a sixteenth; else, as where a tick was stopped on its way, the one
///     step at its end;
///   to show that it is free there: to read every sample below the ball and compare its distance with the radius. Each could
///     reach into it.
///
/// No search for places, no bound, no step that fails, no edge or inside shown to be farther, no tiles, effects, counters.
/// Threading: one thread.
class LeastBall {
 public:
  /// Of a field without holes that the ball does not leave, and the contacts of these strokes on it, whose points are centres.
  LeastBall(const engine::Version& field, double radius_mm, std::span<const haptic::StrokeSample> strokes);

  /// Computes all centres; the sum of their heights and of the nearest squared distances, so that nothing is left out.
  [[nodiscard]] double run() const noexcept;

  // Averages of a contact.
  /// Places whose distance is computed, steps times places.
  [[nodiscard]] double cells() const noexcept { return perContact(solved_); }
  /// Of these, insides of cells.
  [[nodiscard]] double newtonCells() const noexcept { return perContact(solved_inside_); }
  [[nodiscard]] double steps() const noexcept { return perContact(steps_); }
  /// Read from the array, each sample once [bytes].
  [[nodiscard]] double bytes() const noexcept { return sizeof(float) * perContact(read_); }
  [[nodiscard]] std::int64_t contacts() const noexcept { return static_cast<std::int64_t>(ticks_.size()); }
  /// Of the contacts, those of which only the step at the end is computed.
  [[nodiscard]] double shareOfEndsAlone() const noexcept { return perContact(ends_alone_); }

 private:
  static constexpr int kMostPlaces = 3;
  struct Place {
    haptic::CellIndex cell;
    double u, v;  // 0 or 1 across an edge; else where Newton's method begins
  };
  struct Tick {
    glm::dvec3 endpoint_mm, from_mm;  // from_mm: the centre before the first step
    std::array<Place, kMostPlaces> places;
    int count = 0;
    int steps = 1;
    std::size_t first_below = 0, end_below = 0;  // of below_
  };
  void addSamples(Tick& tick, const glm::dvec3& centre);
  [[nodiscard]] int stepsTo(const glm::dvec3& centre, const Tick& tick) const noexcept;
  [[nodiscard]] glm::dvec3 step(const glm::dvec3& centre, Tick& tick) const noexcept;
  [[nodiscard]] double perContact(std::size_t count) const noexcept {
    return ticks_.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(ticks_.size());
  }

  PlainHeights heights_;
  double radius_;
  std::vector<Tick> ticks_;
  std::vector<haptic::CellIndex> below_;  // samples below the ball
  std::size_t solved_ = 0, solved_inside_ = 0, steps_ = 0, read_ = 0, ends_alone_ = 0;
};

}  // namespace fettle::bench

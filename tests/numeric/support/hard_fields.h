#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/base/tick_counters.h"
#include "haptic/scene/scene.h"

namespace fettle::tests {

/// A field on which contact is hard to get right, and what its answers can be held to.
struct HardField {
  std::string name;
  engine::Version field;
  double slope = 0.0;    ///< Lipschitz constant of the surface, from its samples; 1e6 and more at spikes
  double size_mm = 0.0;  ///< largest coordinate there is: what positions and heights round to
  bool gaps = false;     ///< holes in it
};

/// One kind of hard field each: flat, tilted, near-vertical steps, spikes of 1e6, saddles, concave corners,
/// duplicate minima, ridges, vertices, holes, borders, denormal heights, anisotropic spacing, scales of 1e-6
/// and 1e6, an origin 5e6 away, heights near 5e6, noise across tiles. All of them have cells.
[[nodiscard]] std::vector<std::string> hardFieldNames();
[[nodiscard]] HardField hardField(const std::string& name);

/// Wraps a field: works out slope and size.
[[nodiscard]] HardField asHardField(std::string name, engine::Version field);

/// The three ways to touch.
enum class Choice : std::uint8_t { kPaper, kDescent, kCertified, kSphere };
/// A tip that such a search loses may be handed to a farther point.
[[nodiscard]] constexpr bool searchesLocally(Choice choice) noexcept {
  return choice == Choice::kPaper || choice == Choice::kDescent;
}
inline constexpr Choice kChoices[] = {Choice::kPaper, Choice::kDescent, Choice::kCertified, Choice::kSphere};
[[nodiscard]] std::string choiceName(Choice choice);
/// A spring of 1 N/mm whose limit does not bite (1000 N), no tool. The certified radius, 40 cells, holds the
/// whole of these fields; the ball is 1.5 of the smaller spacing.
[[nodiscard]] haptic::Scene sceneFor(Choice choice, const engine::Grid& grid);

/// Height of the surface [mm] by plain interpolation in long double, sign and unit applied; NaN over holes
/// and outside the field. The twin of Surface and Patch that shares no line with them.
[[nodiscard]] long double heightAt(const engine::Version& field, double x_mm, double y_mm);
/// |n| times the rounding of a double of that size.
[[nodiscard]] inline double ulps(double n, double size) {
  return n * 2.3e-16 * size;
}

/// A hand that wanders over, on, below and outside the field: rests, moves of 1e-9 to half a cell, and now
/// and then of many; `jumps` false leaves those out. Depth is a few cells. Same seed, same path.
enum class Jumps : std::uint8_t { kNo, kYes };
[[nodiscard]] std::vector<haptic::StrokeSample> wander(const HardField& hard, int ticks, std::uint64_t seed,
                                                       Jumps jumps);

/// Rare but legal events of a run in one line, which is also kept as a property of the test: counters that
/// are not zero and `more`.
void tellRare(const std::string& name, const haptic::TickCounters& counters, const std::string& more = {});

}  // namespace fettle::tests

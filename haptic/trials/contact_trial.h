#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/scene/scene.h"

namespace fettle::trials {

/// One way of finding the point that is felt.
struct ContactChoice {
  const char* name;
  haptic::ContactLevel level = haptic::ContactLevel::kPaper;
  int search_rounds = 2048;        ///< level paper, and a ball; the last one only looks
  int certified_radius_cells = 2;  ///< level certified
  double ball_radius_cells = 0.0;  ///< of the larger spacing; 0: a point, else level means nothing

  /// The scene with this in place of what it had.
  [[nodiscard]] haptic::Scene in(haptic::Scene scene, const engine::Grid& grid) const;
};

/// From the fastest to the surest, points before balls.
[[nodiscard]] std::span<const ContactChoice> contactChoices();

/// What a choice gives away, over the ticks in which it or the truth is in contact.
struct ContactFigures {
  double ns = 0.0, ns_worst = 0.0;                     ///< a tick: median and worst of the repeats
  double mean_mm = 0.0, p99_mm = 0.0, worst_mm = 0.0;  ///< of |penetration - true penetration|
  double wrong = 0.0;                  ///< share of ticks that are not at the closest point, 0 .. 1
  std::int64_t ticks = 0, beyond = 0;  ///< judged; deeper than the truth looks, left out
  std::uint64_t hash = 0;              ///< of all penetrations
};

/// A hand over a field, and what each of its ticks ought to feel: the closest point of all cells within 16
/// cells. For a ball, of the field grown by it (grown_surface.h), in a square of 96 cells without holes.
///
/// The hand goes over any grid in the same cells: 0.4 a tick, pressed in by up to 6. Open loop, the same way
/// whatever it feels, so that choices can be compared tick by tick.
/// Threading: one thread; the field may be in use elsewhere. Deterministic but for times.
class ContactTrial {
 public:
  /// For a point (`ball_radius_cells` 0) or a ball. Empty: the field has no cells, or no square without
  /// holes. Errors: kCancelled.
  [[nodiscard]] static engine::Result<std::optional<ContactTrial>> make(const engine::Version& field,
                                                                        double ball_radius_cells,
                                                                        std::int64_t ticks,
                                                                        const engine::JobControl& job);

  /// `choice` has the tip of this trial. Errors: kCancelled.
  [[nodiscard]] engine::Result<ContactFigures> measure(const ContactChoice& choice, int repeats,
                                                       const engine::JobControl& job) const;

  /// The truth, doubted: for a point, how much nearer a look at 33 x 33 points of every cell in reach came at
  /// worst; for a ball, by how much the distance of a true centre from the surface is not the radius. Of
  /// twelve ticks or so [mm]; 0 is best.
  [[nodiscard]] double doubt() const;

 private:
  struct Truth {
    glm::dvec3 penetration_mm{0.0};  // zero: no contact
    double distance_mm = 0.0;
    bool beyond = false;  // the closest point is farther than was looked
  };

  engine::Version field_;    // that is felt
  engine::Version surface_;  // that the tip's own point stays on: field_, or it grown by the ball
  double radius_mm_ = 0.0;   // of the ball
  double reach_mm_ = 0.0;    // how far the truth looks
  std::vector<haptic::StrokeSample> strokes_;
  std::vector<Truth> truths_;
};

}  // namespace fettle::trials

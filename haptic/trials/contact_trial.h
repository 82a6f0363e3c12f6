#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/scene/scene.h"

namespace fettle::trials {

/// One method of finding the contact point.
struct ContactChoice {
  const char* name;
  haptic::ContactLevel level = haptic::ContactLevel::kPaper;
  int search_rounds = 2048;        ///< level descent, and a ball; the last one only tests
  int certified_radius_cells = 2;  ///< level certified
  double ball_radius_cells = 0.0;  ///< of the larger spacing; 0: a point, else level is ignored
  bool before_revision_4 =
      false;  ///< a ball as scenes of contact revision 3 have it; else as the scene has it

  /// The scene with this method.
  [[nodiscard]] haptic::Scene in(haptic::Scene scene, const engine::Grid& grid) const;
};

/// From the fastest to the most accurate, points before balls.
[[nodiscard]] std::span<const ContactChoice> contactChoices();

/// Cost and error of a choice, over the ticks in which it or the truth is in contact.
struct ContactFigures {
  double ns = 0.0, ns_worst = 0.0;                     ///< per tick: median and worst of the repeats
  double mean_mm = 0.0, p99_mm = 0.0, worst_mm = 0.0;  ///< of |penetration - true penetration|
  double wrong = 0.0;                  ///< share of ticks that are not at the closest point, 0 .. 1
  std::int64_t ticks = 0, beyond = 0;  ///< evaluated; deeper than the truth's search radius, left out
  std::uint64_t hash = 0;              ///< of all penetrations
};

/// A hand over a field, and the correct contact of each of its ticks: the closest point of all cells within
/// 16 cells. For a ball, of the field grown by it, in a square of 96 cells without holes.
///
/// The hand moves in units of cells on any grid: 0.4 per tick, pressed in by up to 6. Open loop, the same
/// path whatever the force, so that choices can be compared tick by tick.
/// Threading: one thread; the field may be in use elsewhere. Deterministic apart from times.
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

  /// An estimate of the error of the truth itself: for a point, how much nearer the nearest of 33 x 33 points
  /// of every cell in reach is at worst; for a ball, by how much the distance of a true centre from the
  /// surface differs from the radius. Over about twelve ticks [mm]; 0 is best.
  [[nodiscard]] double truthError() const;

 private:
  struct Truth {
    glm::dvec3 penetration_mm{0.0};  // zero: no contact
    double distance_mm = 0.0;
    bool beyond = false;  // the closest point is beyond the search radius
  };

  engine::Version field_;    // the field that is felt
  engine::Version surface_;  // that the tip's own point stays on: field_, or it grown by the ball
  double radius_mm_ = 0.0;   // of the ball
  double reach_mm_ = 0.0;    // the truth's search radius
  std::vector<haptic::StrokeSample> strokes_;
  std::vector<Truth> truths_;
};

}  // namespace fettle::trials

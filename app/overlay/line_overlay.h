#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/field/reader.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// A position [samples] on the highest of the samples around it, in field coordinates [mm]: what is drawn there is
/// not hidden by the surface's own noise. Positions outside take the height of the border, holes 0.
[[nodiscard]] glm::dvec3 aboveSurface(const engine::FieldReader& reader, glm::dvec2 at);
/// The same, but nothing over a hole: what is drawn at height 0 there is far from a surface whose heights are not about 0.
[[nodiscard]] std::optional<glm::dvec3> aboveSamples(const engine::FieldReader& reader, glm::dvec2 at);

/// The middle of a rectangle [samples] at the height of the surface: of its sample with a height that is nearest to the middle, looked
/// for at 33 x 33 places; where it has none, halfway between the lowest and the highest of the field.
[[nodiscard]] glm::dvec3 middleOnSurface(const engine::FieldReader& reader, glm::dvec2 low, glm::dvec2 high);

/// The edge lines of a field in the picture: thin lines over a band of twice their standard deviation to either side;
/// steps, creases, what is not located and the chosen line each in a colour. They lie on the upper side of the surface
/// and are hidden by what is in front of them.
/// Threading: main.
class LineOverlay {
 public:
  /// Adds the lines to the overlays of the next frame, with pieces of about three pixels or longer. They are computed
  /// again where field, choice or that length differ from the last frame's: O(points).
  void append(const engine::Version& field, std::optional<std::int64_t> chosen, double mm_per_pixel,
              render::Overlays& overlays);

 private:
  engine::Version of_;
  std::optional<std::int64_t> chosen_;
  int stride_ = 0;
  double mm_per_pixel_ = 0.0;
  std::vector<render::OverlayLine> pieces_;
  std::vector<render::LineMeaning> meanings_;  // of the colours in them
};

/// Adds one to those of a picture, unless it is there.
void addMeaning(const render::LineMeaning& meaning, std::vector<render::LineMeaning>& meanings);

}  // namespace fettle::app

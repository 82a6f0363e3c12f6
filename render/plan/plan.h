#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/camera.h"
#include "render/plan/framing.h"
#include "render/plan/overlay.h"
#include "render/plan/picture.h"
#include "render/plan/placing.h"
#include "render/plan/value_range.h"
#include "shaders/layout.h"

namespace fettle::render {

/// One surface in a picture.
struct PanelPlan {
  Rectangle plot;  ///< pixels of the finished picture
  engine::Version field;
  Framing framing;
  Camera camera;  ///< pixels of the finished picture; the framing's of the view
  Placing placing;
  double reference = 0.0;       ///< height at scene z 0 [height_unit of the field]
  double mm_per_unit = 1.0;     ///< scene mm per height unit, exaggeration included
  double lowest = 0.0;          ///< lower heights are drawn at this one [height_unit]
  double highest = 0.0;         ///< and higher ones at this
  double floor_z = 0.0;         ///< of the plate under the surface [scene mm]
  double cut_z = 0.0;           ///< nothing is drawn above [scene mm]
  gpu::PanelUniforms uniforms;  ///< all but `paging`, which follows the field's texture
};

/// A point of the field [field mm] in the scene of a panel.
[[nodiscard]] glm::dvec3 inScene(const PanelPlan& panel, const glm::dvec3& field_mm);

/// A picture planned on the CPU: the position and colour of everything, before any device is used.
struct PicturePlan {
  std::vector<PanelPlan> panels;
  Layout layout;
  DecorationContent decorations;
  Palette palette;
  ColourMap map = ColourMap::kViridis;
  ValueRange range;
  double contour_step = 0.0;  ///< [height_unit of the first field]
  double exaggeration = 1.0;
};

/// The values of the fields of a picture: heights of all of them in the first one's unit, and the values that
/// colours show.
struct PictureSpans {
  ValueSpan heights;
  ValueSpan colours;
};
/// The spans of the same fields (and original), all of them inverted. O(1).
[[nodiscard]] PictureSpans negated(const PictureSpans& spans) noexcept;
/// Reads all fields (and the original): time depends on their size.
[[nodiscard]] PictureSpans spansOf(std::span<const engine::Version> fields,
                                   const std::optional<engine::Version>& deviation_from);

/// A picture with known spans in a known layout, one field per plot; time does not depend on the fields'
/// size. Heights are drawn as scene z = (height - reference) * height_unit.mm * exaggeration with the
/// reference at the middle of the robust span of all fields; spikes beyond it are clipped half a span above
/// and just over the floor. Errors (kInput): a spec outside the ranges stated at PictureSpec and View.
[[nodiscard]] engine::Result<PicturePlan> planPicture(const PictureSpec& spec,
                                                      std::span<const engine::Version> fields,
                                                      const PictureSpans& spans, Layout layout);

/// The round factor that makes relief readable: 1 when height to width lies between 0.04 and 0.4, otherwise
/// the factor that makes it about 0.15, as 1, 2 or 5 times a power of ten. Both in millimetres.
[[nodiscard]] double chooseExaggeration(double relief_mm, double extent_mm);

}  // namespace fettle::render

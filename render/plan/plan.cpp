#include "render/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "render/config.h"
#include "render/plan/colour_map.h"
#include "render/plan/number_text.h"

namespace fettle::render {
namespace {

using engine::inputError;

constexpr double kAmbient = 0.30;
// Colours of a deviation are read as numbers: shading may indicate the shape, but not darken them.
constexpr double kDeviationAmbient = 0.80;
// The light stands 45 degrees above the field, over the viewer's left shoulder: lit from the upper left,
// hills look like hills (Imhof 1965, "Kartographische Gelaendedarstellung").
constexpr double kLightUp = 0.70710678118654752;

engine::Status checkSpec(const PictureSpec& spec) {
  const View& v = spec.view;
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in(v.width, kSmallestPicture, kLargestPicture) || !in(v.height, kSmallestPicture, kLargestPicture))
    return inputError(fmt::format("a picture of {} x {} pixels", v.width, v.height), "picture size",
                      fmt::format("give {} to {} pixels per side", kSmallestPicture, kLargestPicture));
  if (!std::isfinite(v.azimuth_deg)) return inputError("the azimuth is not a number", "view", "give degrees");
  if (!in(v.elevation_deg, 0.0, 90.0))
    return inputError(fmt::format("an elevation of {} degrees", v.elevation_deg), "view", "give 0 to 90");
  if (!in(v.zoom, 1e-3, 1e6))
    return inputError(fmt::format("a zoom of {}", v.zoom), "view", "give 0.001 to 1000000");
  if (v.vertical_exaggeration != 0.0 && !in(v.vertical_exaggeration, 1e-9, 1e9))
    return inputError(fmt::format("a vertical exaggeration of {}", v.vertical_exaggeration), "view",
                      "give a positive factor, or 0 to choose one");
  if (!in(spec.marks_opacity, 0, 1)) return inputError("the opacity of marks", "picture", "give 0 to 1");
  if (spec.range && !(std::isfinite(spec.range->low) && std::isfinite(spec.range->high) &&
                      spec.range->low < spec.range->high))
    return inputError("the range of the colours is empty", "picture", "give a low end below the high end");
  const Colouring& c = spec.colouring;
  // A step is a float in the shader, which divides by it.
  if (!in(c.tolerance, 0.0, 1e30) || !in(c.contour_step, 0.0, 1e30) ||
      (c.contour_step > 0.0 && c.contour_step < 1e-30))
    return inputError("the tolerance or the step of contour lines is out of range", "picture",
                      "give 0 or more");
  return {};
}

// In lengths, not in fractions: those of the shorter side of a single profile are any number.
engine::Status checkCentre(const View& v, const glm::dvec2& extent) {
  constexpr double kFarthest = 100.0;
  const double farthest = kFarthest * std::max(extent.x, extent.y);
  // Also for what is not a number.
  if (!(std::abs((v.centre_x - 0.5) * extent.x) <= farthest &&
        std::abs((v.centre_y - 0.5) * extent.y) <= farthest && std::abs(v.centre_z) <= kFarthest))
    return inputError("the middle of the picture lies far outside the field", "view",
                      "give fractions near 0 to 1");
  return {};
}

// A range that is not empty, for colours: a constant value gets the middle colour.
ValueRange opened(ValueRange r, double half) {
  if (r.low < r.high) return r;
  half = std::max({half, std::abs(r.low) * 1e-6, 1e-9});
  return {r.low - half, r.high + half};
}

bool anyMark(const engine::Version& v) {
  return v.reader().root().marked_children != 0;
}
bool anyHole(const engine::Version& v) {
  return v.reader().root().holed_children != 0;
}

// Of the colours' numbers: heights in the unit that they have on every panel of the field.
ShownUnit unitOfColours(Quantity quantity, const engine::Grid& grid, const ValueRange& heights,
                        const ValueRange& colours) {
  const FieldUnits units = fieldUnits(grid, heights.low, heights.high);
  if (quantity == Quantity::kHeight) return units.height;
  return deviationUnit(grid.height_unit, units.change,
                       std::max(std::abs(colours.low), std::abs(colours.high)));
}

glm::vec4 vec4Of(const glm::vec3& v, double w) {
  return {v, static_cast<float>(w)};
}

// Of heights as they are now: the spans may be those of before an edit, so that colours stay as they are. Deviations have no
// pyramid; theirs are those of the span.
ValueRange extremesNow(std::span<const engine::Version> fields, Quantity quantity, const ValueSpan& span) {
  if (quantity != Quantity::kHeight) return span.extreme;
  const double unit = fields.front().grid().height_unit.mm;
  ValueRange extreme{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const engine::Version& v : fields) {
    const engine::HeightBounds bounds = v.reader().bounds();
    if (bounds.empty()) continue;
    const double to_first = v.grid().height_unit.mm / unit;
    extreme = {std::min(extreme.low, bounds.min * to_first), std::max(extreme.high, bounds.max * to_first)};
  }
  return extreme.low <= extreme.high ? extreme : span.extreme;
}

}  // namespace

double chooseExaggeration(double relief_mm, double extent_mm) {
  if (!(relief_mm > 0.0) || !(extent_mm > 0.0)) return 1.0;
  const double ratio = relief_mm / extent_mm;
  if (ratio >= 0.04 && ratio <= 0.4) return 1.0;
  return std::clamp(roundDown125(0.18 / ratio), 1e-36, 1e36);
}

PictureSpans spansOf(std::span<const engine::Version> fields,
                     const std::optional<engine::Version>& deviation_from) {
  PictureSpans spans;
  const engine::LengthUnit& unit = fields.front().grid().height_unit;
  for (const engine::Version& v : fields) {
    ValueSpan span = heightSpan(v);
    const double to_first = v.grid().height_unit.mm / unit.mm;
    for (ValueRange* r : {&span.robust, &span.extreme}) *r = {r->low * to_first, r->high * to_first};
    spans.heights = join(spans.heights, span);
    if (deviation_from) spans.colours = join(spans.colours, deviationSpan(v, *deviation_from));
  }
  if (!deviation_from) spans.colours = spans.heights;
  return spans;
}

glm::dvec3 inScene(const PanelPlan& p, const glm::dvec3& field_mm) {
  const double unit = p.field.grid().height_unit.mm;
  return {p.placing.first + glm::dvec2(field_mm), (field_mm.z / unit - p.reference) * p.mm_per_unit};
}

PictureSpans negated(const PictureSpans& spans) noexcept {
  return {negated(spans.heights), negated(spans.colours)};
}

engine::Result<PicturePlan> planPicture(const PictureSpec& spec, std::span<const engine::Version> fields,
                                        const PictureSpans& spans, Layout layout) {
  if (engine::Status ok = checkSpec(spec); !ok) return tl::unexpected(ok.error());
  PicturePlan plan;
  plan.layout = std::move(layout);
  // Geometry. All fields share the reference and the unit of height of the first one.
  const engine::LengthUnit& unit = fields.front().grid().height_unit;
  const ValueSpan &heights = spans.heights, &colours = spans.colours;
  glm::dvec2 extent{0.0};
  for (const engine::Version& v : fields) extent = glm::max(extent, placingOf(v.grid()).extent());
  if (engine::Status ok = checkCentre(spec.view, extent); !ok) return tl::unexpected(ok.error());
  const double relief = heights.robust.high - heights.robust.low;  // [height_unit]
  const double widest = std::max(extent.x, extent.y);
  plan.exaggeration = spec.view.vertical_exaggeration > 0.0 ? spec.view.vertical_exaggeration
                                                            : chooseExaggeration(relief * unit.mm, widest);
  const double mm_per_unit = unit.mm * plan.exaggeration;
  const double reference = 0.5 * (heights.robust.low + heights.robust.high);
  // A flat field still has a base of some height, so that it looks like a body.
  const double relief_mm = relief * mm_per_unit;
  const double plinth = std::max(0.08 * relief_mm, 0.012 * widest);
  const double floor_z = -0.5 * relief_mm - plinth;
  const double lowest_drawn = reference + (floor_z + 0.3 * plinth) / mm_per_unit;
  const double highest_drawn = heights.robust.high + 0.5 * relief + 0.3 * plinth / mm_per_unit;
  const double top_z = 0.5 * relief_mm;
  const double cut_z = (highest_drawn - reference) * mm_per_unit;

  // Colours.
  const Quantity quantity = !spec.deviation_from       ? Quantity::kHeight
                            : spec.difference.one_sign ? Quantity::kOneSign
                                                       : Quantity::kDeviation;
  plan.map = resolve(spec.colouring.map, quantity);
  plan.palette = paletteOf(spec.theme, plan.map);
  // Constant values: a bar of about the size of the relief, or of a hundredth of the field's width.
  const double flat_half =
      relief > 0.0 ? roundDown125(0.01 * relief) : roundDown125(0.01 * std::max(widest, 1e-6) / unit.mm);
  plan.range = opened(spec.range ? *spec.range : colours.robust, flat_half);
  if (quantity != Quantity::kHeight) {
    const double limit = std::max(std::abs(plan.range.low), std::abs(plan.range.high));
    // Rounding may leave a little of the other sign.
    const bool below = -colours.extreme.low > colours.extreme.high;
    plan.range = {quantity == Quantity::kOneSign && !below ? 0.0 : -limit,
                  quantity == Quantity::kOneSign && below ? 0.0 : limit};
  }

  const std::vector<Tick> steps = ticks(plan.range.low, plan.range.high, 13);
  plan.contour_step = spec.colouring.contour_step > 0.0 ? spec.colouring.contour_step
                      : steps.size() > 1                ? steps[1].value - steps[0].value
                                                        : plan.range.high - plan.range.low;
  const ColourTable table = tableOf(spec.colouring, quantity, plan.range);

  for (std::size_t i = 0; i < fields.size(); ++i) {
    PanelPlan panel;
    panel.plot = plan.layout.plots[i];
    if (panel.plot.width < 8 || panel.plot.height < 8)
      return inputError(fmt::format("a picture of {} x {} pixels leaves no room for the surface",
                                    spec.view.width, spec.view.height),
                        "picture size", "make it larger, or leave the decorations out");
    panel.field = fields[i];
    panel.floor_z = floor_z;
    panel.cut_z = cut_z;
    panel.placing = placingOf(panel.field.grid());
    const glm::dvec2 half = 0.5 * extent;
    Framing& framing = panel.framing;
    framing.shown = {{-half.x, -half.y, floor_z}, {half.x, half.y, top_z}};
    framing.drawn = {{-half.x, -half.y, floor_z}, {half.x, half.y, cut_z}};
    // A margin around the block inside its plot.
    framing.plot = panel.plot;
    const int side = std::min(panel.plot.width, panel.plot.height);
    const int margin = plan.layout.decorated ? static_cast<int>(0.012 * side) : 0;
    framing.share = static_cast<double>(side - 2 * margin) / side;
    framing.first = panel.placing.first;
    framing.reference_mm = reference * unit.mm;
    framing.exaggeration = plan.exaggeration;
    panel.camera = framing.camera(spec.view);

    gpu::PanelUniforms& u = panel.uniforms;
    const double own_unit =
        panel.field.grid().height_unit.mm / unit.mm;  // units of the first field per unit of this field
    const double share = 1.0 / own_unit;
    panel.reference = reference * share;
    panel.mm_per_unit = mm_per_unit * own_unit;
    panel.lowest = lowest_drawn * share;
    panel.highest = highest_drawn * share;
    u = {};
    u.views[0].clip_from_scene = glm::mat4(panel.camera.clipFromScene());
    u.placing = glm::vec4(glm::dvec4(panel.placing.first, panel.placing.spacing));
    u.relief = glm::vec4(
        glm::dvec4(panel.field.reader().sign(), reference * share, mm_per_unit * own_unit, floor_z));
    u.limits = glm::vec4(glm::dvec4(lowest_drawn * share, highest_drawn * share,
                                    spec.deviation_from ? spec.deviation_from->reader().sign() : 1.0F, 0.0));
    u.colouring = glm::vec4(glm::dvec4(plan.range.low * share, own_unit / (plan.range.high - plan.range.low),
                                       plan.contour_step * share, 0.0));
    const glm::dvec3 right = panel.camera.right();
    const glm::dvec3 away{-right.y, right.x, 0.0};  // horizontal, from the viewer into the picture
    const double level = std::sqrt(0.5) * std::sqrt(1.0 - kLightUp * kLightUp);
    u.light = glm::vec4(glm::dvec4(level * (away - right) + glm::dvec3(0.0, 0.0, kLightUp),
                                   spec.deviation_from ? kDeviationAmbient : kAmbient));
    const double marks_share = spec.marks_look == MarksLook::kOutline ? -1.0 : spec.marks_opacity;
    u.marks_tint = vec4Of(plan.palette.marks, marks_share);
    u.suggested_tint = vec4Of(plan.palette.suggested, marks_share);
    // A power of two, so that stripes do not swim while a view comes nearer.
    const double stripes_mm = hatchPeriod(plan.layout.scale) / std::max(panel.camera.pixelsPerMm(), 1e-30);
    u.no_data = vec4Of(plan.palette.no_data, std::exp2(std::round(std::log2(stripes_mm))));
    u.wall = vec4Of(plan.palette.wall, 1.0);
    u.size = glm::ivec4(panel.placing.size, panel.placing.true_size);
    u.shade = glm::ivec4(0, 0, panel.placing.size);
    // A ray up or down the picture; seen from straight above, a sample is drawn exactly at its position. In
    // perspective that holds only for the middle of the picture.
    const double least = spec.view.projection == Projection::kPerspective ? 0.3 : 0.0;
    const double upright = std::max(least, std::abs(panel.camera.up().z)) * panel.camera.pixelsPerMm();
    u.seam = glm::vec4(0.0F, static_cast<float>(std::min(1e30, 1.0 / std::max(upright, 1e-30))), 0.0F, 0.0F);
    for (std::size_t k = 0; k < table.size(); ++k) u.colours[k] = glm::vec4(table[k], 1.0F);
    plan.panels.push_back(std::move(panel));
  }

  DecorationContent& f = plan.decorations;
  f.range = plan.range;
  const ValueRange extreme = extremesNow(fields, quantity, colours);
  // What rounding leaves on the other side of zero is no value that is missing.
  const double rounding = quantity == Quantity::kOneSign ? 1e-6 * (plan.range.high - plan.range.low) : 0.0;
  f.below = !colours.empty && extreme.low < plan.range.low - rounding;
  f.above = !colours.empty && extreme.high > plan.range.high + rounding;
  f.quantity = quantity == Quantity::kHeight ? "height" : spec.difference.name;
  f.height_unit = unitOfColours(quantity, fields.front().grid(), heights.robust, plan.range);
  f.lateral_unit = fields.front().grid().lateral_unit;
  f.length_unit = fieldUnits(fields.front().grid(), heights.robust.low, heights.robust.high).length;
  f.pixels_per_mm = plan.panels.front().camera.pixelsPerMm();
  f.exaggeration = plan.exaggeration;
  f.approximate_scale = spec.view.projection == Projection::kPerspective;
  for (const engine::Version& v : fields) {
    f.marks = f.marks || (spec.marks == MarksOverlay::kShow && anyMark(v));
    f.no_data = f.no_data || anyHole(v);
  }
  if (quantity != Quantity::kHeight && spec.deviation_from && anyHole(*spec.deviation_from))
    f.without = spec.difference.without;
  f.marks_opacity = static_cast<float>(spec.marks_opacity);
  if (f.below || f.above) {
    f.note = fmt::format("lowest {}\nhighest {}", shortNumber(extreme.low * f.height_unit.per_unit),
                         shortNumber(extreme.high * f.height_unit.per_unit));
    if (quantity != Quantity::kHeight && !spec.range)
      f.note += fmt::format("\nbar: {:.3g} %", 100.0 * colours.share);
  }
  if (quantity == Quantity::kDeviation && !colours.empty && colours.extreme == ValueRange{})
    f.note = "no deviation";
  const auto add = [&](const std::string& line) { f.note += (f.note.empty() ? "" : "\n") + line; };
  if (quantity == Quantity::kDeviation && spec.colouring.tolerance > 0.0)
    add("\u00b1" + shortNumber(spec.colouring.tolerance * f.height_unit.per_unit) + " is 0");
  if (spec.contours == Contours::kShow)
    add("lines: " + shortNumber(plan.contour_step * f.height_unit.per_unit));
  return plan;
}

}  // namespace fettle::render

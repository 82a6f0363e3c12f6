#include "app/window/overlays.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/overlay/line_overlay.h"
#include "app/texts/texts.h"
#include "app/window/navigation.h"
#include "app/window/scene_edits.h"
#include "engine/field/difference.h"

namespace fettle::app {

namespace {

using State = PlaceTool::State;

constexpr double kLeastSeen = 96.0;  // [samples]; of less the surroundings show no edge
constexpr double kPlacePiece_px = 3.0;
// Narrow: the hand has to see the edge below.
constexpr float kOtherPlace_px = 2.5F, kPresentPlace_px = 4.0F, kPlaceEnd_px = 9.0F;
constexpr render::LineMeaning kOpenPlace{{0.75F, 0.08F, 0.75F}, textOf("place for a line")},
    kPresentPlace{{1.0F, 0.2F, 0.9F}, textOf("the present place")},
    kDonePlace{{0.08F, 0.6F, 0.15F}, textOf("place done")},
    kSkippedPlace{{0.3F, 0.3F, 0.3F}, textOf("place skipped")},
    kSectionMeaning{{0.02F, 0.02F, 0.02F}, textOf("section")},
    kPointMeaning{{1.0F, 0.9F, 0.2F}, textOf("point of the plane")};
constexpr float kSection_px = 2.5F;
constexpr glm::vec3 kSectionRim{0.95F, 0.95F, 0.95F};
constexpr glm::vec3 kPointRim{0.02F, 0.02F, 0.02F};

// Its name in the language of the window.
render::LineMeaning inWords(render::LineMeaning meaning) {
  meaning.name = tr(meaning.name);
  return meaning;
}

// From one position to another, unless one of them is over a hole.
void addBetween(const std::optional<glm::dvec3>& from_mm, const std::optional<glm::dvec3>& to_mm,
                render::OverlayLine piece, std::vector<render::OverlayLine>& pieces) {
  if (!from_mm || !to_mm) return;
  piece.from_mm = *from_mm;
  piece.to_mm = *to_mm;
  pieces.push_back(piece);
}

const render::LineMeaning& meaningOfPlace(State state, bool present) {
  return state == State::kDone      ? kDonePlace
         : present                  ? kPresentPlace
         : state == State::kSkipped ? kSkippedPlace
                                    : kOpenPlace;
}

}  // namespace

render::View viewOfPlace(const render::View& view, const render::Framing& framing,
                         const engine::FieldReader& reader, const engine::WorthPlace& place) {
  glm::dvec2 low = place.path.front(), high = low;
  for (const glm::dvec2& p : place.path) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec2 spacing(reader.grid().spacingXMm(), reader.grid().spacingYMm());
  const glm::dvec2 extent_mm = spacing * glm::max(high - low, glm::dvec2(kLeastSeen));
  render::View there = view;
  Navigation::show(there, framing, framing.sceneOf(middleOnSurface(reader, low, high)),
                   std::max(extent_mm.x, extent_mm.y));
  return there;
}

void PlaceOverlay::append(const engine::Version& field, const PlaceTool& places, double mm_per_pixel,
                          render::Overlays& overlays) {
  if (places.found() == nullptr) {
    of_ = {};
    return;
  }
  if (of_.empty() || !(field == of_) || places.revision() != revision_ || mm_per_pixel != mm_per_pixel_) {
    of_ = field;
    revision_ = places.revision();
    mm_per_pixel_ = mm_per_pixel;
    pieces_.clear();
    const engine::Grid& grid = field.grid();
    const double sample_mm = std::max(grid.spacingXMm(), grid.spacingYMm());
    const auto stride =
        static_cast<std::size_t>(std::clamp(kPlacePiece_px * mm_per_pixel / sample_mm, 1.0, 1e6));
    const engine::FieldReader reader = field.reader();
    const std::vector<engine::WorthPlace>& all = places.found()->places;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::vector<glm::dvec2>& path = all[k].path;
      const bool present = places.present() == k;
      render::OverlayLine piece;
      piece.depth = render::OverlayLine::Depth::kInScene;
      piece.colour = meaningOfPlace(places.state(k), present).colour;
      piece.opacity = present ? 0.55F : 0.35F;
      piece.width_px = present ? kPresentPlace_px : kOtherPlace_px;
      for (std::size_t i = 0; i + 1 < path.size(); i += stride) {
        piece.from_mm = aboveSurface(reader, path[i]);
        piece.to_mm = aboveSurface(reader, path[std::min(i + stride, path.size() - 1)]);
        pieces_.push_back(piece);
      }
      if (!present) continue;
      piece.opacity = 1.0F;
      piece.width_px = kPlaceEnd_px;
      piece.depth = render::OverlayLine::Depth::kOnTop;
      for (const glm::dvec2& end : {path.front(), path.back()}) {
        piece.from_mm = piece.to_mm = aboveSurface(reader, end);
        pieces_.push_back(piece);
      }
    }
  }
  overlays.lines.insert(overlays.lines.end(), pieces_.begin(), pieces_.end());
  for (std::size_t k = 0; k < places.found()->places.size(); ++k)
    addMeaning(inWords(meaningOfPlace(places.state(k), places.present() == k)), overlays.meanings);
}

void appendStepArea(const engine::Version& field, const engine::History& history, std::int64_t step,
                    render::Overlays& overlays) {
  constexpr int kPieces = 48;  // of each side
  constexpr std::size_t kMostTiles =
      512;  // whose samples are looked at in a frame; of more the tiles will do
  const engine::Version &before = history.state(step - 1), &after = history.state(step);
  engine::SampleRect changed = history.info(step).rect;
  // Of a step of samples and marks alone: the tiles of a stroke reach far beyond it.
  if (before.lines() == after.lines() && before.formOver() == after.formOver() &&
      before.reader().sign() == after.reader().sign())
    if (const auto samples = engine::changedSamples(before, after, kMostTiles); samples && !samples->empty())
      changed = {samples->column - 1, samples->row - 1, samples->columns + 2, samples->rows + 2};
  const engine::FieldReader reader = field.reader();
  const glm::dvec2 last(reader.width() - 1, reader.height() - 1);
  const glm::dvec2 low = glm::clamp(glm::dvec2(changed.column, changed.row), glm::dvec2(0.0), last);
  const glm::dvec2 high =
      glm::clamp(glm::dvec2(changed.column + changed.columns - 1, changed.row + changed.rows - 1), low, last);
  const std::array corners{low, glm::dvec2(high.x, low.y), high, glm::dvec2(low.x, high.y)};
  render::OverlayLine piece;
  piece.depth = render::OverlayLine::Depth::kInScene;
  piece.colour = {1.0F, 0.85F, 0.1F};
  piece.width_px = 2.5F;
  for (std::size_t side = 0; side < corners.size(); ++side)
    for (int i = 0; i < kPieces; ++i) {
      const auto at = [&](int k) {
        return aboveSamples(reader, glm::mix(corners[side], corners[(side + 1) % 4], k / double(kPieces)));
      };
      addBetween(at(i), at(i + 1), piece, overlays.lines);
    }
}

void appendPoints(const engine::Version& field, std::span<const glm::dvec2> points_mm,
                  render::Overlays& overlays) {
  // A dark rim: seen on light and dark colours of heights.
  constexpr float kRim_px = 13.0F, kPoint_px = 8.0F;
  const engine::FieldReader reader = field.reader();
  const glm::dvec2 spacing(field.grid().spacingXMm(), field.grid().spacingYMm());
  render::OverlayLine piece;
  piece.depth = render::OverlayLine::Depth::kOnTop;
  const auto at = [&](std::size_t i) { return aboveSurface(reader, points_mm[i] / spacing); };
  for (std::size_t i = 0; i + 1 < points_mm.size(); ++i) {
    piece.colour = kPointRim;
    piece.width_px = 2.0F;
    piece.from_mm = at(i);
    piece.to_mm = at(i + 1);
    overlays.lines.push_back(piece);
  }
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    piece.from_mm = piece.to_mm = at(i);
    piece.colour = kPointRim;
    piece.width_px = kRim_px;
    overlays.lines.push_back(piece);
    piece.colour = kPointMeaning.colour;
    piece.width_px = kPoint_px;
    overlays.lines.push_back(piece);
  }
  if (!points_mm.empty()) addMeaning(inWords(kPointMeaning), overlays.meanings);
}

void SectionOverlay::append(const engine::Version& field, const SectionTool& section, double mm_per_pixel,
                            render::Overlays& overlays) {
  if (!(of_ == field) || revision_ != section.revision() || mm_per_pixel_ != mm_per_pixel) {
    of_ = field;
    revision_ = section.revision();
    mm_per_pixel_ = mm_per_pixel;
    pieces_.clear();
    const engine::FieldReader reader = field.reader();
    const glm::dvec2 spacing(field.grid().spacingXMm(), field.grid().spacingYMm());
    for (std::size_t i = 0; i < section.sections().size(); ++i)
      addSection(reader, spacing, section.sections()[i], section.chosen() == i);
  }
  overlays.lines.insert(overlays.lines.end(), pieces_.begin(), pieces_.end());
  if (!pieces_.empty()) addMeaning(inWords(kSectionMeaning), overlays.meanings);
}

void SectionOverlay::addSection(const engine::FieldReader& reader, const glm::dvec2& spacing,
                                const KeptSection& section, bool chosen) {
  constexpr double kMostPieces = 2000.0;
  const double wanted = mm_per_pixel_ > 0.0 ? section.lengthMm() / (3.0 * mm_per_pixel_) : 1.0;
  const int count = static_cast<int>(std::clamp(wanted, 1.0, kMostPieces));
  const auto at = [&](int i) {
    return aboveSamples(reader, (section.from + (section.to - section.from) * (i / double(count))) / spacing);
  };
  render::OverlayLine piece;
  const auto draw = [&] {
    for (int i = 0; i < count; ++i) addBetween(at(i), at(i + 1), piece, pieces_);
  };
  // What the surface hides of it is still seen faintly; the rest is on a light rim, for dark colours.
  piece.colour = kSectionMeaning.colour;
  piece.depth = render::OverlayLine::Depth::kOnTop;
  piece.opacity = chosen ? 0.3F : 0.15F;
  piece.width_px = kSection_px;
  draw();
  piece.depth = render::OverlayLine::Depth::kInScene;
  if (chosen) {
    piece.opacity = 1.0F;
    piece.colour = kSectionRim;
    piece.width_px = kSection_px + 2.0F;
    draw();
  }
  piece.opacity = chosen ? 1.0F : 0.45F;
  piece.colour = kSectionMeaning.colour;
  piece.width_px = kSection_px;
  draw();
  if (!chosen) return;
  piece.depth = render::OverlayLine::Depth::kOnTop;
  piece.width_px = 9.0F;
  // An end over a hole is at the height where the line goes on.
  const auto height = [&](int end, int step) {
    for (int i = end; i >= 0 && i <= count; i += step)
      if (const auto there = at(i)) return there->z;
    return 0.0;
  };
  for (const int end : {0, count}) {
    const glm::dvec2 there_mm = end == 0 ? section.from : section.to;
    piece.from_mm = piece.to_mm = glm::dvec3(there_mm, height(end, end == 0 ? 1 : -1));
    pieces_.push_back(piece);
  }
}

constexpr std::size_t kForces = 240;
constexpr double kLargestForce_px = 60.0;  // the arrow of the largest force
constexpr double kStylus_px = 96.0;
constexpr double kTurn_px = 2.0;  // of the drawn stylus' end

bool StylusOverlay::moved(const haptic::LoopState& state, double mm_per_pixel) const {
  constexpr glm::dvec3 kNone{0.0};
  const glm::dvec3 turned = state.stylus_axis.value_or(kNone) - state_.stylus_axis.value_or(kNone);
  return glm::length(state.endpoint_mm - state_.endpoint_mm) > mm_per_pixel ||
         glm::length(turned) * kStylus_px > kTurn_px || state.contact != state_.contact;
}

TipLook StylusOverlay::tipLookOf(const LoopClient& client) {
  const haptic::Scene& scene = client.scene();
  const engine::Grid& grid = client.field().grid();
  TipLook look;
  look.ring_mm = std::max(brushRadius(client), 0.5) * std::max(grid.spacingXMm(), grid.spacingYMm());
  if (scene.tip == haptic::TipShape::kSphere) look.ball_radius_mm = scene.tip_radius_mm;
  look.colour =
      haptic::isMarkTool(client.tool()) ? glm::vec3{1.0F, 0.55F, 0.0F} : glm::vec3{1.0F, 1.0F, 1.0F};
  return look;
}

void StylusOverlay::appendTip(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel,
                              double scale, const StylusLook& look, render::Overlays& overlays) {
  const TipLook tip_look = tipLookOf(client);
  render::StylusState tip;
  tip.endpoint_mm = state.endpoint_mm;
  tip.proxy_mm = state.proxy_mm;
  tip.force_n = state.force_n;
  tip.contact = state.contact;
  tip.tip_radius_mm = tip_look.ball_radius_mm;
  tip.discs = !look.pen;
  tip.arrow = look.force;
  render::appendStylus(tip, kLargestForce_px * scale * mm_per_pixel / client.scene().force_limit_n,
                       overlays.lines);
  render::Overlays::Ring ring;
  ring.x_mm = state.contact ? state.proxy_mm.x : state.endpoint_mm.x;
  ring.y_mm = state.contact ? state.proxy_mm.y : state.endpoint_mm.y;
  ring.radius_mm = tip_look.ring_mm;
  ring.colour = tip_look.colour;
  overlays.rings.push_back(ring);
  // In contact the endpoint is under the surface.
  const glm::dvec3& seen_mm = state.contact ? state.proxy_mm : state.endpoint_mm;
  if (look.pen)
    overlays.stylus = render::StylusBody{.tip_mm = seen_mm,
                                         .ball_radius_mm = tip.tip_radius_mm,
                                         .to_tail = state.stylus_axis,
                                         .length_px = kStylus_px * scale,
                                         .colour = ring.colour,
                                         .shadow = look.shadow};
}

void StylusOverlay::append(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel,
                           double scale, const StylusLook& look, render::Overlays& overlays) {
  appendTip(client, state, mm_per_pixel, scale, look, overlays);
  if (look.trail)
    trail_.append(state.contact ? state.proxy_mm : state.endpoint_mm, mm_per_pixel, StylusTrail::Clock::now(),
                  overlays);
  else
    trail_.clear();
}

void StylusOverlay::drawn() {
  forces_.push_back(static_cast<float>(glm::length(state_.force_n)));
  if (forces_.size() > kForces) forces_.erase(forces_.begin());
}

}  // namespace fettle::app

#include "app/window/window_picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "app/window/plane_map.h"
#include "app/window/preview_change.h"
#include "app/work/visible_part.h"
#include "engine/base/stopwatch.h"
#include "render/plan/overlay.h"

namespace fettle::app {
namespace {

// While nothing but the detail of tiles is unknown they are measured between two frames, which would each take longer
// than their measuring: input waits for a share, and a frame shows meanwhile what is known.
constexpr double kMeasuring_ms = 20.0;
constexpr std::chrono::milliseconds kShownMeanwhile{250};

// Between two frames of a preview: what else the window does waits no longer.
constexpr double kMostRest_ms = 50.0;

// Since something was drawn, and since the last input: nobody waits for a rehearsal, and much else begins with a field.
constexpr std::chrono::seconds kRehearsedAfter{1};
// A frame that draws this share of the picture tells how long all of it takes, at most.
constexpr double kTellsOfWhole = 0.5;

constexpr int kPicks =
    12;  // positions of the picture, in each direction, at which the visible part is sampled

// Whether what differs between two frames changes every pixel of the surface, whatever the field and the view are.
bool looksAlike(const render::FrameInput& a, const render::FrameInput& b) {
  return a.contours == b.contours && a.form == b.form && a.colouring == b.colouring && a.range == b.range &&
         a.marks_opacity == b.marks_opacity && a.marks_look == b.marks_look && a.theme == b.theme &&
         a.arrangement == b.arrangement && a.decoration == b.decoration &&
         a.light_azimuth_deg == b.light_azimuth_deg && a.light_elevation_deg == b.light_elevation_deg &&
         a.stereo.mode == b.stereo.mode;
}

bool same(const render::Shown& a, const render::Shown& b) {
  return a.versions == b.versions && a.original == b.original && a.marks == b.marks &&
         a.accepted == b.accepted && a.difference == b.difference;
}

}  // namespace

engine::Status WindowPicture::make() {
  render::LiveOptions options;
  options.measuring_ms = render::kWindowMeasuringMs;
  options.uploading_ms = render::kWindowUploadingMs;
  auto live = render::LivePicture::create(window_.context(), render::Window::pictureFormat(), options);
  if (!live) return tl::unexpected(live.error());
  lose();
  live_ = std::move(*live);
  clear();
  return {};
}

void WindowPicture::clear() {
  shown_ = {};
  refinement_ = {};
  at_rest_ = {};
  figures_ = {};
  // What took long was another field or another device.
  moving_ = FrameBudget();
  strokes_ = FrameBudget(FrameBudget::kSlowStroke_ms, FrameBudget::kQuickStroke_ms);
  whole_alone_ = whole_beside_ = FrameBudget::ofWhole();
  bands_ms_ = 0.0;
  sharp_later_ = {};
  results_came_ = results_wait_ = false;
  measured_ = Measured::kNothing;
  needs_redraw_ = true;
  look_.reset();
  rehearses_ = false;
  rehearsal_.end();  // it holds what was shown
}

void WindowPicture::fit(render::View& view) {
  const render::Rectangle& area = window_.pictureArea();
  if (view.width != area.width || view.height != area.height) needs_redraw_ = true;
  view.width = area.width;
  view.height = area.height;
}

engine::Status WindowPicture::show(render::Shown shown) {
  if (same(shown, shown_)) return {};
  if (auto status = live_->update(shown); !status) return status;
  // Without a form the heights are others.
  const bool other_form = !shown_.versions.empty() && !shown.versions.empty() &&
                          shown_.versions.front().formOver() != shown.versions.front().formOver();
  if (other_form) live_->refreshRanges();
  results_came_ = results_came_ || previewsDiffer(shown, shown_);
  const bool more_of_them = onlyPreviewsDiffer(shown, shown_);
  rehearsal_.release();  // it may hold the version of before
  shown_ = std::move(shown);
  (more_of_them ? results_wait_ : needs_redraw_) = true;
  return {};
}

void WindowPicture::smoothAtRest(bool wanted) noexcept {
  if (wanted != smooth_at_rest_) needs_redraw_ = true;
  smooth_at_rest_ = wanted;
}

void WindowPicture::computes(bool previews) noexcept {
  // Bands before and after say nothing together.
  if (previews != computes_ && figures_.bands_left > 0) bands_ms_ = std::numeric_limits<double>::infinity();
  computes_ = previews;
}

render::Sharpness WindowPicture::sharpness(const render::View& view, bool held) {
  const bool pending = motion_.sharpPending();
  const render::Sharpness sharpness = motion_.see(view, held, CameraMotion::Clock::now());
  if (pending && !motion_.sharpPending()) needs_redraw_ = true;
  return sharpness == render::Sharpness::kHalf && adapts_ && moving_.less() ? render::Sharpness::kQuarter
                                                                            : sharpness;
}

void WindowPicture::noteFrame(double ms) noexcept {
  if (measured_ == Measured::kMoving || measured_ == Measured::kWholeWithLess) moving_.note(ms);
  if (measured_ == Measured::kStroke) strokes_.note(ms);
  if (measured_ == (wholeFrames().less() ? Measured::kWholeWithLess : Measured::kWhole))
    wholeFrames().note(ms);
  tellOfWhole(ms);
  measured_ = Measured::kNothing;
  if (std::exchange(drew_, false))
    results_due_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double, std::milli>(std::min(ms, kMostRest_ms)));
}

// What the last frame says about one of all of the picture with every pixel.
void WindowPicture::tellOfWhole(double ms) noexcept {
  if (!drew_) return;
  if (drawn_sharpness_ != render::Sharpness::kFull) {
    bands_ms_ = 0.0;  // those before are not to be seen any more
    return;
  }
  if (figures_.band) {
    bands_ms_ += ms;
    if (figures_.bands_left == 0) wholeFrames().tell(0.0, std::exchange(bands_ms_, 0.0));
    return;
  }
  // An edit between two bands leaves as many of them to be drawn.
  if (figures_.bands_left == 0) bands_ms_ = 0.0;
  if (figures_.redrawn < kTellsOfWhole) return;
  // What was uploaded took a part of it.
  wholeFrames().tell(figures_.upload.tiles == 0 ? ms : 0.0, ms / figures_.redrawn);
}

bool WindowPicture::takeDue(Draws draws) {
  const auto now = Refinement::Clock::now();
  if (draws == Draws::kRefined && motion_.sharpPending()) refinement_.restart(now);  // the view moves
  const bool refines = draws == Draws::kRefined;
  if (refines && measuresFirst(now)) return false;
  const bool results = (results_wait_ || figures_.upload.pending_tiles > 0) &&
                       !(computes_ && figures_.upload.pending_of_first == 0 && now < results_due_);
  const bool changes = needs_redraw_ || results ||
                       (refines && (refinement_.due(now) || (sharp_later_.due(now) && !samplesCome()) ||
                                    figures_.bands_left > 0));
  only_rest_asked_ = !changes && refines && smooth_at_rest_ && !refinement_.pending() && at_rest_.due(now);
  const bool due = changes || only_rest_asked_;
  if (due) needs_redraw_ = results_wait_ = false;
  if (!due && refines && look_ && now - std::max(drawn_, hand_) >= kRehearsedAfter) {
    if (!std::exchange(rehearses_, true))
      rehearsal_.begin(*live_, shown_, *look_);
    else
      rehearsal_.drawNext(shown_);
  }
  return due;
}

// Whether the next frame is left out for the sake of the tiles whose detail is unknown; measures some of them.
bool WindowPicture::measuresFirst(Refinement::Clock::time_point now) {
  const render::UploadStatistics& upload = figures_.upload;
  const bool only_measures =
      upload.unmeasured_tiles > 0 &&
      upload.pending_tiles == upload.unmeasured_tiles + figures_.residency.pages_waiting;
  if (needs_redraw_ || results_wait_ || !only_measures || now - drawn_ >= kShownMeanwhile) return false;
  return live_->measureFor(kMeasuring_ms) > 0;
}

// Whether samples that are shown are still to be uploaded: a sharp picture could not come in bands, and would be drawn again.
bool WindowPicture::samplesCome() const noexcept {
  const render::UploadStatistics& upload = figures_.upload;
  return upload.pending_tiles > upload.unmeasured_tiles + figures_.residency.pages_waiting;
}

// Whether the next frame has half the resolution since whole frames take long; `changes_whole`: it is one.
bool WindowPicture::drawsLess(bool changes_whole, Refinement::Clock::time_point now) const noexcept {
  if (!adapts_ || !may_be_half_ || !wholeFrames().less()) return false;
  // The frame after one of half the resolution is whole, too.
  return changes_whole || (sharp_later_.pending() && (!sharp_later_.due(now) || samplesCome()));
}

bool WindowPicture::draw(render::FrameInput input, Draws draws, std::string& status) {
  // Drawn with the usual vertices at first: a key acts at once, and the picture becomes finer after it.
  const auto now = Refinement::Clock::now();
  const bool looks_other = look_ && !looksAlike(*look_, input);
  if (looks_other) refinement_.restart(now);
  look_ = input;
  look_->overlays = {};
  const bool sharp_wanted = draws == Draws::kRefined && input.sharpness == render::Sharpness::kFull;
  const bool changes_whole = sharp_wanted && (std::exchange(results_came_, false) || looks_other);
  if (sharp_wanted && drawsLess(changes_whole, now))
    input.sharpness = moving_.less() ? render::Sharpness::kQuarter : render::Sharpness::kHalf;
  // The first frame of every pixel after those with fewer has the usual vertices: with more it would take longer.
  const bool sharpens =
      input.sharpness == render::Sharpness::kFull &&
      (drawn_sharpness_ == render::Sharpness::kHalf || drawn_sharpness_ == render::Sharpness::kQuarter);
  if (sharpens) refinement_.restart(now);
  if (draws == Draws::kRefined)
    input.panel_vertices =
        refinement_.vertices(input.vertex_budget, shown_.versions.size(), Refinement::Clock::now());
  const bool in_bands = draws == Draws::kRefined && !changes_whole &&
                        input.sharpness == render::Sharpness::kFull &&
                        (refinement_.inBands() || sharpens || figures_.bands_left > 0);
  if (in_bands) input.redraw = render::FrameInput::Redraw::kInBands;
  const bool rests = draws == Draws::kRefined && smooth_at_rest_ && !refinement_.pending() &&
                     input.sharpness == render::Sharpness::kFull &&
                     at_rest_.rests(PictureAtRest::Clock::now());
  if (rests) input.sharpness = render::Sharpness::kRest;
  const engine::Stopwatch watch;
  const auto target = window_.pictureTarget();
  if (!target) return false;  // present() reports the reason
  const auto figures = live_->draw(input, **target);
  if (!figures) {
    if (window_.usable()) status = figures.error().line();
    return false;
  }
  const double took_ns = watch.ns();
  drawn_ = Refinement::Clock::now();
  figures_ = *figures;
  draw_figures_.last_ms = 1e-6 * took_ns;
  draw_figures_.times.add(static_cast<std::int64_t>(took_ns));
  draw_figures_.tiles_uploaded += figures_.upload.tiles;
  draw_figures_.bytes_uploaded += figures_.upload.bytes;
  drawn_sharpness_ = input.sharpness;
  // Frames that refine a picture at rest take long on purpose.
  const bool whole = sharp_wanted && !rests && !figures_.band && !wholeFrames().less() &&
                     figures_.redrawn == 1.0 && figures_.upload.tiles == 0;
  const bool with_less =
      input.sharpness == render::Sharpness::kHalf || input.sharpness == render::Sharpness::kQuarter;
  drew_ = true;
  if (changes_whole || whole) {
    measured_ = with_less ? Measured::kWholeWithLess : Measured::kWhole;
    if (with_less) sharp_later_.drawnWithLess(drawn_);
  } else if (!sharp_wanted && with_less) {
    measured_ = Measured::kMoving;
  } else if (!rests && !figures_.band && figures_.continued && figures_.redrawn < 1.0) {
    measured_ = Measured::kStroke;
  }
  if (!with_less) sharp_later_.drawnSharply();
  at_rest_.drawn({.changed = figures_.redrawn > 0.0,
                  .at_rest = rests,
                  .left = figures_.rest_left,
                  .asked_here = only_rest_asked_},
                 PictureAtRest::Clock::now());
  // One that was drawn for the sake of rest alone has as many vertices as the one before.
  if (draws == Draws::kRefined && !only_rest_asked_)
    refinement_.drawn({.whole = figures_.redrawn == 1.0,
                       .continued = figures_.continued,
                       .tiles_coming = figures_.upload.pending_tiles > figures_.residency.pages_waiting,
                       .pages_coming = figures_.residency.pages_waiting > 0,
                       .bands_left = figures_.bands_left},
                      Refinement::Clock::now());
  return true;
}

void WindowPicture::refreshRanges() {
  if (live_) live_->refreshRanges();
}

void WindowPicture::refreshColours() {
  if (live_) live_->refreshColours();
}

bool WindowPicture::inside(double x, double y) const {
  const render::Rectangle& area = window_.pictureArea();
  return x >= area.x && y >= area.y && x < area.x + area.width && y < area.y + area.height;
}

std::optional<render::Picked> WindowPicture::pick(double x, double y) const {
  const render::Rectangle& area = window_.pictureArea();
  return live_ ? live_->pick(x - area.x, y - area.y) : std::nullopt;
}

std::optional<render::Grip> WindowPicture::grip(double x, double y) const {
  const render::Rectangle& area = window_.pictureArea();
  return live_ ? live_->grip(x - area.x, y - area.y) : std::nullopt;
}

std::optional<render::Framing> WindowPicture::framing() const {
  return live_ ? live_->framing() : std::nullopt;
}

std::optional<render::Grip> WindowPicture::gripInMiddle() const {
  const auto seen = framing();
  if (!seen) return std::nullopt;
  return live_->grip(seen->plot.x + 0.5 * seen->plot.width, seen->plot.y + 0.5 * seen->plot.height);
}

std::optional<glm::dvec2> WindowPicture::fieldAt(const glm::dvec2& pixel, const engine::Version& field,
                                                 const render::View& view) const {
  if (const auto picked = pick(pixel.x, pixel.y)) return glm::dvec2(picked->position_mm);
  return levelAt(pixel, field, view);
}

std::optional<glm::dvec2> WindowPicture::levelAt(const glm::dvec2& pixel, const engine::Version& field,
                                                 const render::View& view,
                                                 std::optional<double> height) const {
  if (!live_) return std::nullopt;
  const engine::Grid& grid = field.grid();
  const engine::HeightBounds bounds = field.reader().bounds();
  if (bounds.empty()) return std::nullopt;
  const double middle_height =
      0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max)) * grid.height_unit.mm;
  const double z = height.value_or(middle_height);
  const double wide = std::max(grid.width - 1, 1) * grid.spacingXMm(),
               tall = std::max(grid.height - 1, 1) * grid.spacingYMm();
  const double reach = 0.25 * std::max(wide, tall) / view.zoom;
  const glm::dvec2 middle{view.centre_x * wide, view.centre_y * tall};
  std::array<PlaneMap::Pair, 4> pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const glm::dvec2 place = middle + reach * glm::dvec2(i % 2 == 0 ? -1.0 : 1.0, i < 2 ? -1.0 : 1.0);
    const auto seen = live_->pixelOf(0, {place, z});
    if (!seen) return std::nullopt;
    pairs[i] = {{seen->first + window_.pictureArea().x, seen->second + window_.pictureArea().y}, place};
  }
  const auto plane = PlaneMap::through(pairs);
  return plane ? plane->fieldAt(pixel) : std::nullopt;
}

std::optional<glm::dvec2> WindowPicture::placeOf(const glm::dvec3& field_mm) const {
  const auto seen = live_ ? live_->pixelOf(0, field_mm) : std::nullopt;
  if (!seen) return std::nullopt;
  return glm::dvec2(seen->first + window_.pictureArea().x, seen->second + window_.pictureArea().y);
}

std::vector<Seen> WindowPicture::seenPlaces(const engine::Grid& grid) const {
  const render::Rectangle& area = window_.pictureArea();
  std::vector<Seen> seen;
  // By millimetres: what is shown of the field, or next to it, may have fewer samples.
  const auto sampleAt = [](double mm, double spacing_mm, std::int32_t side) {
    return std::clamp(static_cast<std::int32_t>(mm / spacing_mm), 0, side - 1);
  };
  for (int y = 0; y <= kPicks; ++y)
    for (int x = 0; x <= kPicks; ++x)
      if (const auto picked =
              pick(area.x + area.width * x / double(kPicks), area.y + area.height * y / double(kPicks)))
        seen.push_back({sampleAt(picked->position_mm.x, grid.spacingXMm(), grid.width),
                        sampleAt(picked->position_mm.y, grid.spacingYMm(), grid.height)});
  return seen;
}

engine::SampleRect WindowPicture::seenRect(const engine::Grid& grid) const {
  const std::vector<Seen> seen = seenPlaces(grid);
  if (seen.empty()) return {};
  Seen low = seen.front(), high = seen.front();
  for (const Seen& place : seen) {
    low = {std::min(low.column, place.column), std::min(low.row, place.row)};
    high = {std::max(high.column, place.column), std::max(high.row, place.row)};
  }
  return {low.column, low.row, high.column - low.column + 1, high.row - low.row + 1};
}

engine::FieldView WindowPicture::seenPart(const engine::Grid& grid, const render::View& view) const {
  const auto along = [](double share, int side) {
    return static_cast<std::int32_t>(std::clamp(share, 0.0, 1.0) * (side - 1));
  };
  return visiblePart(grid, seenPlaces(grid),
                     {along(view.centre_x, grid.width), along(view.centre_y, grid.height)});
}

render::Rectangle WindowPicture::plot(const render::View& view, const Display& display) const {
  const render::Rectangle& area = window_.pictureArea();
  const auto layout =
      render::layOut(view, display.decorations ? render::Decoration::kFull : render::Decoration::kNone, 1,
                     render::Titles::kNone, kDecorations * window_.scale());
  render::Rectangle rectangle = layout.plots.front();
  rectangle.x += area.x;
  rectangle.y += area.y;
  return rectangle;
}

bool WindowPicture::hasSplitLine(const Display& display) const {
  return display.split && shown_.versions.size() == 2 && display.stereo == render::StereoMode::kOff;
}

}  // namespace fettle::app

#include "app/window/draw_field.h"

#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

using Draws = WindowPicture::Draws;

// What the colours show the difference from, and what that is.
struct Compared {
  engine::Version with;
  render::Difference difference;
  bool residuals = false;  ///< its colours are read by the legend: nothing is tinted over them
};

std::optional<Compared> comparedWith(Parts& parts) {
  const engine::Version& field = parts.document.client()->field();
  if (const auto& form = parts.form.previewed()) return Compared{form->surface, {tr("deviation")}, true};
  if (parts.fit.shown)
    if (const auto* surface = parts.fit.surface(field))
      return Compared{*surface, {tr("distance"), false, parts.fit.leavesOut() ? tr("not fitted") : ""}, true};
  if (parts.features.shown)
    if (const auto* saddles = parts.features.saddles(field)) {
      const bool dales = (*parts.features.found())["kind"] == "dales";
      return Compared{
          *saddles,
          {dales ? tr("dale depth") : tr("hill height"), true, dales ? tr("no dale") : tr("no hill")},
          true};
    }
  if (parts.compare.shown)
    if (const auto* other = parts.compare.beside(field)) return Compared{*other, {tr("deviation")}, true};
  if (parts.settings.display.deviation)
    return Compared{parts.document.client()->original(), {tr("deviation")}, false};
  return std::nullopt;
}

// A hand that marks has to see what it marks.
bool handMarks(const Parts& parts) {
  return parts.marking.lasso().active() ||
         (parts.stylus.on() && haptic::isMarkTool(parts.document.client()->tool()));
}

// Residuals are read by their colours: a tint would falsify them.
bool outlinesMarks(Parts& parts) {
  if (!parts.document.isOpen()) return false;
  const auto compared = comparedWith(parts);
  return compared && compared->residuals && !handMarks(parts);
}

// The settings of the user.
render::FrameInput frameInput(Parts& parts, render::Sharpness sharpness, const DrawOptions& options) {
  const Display& display = parts.settings.display;
  render::FrameInput input;
  input.view = parts.view;
  input.vertex_budget = display.vertices;
  input.arrangement = display.split && parts.picture.shown().versions.size() == 2
                          ? render::Arrangement::kSplit
                          : render::Arrangement::kSideBySide;
  input.split = display.split_at;
  input.contours = display.contours ? render::Contours::kShow : render::Contours::kHide;
  input.form = display.form;
  input.marks_opacity = display.marks_opacity;
  input.marks_look = outlinesMarks(parts) ? render::MarksLook::kOutline : render::MarksLook::kTint;
  input.range = parts.colours.range(display, parts.picture.shown());
  input.colouring = parts.colours.colouring(display, ColourRange::quantityOf(parts.picture.shown()));
  input.stereo.mode = display.stereo;
  input.stereo.eye_separation = static_cast<double>(display.eye_separation);
  input.theme = display.theme;
  if (display.half_in_motion && !options.sharp_motion) input.sharpness = sharpness;
  input.titles_in_margin = true;  // the picture stays where it is when a preview begins
  input.decoration_scale = WindowPicture::kDecorations * parts.window.scale();
  input.decoration = display.decorations ? render::Decoration::kFull : render::Decoration::kNone;
  input.light_azimuth_deg = display.light_azimuth_deg;
  input.light_elevation_deg = display.light_elevation_deg;
  return input;
}

// Means of a large field, in its place until the surface of a previewed form is there for all of its samples.
const CoarseForm* meansShown(const Parts& parts) {
  const auto& form = parts.form.previewed();
  return form && form->coarse ? &*form->coarse : nullptr;
}

// A preview that has fewer samples at first has no differences from others: it follows when it has all.
std::vector<PreviewPicture> previewsOf(Parts& parts) {
  if (meansShown(parts) != nullptr) return {};
  std::vector<PreviewPicture> previews = parts.filters.pictures();
  if (auto heights = parts.heights.picture()) {
    previews.push_back(*std::move(heights));
    if (previews.size() > FilterPreview::kMostVariants) previews.erase(previews.begin());
  }
  const engine::Grid& grid = parts.document.client()->field().grid();
  if (comparedWith(parts))
    std::erase_if(previews, [&grid](const PreviewPicture& preview) {
      return preview.field.grid().width != grid.width || preview.field.grid().height != grid.height;
    });
  return previews;
}

render::Shown shownOf(Parts& parts, const std::vector<PreviewPicture>& previews) {
  const LoopClient& client = *parts.document.client();
  const Display& display = parts.settings.display;
  const auto compared = comparedWith(parts);
  render::Shown shown;
  shown.marks = display.marks ? render::MarksOverlay::kShow : render::MarksOverlay::kHide;
  if (compared) shown.difference = compared->difference;
  // All with the same sign: the loop inverts the field some ticks after the scene was changed, and a preview
  // may have been computed before that.
  const float sign = client.field().reader().sign();
  const auto likeField = [sign](const engine::Version& v) {
    return v.reader().sign() == sign ? v : v.inverted();
  };
  if (parts.shows_before) {
    shown.versions.push_back(likeField(client.original()));
  } else if (const CoarseForm* coarse = meansShown(parts)) {
    shown.versions.push_back(likeField(coarse->means));
    shown.original = likeField(coarse->surface);
    return shown;
  } else {
    shown.versions.push_back(parts.marking.edges.over(client.field()));
  }
  for (const PreviewPicture& preview : previews) shown.versions.push_back(likeField(preview.field));
  if (compared) shown.original = likeField(compared->with);
  if (parts.marking.edges.suggestion() != nullptr && !parts.shows_before) shown.accepted = client.field();
  return shown;
}

void addTitles(const Parts& parts, const std::vector<PreviewPicture>& previews, render::FrameInput& input) {
  if (const CoarseForm* coarse = meansShown(parts))
    input.titles.push_back(screenText(trFormat("without the form: {}", coarseFormState(*coarse))));
  if (previews.empty()) return;
  input.titles.emplace_back(tr("unchanged"));
  for (const PreviewPicture& preview : previews) input.titles.push_back(preview.title);
  // One plot has room for only one title.
  if (input.arrangement == render::Arrangement::kSplit)
    input.titles = {trFormat("left: unchanged, right: {}", input.titles[1]), ""};
  for (std::string& title : input.titles) title = screenText(title);
}

}  // namespace

void drawField(Parts& parts, const DrawOptions& options) {
  WindowPicture& picture = parts.picture;
  LoopClient& client = *parts.document.client();
  const haptic::LoopState state = client.state();
  const auto now = SparedShadow::Clock::now();
  if (parts.stylus_overlay.moved(state, picture.mmPerPixel())) {
    parts.spared_shadow.moved(now);
    picture.requestRedraw();
  }
  picture.fit(parts.view);
  const std::vector<PreviewPicture> previews = previewsOf(parts);
  if (const auto status = picture.show(shownOf(parts, previews)); !status) {
    // present() reports a lost device.
    if (parts.window.usable()) parts.feedback.message(status.error().line(), "");
    return;
  }
  picture.adapt(!options.steady);
  picture.allowHalf(parts.settings.display.half_in_motion && !options.sharp_motion);
  if (parts.spared_shadow.due(picture.spares(), now)) picture.requestRedraw();
  const render::Sharpness sharpness = picture.sharpness(parts.view, parts.drag.active());
  picture.smoothAtRest(parts.settings.display.smooth_at_rest && options.smooth_at_rest);
  if (!picture.takeDue(Draws::kRefined)) return;

  render::FrameInput input = frameInput(parts, sharpness, options);
  addTitles(parts, previews, input);
  const bool stylus = parts.stylus.on() || client.mouse() == nullptr || client.controllerLeads();
  // The shadow is three quarters of what a frame with a brush takes.
  StylusLook look = parts.settings.display.stylusLook();
  const bool shown = stylus && state.link == haptic::LinkState::kConnected;
  const bool left_out = shown && look.pen && look.shadow && !parts.spared_shadow.shown(picture.spares(), now);
  if (left_out) look.shadow = false;
  if (shown)
    parts.stylus_overlay.append(client, state, picture.mmPerPixel(), parts.window.scale(), look,
                                input.overlays);
  else
    parts.stylus_overlay.hide();
  if (parts.settings.side_panel && parts.settings.panels["Form"])
    appendPoints(client.field(), parts.plane_points.set(parts.form.options), input.overlays);
  parts.section_overlay.append(client.field(), parts.section, picture.mmPerPixel(), input.overlays);
  parts.place_overlay.append(client.field(), parts.marking.places, picture.mmPerPixel(), input.overlays);
  if (parts.settings.display.marks)
    parts.line_overlay.append(client.field(), parts.marking.lines.chosen(client), picture.mmPerPixel(),
                              input.overlays);
  parts.line_drag.append(client.field(), input.overlays);
  const engine::History& history = client.history();
  if (const auto step = parts.pointed_step; step && *step > history.first() && *step <= history.last())
    appendStepArea(client.field(), history, *step, input.overlays);
  parts.stylus_overlay.begin(state);
  if (!picture.draw(std::move(input), Draws::kRefined, parts.feedback.status)) return;
  parts.stylus_overlay.drawn();
  parts.spared_shadow.drawn(left_out);
  if (parts.stylus_overlay.fades()) picture.requestRedraw();
  client.setView(parts.view.azimuth_deg, parts.view.zoom);
}

// The pen's size is that of a window's pixels.
constexpr StylusLook kTipInTheRoom{.pen = false, .shadow = false, .force = true, .trail = false};

HeadsetPicture headsetPicture(Parts& parts, const DrawOptions& options) {
  LoopClient& client = *parts.document.client();
  HeadsetPicture picture;
  picture.shown = shownOf(parts, {});
  picture.input = frameInput(parts, render::Sharpness::kFull, options);
  const haptic::LoopState state = client.state();
  if (client.mouse() == nullptr && state.link == haptic::LinkState::kConnected)
    StylusOverlay::appendTip(client, state, parts.picture.mmPerPixel(), 1.0, kTipInTheRoom,
                             picture.input.overlays);
  return picture;
}

TipLook tipLookOf(const Parts& parts) {
  return StylusOverlay::tipLookOf(*parts.document.client());
}

void drawCoarse(Parts& parts, const DrawOptions& options) {
  WindowPicture& picture = parts.picture;
  picture.adapt(!options.steady);
  picture.fit(parts.view);
  render::Shown shown;
  shown.versions.push_back(parts.opening.coarse()->field);
  if (const auto status = picture.show(std::move(shown)); !status) {
    if (parts.window.usable()) parts.feedback.status = status.error().line();
    parts.dropCoarse();
    return;
  }
  const render::Sharpness sharpness = picture.sharpness(parts.view, parts.drag.active());
  if (picture.takeDue(Draws::kCoarse))
    (void)picture.draw(frameInput(parts, sharpness, options), Draws::kCoarse, parts.feedback.status);
}

}  // namespace fettle::app

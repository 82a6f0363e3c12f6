#include "app/window/window_state.h"

#include <cmath>
#include <utility>

#include <imgui.h>

#include "app/window/axes_gizmo.h"
#include "app/work/suggestion_text.h"
#include "haptic/safety/safety.h"
#include "haptic/scene/scene_numbers.h"

namespace fettle::app {
namespace {

// Enough digits to distinguish states, few enough to ignore rounding.
double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

double ms(std::int64_t ns) {
  return 1e-6 * static_cast<double>(ns);
}

Report firstState(const Parts& p, const Input& input, const RunFigures& run) {
  const Question* const dialog = p.feedback.questions.shown();
  const render::Rectangle& area = p.window.pictureArea();
  const SessionKeeper* const keeper = p.document.keeper();
  const HeadsetFigures& headset = run.headset;
  const Report room{{"mm", headset.metres_per_mm},
                    {"true_size", headset.true_size},
                    {"tip", headset.tip ? Report(*headset.tip == 0 ? "left" : "right") : Report()},
                    {"points", headset.points}};
  Report r{{"keys", input.counts().keys},
           {"buttons", input.counts().buttons},
           {"wheels", input.counts().wheels},
           {"drops", input.counts().drops},
           {"cursor", {std::lround(p.cursor.x), std::lround(p.cursor.y)}},
           {"frame", {p.window.width(), p.window.height()}},
           {"picture", {area.x, area.y, area.width, area.height}},
           {"minimised", p.window.minimised()},
           {"full_screen", p.full_screen},
           {"scale", rounded(p.window.scale())},
           {"dialog", dialog != nullptr ? name(dialog->kind) : "none"},
           {"dialog_path", dialog != nullptr ? dialog->path : ""},
           {"text_field", ImGui::GetIO().WantTextInput},
           {"field_text", p.window.fieldText()},
           {"message", dialog != nullptr ? dialog->said.what : ""},
           {"status", p.feedback.status},
           {"reduced_motion", p.settings.display.reduced_motion},
           {"light_panels", p.settings.panels_theme == render::Theme::kLight},
           {"asks_before_quitting", p.settings.ask_before_quitting},
           {"device_losses", run.device_losses},
           {"headset", run.headset.name.empty() ? "none"
                       : run.headset.over       ? "over"
                       : run.headset.stands     ? "stands"
                       : run.headset.frames > 0 ? "shown"
                                                : "starting"},
           {"room", room},
           {"loading", p.opening.busy()},
           {"coarse", p.coarseIsShown()},
           {"saving", p.saving.busy(p.document)},
           {"writing", p.results.busy() ? p.results.what() : ""},
           {"path", p.document.path()},
           {"save_path", keeper != nullptr && keeper->named() ? keeper->path() : p.saving.path()}};
  Report notices = Report::array();
  for (const Notice& notice : p.feedback.notices) notices.push_back(notice.what);
  r["notices"] = notices;
  if (p.seenGrid() != nullptr)
    r["view"] = {rounded(p.view.azimuth_deg), rounded(p.view.elevation_deg), rounded(p.view.zoom),
                 rounded(p.view.centre_x),    rounded(p.view.centre_y),      rounded(p.view.centre_z)};
  return r;
}

void addDocument(const Parts& p, Report& r) {
  const LoopClient& client = *p.document.client();
  const SessionKeeper& keeper = *p.document.keeper();
  const Lasso& lasso = p.marking.lasso();
  r["tool"] = p.stylus.on() ? haptic::toolName(client.tool()) : "view";
  r["lasso"] = !lasso.active() ? "" : lasso.shape() == Lasso::Shape::kBox ? "box" : "free";
  Report open_panels = Report::array();
  for (const auto& [panel, open] : p.settings.panels)
    if (p.settings.side_panel && open) open_panels.push_back(panel);
  r["panels"] = open_panels;
  r["steps"] = client.history().number();
  r["last_step"] = client.history().last();
  r["unsaved"] = p.document.unsaved();
  r["session"] = keeper.path();
  r["session_named"] = keeper.named();
  r["session_waiting"] = keeper.waiting();
  r["kept"] = keeper.waiting() == 0 && !keeper.error();
}

// Where the ends of the axes can be clicked on: those of x, y and z above zero, then below. The view to come, so that
// each picture of a flight is no state of its own.
Report axesState(const Parts& p) {
  Report ends = Report::object();
  if (!p.settings.display.axes) return ends;
  const AxesGizmo gizmo(p.viewToCome(), p.picture.plot(p.view, p.settings.display), p.window.scale());
  if (!gizmo.shown()) return ends;
  for (const AxesGizmo::Ball& ball : gizmo.balls())
    ends[std::string(1, "xyz"[ball.axis]) + (ball.positive ? "+" : "-")] = {std::lround(ball.at.x),
                                                                            std::lround(ball.at.y)};
  return ends;
}

void addBrushAndView(const Parts& p, Report& r) {
  const haptic::MouseStylus* const mouse = p.document.client()->mouse();
  const haptic::Scene& scene = p.document.client()->scene();
  const Display& display = p.settings.display;
  const render::ValueRange& range = p.picture.figures().range;
  r["inverted"] = scene.invert;
  r["brush"] = rounded(scene.brush_radius_samples);
  r["falloff"] = std::string(haptic::rowOf(scene.brush_falloff).word);
  r["spacing"] = rounded(scene.brush_spacing);
  r["radial"] = !p.radial.active()   ? Report()
                : p.radial.pointed() ? Report(std::string(RadialMenu::kItems[*p.radial.pointed()].name))
                                     : Report("");
  r["pointed_step"] = p.pointed_step ? Report(*p.pointed_step) : Report();
  r["shows_before"] = p.shows_before;
  r["stylus_pen"] = display.stylus.pen;
  r["mark_brush"] = rounded(scene.mark_radius_samples);
  r["press_mm"] = mouse != nullptr ? rounded(mouse->pressMm()) : 0.0;
  r["adjusting"] = p.brush.of() == BrushAdjustment::Of::kRadius  ? "radius"
                   : p.brush.of() == BrushAdjustment::Of::kDepth ? "depth"
                                                                 : "";
  r["typed"] = p.brush.typed();
  r["perspective"] = p.view.projection == render::Projection::kPerspective;
  r["marks"] = display.marks;
  r["deviation"] = display.deviation;
  r["contours"] = display.contours;
  r["vertices"] = display.vertices;
  r["colours"] = {rounded(range.low), rounded(range.high)};
  const render::Shown& shown = p.picture.shown();
  const RangeRule& rule = ColourRange::ruleOf(display, ColourRange::quantityOf(shown));
  r["colours_are"] = shown.original ? shown.difference.name : "height";
  r["colour_map"] = static_cast<int>(p.colours.colouring(display, ColourRange::quantityOf(shown)).map);
  const bool marks = shown.marks == render::MarksOverlay::kShow;
  r["marks_tinted"] = marks && p.picture.marksLook() == render::MarksLook::kTint;
  r["marks_outlined"] = marks && p.picture.marksLook() == render::MarksLook::kOutline;
  r["without_colour"] = shown.original ? shown.difference.without : "";
  static constexpr const char* kRules[] = {"automatic", "share", "all", "typed"};
  r["colour_rule"] = kRules[static_cast<std::size_t>(rule.kind)];
  r["contour_step"] = p.picture.figures().contour_step;
  r["tolerance"] = p.colours.typed.tolerance;
  const auto& handles = p.colours.handles;
  r["colour_handles"] =
      handles ? Report{std::lround(handles->low_x), std::lround(handles->high_x), std::lround(handles->y)}
              : Report();
  r["contact_level"] =
      scene.tip == haptic::TipShape::kSphere ? "ball" : std::string(haptic::levelName(scene.level));
  r["measured"] = {!p.costs.contact().empty(), !p.costs.detail().empty()};
  r["map"] = static_cast<int>(display.map);
  r["rehearsed"] = p.picture.rehearsed();
  r["mouse"] = std::string(kMousePresets[static_cast<std::size_t>(p.settings.habits)].word);
  r["bookmarks"] = p.bookmarks.count();
  r["axes"] = axesState(p);
  r["light"] = {std::lround(display.light_azimuth_deg), std::lround(display.light_elevation_deg)};
}

void addFilters(const Parts& p, Report& r) {
  const FilterPreview& filters = p.filters;
  const EdgeTool& edges = p.marking.edges;
  Report variants = Report::array();
  for (const FilterPreview::Variant& v : filters.variants()) variants.push_back(filterName(v.spec));
  r["filter"] = filterName(filters.spec);
  r["max_change"] = filters.spec.max_change ? Report(*filters.spec.max_change) : Report();
  r["variants"] = variants;
  r["filtering"] = filters.computing();
  r["preview_is_behind"] = filters.isBehind();
  const engine::FilterView::Picture& so_far = filters.soFar();
  r["preview_so_far"] = so_far.field.empty() ? Report() : Report(previewState(so_far, so_far.field.grid()));
  Report listed = Report::array();
  if (const FilterSuggester::Found* const found = p.suggester.found())
    for (const ListedFilter& each : listedFilters(found->suggestion, found->asked, p.units.change)) {
      const engine::FilterCandidate& candidate = found->suggestion.candidates[each.candidate];
      listed.push_back({{"method", engine::methodOf(candidate)},
                        {"name", candidateName(candidate)},
                        {"filter", filterName(candidate.spec)},
                        {"why", each.why}});
    }
  r["trying_filters"] = p.suggester.busy();
  r["listed_filters"] = listed;
  r["no_filter"] = p.suggester.nothing();
  r["listed_are_outdated"] = p.suggester.outdated();
  r["suggested"] = edges.suggestion() != nullptr ? edges.suggestion()->samples : 0;
  r["looking_for_edges"] = edges.busy();
  const engine::EdgeLines lines = p.document.client()->newest().lines();
  r["lines"] = lines ? lines->size() : 0;
  const PlaceTool& places = p.marking.places;
  r["looking_for_places"] = places.busy();
  r["places"] = places.found() != nullptr ? places.found()->places.size() : 0;
  r["place"] = places.present() ? Report(*places.present() + 1) : Report();
  r["places_done"] = places.count(PlaceTool::State::kDone);
  r["places_outdated"] = places.outdated();
  r["places_skipped"] = places.count(PlaceTool::State::kSkipped);
  r["draws_lines"] = p.settings.draw_lines;
  r["marking"] = p.marking.edit.busy();
  const engine::FieldForm& form = p.document.client()->newest().formOver();
  r["form"] = form != nullptr ? Report(std::string(engine::infoOf(*form).word)) : Report();
  r["fitting_form"] = p.form.busy();
  const auto& preview = p.form.previewed();
  r["form_preview"] = preview ? Report(std::string(engine::infoOf(preview->options.kind).word)) : Report();
  r["form_preview_means_of"] = preview && preview->coarse ? Report(preview->coarse->step) : Report();
  r["form_rms"] = p.form.fit() ? Report(p.form.fit()->rms) : Report();
  Report points = Report::array();
  if (const auto& through = p.form.options.through)
    for (const glm::dvec2& at : through->at_mm) points.push_back({rounded(at.x), rounded(at.y)});
  r["plane_points"] = points;
  r["plane_point"] = p.plane_points.next() ? Report(*p.plane_points.next() + 1) : Report();
  r["computing_heights"] = p.heights.busy();
  r["heights_found"] = p.heights.found();
  r["lines_suggested"] = p.line_suggester.says();
  r["lines_by"] = lineWayName(p.heights.lines.method, p.heights.lines.degree);
  const haptic::HeightsMaker* const previewed = p.heights.previewed();
  r["heights_preview"] = previewed != nullptr ? Report(p.heights.previewName()) : Report();
  const auto& removal = p.removal.counts();
  r["would_remove"] = removal ? Report(removal->removed) : Report();
  r["heights_so_far"] = p.heights.soFar();
  r["measuring"] = p.measure.busy();
  Report parameters = Report::object();
  if (const auto* figures = p.measure.figures())
    for (const ArealLine& line : figures->lines) parameters[line.name] = line.values;
  r["parameters"] = parameters;
  r["curves"] = p.measure.figures() ? p.measure.figures()->curves.size() : 0;
  r["parameters_of"] = p.measure.figures() ? p.measure.figures()->samples : 0;
  r["parameters_outdated"] = p.measure.outdated();
  const auto& profiles = p.section.profiles();
  r["comparing"] = p.compare.busy();
  const auto* compared = p.compare.compared();
  r["compared_rms_mm"] = compared != nullptr ? Report(compared->rms_mm) : Report();
  r["compared_rotation"] =
      compared != nullptr && compared->alignment ? Report(compared->alignment->angles.rotation_z) : Report();
  r["fitting"] = p.fit.busy();
  r["fits"] = p.fit.fits() != nullptr ? p.fit.fits()->report : Report();
  r["finding_features"] = p.features.busy();
  r["features"] = p.features.found() != nullptr ? *p.features.found() : Report();
  r["taking_section"] = p.section.busy();
  r["section_mm"] = profiles ? Report(rounded(profiles->now.lengthMm())) : Report();
  r["section_before"] = profiles && profiles->before.size() > 0;
  const Report& figures = p.section.figures().report;
  r["section_dz_mm"] = figures.contains("cursors") ? figures["cursors"]["dz_mm"] : Report();
  r["section_figures"] = figures;
  r["sections"] = p.section.sections().size();
  r["section"] = p.section.chosen() ? Report(*p.section.chosen() + 1) : Report();
  r["applying"] = filters.applying();
  r["filters_applied"] = filters.applied();
}

Report triple(const glm::dvec3& v) {
  return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

// Of the page of the device.
Report deviceCheck(const Parts& p) {
  const DeviceCheck& check = p.device_check;
  const DeviceSetup& setup = p.document.client()->deviceSetup();
  Report r{{"running", check.running() != DeviceCheck::Running::kNothing},
           {"motion", setup.motion},
           {"clutch_buttons", setup.clutch_buttons},
           {"menu_buttons", setup.menu_buttons},
           {"reach_used", setup.reach.has_value()}};
  if (check.reach()) r["reach_mm"] = {triple(check.reach()->low_mm), triple(check.reach()->high_mm)};
  if (const auto& rest = check.rest())
    r["rest"] = {rest->force_n, rounded(rest->moved_mm), rest->device_faults};
  for (int i = 0; i < kPushedWays; ++i)
    if (const auto& came = check.direction(static_cast<PushedWay>(i)))
      r[name(static_cast<PushedWay>(i))] = axisText(*came);
  return r;
}

void addDevice(const Parts& p, Report& r) {
  LoopClient& client = *p.document.client();
  const haptic::LoopState now = client.state();
  const haptic::LoopState& drawn = p.stylus_overlay.state();
  const haptic::Scene& scene = client.scene();
  r["device"] = client.device().profile().name;
  r["connected"] = now.link == haptic::LinkState::kConnected;
  r["safety"] = std::string(haptic::name(now.safety));
  r["device_buttons"] = now.buttons;
  r["device_mm"] = triple(now.device_mm);
  if (now.stylus_axis) r["stylus_axis"] = triple(*now.stylus_axis);
  r["device_check"] = deviceCheck(p);
  Report effects = Report::array();
  for (const haptic::EffectKind effect : scene.effects)
    effects.push_back(std::string(haptic::effectName(effect)));
  r["effects"] = effects;
  Report numbers = Report::object();
  for (const haptic::SceneNumber& number : haptic::kSceneNumbers)
    numbers[std::string(number.table) + "." + std::string(number.key)] = rounded(number.of(scene));
  r["scene_numbers"] = numbers;
  r["scene"] = p.scene_files.title(client);
  const SoundPlayer* const sound = client.soundPlayer();
  r["sound"] = sound != nullptr ? sound->driver() : "";
  // Full seconds: what is heard is no state of its own.
  r["heard_s"] = sound != nullptr ? sound->counters().ticks / static_cast<std::uint64_t>(client.rate()) : 0;
  r["volume"] = rounded(static_cast<double>(p.settings.loudness.volume));
  r["muted"] = p.settings.loudness.muted;
  r["stiffness_n_per_mm"] = rounded(scene.stiffness_n_per_mm);
  r["rate_hz"] = client.rate();
  r["stroke"] = p.stylus.held() || p.marking.held();
  r["touching"] = drawn.contact;
  // The cells under the cursor and under the drawn stylus: equal when the stylus has followed.
  const engine::Grid& grid = client.field().grid();
  const auto cell = [&](double x_mm, double y_mm) {
    return Report{std::lround(std::floor(x_mm / grid.spacingXMm())),
                  std::lround(std::floor(y_mm / grid.spacingYMm()))};
  };
  const auto& under = p.stylus.underCursor();
  r["under_cursor"] = under ? cell(under->position_mm.x, under->position_mm.y) : Report();
  r["stylus_at"] = cell(drawn.endpoint_mm.x, drawn.endpoint_mm.y);
}

// What is still to come until all effects of the input are visible, by name; empty: nothing.
Report waitedFor(const Parts& p, const Input& input) {
  Report names = Report::array();
  const auto waits = [&](const char* name, bool is) {
    if (is) names.push_back(name);
  };
  waits("input", !input.empty() || input.acted());
  waits("the panels' keys", p.window.panelsAreBehind());
  waits("opening", p.opening.busy());
  waits("files", p.files.busy());
  waits("saving", p.saving.busy(p.document));
  waits("a file of what was measured", p.results.busy());
  if (const Questions& questions = p.feedback.questions; questions.pending()) {
    // A dialog needs some frames until it is in its final position.
    constexpr int kInPlace = 4;
    waits("a key held", p.held());
    waits("tiles", p.picture.figures().upload.pending_tiles > 0);
    waits("the dialog", questions.frames() < kInPlace);
    waits("the file that was chosen", questions.shown() != nullptr && questions.shown()->confirmed);
  } else {
    waits("a movement", isActive(p, input));
    waits("a finer picture", p.document.isOpen() && p.picture.refining());
    // A device that moves by itself comes to no rest.
    waits("the pen's shadow",
          p.document.isOpen() && p.document.client()->mouse() != nullptr && p.spared_shadow.pending());
    waits("the pen's trail",
          p.document.isOpen() && p.document.client()->mouse() != nullptr && p.stylus_overlay.fades());
  }
  if (!p.document.isOpen()) return names;
  const LoopClient& client = *p.document.client();
  const haptic::MouseStylus* const mouse = p.document.client()->mouse();
  waits("the mouse's stylus", mouse != nullptr && mouse->busy());
  waits("a filter", p.filters.computing() || p.filters.applying() || p.filters.awaitsRest());
  waits("the noise", p.filters.measuresNoise());
  waits("a suggestion", p.suggester.busy() || p.line_suggester.busy());
  waits("devices", p.devices.busy());
  waits("a form", p.form.busy());
  waits("heights", p.heights.busy() || p.heights.awaitsRest());
  waits("a count", p.removal.busy());
  waits("a comparison", p.compare.busy());
  waits("shapes", p.fit.busy());
  waits("features", p.features.busy());
  waits("a transform", p.transform.busy());
  waits("joined scans", p.join.busy());
  waits("figures", p.measure.busy());
  waits("a section", p.section.busy());
  waits("marks", p.marking.busy());
  waits("a histogram", p.colours.busy());
  waits("notices", p.notice_room.waits());
  if (p.picture.empty()) {
    waits("a picture", true);
    return names;
  }
  // The picture shows the field as requested by the scene.
  const render::Shown& shown = p.picture.shown();
  waits("the field in the picture",
        !p.shows_before && shown.accepted.value_or(shown.versions.front()) != client.field());
  waits("the loop's step", client.history().current() != client.upright());
  waits("inversion", (client.field().reader().sign() < 0.0F) != client.scene().invert);
  return names;
}

}  // namespace

bool actsNow(const Parts& parts, const Input& input) {
  return !input.empty() || input.acted() || parts.held() || parts.flight.active() ||
         parts.window.panelsAreBehind();
}

bool isActive(const Parts& parts, const Input& input) {
  return parts.picture.active() || actsNow(parts, input);
}

Report windowState(const Parts& parts, const Input& input, const RunFigures& run) {
  static constexpr const char* kLimits[] = {"none", "loading", "memory", "vertices"};
  Report r = firstState(parts, input, run);
  if (parts.document.isOpen()) {
    addDocument(parts, r);
    addBrushAndView(parts, r);
    addFilters(parts, r);
    addDevice(parts, r);
  }
  const Report waited = waitedFor(parts, input);
  const bool settled = waited.empty();
  // How close each panel is to the field, and what limits it: only of a picture at rest, since it differs
  // from frame to frame.
  Report bounds = Report::array(), limits = Report::array();
  for (const render::PanelDetail& panel : parts.picture.figures().panels) {
    if (!settled) break;
    bounds.push_back(rounded(panel.bound_px));
    limits.push_back(kLimits[static_cast<std::size_t>(panel.limit)]);
  }
  r["bounds_px"] = bounds;
  r["limits"] = limits;
  r["smooth"] = parts.picture.figures().rests;
  static constexpr const char* kSharpness[] = {"full", "half", "quarter", "fine", "full"};
  r["sharpness"] = kSharpness[static_cast<std::size_t>(parts.picture.drawnSharpness())];
  r["spares"] = parts.picture.spares();
  r["settled"] = settled;
  r["waits_for"] = waited;
  return r;
}

void logState(EventLog& log, const Parts& parts, const Input& input, const RunFigures& run) {
  if (!log.listens()) return;
  // The texts change, or move, without a change of the state: a menu opens, a header closes, a line above
  // grows. Figures change all the time.
  const std::vector<render::PanelText> written = parts.window.texts();
  std::size_t words = written.size();
  const auto mix = [&](std::size_t value) { words = 31 * words + value; };
  for (const render::PanelText& text : written) {
    for (const char c : text.text)
      if (c < '0' || c > '9') mix(static_cast<unsigned char>(c));
    mix(static_cast<std::size_t>(std::lround(text.x)));
    mix(static_cast<std::size_t>(std::lround(text.y)));
  }
  Report state = windowState(parts, input, run);
  state["words"] = words;
  log.write(std::move(state), [&] {
    Report texts = Report::array();
    for (const render::PanelText& text : written)
      texts.push_back(
          {{"text", text.text},
           {"at",
            {std::lround(text.x), std::lround(text.y), std::lround(text.width), std::lround(text.height)}},
           {"cut", text.cut}});
    return Report{{"frames", run.frames}, {"shown_ns", run.shown_ns}, {"texts", texts}};
  });
}

Report runReport(const Parts& parts, const RunFigures& run) {
  const DrawFigures& draw = parts.picture.drawFigures();
  const haptic::TimingFigures frame = draw.times.figures();
  Report r{{"device", parts.window.device()},
           {"shown_through", parts.window.shownThrough()},
           {"frames", run.frames}};
  r["frame_p50_ms"] = ms(frame.p50_ns);
  r["frame_p99_ms"] = ms(frame.p99_ns);
  r["tiles_uploaded"] = draw.tiles_uploaded;
  r["bytes_uploaded"] = draw.bytes_uploaded;
  if (parts.document.isOpen()) {
    LoopClient& client = *parts.document.client();
    const OpeningTimes& times = parts.opening.times();
    r["open_coarse_picture_ms"] = times.coarse_ms;
    r["open_read_ms"] = times.read_ms;
    r["open_touched_ms"] = times.touched_ms;
    r["open_first_picture_ms"] = times.seen_ms;
    r["open_whole_picture_ms"] = times.whole_ms;
    const haptic::TimingFigures late = client.timing().lateness.figures();
    const haptic::TimingFigures edit = client.latency().histogram().figures();
    r["ticks"] = late.count;
    r["rate_hz"] = client.measuredRate();
    r["lateness_p50_us"] = 1e3 * ms(late.p50_ns);
    r["lateness_p99_us"] = 1e3 * ms(late.p99_ns);
    r["lateness_worst_us"] = 1e3 * ms(late.worst_ns);
    r["edits_shown"] = edit.count;
    r["edit_to_pixel_p50_ms"] = ms(edit.p50_ns);
    r["edit_to_pixel_p99_ms"] = ms(edit.p99_ns);
    r["steps"] = client.history().number();
    r["filters_applied"] = parts.filters.applied();
    r["saved"] = parts.saving.path();
    r["session"] = parts.document.keeper()->path();
    r["session_named"] = parts.document.keeper()->named();
    r["unsaved_changes"] = parts.document.unsaved();
  }
  r["validation_messages"] = parts.window.validationMessages();
  return r;
}

void noteHeadset(const HeadsetFigures& headset, Report& report) {
  if (headset.name.empty()) return;
  report["headset"] = headset.name;
  report["headset_frames"] = headset.frames;
  for (const std::string& message : headset.validation) report["validation_messages"].push_back(message);
}

}  // namespace fettle::app

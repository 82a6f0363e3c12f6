// What `fettle view --events` tells: the state of the window as a person sees it, for scripts and tests that
// drive it by keys and mouse and have to know when what they did is on the screen.
#include <cmath>

#include <imgui.h>

#include "app/window/workstation.h"
#include "haptic/safety/safety.h"

namespace fettle::app {
namespace {

// Enough digits to tell two states apart, few enough that rounding does not make two of one.
double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

}  // namespace

// Keys are stable. Lengths are pixels of the frame, "cursor" and "picture" from its upper left corner.
Report Workstation::told() const {
  const Question* const dialog = questions_.shown();
  static constexpr const char* kLimits[] = {"none", "under way", "memory", "vertices"};
  static constexpr const char* kTools[] = {"feel", "smooth", "mark", "unmark"};
  const render::Rectangle& area = window_->pictureArea();
  Report r{{"keys", hands_.keys},
           {"buttons", hands_.buttons},
           {"wheels", hands_.wheels},
           {"drops", hands_.drops},
           {"cursor", {std::lround(last_x_), std::lround(last_y_)}},
           {"frame", {window_->width(), window_->height()}},
           {"picture", {area.x, area.y, area.width, area.height}},
           {"minimised", window_->minimised()},
           {"scale", rounded(window_->scale())},
           {"dialog", dialog != nullptr ? name(dialog->kind) : "none"},
           {"dialog_path", dialog != nullptr ? dialog->path : ""},
           {"text_field", ImGui::GetIO().WantTextInput},
           {"message", dialog != nullptr ? dialog->said.what : ""},
           {"status", status_text_},
           {"asks_before_quitting", settings_.ask_before_quitting},
           {"device_losses", device_losses_},
           {"loading", loading_.busy()},
           {"coarse", coarseIsShown()},
           {"saving", saving_.busy() || write_after_scan_ || (keeper_ && keeper_->saving())},
           {"path", path_},
           {"save_path", keeper_ && keeper_->named() ? keeper_->path() : save_path_}};
  Report notices = Report::array();
  for (const Notice& notice : notices_) notices.push_back(notice.what);
  r["notices"] = notices;
  // A dialog has a frame drawn each time round, and is in its place after some of them.
  constexpr int kInPlace = 4;
  const bool moves = !questions_.pending()
                         ? active() || (touch_ && refinement_.owed())
                         : stylus_held_ || drag_ != Drag::kNone || figures_.upload.pending_tiles > 0 ||
                               questions_.frames() < kInPlace;
  bool settled = !moves && input_.empty() && !loading_.busy() && r["saving"] == false;
  if (seenGrid() != nullptr)
    r["view"] = {rounded(view_.azimuth_deg), rounded(view_.elevation_deg), rounded(view_.zoom),
                 rounded(view_.centre_x), rounded(view_.centre_y)};
  if (touch_) {
    const haptic::LoopState& drawn = drawn_state_;
    const haptic::LoopState now = touch_->state();
    const haptic::Scene& scene = touch_->scene();
    r["tool"] = tool_on_ ? kTools[static_cast<std::size_t>(touch_->tool())] : "view";
    r["lasso"] = !lasso_.active() ? "" : lasso_.shape() == Lasso::Shape::kBox ? "box" : "free";
    Report open_panels = Report::array();
    for (const auto& [panel, open] : settings_.panels)
      if (side_panel_ && open) open_panels.push_back(panel);
    r["panels"] = open_panels;
    r["steps"] = touch_->history().number();
    r["last_step"] = touch_->history().last();
    r["unsaved"] = unsaved();
    r["session"] = keeper_->path();
    r["session_named"] = keeper_->named();
    r["session_waiting"] = keeper_->waiting();
    r["kept"] = keeper_->waiting() == 0 && !keeper_->error();
    r["inverted"] = scene.invert;
    r["brush"] = rounded(scene.brush_radius_samples);
    r["mark_brush"] = rounded(scene.mark_radius_samples);
    r["press_mm"] = touch_->mouse() != nullptr ? rounded(touch_->mouse()->pressMm()) : 0.0;
    r["adjusting"] = adjusting_ == Adjusting::kRadius  ? "radius"
                     : adjusting_ == Adjusting::kDepth ? "depth"
                                                       : "";
    r["typed"] = typed_;
    r["perspective"] = view_.projection == render::Projection::kPerspective;
    r["marks"] = display_.marks;
    r["deviation"] = display_.deviation;
    r["contours"] = display_.contours;
    r["vertices"] = display_.vertices;
    r["colours"] = {rounded(figures_.range.low), rounded(figures_.range.high)};
    r["contact_level"] =
        scene.tip == haptic::TipShape::kSphere ? "ball" : std::string(haptic::levelName(scene.level));
    r["measured"] = {!costs_.contact().empty(), !costs_.detail().empty()};
    r["map"] = static_cast<int>(display_.map);
    r["light"] = {std::lround(display_.light_azimuth_deg), std::lround(display_.light_elevation_deg)};
    Report variants = Report::array();
    for (const FilterPreview::Variant& v : filters_.variants()) variants.push_back(filterName(v.spec));
    r["filter"] = filterName(filters_.spec);
    r["max_change"] = filters_.spec.max_change ? Report(*filters_.spec.max_change) : Report();
    r["variants"] = variants;
    r["filtering"] = filters_.computing();
    r["suggested"] = edges_.suggestion() != nullptr ? edges_.suggestion()->samples : 0;
    r["looking_for_edges"] = edges_.busy();
    r["applying"] = filters_.applying();
    r["filters_applied"] = filters_.applied();
    r["device"] = touch_->device().profile().name;
    r["connected"] = now.link == haptic::LinkState::kConnected;
    r["safety"] = std::string(haptic::name(now.safety));
    Report effects = Report::array();
    for (const haptic::EffectKind effect : scene.effects)
      effects.push_back(std::string(haptic::effectName(effect)));
    r["effects"] = effects;
    r["stiffness_n_per_mm"] = rounded(scene.stiffness_n_per_mm);
    r["rate_hz"] = touch_->rate();
    r["stroke"] = stylus_held_;
    r["touching"] = drawn.contact;
    // The cells that the cursor points at and that the stylus was drawn over: the same when it has followed.
    const engine::Grid& grid = touch_->field().grid();
    const auto cell = [&](double x_mm, double y_mm) {
      return Report{std::lround(std::floor(x_mm / grid.spacingXMm())),
                    std::lround(std::floor(y_mm / grid.spacingYMm()))};
    };
    r["under_cursor"] =
        under_cursor_ ? cell(under_cursor_->position_mm.x, under_cursor_->position_mm.y) : Report();
    r["stylus_at"] = cell(drawn.endpoint_mm.x, drawn.endpoint_mm.y);
    settled = settled && (touch_->mouse() == nullptr || !touch_->mouse()->busy()) && !filters_.computing() &&
              !mark_edit_.busy() && !edges_.busy() && !shown_.versions.empty() && !filters_.applying() &&
              shown_.accepted.value_or(shown_.versions.front()) == touch_->field() &&
              touch_->history().current() == touch_->upright() &&
              (touch_->field().reader().sign() < 0.0F) == scene.invert;
  }
  // How near each panel comes to the field, and what keeps it from coming nearer: of a picture at rest alone,
  // since it differs from frame to frame.
  Report bounds = Report::array(), limits = Report::array();
  for (const render::PanelDetail& panel : figures_.panels) {
    if (!settled) break;
    bounds.push_back(rounded(panel.bound_px));
    limits.push_back(kLimits[static_cast<std::size_t>(panel.limit)]);
  }
  r["bounds_px"] = bounds;
  r["limits"] = limits;
  r["settled"] = settled;
  return r;
}

void Workstation::countHand(const render::InputEvent& event) {
  const render::InputKind kind = event.kind;
  hands_.keys += kind == render::InputKind::kKeyDown;
  hands_.buttons += kind == render::InputKind::kButtonDown || kind == render::InputKind::kButtonUp;
  hands_.wheels += kind == render::InputKind::kWheel;
}

void Workstation::tell() {
  if (!events_.listens()) return;
  // What is written changes, or moves, without any of the above: a menu opens, a header closes, a line above
  // grows. Figures change all the time.
  const std::vector<render::PanelText> written = window_->texts();
  std::size_t words = written.size();
  const auto mix = [&](std::size_t value) { words = 31 * words + value; };
  for (const render::PanelText& text : written) {
    for (const char c : text.text)
      if (c < '0' || c > '9') mix(static_cast<unsigned char>(c));
    mix(static_cast<std::size_t>(std::lround(text.x)));
    mix(static_cast<std::size_t>(std::lround(text.y)));
  }
  Report state = told();
  state["words"] = words;
  events_.tell(std::move(state), [&] {
    Report texts = Report::array();
    for (const render::PanelText& text : written)
      texts.push_back(
          {{"text", text.text},
           {"at",
            {std::lround(text.x), std::lround(text.y), std::lround(text.width), std::lround(text.height)}},
           {"cut", text.cut}});
    return Report{{"frames", frames_}, {"texts", texts}};
  });
}

}  // namespace fettle::app

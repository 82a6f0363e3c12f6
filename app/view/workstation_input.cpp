#include <algorithm>
#include <cmath>

#include <imgui.h>

#include "app/view/workstation.h"

namespace fettle::app {
namespace {

using haptic::Tool;
using render::InputEvent;
using render::InputKind;
using render::Key;
using render::MouseButton;

constexpr double kKey_px = 40.0;        // what an arrow key moves the view by
constexpr double kRadius_px = 8.0;      // of the cursor's way for one sample of radius
constexpr double kDepth_px = 20.0;      // ... for a tenth of the deepest press
constexpr double kBrushStep = 1.0;      // [ and ]
constexpr double kLargestBrush = 64.0;  // [samples], see Scene
constexpr double kSplitGrip_px = 8.0;

}  // namespace

bool Workstation::inPicture(double x, double y) const {
  const render::Rectangle& area = window_->pictureArea();
  return x >= area.x && y >= area.y && x < area.x + area.width && y < area.y + area.height;
}

std::optional<render::Picked> Workstation::pick(double x, double y) const {
  const render::Rectangle& area = window_->pictureArea();
  return picture_->pick(x - area.x, y - area.y);
}

// What cannot wait for the next frame: the mouse as stylus.
void Workstation::toStylus(const InputEvent& event) {
  if (!touch_ || touch_->mouse() == nullptr) return;
  haptic::MouseStylus& mouse = *touch_->mouse();
  using Button = haptic::MouseStylus::Button;
  if (!tool_on_ || dialog_ != Dialog::kNone) {
    mouse.setButton(Button::kReleased);
    mouse.leave();
    stylus_held_ = false;
    return;
  }
  if (event.kind == InputKind::kButtonUp && event.button == MouseButton::kLeft) {
    mouse.setButton(Button::kReleased);
    stylus_held_ = false;
    return;
  }
  if (event.kind == InputKind::kLeave) {
    if (!stylus_held_) mouse.leave();
    return;
  }
  if (event.kind != InputKind::kMove && event.kind != InputKind::kButtonDown) return;
  if (drag_ != Drag::kNone || adjusting_ != Adjusting::kNothing) return;
  if (!inPicture(event.x, event.y) || (event.panels_mouse && !stylus_held_)) {
    mouse.leave();
    return;
  }
  under_cursor_ = pick(event.x, event.y);
  if (under_cursor_)
    mouse.setCursor(under_cursor_->position_mm);
  else
    mouse.leave();
  if (event.kind == InputKind::kButtonDown && event.button == MouseButton::kLeft && !event.modifiers.alt &&
      under_cursor_) {
    stylus_held_ = true;
    mouse.setButton(Button::kHeld);
  }
}

void Workstation::handleInput() {
  for (const auto& [event, stylus_has_it] : std::exchange(input_, {})) {
    if (!stylus_has_it) toStylus(event);
    if (event.kind != InputKind::kMove || !event.panels_mouse || ImGui::IsAnyMouseDown()) stale_ = true;
    handle(event);
    last_x_ = event.x;
    last_y_ = event.y;
  }
}

Drag Workstation::dragOf(const InputEvent& event) const {
  const render::Modifiers& m = event.modifiers;
  switch (event.button) {
    case MouseButton::kLeft:
      if (m.alt) return Drag::kTurn;
      if (tool_on_) return Drag::kNone;
      return m.shift ? Drag::kPan : Drag::kTurn;
    case MouseButton::kMiddle:
      if (habits_ == Habits::kBlender && m.shift) return Drag::kPan;
      if (habits_ == Habits::kBlender && m.control) return Drag::kZoom;
      return Drag::kTurn;
    case MouseButton::kRight:
      return Drag::kPan;
    case MouseButton::kOther:
      break;
  }
  return Drag::kNone;
}

void Workstation::handle(const InputEvent& event) {
  if (adjusting_ != Adjusting::kNothing && handleAdjusting(event)) return;
  if (event.kind == InputKind::kKeyDown) {
    handleKey(event);
    return;
  }
  if (!touch_ || dialog_ != Dialog::kNone) return;
  const engine::Grid& grid = touch_->field().grid();
  const render::Rectangle& area = window_->pictureArea();
  const double dx = event.x - last_x_, dy = event.y - last_y_;
  const double split_px = plot().x + display_.split_at * plot().width;
  switch (event.kind) {
    case InputKind::kButtonDown:
      if (event.panels_mouse || !inPicture(event.x, event.y)) return;
      if (display_.split && shown_.versions.size() == 2 && event.button == MouseButton::kLeft &&
          std::abs(event.x - split_px) <= kSplitGrip_px) {
        dragging_split_ = true;
        return;
      }
      drag_ = dragOf(event);
      break;
    case InputKind::kButtonUp:
      drag_ = Drag::kNone;
      dragging_split_ = false;
      break;
    case InputKind::kMove:
      if (dragging_split_)
        display_.split_at = std::clamp((event.x - plot().x) / std::max(plot().width, 1), 0.02, 0.98);
      else if (drag_ == Drag::kTurn)
        Navigation::turn(view_, dx, dy, area.width);
      else if (drag_ == Drag::kPan)
        Navigation::pan(view_, grid, dx, dy, figures_.pixels_per_mm);
      else if (drag_ == Drag::kZoom)
        Navigation::zoom(view_, grid, -0.05 * dy, 0.0, 0.0, figures_.pixels_per_mm);
      break;
    case InputKind::kWheel:
      if (event.panels_mouse || !inPicture(event.x, event.y)) return;
      if (touch_->mouse() != nullptr && tool_on_ && (stylus_held_ || event.modifiers.control)) {
        touch_->mouse()->wheel(event.wheel);
      } else {
        Navigation::zoom(view_, grid, event.wheel, event.x - (area.x + 0.5 * area.width),
                         event.y - (area.y + 0.5 * area.height), figures_.pixels_per_mm);
        // Several steps between two frames each start from what the one before made.
        figures_.pixels_per_mm *= std::pow(1.15, event.wheel);
      }
      break;
    default:
      break;
  }
}

void Workstation::handleKey(const InputEvent& event) {
  if (dialog_ != Dialog::kNone) {
    // A short press falls between two frames, and ImGui would not see it.
    dialog_key_ = event.key;
    return;
  }
  // A text field has it; for two frames ImGui still says so of the field of a dialog that was closed.
  if (event.panels_key && frames_ > dialog_frame_ + 3) return;
  const auto action = actionOf(event.key, event.modifiers);
  if (event.modifiers == render::Modifiers{true, false, false} && event.key >= render::letter('1') &&
      event.key <= render::letter('9')) {
    const auto n = static_cast<std::size_t>(static_cast<int>(event.key) - '1');
    if (n < recent_.paths().size()) askToOpen(recent_.paths()[n]);
    return;
  }
  if (action) act(*action);
}

// F and Shift+F: move or type, confirm with the left button or Enter, leave with the right one or Esc.
bool Workstation::handleAdjusting(const InputEvent& event) {
  const bool radius = adjusting_ == Adjusting::kRadius;
  const auto set = [&](double value) { radius ? setBrushRadius(value) : setPressDepth(value); };
  const auto end = [&] {
    adjusting_ = Adjusting::kNothing;
    typed_.clear();
  };
  switch (event.kind) {
    case InputKind::kMove: {
      if (!typed_.empty()) return true;
      const double way = event.x - adjust_x_;
      set(adjust_from_ + (radius ? std::round(way / kRadius_px) : way / kDepth_px * 0.1 * press_mm_));
      return true;
    }
    case InputKind::kButtonDown:
      if (event.button == MouseButton::kRight) set(adjust_from_);
      end();
      return true;
    case InputKind::kKeyDown: {
      const int code = static_cast<int>(event.key);
      const int keypad0 = static_cast<int>(Key::kKeypad0);
      if (code >= '0' && code <= '9') {
        typed_ += static_cast<char>(code);
      } else if (code >= keypad0 && code <= keypad0 + 9) {
        typed_ += static_cast<char>('0' + code - keypad0);
      } else if (event.key == Key::kPeriod || event.key == Key::kKeypadPeriod) {
        typed_ += '.';
      } else if (event.key == Key::kBackspace && !typed_.empty()) {
        typed_.pop_back();
      } else if (event.key == Key::kEnter || event.key == Key::kKeypadEnter) {
        end();
        return true;
      } else {
        set(adjust_from_);
        end();
        return event.key == Key::kEscape;
      }
      if (!typed_.empty()) set(std::strtod(typed_.c_str(), nullptr));
      return true;
    }
    default:
      return event.kind != InputKind::kWheel;
  }
}

bool Workstation::takeDialogKey(Key key) {
  if (dialog_key_ != key) return false;
  dialog_key_ = Key::kNone;
  return true;
}

void Workstation::chooseTool(std::optional<Tool> tool) {
  tool_on_ = tool.has_value();
  if (!touch_) return;
  touch_->setTool(tool.value_or(Tool::kFeel));
  if (touch_->mouse() == nullptr) return;
  if (!tool_on_) {
    touch_->mouse()->setButton(haptic::MouseStylus::Button::kReleased);
    touch_->mouse()->leave();
    stylus_held_ = false;
    return;
  }
  // The tool is there at once, where the cursor is.
  if (inPicture(last_x_, last_y_)) {
    under_cursor_ = pick(last_x_, last_y_);
    if (under_cursor_) touch_->mouse()->setCursor(under_cursor_->position_mm);
  }
}

void Workstation::setBrushRadius(double samples) {
  if (!touch_ || !std::isfinite(samples)) return;
  haptic::Scene scene = touch_->scene();
  const double radius = std::clamp(samples, 0.0, kLargestBrush);
  const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
  double& wanted = marking ? scene.mark_radius_samples : scene.brush_radius_samples;
  if (wanted == radius) return;
  wanted = radius;
  touch_->setScene(scene);
}

void Workstation::setPressDepth(double depth_mm) {
  if (!touch_ || touch_->mouse() == nullptr || !std::isfinite(depth_mm)) return;
  haptic::MouseStylus& mouse = *touch_->mouse();
  const engine::Grid& grid = touch_->field().grid();
  const double step = 0.1 * std::max(grid.spacingXMm(), grid.spacingYMm());  // of Touch's mouse
  mouse.wheel((mouse.pressMm() - depth_mm) / step);
}

void Workstation::clearMarks() {
  const engine::Version before = touch_->upright();
  engine::LiveField field(before, engine::Growth::kAllowed);
  const engine::FieldReader reader = before.reader();
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      const engine::Tile& old = reader.tile(tc, tr);
      if (old.marked_samples == 0) continue;
      for (int r = 0; r < engine::kTileSide; ++r)
        for (int c = 0; c < engine::kTileSide; ++c)
          if (old.marked(c, r) &&
              !field.setMark(tc * engine::kTileSide + c, tr * engine::kTileSide + r, false)) {
            message("memory ran out", "close other programs");
            return;
          }
    }
  if (!(field.snapshot() == before))
    touch_->replace(field.snapshot(), "Clear marks", engine::StepKind::kMark);
}

void Workstation::act(Action action) {
  stale_ = true;
  // What needs no field.
  switch (action) {
    case Action::kOpen:
      dialog_ = Dialog::kOpen;
      dialog_fresh_ = true;
      dialog_path_ = path_;
      return;
    case Action::kQuit:
      askToQuit();
      return;
    case Action::kShortcuts:
      dialog_ = Dialog::kShortcuts;
      dialog_fresh_ = true;
      return;
    case Action::kSidePanel:
      side_panel_ = !side_panel_;
      return;
    default:
      break;
  }
  if (!touch_) return;
  const engine::Grid& grid = touch_->field().grid();
  const double wide = window_->pictureArea().width;
  const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
  const double radius = marking ? touch_->scene().mark_radius_samples : touch_->scene().brush_radius_samples;
  const auto look = [&](double azimuth, double elevation) {
    view_.azimuth_deg = azimuth;
    view_.elevation_deg = elevation;
  };
  switch (action) {
    case Action::kSave:
      save();
      break;
    case Action::kSaveAs:
    case Action::kExport:
      dialog_ = action == Action::kSaveAs ? Dialog::kSaveAs : Dialog::kExport;
      dialog_fresh_ = true;
      dialog_path_ = suggestedPath();
      break;
    case Action::kUndo:
      touch_->undo();
      break;
    case Action::kRedo:
      touch_->redo();
      break;
    case Action::kNavigate:
      if (!filters_.variants().empty() || filters_.computing() || filters_.applying())
        filters_.cancel(*touch_);
      else
        chooseTool(std::nullopt);
      break;
    case Action::kFeel:
      chooseTool(Tool::kFeel);
      break;
    case Action::kSmooth:
      chooseTool(Tool::kSmooth);
      break;
    case Action::kMark:
      chooseTool(Tool::kMark);
      break;
    case Action::kUnmark:
      chooseTool(Tool::kUnmark);
      break;
    case Action::kBrushRadius:
    case Action::kBrushStrength:
      if (action == Action::kBrushStrength && touch_->mouse() == nullptr) break;
      adjusting_ = action == Action::kBrushRadius ? Adjusting::kRadius : Adjusting::kDepth;
      press_mm_ = touch_->mouse() != nullptr ? touch_->mouse()->pressMm() : 0.0;
      adjust_from_ = action == Action::kBrushRadius ? radius : press_mm_;
      adjust_x_ = last_x_;
      typed_.clear();
      break;
    case Action::kBrushSmaller:
      setBrushRadius(radius - kBrushStep);
      break;
    case Action::kBrushLarger:
      setBrushRadius(radius + kBrushStep);
      break;
    case Action::kInvert: {
      haptic::Scene scene = touch_->scene();
      scene.invert = !scene.invert;
      filters_.cancel(*touch_);
      touch_->setScene(scene);
      break;
    }
    case Action::kShowMarks:
      display_.marks = !display_.marks;
      break;
    case Action::kClearMarks:
      clearMarks();
      break;
    case Action::kFilterNext:
      filters_.spec.kind = filters_.spec.kind == engine::FilterKind::kBox ? engine::FilterKind::kGaussian
                           : filters_.spec.kind == engine::FilterKind::kGaussian ? engine::FilterKind::kMedian
                                                                                 : engine::FilterKind::kBox;
      break;
    case Action::kFilterPreview:
      filters_.compute(*touch_, FilterPreview::Keep::kReplace);
      break;
    case Action::kFilterApply:
      if (!filters_.variants().empty()) filters_.apply(*touch_);
      break;
    case Action::kSplitPreview:
      display_.split = !display_.split;
      break;
    case Action::kDeviation:
      display_.deviation = !display_.deviation;
      picture_->refreshRanges();
      break;
    case Action::kContours:
      display_.contours = !display_.contours;
      break;
    case Action::kNextMap:
      display_.map = static_cast<render::ColourMap>((static_cast<int>(display_.map) + 1) % 5);
      break;
    case Action::kViewAll:
      Navigation::showAll(view_);
      break;
    case Action::kViewLastStroke: {
      const engine::FieldRect rect = touch_->lastRect();
      if (rect.empty()) break;
      Navigation::centreOn(view_, grid, (rect.column + 0.5 * rect.columns) * grid.spacingXMm(),
                           (rect.row + 0.5 * rect.rows) * grid.spacingYMm());
      break;
    }
    case Action::kViewFront:
      look(0.0, 25.0);
      break;
    case Action::kViewBack:
      look(180.0, 25.0);
      break;
    case Action::kViewRight:
      look(90.0, 25.0);
      break;
    case Action::kViewLeft:
      look(270.0, 25.0);
      break;
    case Action::kViewTop:
      look(0.0, 90.0);
      break;
    case Action::kProjection:
      view_.projection = view_.projection == render::Projection::kOrthographic
                             ? render::Projection::kPerspective
                             : render::Projection::kOrthographic;
      break;
    case Action::kTurnLeft:
      Navigation::turn(view_, -kKey_px, 0.0, wide);
      break;
    case Action::kTurnRight:
      Navigation::turn(view_, kKey_px, 0.0, wide);
      break;
    case Action::kTiltUp:
      Navigation::turn(view_, 0.0, kKey_px, wide);
      break;
    case Action::kTiltDown:
      Navigation::turn(view_, 0.0, -kKey_px, wide);
      break;
    case Action::kPanLeft:
      Navigation::pan(view_, grid, kKey_px, 0.0, figures_.pixels_per_mm);
      break;
    case Action::kPanRight:
      Navigation::pan(view_, grid, -kKey_px, 0.0, figures_.pixels_per_mm);
      break;
    case Action::kPanUp:
      Navigation::pan(view_, grid, 0.0, kKey_px, figures_.pixels_per_mm);
      break;
    case Action::kPanDown:
      Navigation::pan(view_, grid, 0.0, -kKey_px, figures_.pixels_per_mm);
      break;
    case Action::kZoomIn:
    case Action::kZoomOut:
      Navigation::zoom(view_, grid, action == Action::kZoomIn ? 2.0 : -2.0, 0.0, 0.0, figures_.pixels_per_mm);
      break;
    case Action::kArm:
      touch_->arm();
      break;
    case Action::kDisarm:
      touch_->disarm();
      break;
    case Action::kCalibrate:
      touch_->calibrate();
      break;
    default:
      break;
  }
}

}  // namespace fettle::app

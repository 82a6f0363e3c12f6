#include "app/view/workstation.h"

#include <algorithm>
#include <cmath>

namespace fettle::app {
namespace {

using haptic::Tool;

constexpr double kKey_px = 40.0;        // what an arrow key moves the view by
constexpr double kBrushStep = 1.0;      // [ and ]
constexpr double kLargestBrush = 64.0;  // [samples], see Scene

}  // namespace

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
  if (!(field.snapshot() == before)) touch_->replaceMarks(before, field.snapshot(), "Clear marks");
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
      dialog_path_ = suggestedPath(action == Action::kSaveAs ? ".fettle" : "_fettled.tif");
      break;
    case Action::kUndo:
      undo();
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
      if (picture_) picture_->refreshRanges();
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

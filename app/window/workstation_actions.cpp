#include "app/window/workstation.h"

#include <algorithm>
#include <cmath>

#include "app/live/placement.h"

namespace fettle::app {
namespace {

using haptic::Tool;

constexpr double kKey_px = 40.0;    // what an arrow key moves the view by
constexpr double kBrushStep = 1.0;  // [ and ]

}  // namespace

// Ctrl turns a tool into its opposite for one stroke.
Tool Workstation::toolFor(const render::Modifiers& modifiers) const {
  const Tool tool = turned_tool_.value_or(touch_->tool());
  if (!modifiers.control) return tool;
  switch (tool) {
    case Tool::kFeel:
      return Tool::kSmooth;
    case Tool::kSmooth:
      return Tool::kFeel;
    case Tool::kMark:
      return Tool::kUnmark;
    case Tool::kUnmark:
      break;
  }
  return Tool::kMark;
}

void Workstation::chooseTool(std::optional<Tool> tool) {
  tool_on_ = tool.has_value();
  turned_tool_.reset();
  lasso_.leave();
  if (!touch_) return;
  touch_->setTool(tool.value_or(Tool::kFeel));
  if (touch_->mouse() == nullptr) return;
  if (!tool_on_) {
    touch_->mouse()->release();
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

void Workstation::takeScene(const haptic::Scene& scene) {
  const engine::Status taken = touch_->setScene(scene);
  if (!taken) notices_.push_back({taken.error().what, taken.error().remedy});
}

void Workstation::noteWithoutForce(const haptic::Scene& scene) {
  if (touch_->device().profile().gives_force) return;
  if (const auto problem = problemOnEveryDevice(scene, touch_->field().grid(), touch_->rate()))
    notices_.push_back({withoutForceText(*problem), ""});
}

void Workstation::setBrushRadius(double samples) {
  if (!touch_ || !std::isfinite(samples)) return;
  haptic::Scene scene = touch_->scene();
  const double radius = std::clamp(samples, 0.0, haptic::kMaxBrushRadius);
  const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
  double& wanted = marking ? scene.mark_radius_samples : scene.brush_radius_samples;
  if (wanted == radius) return;
  wanted = radius;
  takeScene(scene);
}

void Workstation::setPressDepth(double depth_mm) {
  if (!touch_ || touch_->mouse() == nullptr || !std::isfinite(depth_mm)) return;
  haptic::MouseStylus& mouse = *touch_->mouse();
  const engine::Grid& grid = touch_->field().grid();
  const double step = 0.1 * std::max(grid.spacingXMm(), grid.spacingYMm());  // of LoopClient's mouse
  mouse.wheel((mouse.pressMm() - depth_mm) / step);
}

void Workstation::setRate(double hz) {
  if (!touch_) return;
  // What was computed belongs to the loop that ends (LoopClient::setRate).
  filters_.cancel(*touch_);
  stylus_held_ = false;
  const engine::Status set = touch_->setRate(hz);
  options_.touch.rate_hz = touch_->rate();
  // Without a loop there is nothing to work with; what was done is kept as at every end.
  if (touch_->finished())
    end_ = set;
  else if (!set)
    message(set.error().line(), "the loop runs on as before");
  stale_ = true;
}

// Whether the action was one of the camera's.
bool Workstation::moveCamera(Action action, const engine::Grid& grid) {
  const double wide = window_->pictureArea().width;
  const auto look = [&](double azimuth, double elevation) {
    view_.azimuth_deg = azimuth;
    view_.elevation_deg = elevation;
  };
  switch (action) {
    case Action::kViewAll:
      Navigation::showAll(view_);
      break;
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
    default:
      return false;
  }
  return true;
}

void Workstation::act(Action action) {
  stale_ = true;
  // What needs no field.
  switch (action) {
    case Action::kOpen:
      ask({.kind = Question::Kind::kOpen, .path = path_});
      return;
    case Action::kQuit:
      // Without the question nothing is lost either: it is there when the scan is opened again.
      if (settings_.ask_before_quitting || !unsaved())
        askToQuit();
      else
        quit_unasked_ = true;
      return;
    case Action::kMouseHabits:
      habits_ = static_cast<Habits>((static_cast<int>(habits_) + 1) % 3);
      return;
    case Action::kTheme:
      display_.theme = display_.theme == render::Theme::kDark ? render::Theme::kLight : render::Theme::kDark;
      return;
    case Action::kFurniture:
      display_.furniture = !display_.furniture;
      return;
    case Action::kEnterPanels:
      side_panel_ = true;
      enter_panels_ = true;
      window_->enterPanels();
      return;
    case Action::kShortcuts:
      ask({.kind = Question::Kind::kShortcuts});
      return;
    case Action::kSidePanel:
      side_panel_ = !side_panel_;
      return;
    default:
      break;
  }
  const engine::Grid* const seen = seenGrid();
  if (seen == nullptr || moveCamera(action, *seen) || !touch_) return;
  const engine::Grid& grid = *seen;
  const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
  const double radius = marking ? touch_->scene().mark_radius_samples : touch_->scene().brush_radius_samples;
  switch (action) {
    case Action::kSave:
      save({});
      break;
    case Action::kSaveAs:
      ask({.kind = Question::Kind::kSaveAs, .path = suggestedPath(".fettle")});
      break;
    case Action::kExport:
      ask({.kind = Question::Kind::kExport, .path = suggestedPath("_fettled.tif")});
      break;
    case Action::kUndo:
      undo();
      break;
    case Action::kRedo:
      touch_->redo();
      break;
    case Action::kNavigate:
      if (mark_edit_.busy())
        mark_edit_.cancel();
      else if (edges_.on())
        edges_.drop();
      else if (!filters_.variants().empty() || filters_.computing() || filters_.applying())
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
    case Action::kUnmark:
      // To paint over a suggestion is to take it first.
      (void)edges_.accept(*touch_);
      chooseTool(action == Action::kMark ? Tool::kMark : Tool::kUnmark);
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
      takeScene(scene);
      break;
    }
    case Action::kShowMarks:
      display_.marks = !display_.marks;
      break;
    case Action::kClearMarks:
      mark_edit_.ask("Clear marks", engine::clearMarks);
      break;
    case Action::kInvertMarks:
      mark_edit_.ask("Invert marks", engine::invertMarks);
      break;
    case Action::kLasso:
    case Action::kBox:
      beginLasso(action == Action::kLasso ? Lasso::Shape::kFree : Lasso::Shape::kBox);
      break;
    case Action::kEdges:
    case Action::kEdgesMore:
    case Action::kEdgesFewer:
    case Action::kEdgesThicker:
    case Action::kEdgesThinner:
    case Action::kEdgesCoarser:
    case Action::kEdgesFiner:
      actOnEdges(action);
      break;
    case Action::kKeepWithin: {
      haptic::Scene scene = touch_->scene();
      if (scene.max_change) most_change_ = *scene.max_change;
      scene.max_change = scene.max_change ? std::nullopt : std::optional(most_change_);
      takeScene(scene);
      break;
    }
    case Action::kFilterNext:
      filters_.spec.kind =
          engine::filters()[(static_cast<std::size_t>(filters_.spec.kind) + 1) % engine::filters().size()]
              .kind;
      filters_.spec.sigma = filters_.spec.range_sigma = 0.0;  // in other units for another kind
      break;
    case Action::kFilterPreview:
      filters_.compute(*touch_, FilterPreview::Keep::kReplace, seenPart());
      break;
    case Action::kFilterBeside:
      filters_.compute(*touch_, FilterPreview::Keep::kAdd, seenPart());
      break;
    case Action::kFilterDrop:
      if (!filters_.variants().empty()) filters_.drop(filters_.variants().size() - 1);
      break;
    case Action::kFilterApply:
      if (edges_.accept(*touch_)) break;
      if (!filters_.variants().empty()) filters_.apply(*touch_);
      break;
    case Action::kWindowLarger:
    case Action::kWindowSmaller:
      filters_.spec.window = std::clamp(filters_.spec.window + (action == Action::kWindowLarger ? 2 : -2), 1,
                                        engine::FilterSpec::kMaxWindow);
      break;
    case Action::kMorePasses:
    case Action::kFewerPasses:
      filters_.spec.passes = std::clamp(filters_.spec.passes + (action == Action::kMorePasses ? 1 : -1), 1,
                                        engine::FilterSpec::kMaxPasses);
      break;
    case Action::kFilterScope:
      filters_.spec.scope = filters_.spec.scope == engine::FilterScope::kKeepMarks
                                ? engine::FilterScope::kOnlyMarks
                                : engine::FilterScope::kKeepMarks;
      break;
    case Action::kFilterMaxChange: {
      std::optional<double>& most = filters_.spec.max_change;
      if (most) most_change_ = *most;
      most = most ? std::nullopt : std::optional(most_change_);
      break;
    }
    case Action::kSplitLeft:
    case Action::kSplitRight:
      display_.split_at =
          std::clamp(display_.split_at + (action == Action::kSplitLeft ? -0.02 : 0.02), 0.02, 0.98);
      break;
    case Action::kLightLeft:
    case Action::kLightRight:
      display_.light_azimuth_deg =
          std::fmod(display_.light_azimuth_deg + (action == Action::kLightLeft ? 10.0F : 350.0F), 360.0F);
      break;
    case Action::kLightHigher:
    case Action::kLightLower:
      display_.light_elevation_deg = std::clamp(
          display_.light_elevation_deg + (action == Action::kLightHigher ? 5.0F : -5.0F), 5.0F, 90.0F);
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
    case Action::kStereo:
      display_.stereo = static_cast<render::StereoMode>((static_cast<int>(display_.stereo) + 1) % 3);
      break;
    case Action::kViewLastStroke: {
      const engine::SampleRect rect = touch_->lastRect();
      if (rect.empty()) break;
      Navigation::centreOn(view_, grid, (rect.column + 0.5 * rect.columns) * grid.spacingXMm(),
                           (rect.row + 0.5 * rect.rows) * grid.spacingYMm());
      break;
    }
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

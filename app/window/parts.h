#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

#include "app/overlay/line_overlay.h"
#include "app/window/actions.h"
#include "app/window/active_document.h"
#include "app/window/bookmarks.h"
#include "app/window/brush_adjustment.h"
#include "app/window/change_figures.h"
#include "app/window/colour_range.h"
#include "app/window/drags.h"
#include "app/window/files.h"
#include "app/window/flight.h"
#include "app/window/list_press.h"
#include "app/window/marking.h"
#include "app/window/notice_room.h"
#include "app/window/opening.h"
#include "app/window/overlays.h"
#include "app/window/questions.h"
#include "app/window/radial_menu.h"
#include "app/window/report_request.h"
#include "app/window/result_writing.h"
#include "app/window/saving.h"
#include "app/window/scene_files.h"
#include "app/window/section_drag.h"
#include "app/window/settings.h"
#include "app/window/spared_shadow.h"
#include "app/window/stylus.h"
#include "app/window/view_text.h"
#include "app/window/window_picture.h"
#include "app/work/choice_costs.h"
#include "app/work/compare_tool.h"
#include "app/work/device_check.h"
#include "app/work/device_lister.h"
#include "app/work/feature_tool.h"
#include "app/work/filter_preview.h"
#include "app/work/filter_suggester.h"
#include "app/work/fit_tool.h"
#include "app/work/form_tool.h"
#include "app/work/height_tool.h"
#include "app/work/join_tool.h"
#include "app/work/line_suggester.h"
#include "app/work/measure_tool.h"
#include "app/work/plane_picking.h"
#include "app/work/recent_files.h"
#include "app/work/removal_count.h"
#include "app/work/section_tool.h"
#include "app/work/transform_tool.h"
#include "render/plan/number_text.h"

namespace fettle::app {

/// Whether the window is to end: with everything saved as requested, or with unsaved work to be stored.
enum class Quit : std::uint8_t { kNo, kDone, kKeepWork };

/// The parts of the window, each with one duty: actions change them, panels show them and events report them.
/// No part uses this struct; what concerns several of them is done here or by their owner. Threading: main.
struct Parts {
  Parts(render::Window& on, const Settings& remembered)
      : window(on), settings(remembered), recent(recentFile()), picture(on) {}

  render::Window& window;
  Settings settings;
  RecentFiles recent;
  Feedback feedback;
  NoticeRoom notice_room;
  ListPress list_press;
  Files files;
  ScanOptions usual_reading;  ///< as the command line says, of every scan that nothing else was said of
  ScanOptions reading;        ///< of the open scan

  ActiveDocument document;
  Opening opening;
  Saving saving;
  SceneFiles scene_files;
  ResultWriting results;
  ReportWriter write_report;

  WindowPicture picture;
  render::View view = startView();
  Flight flight;  ///< of `view`
  Bookmarks bookmarks;
  StylusOverlay stylus_overlay;
  SparedShadow spared_shadow;
  LineOverlay line_overlay;
  PlaceOverlay place_overlay;
  SectionOverlay section_overlay;

  glm::dvec2 cursor{0.0};  ///< pixels of the window's frame
  Stylus stylus;
  RadialMenu radial;
  BrushAdjustment brush;
  ViewDrag drag;

  Marking marking;
  LineDrag line_drag;
  SectionDrag section_drag;
  PictureClick plane_click;  ///< that sets a point
  FilterPreview filters;
  FilterSuggester suggester;
  LineSuggester line_suggester;
  FormTool form;
  PlanePicking plane_points;  ///< of its choice
  HeightTool heights;
  RemovalCount removal;
  MeasureTool measure;
  SectionTool section;
  FitTool fit;
  FeatureTool features;
  TransformTool transform;
  JoinTool join;
  CompareTool compare;
  ChangeFigures change;
  ColourRange colours;
  ChoiceCosts costs;
  DeviceCheck device_check;  ///< of the page of the device
  DeviceLister devices;      ///< that can be chosen
  DeviceSetup device_setup;  ///< as chosen there so far
  render::FieldUnits units;  ///< in which the open document's quantities are shown
  double last_limit = 0.05;  ///< [height unit], for limits that are switched on again

  std::optional<std::int64_t> pointed_step;  ///< in the list of steps: where it changed something is shown
  std::int64_t steps_seen = 0;               ///< of showMarksMade()
  bool shows_before = false;                 ///< the scan as it was, while a key is held
  bool full_screen = false;                  ///< the picture and the status line alone, on all of the screen
  std::string status_before;                 ///< the status line said how to leave that
  std::string enter_panel;    ///< the panel of this name comes into view with the next frame; none: empty
  bool enter_panels = false;  ///< the panels get the keyboard focus with the next frame
  Quit quit = Quit::kNo;

  /// How a file is to be read: as the command line says, else as was said of this file before.
  [[nodiscard]] ScanOptions readingOf(const std::string& path) const;
  /// Of the document or coarse picture that is shown; null when there is none.
  [[nodiscard]] const engine::Grid* seenGrid() const;
  /// Whether the coarse picture is shown.
  [[nodiscard]] bool coarseIsShown() const;
  /// The first picture of a large field takes the main thread some seconds: the frame before announces it.
  [[nodiscard]] bool announcesPicture() const;
  /// Whether the mouse holds the stylus, the lasso or the view.
  [[nodiscard]] bool held() const;

  /// The view, or the one to which a flight leads: from where the next key goes on.
  [[nodiscard]] const render::View& viewToCome() const noexcept {
    return flight.active() ? flight.destination() : view;
  }
  /// Moves the view to another one: in a flight, or at once where the settings have none or no picture is seen.
  void flyTo(const render::View& to);
  /// Whether a place of the window is one that can be clicked on in the axes, and what that does.
  [[nodiscard]] std::optional<Action> axisAt(const glm::dvec2& place) const;

  /// Marks and lines that are hidden are shown again when one is made. Once per frame.
  void showMarksMade();
  /// Switches a tool on, or all off.
  void chooseTool(std::optional<haptic::Tool> tool);
  /// Releases what is held and cancels what was not confirmed.
  void releaseHands();
  void setFullScreen(bool on);
  /// Only dialogs have the keyboard: ImGui closes a dialog when the panels take it.
  void leavePanels();
  /// Removes the coarse picture: it must not stay where the scan could not be read.
  void dropCoarse();
  /// Of the open scene, else beside the scan.
  [[nodiscard]] std::string scenePathToSave() const;
  /// Writes what the transform panel says, to a session of a name that is free.
  void writeTransformed();
  /// The same of the scans that the join panel lists.
  void writeJoined();
  /// Closes the document, if one is open, with everything about it.
  void closeDocument(SessionKeeper::Afterwards afterwards);
};

}  // namespace fettle::app

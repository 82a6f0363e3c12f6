#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "app/report.h"
#include "app/window/actions.h"
#include "app/window/device_renewal.h"
#include "app/window/draw_field.h"
#include "app/window/event_log.h"
#include "app/window/headset_room.h"
#include "app/window/input.h"
#include "app/window/panels/panels.h"
#include "app/window/parts.h"
#include "app/window/report_request.h"
#include "app/window/tool_results.h"
#include "app/window/window_state.h"
#include "app/xr/room_table.h"

namespace fettle::app {

struct ViewOptions {
  std::string scan;  ///< may be empty: a window to drop one on
  std::optional<haptic::Scene> scene;
  std::string scene_path;  ///< of the file it is from
  LoopClientOptions client;
  ScanOptions reading;
  render::WindowOptions window;
  double seconds = 0.0;  ///< ends after this time; 0 = no limit
  DrawOptions drawing;
  std::optional<render::Theme> theme;  ///< of the panels, in place of the one in the settings, and kept there
  bool xr = false;                     ///< shows the field in a headset as well
  RoomScale xr_scale = RoomScale::kGiant;
  ReportWriter write_report;
  std::string events;  ///< where to write the events (EventLog); empty: nowhere
};

/// `fettle view`: one window, one field, one loop. It owns the parts (parts.h) and runs the frames on the
/// main thread: process input, take results of loop and workers, lay out the panels, draw what changed,
/// present. While the device draws a frame the cursor is passed to the loop, so that strokes are as smooth on
/// a slow device as on a fast one.
///
///   Window -> Input -> actions -> document, touch, picture, ...
///   loop, workers -> results -> notices, dialogs -> answers -> open, save, quit
///
/// Threading: main.
class Workstation {
 public:
  [[nodiscard]] static engine::Result<std::unique_ptr<Workstation>> create(const ViewOptions& options);
  ~Workstation();
  Workstation& operator=(Workstation&&) = delete;

  /// Until the user quits, the time is over or the job is cancelled. The report: runReport.
  [[nodiscard]] engine::Result<Report> run(engine::JobControl& job);

 private:
  Workstation(const ViewOptions& options, const Settings& settings, std::unique_ptr<render::Window> window);

  // A frame.
  void runFrame();
  void whileWaiting();
  void handleInput();
  void followFlight();
  void takeResults();
  void showFrame();
  void noteShown(const render::PresentReport& report, std::optional<std::int64_t> edit_ns, bool announces);

  // Documents.
  /// `reading`: nothing: as every scan of this run.
  void askToOpen(const std::string& path, std::optional<ScanOptions> reading = std::nullopt);
  void open(const std::string& path, const std::optional<ScanOptions>& reading);
  void load(const std::string& path, Recovery recovery, const std::optional<ScanOptions>& reading);
  void takeOpened();
  void askHowToRead(Opened opened);
  void startDocument(Document document);
  void noteWarnings(const std::vector<std::string>& warnings);
  void restoreSections(const Document& document);
  void resumeAfterSave(const Afterwards& afterwards);

  void carryOut(PanelRequests requests);
  void carryOut(Answer answer);
  void carryOutOfScene(Answer answer);
  void setRate(double hz);
  void setDevice(const std::string& words);
  void fitScene();
  void setUpDevice(const DeviceSetup& setup);
  void releaseHandsWhenAsked();
  void losePicture(const engine::Error& why);
  void renewPicture();
  void saveSettings();
  void saveSettingsNow();
  [[nodiscard]] RunFigures figures() const {
    return {frames_, renewal_.losses(), headset_.figures(), shown_ns_};
  }

  ViewOptions options_;
  std::unique_ptr<render::Window> window_;
  Parts parts_;
  HeadsetRoom headset_;
  std::uint64_t documents_ = 0;          // opened
  std::string dialog_path_;              // the one that came last from a dialog
  std::optional<Document> unconfirmed_;  // while it is asked whether its reading is right
  ToolResults tool_results_;
  Input input_;
  DeviceRenewal renewal_;
  EventLog events_;
  Settings saved_settings_;  // as in the file
  double ui_scale_;          // of the settings, as the window has it
  std::chrono::steady_clock::time_point settings_looked_at_{};
  std::uint64_t frames_ = 0;
  std::int64_t shown_ns_ = 0;  // the last one
  engine::Status end_;
};

}  // namespace fettle::app

#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/report.h"
#include "app/window/camera_motion.h"
#include "app/window/event_log.h"
#include "app/window/navigation.h"
#include "app/window/questions.h"
#include "app/window/refinement.h"
#include "app/window/settings.h"
#include "app/window/shortcuts.h"
#include "app/work/background.h"
#include "app/work/choice_costs.h"
#include "app/work/coarse_slot.h"
#include "app/work/edge_tool.h"
#include "app/work/filter_preview.h"
#include "app/work/lasso.h"
#include "app/work/live_change.h"
#include "app/work/loop_client.h"
#include "app/work/mark_edit.h"
#include "app/work/open_document.h"
#include "app/work/recent_files.h"
#include "app/work/replaced_files.h"
#include "app/work/scan_reading.h"
#include "app/work/session_keeper.h"
#include "engine/compare/compare.h"
#include "render/live/live_picture.h"
#include "render/window/window.h"

namespace fettle::app {

struct ViewOptions {
  std::string scan;  ///< may be empty: a window to drop one on
  std::optional<haptic::Scene> scene;
  LoopClientOptions touch;
  ScanOptions reading;
  render::WindowOptions window;
  double seconds = 0.0;       ///< ends after so long; 0 = not by itself
  bool sharp_motion = false;  ///< whatever the settings say, no Sharpness::kHalf while the view moves
  std::string events;         ///< where to tell what happens (EventLog); empty: nowhere
};

/// `fettle view`: one window, one field, one loop. The main thread goes round: take input, take in what loop
/// and workers told, lay the panels out, draw what changed, show it. Between two looks of the device at a
/// frame it goes on taking the cursor to the loop, so that strokes are as smooth on a slow device as on a
/// fast one.
///
/// Threading: main.
class Workstation {
 public:
  [[nodiscard]] static engine::Result<std::unique_ptr<Workstation>> create(const ViewOptions& options);
  ~Workstation();

  /// Until the user quits, the time is up or the job is cancelled. The report: see workstation.cpp.
  [[nodiscard]] engine::Result<Report> run(engine::JobControl& job);

 private:
  enum class Adjusting : std::uint8_t { kNothing, kRadius, kDepth };
  // Whether what is written is where the work lives from then on, or a copy of it for others.
  enum class Keeping : std::uint8_t { kWorkThere, kCopy };
  // Whether a path comes from a dialog that one can go back to.
  enum class Typed : std::uint8_t { kNo, kYes };
  [[nodiscard]] static Keeping keepingOf(Question::Kind kind) {
    return kind == Question::Kind::kSaveAs ? Keeping::kWorkThere : Keeping::kCopy;
  }

  explicit Workstation(const ViewOptions& options);

  // workstation.cpp: the round
  void goRound();
  void whileWaiting();
  void frame();
  void takeResults();
  void drawPicture();
  void followArea();
  [[nodiscard]] render::Sharpness seeMotion();
  [[nodiscard]] render::FrameInput frameInput(render::Sharpness sharpness) const;
  bool submit(const render::FrameInput& input);
  [[nodiscard]] const engine::Grid* seenGrid() const;
  [[nodiscard]] Report report() const;
  [[nodiscard]] bool active() const;

  // workstation_coarse.cpp: what is seen while a large scan is read
  [[nodiscard]] Background<Document>::Work openingWork(const std::string& path, Recovery recovery);
  void takeCoarse();
  void dropCoarse();
  [[nodiscard]] bool coarseIsShown() const;
  [[nodiscard]] std::string coarseText() const;
  void drawCoarse();

  // workstation_device.cpp: a graphics device that is lost
  [[nodiscard]] engine::Status makePicture();
  void losePicture(const engine::Error& why);
  void renewPicture();
  [[nodiscard]] std::string keepWork();

  // workstation_told.cpp: what --events tells
  [[nodiscard]] bool announcesPicture() const;
  void noteOpening();
  void countHand(const render::InputEvent& event);
  [[nodiscard]] Report told() const;
  void tell();

  // workstation_input.cpp
  void handleInput();
  void toStylus(const render::InputEvent& event);
  void handle(const render::InputEvent& event);
  void disarmAtOnce(const render::InputEvent& event);
  void handleKey(const render::InputEvent& event);
  bool handleAdjusting(const render::InputEvent& event);
  void setAdjusted(double value);
  void leaveAdjusting();
  void letGo();
  void act(Action action);
  bool moveCamera(Action action, const engine::Grid& grid);
  void chooseTool(std::optional<haptic::Tool> tool);
  void setBrushRadius(double samples);
  void setPressDepth(double mm);
  void setRate(double hz);
  /// What cannot be, or what the device does not hold, is said in a notice and not done.
  void takeScene(const haptic::Scene& scene);
  /// A notice when no known device would hold the scene; where one is there, it is its own word that counts.
  void noteWithoutForce(const haptic::Scene& scene);
  // Memory that undo may take; older steps are read back from the session when they are wanted.
  static constexpr std::size_t kHistoryBytes = std::size_t{1} << 30;
  // Text of the picture's furniture over that of a picture [render::layOut], at scale 1 of the display: 13
  // pixels, a little smaller than that of the panels.
  static constexpr double kFurniture = 0.87;
  [[nodiscard]] haptic::Tool toolFor(const render::Modifiers& modifiers) const;
  [[nodiscard]] bool inPicture(double x, double y) const;
  [[nodiscard]] std::optional<render::Picked> pick(double x, double y) const;
  [[nodiscard]] Drag dragOf(const render::InputEvent& event) const;

  // workstation_marking.cpp: marks by lasso, by box, by suggestion
  void beginLasso(Lasso::Shape shape);
  bool handleLasso(const render::InputEvent& event);
  void finishLasso(engine::MarkChange change);
  void drawLasso() const;
  void actOnEdges(Action action);
  void pollMarking();
  [[nodiscard]] std::optional<glm::dvec2> fieldAt(const glm::dvec2& pixel) const;
  [[nodiscard]] std::vector<engine::TileRange> seenPart() const;

  // workstation_files.cpp
  void open(const std::string& path);
  void askToOpen(const std::string& path);
  void load(const std::string& path, Recovery recovery);
  void takeDocument(Document document);
  void closeDocument(SessionKeeper::Afterwards afterwards);
  void lookAfterSession();
  void save(Afterwards afterwards);
  void askToWrite(Question from, Typed typed);
  void startSaving(const std::string& path, Keeping keeping, Afterwards afterwards);
  void write(const std::string& path, Keeping keeping);
  [[nodiscard]] std::vector<std::string> outputsOf(const std::string& path, Keeping keeping) const;
  void takeSaved();
  void undo();
  void askToQuit();
  void leave();
  void goOn(const Afterwards& afterwards);
  [[nodiscard]] bool unsaved() const;
  /// How the work is kept, for the status bar.
  [[nodiscard]] std::string sessionText() const;
  [[nodiscard]] std::string suggestedPath(const char* ending) const;

  // workstation_dialogs.cpp
  void ask(Question question);
  void message(std::string what, std::string remedy);
  void leavePanels();
  void dialogs();
  void pathDialog(Question& question);
  void unsavedDialog(Question& question);
  void recoverDialog(const Question& question);
  void shortcutsDialog();
  void messageDialog(const Question& question);
  void replaceDialog(const Question& question);

  // panels/
  void panels();
  void menuBar();
  void menuItem(Action action, bool enabled = true, bool ticked = false);
  float sidePanel();
  void toolPanel();
  void statusPanel();
  void historyPanel();
  void filterPanel();
  void displayPanel();
  void hapticsPanel();
  void contactChooser();
  void detailChooser();
  void edgePanel();
  void deviationPanel();
  [[nodiscard]] bool section(const char* name, bool open_at_first);
  void rememberLayout();
  void statusBar();
  void splitLine();
  [[nodiscard]] render::Rectangle plot() const;  // of the picture's surface, in the window

  ViewOptions options_;
  std::unique_ptr<render::Window> window_;
  std::unique_ptr<render::LivePicture> picture_;
  RecentFiles recent_;
  // What hands did since the last frame. The stylus has its events before the frame comes to the others,
  // unless a key waits that may choose another tool: then it waits behind it.
  struct Pending {
    render::InputEvent event;
    bool stylus_has_it = false;
  };
  std::vector<Pending> input_;

  // The field and what is done to it.
  std::string path_;  // of the scan
  std::string loading_path_;
  std::chrono::steady_clock::time_point load_asked_;
  std::string
      save_path_;  // where Ctrl+S writes the field to, without a session of the user's; empty until chosen
  std::string saving_path_;
  engine::Version saved_;                  // upright, as the file holds it
  std::unique_ptr<SessionKeeper> keeper_;  // there with touch_, and outlives it
  std::unique_ptr<LoopClient> touch_;
  Background<Document> loading_;
  std::shared_ptr<CoarseSlot> coarse_slot_;  // of the newest loading
  std::optional<engine::Preview> coarse_;    // while there is no touch_
  Background<engine::Version> saving_;
  Background<engine::Deviation> measuring_;
  Keeping keeping_ = Keeping::kCopy;
  Afterwards after_saving_;                     // of what is being saved
  std::vector<std::string> writing_, written_;  // all files of what is being written, of save_path_
  bool write_after_scan_ = false;               // saving_path_ waits until the session holds the scan
  bool embeds_ = true;                          // the scan goes into a session saved as
  std::chrono::steady_clock::time_point noted_;
  bool keeping_fails_ = false;  // and the user was told
  engine::Version measured_;    // what measuring_ works on, or deviation_ is of
  std::optional<engine::Deviation> deviation_;
  FilterPreview filters_;
  ChoiceCosts costs_;
  std::vector<Notice> notices_;

  // The picture.
  render::View view_;
  CameraMotion camera_motion_;
  Refinement refinement_;
  Display display_;
  Habits habits_ = Habits::kBlender;
  Settings settings_, saved_settings_;  // panels; as the file has them
  render::FrameStatistics figures_;
  render::Shown shown_;
  bool stale_ = true;
  haptic::LoopState drawn_state_;
  double frame_ms_ = 0.0;
  haptic::TimingHistogram frame_times_;
  std::int64_t tiles_uploaded_ = 0;
  std::int64_t bytes_uploaded_ = 0;
  std::uint64_t frames_ = 0;
  // From asking for the newest scan on [ms]: it was read, it could be touched, it was seen, and all of it lay
  // on the device; 0: not yet.
  struct Opening {
    std::chrono::steady_clock::time_point asked;
    double coarse_ms = 0.0;  // a coarse picture was seen; 0: there was none
    double read_ms = 0.0, touched_ms = 0.0, seen_ms = 0.0, whole_ms = 0.0;
    bool announced = false;  // that the first picture is being made
    [[nodiscard]] double sinceAsked() const;
  } opening_;
  // Devices lost so far, tries to come back since the picture last stood for a while, and when the next one
  // is.
  int device_losses_ = 0;
  int renewals_ = 0;
  std::chrono::steady_clock::time_point renew_at_;
  std::uint64_t renewed_frame_ = 0;

  // For whoever drives the window: what hands did so far.
  EventLog events_;
  struct Hands {
    std::uint64_t keys = 0, buttons = 0, wheels = 0, drops = 0;
  } hands_;

  // Marks drawn at once, and what the work changed so far.
  MarkEdit mark_edit_;
  Lasso lasso_;
  engine::Version marking_original_;  // of the field these are about
  bool lasso_drawn_ = false;          // by hand, since the button went down
  EdgeTool edges_;
  LiveChange change_;

  // The hand.
  bool tool_on_ = false;  // the left button is the stylus
  bool stylus_held_ = false;
  Drag drag_ = Drag::kNone;
  bool dragging_split_ = false;
  double last_x_ = 0.0, last_y_ = 0.0;
  std::optional<render::Picked> under_cursor_;
  Adjusting adjusting_ = Adjusting::kNothing;
  double adjust_from_ = 0.0, adjust_x_ = 0.0;
  std::string typed_;
  double press_mm_ = 0.0;
  double most_change_ = 0.05;                // [height unit], for limits that are switched on again
  std::optional<haptic::Tool> turned_tool_;  // chosen, while Ctrl turned it into its opposite

  // Panels.
  Questions questions_;
  std::uint64_t question_frame_ = 0;  // the last one with a dialog
  bool side_panel_ = true;
  float side_width_ = 0.0F;
  bool enter_panels_ = false;  // the keyboard goes to the panels with the next frame
  bool quit_ = false;
  bool quit_unasked_ = false;  // with what is not saved, which is kept
  std::vector<float> force_plot_;
  engine::Status end_;
  std::string status_text_;
};

}  // namespace fettle::app

#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/history/history.h"
#include "haptic/devices/device.h"
#include "haptic/devices/virtual/mouse_stylus.h"
#include "haptic/effects/stability.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/recorder.h"
#include "haptic/journal/session_sink.h"
#include "haptic/loop/adopt_filtered.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/loop/timing.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

struct TouchOptions {
  std::string device = "mouse";  ///< a word of haptic::openDevice
  double rate_hz = 1000.0;
  /// Spring and depth of the mouse follow the field's spacing; off when a scene file says the spring.
  bool fit_spring = true;
  /// What the device does not hold of the scene it begins with (haptic::stabilityProblem) is lowered to the
  /// largest it holds, with a notice; without it such a scene is refused.
  bool lower_scene = false;
};

/// Something the user should read.
struct Notice {
  std::string what;
  std::string remedy;
};

/// The live loop as the window sees it: field, tools, undo, device. It owns the loop and its device; what the
/// loop tells is taken in by poll(), and what is shown is the newest version the loop has published.
///
/// Steps. A stroke, the adoption of a filter and a change of all marks are a step each (engine::History, the
/// right way up). Undo and redo ask the loop to restore a version; the history moves at once, the field when
/// the loop answers. Undo while a stroke runs makes a step of it first.
///
/// Inversion is a sign that the scene sets: field() has it, history() and upright() do not.
///
/// Every step, undo and redo goes to the session (SessionSink) with the journal that makes it again: the
/// input of each tick, each scene, each round of a filter's adoption, with the tick that took it (journal.h).
///
/// Threading: main thread, but for the port (AdoptionPort), which a worker uses and main answers in poll().
class Touch final : public haptic::AdoptionPort {
 public:
  /// Opens and starts the device and the loop. `history` and `original` the right way up. `sink` outlives
  /// this; null: nothing is recorded. Errors: those of openDevice, HapticLoop::create and start; a scene that
  /// the device does not hold, as in setScene().
  [[nodiscard]] static engine::Result<std::unique_ptr<Touch>> start(engine::History history,
                                                                    const engine::Version& original,
                                                                    const haptic::Scene& scene,
                                                                    const TouchOptions& options,
                                                                    haptic::SessionSink* sink);
  /// As finish(), if that was not called.
  ~Touch() override;
  Touch(const Touch&) = delete;
  Touch& operator=(const Touch&) = delete;

  /// Takes in what the loop told. Cheap; to be called often.
  void poll();
  /// Lets the force fade, ends the loop and takes in its last words: a running stroke becomes a step. Some
  /// 30 ms with a device that gives force. Nothing but the looks at field and history is of use afterwards.
  void finish();
  /// As felt.
  [[nodiscard]] const engine::Version& field() const noexcept { return field_; }
  [[nodiscard]] engine::Version upright() const { return upright(field_); }
  /// The right way up, with what the loop has been asked for and did not answer yet: after an undo the state
  /// gone back to, else upright(). What work in the background begins with.
  [[nodiscard]] engine::Version newest() const {
    return restores_open_ > 0 ? history_.current() : upright(field_);
  }
  [[nodiscard]] const engine::History& history() const noexcept { return history_; }
  [[nodiscard]] const engine::Version& original() const noexcept { return original_; }
  [[nodiscard]] const haptic::Scene& scene() const noexcept { return scene_; }
  /// Where the last step changed something.
  [[nodiscard]] engine::FieldRect lastRect() const noexcept { return last_rect_; }

  void setTool(haptic::Tool tool);
  [[nodiscard]] haptic::Tool tool() const noexcept { return tool_; }
  /// Takes a scene; it is felt from the next tick or two on. Errors (kInput), which change nothing: out of
  /// range (sceneProblem), or more than a device that gives force holds at this rate
  /// (haptic::stabilityProblem): what it says names the largest value that it does hold.
  [[nodiscard]] engine::Status setScene(const haptic::Scene& scene);
  /// What of a scene the device would not hold; nothing for one that gives no force.
  [[nodiscard]] std::optional<haptic::StabilityProblem> stabilityProblem(const haptic::Scene& scene) const;
  /// Largest stiffness [N/mm] that the device holds beside the rest of the scene; none when it gives no
  /// force.
  [[nodiscard]] std::optional<double> largestStiffness() const;
  /// What is done after an undo takes the place of the steps undone.
  void undo();
  void redo();
  void goTo(std::int64_t state);
  [[nodiscard]] bool canUndo() const noexcept { return history_.canUndo() || strokeRuns(); }
  [[nodiscard]] bool canRedo() const noexcept { return history_.canRedo() && !strokeRuns(); }
  /// Puts a step read back from a session in front of those held.
  void prepend(engine::Step step) { history_.prepend(std::move(step)); }
  /// Puts other marks in place as one step of kind kMark: `marked` is a version of the newest field
  /// (upright(), the same memory) with marks set and cleared. Strokes made since `marked` was taken are kept.
  void replaceMarks(const engine::Version& base, const engine::Version& marked, std::string name);
  /// Allows force, as soon as the device is ready and the commanded force small (ForceGuard::arm). A device
  /// that cannot push, and a simulated hand, are armed by themselves when they come and after a fault.
  void arm();
  /// No force from the next tick on, past all that was sent before; and nothing arms again but arm().
  void disarm();
  void calibrate();
  /// The view turned or zoomed: "away" on the desk stays "into the picture". Devices in field coordinates
  /// have nothing to turn.
  void setView(double azimuth_deg, double zoom);

  /// To be told of a filter that begins to be computed on field(): what it is called from then on.
  [[nodiscard]] std::uint64_t noteFilterBase();
  /// ... and of one whose result is about to be brought in through the port, under a name for the list of
  /// steps.
  void noteFilterBegun(std::uint64_t base, const engine::FilterSpec& spec, std::string name);
  engine::Result<engine::Version> snapshot() override;
  engine::Result<Answer> adopt(engine::Version version) override;
  void pause() override;
  /// Lets a worker that waits at the port go, with kCancelled; until allowPort().
  void closePort();
  void allowPort();

  [[nodiscard]] haptic::MouseStylus* mouse() noexcept { return mouse_; }
  [[nodiscard]] const haptic::Device& device() const noexcept { return *device_; }
  /// The newest tick.
  [[nodiscard]] haptic::LoopState state() noexcept { return loop_->state(); }
  [[nodiscard]] const haptic::LoopTiming& timing() const noexcept { return loop_->timing(); }
  [[nodiscard]] const haptic::RealTimeReport& realTime() const noexcept { return loop_->realTime(); }
  [[nodiscard]] double rate() const noexcept { return options_.rate_hz; }
  /// Ends the loop as finish() does - the force fades to zero, a running stroke becomes a step - and starts
  /// another at this rate [Hz], 1000 .. 10000, from the history's state: some 10 ms, 30 with a device that
  /// gives force. A device that pushes is to be armed again; who had disarmed stays disarmed. Figures of the
  /// timing begin anew, and so does the way of a simulated hand. A filter under way is cancelled, and results
  /// computed before are not to be brought in afterwards: the journal has forgotten their base.
  /// Errors: a rate out of range, or one at which the device does not hold the scene, and nothing has
  /// happened; those of start(), after which it runs at the old rate, or is finished().
  [[nodiscard]] engine::Status setRate(double rate_hz);
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  /// Ticks a second, over the last second or so.
  [[nodiscard]] double measuredRate() const noexcept { return measured_rate_; }
  [[nodiscard]] std::vector<Notice> takeNotices() { return std::exchange(notices_, {}); }

  /// Edit to pixel: the time [steady_clock ns] before which no edit in field() that was not taken by this
  /// call yet can have been made; empty when there is none. Too early by at most the loop's period of
  /// publication, 8 ticks.
  [[nodiscard]] std::optional<std::int64_t> takeUnshownEdit() noexcept {
    return std::exchange(unshown_ns_, std::nullopt);
  }
  /// A frame with all that such a time stands for was on the screen at `shown_ns`.
  void noteShown(std::int64_t edit_ns, std::int64_t shown_ns);
  [[nodiscard]] const haptic::TimingHistogram& latency() const noexcept { return latency_; }
  [[nodiscard]] double lastLatencyMs() const noexcept { return last_latency_ms_; }

  [[nodiscard]] static engine::Version upright(const engine::Version& version) {
    return version.reader().sign() < 0.0F ? version.inverted() : version;
  }

 private:
  struct Mailbox;
  // Whether a step is what ticks and filters made of the field, or marks set on top of that.
  enum class Source : std::uint8_t { kLoop, kMarks };
  Touch(engine::History history, const engine::Version& original, const haptic::Scene& scene,
        const TouchOptions& options, haptic::SessionSink* sink);
  [[nodiscard]] engine::Status openDevice();
  [[nodiscard]] engine::Status startLoop();
  [[nodiscard]] engine::Status restartLoop();
  [[nodiscard]] bool armsItself() const;
  [[nodiscard]] std::optional<haptic::StabilityProblem> stabilityProblem(const haptic::Scene& scene,
                                                                         double rate_hz) const;
  void takeRecords();
  void take(haptic::LoopEvent&& event);
  void journalAnswer(const haptic::LoopEvent& event);
  void keepStroke();
  void restore(const engine::Version& upright_version);
  void send(haptic::LoopCommand&& command);
  void push(const std::string& name, engine::StepKind kind, const engine::Version& after,
            const haptic::LoopPlace& at, Source source = Source::kLoop, std::string data = {});
  void noteEdit(const haptic::LoopEvent& event);
  void answerPort();
  void armByItself();
  void measureRate();
  void watch();
  [[nodiscard]] bool strokeRuns() const noexcept;

  TouchOptions options_;
  engine::History history_;
  engine::Version original_;
  haptic::Scene scene_;
  haptic::Tool tool_ = haptic::Tool::kFeel;
  std::unique_ptr<haptic::Device> device_;
  haptic::MouseStylus* mouse_ = nullptr;  // device_, when it is one
  std::unique_ptr<haptic::HapticLoop> loop_;
  engine::Version field_;      // newest published
  haptic::LoopPlace place_;    // where in the loop's life that was
  engine::Version committed_;  // upright: the last step's, what a running stroke is measured against
  haptic::Tool stroke_tool_ = haptic::Tool::kFeel;
  engine::FieldRect last_rect_;
  std::vector<haptic::LoopCommand> unsent_;  // found the ring full

  haptic::SessionSink* sink_;
  bool finished_ = false;
  bool disarmed_ = false;  // by the user, who did not arm since
  haptic::Recorder recorder_;
  std::uint64_t recorded_ = 0;  // ticks, those lost included
  std::uint64_t lost_ = 0;
  std::deque<haptic::LoopEvent> held_;  // until the ticks they stand after are recorded
  std::deque<std::pair<std::uint64_t, haptic::Scene>> scenes_;  // sent, not answered
  std::uint64_t filters_ = 0;

  std::uint64_t next_id_ = 1;
  std::uint64_t restores_open_ = 0;
  std::string adoption_name_ = "Filter";
  bool adoption_begun_ = false;  // the running adoption has its step
  std::unique_ptr<Mailbox> mailbox_;
  std::vector<Notice> notices_;
  haptic::LoopState seen_;
  double scale_at_start_ = 1.0;  // the largest there is: see setView()
  double view_azimuth_deg_ = 0.0, view_zoom_ = 1.0;

  std::optional<std::int64_t> unshown_ns_;
  std::uint64_t last_event_tick_ = 0;
  haptic::TimingHistogram latency_;
  double last_latency_ms_ = 0.0;

  std::uint64_t rate_tick_ = 0;
  std::int64_t rate_ns_ = 0;
  double measured_rate_ = 0.0;
  std::int64_t armed_try_ns_ = 0;
};

}  // namespace fettle::app

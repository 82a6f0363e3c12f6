#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/work/adoption_mailbox.h"
#include "app/work/device_loop.h"
#include "app/work/edit_latency.h"
#include "app/work/notice.h"
#include "app/work/step_keeper.h"
#include "engine/base/error.h"
#include "engine/history/history.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// The live loop as the window sees it: field, tools, undo, device. What the loop publishes is taken in by
/// poll(), and what is shown is the newest version it has published.
///
/// Steps (StepKeeper). Undo and redo ask the loop to restore a version; the history moves at once, the field
/// when the loop answers. Undo while a stroke runs makes a step of it first.
///
/// Inversion is a sign that the scene sets: field() has it, history() and upright() do not.
///
/// Threading: main thread; a worker uses port(), whose questions poll() carries to the loop.
class Touch final {
 public:
  /// Opens and starts the device and the loop. `history` and `original` upright. `sink` outlives this; null:
  /// nothing is recorded. Errors: those of openDevice, HapticLoop::create and start; a scene that the device
  /// does not hold, as in setScene().
  [[nodiscard]] static engine::Result<std::unique_ptr<Touch>> start(engine::History history,
                                                                    const engine::Version& original,
                                                                    const haptic::Scene& scene,
                                                                    const TouchOptions& options,
                                                                    haptic::SessionSink* sink);
  /// As finish(), if that was not called.
  ~Touch();
  Touch(const Touch&) = delete;
  Touch& operator=(const Touch&) = delete;

  /// Takes in what the loop published and answered. Cheap; to be called often.
  void poll();
  /// Lets the force fade, ends the loop and takes in what it published last: a running stroke becomes a step.
  /// Some 30 ms with a device that gives force. Only the looks at field and history are of use afterwards.
  void finish();
  [[nodiscard]] bool finished() const noexcept { return !loop_.running(); }

  /// As felt.
  [[nodiscard]] const engine::Version& field() const noexcept { return field_; }
  [[nodiscard]] engine::Version upright() const { return upright(field_); }
  /// Upright, with what the loop has been asked for and did not answer yet: after an undo the state gone back
  /// to, else upright(). What work in the background begins with.
  [[nodiscard]] engine::Version newest() const {
    return restores_open_ > 0 ? history().current() : upright(field_);
  }
  [[nodiscard]] const engine::History& history() const noexcept { return steps_.history(); }
  [[nodiscard]] const engine::Version& original() const noexcept { return original_; }
  [[nodiscard]] const haptic::Scene& scene() const noexcept { return scene_; }
  /// Where the last step changed something.
  [[nodiscard]] engine::SampleRect lastRect() const noexcept { return steps_.lastRect(); }

  void setTool(haptic::Tool tool);
  [[nodiscard]] haptic::Tool tool() const noexcept { return tool_; }
  /// Takes a scene; it is felt from the next tick or two on. Errors (kInput), which change nothing: out of
  /// range (sceneProblem), or more than a device that gives force holds at this rate
  /// (haptic::stabilityProblem): the message names the largest value that it does hold.
  [[nodiscard]] engine::Status setScene(const haptic::Scene& scene);
  /// What of a scene the device would not hold; nothing for one that gives no force.
  [[nodiscard]] std::optional<haptic::StabilityProblem> stabilityProblem(const haptic::Scene& scene) const {
    return loop_.stabilityProblem(scene, loop_.rate());
  }
  /// Largest stiffness [N/mm] that the device holds with the rest of the scene; none when it gives no force.
  [[nodiscard]] std::optional<double> largestStiffness() const { return loop_.largestStiffness(scene_); }

  /// What is done after an undo takes the place of the steps undone.
  void undo();
  void redo();
  void goTo(std::int64_t state);
  [[nodiscard]] bool canUndo() const noexcept { return history().canUndo() || strokeRuns(); }
  [[nodiscard]] bool canRedo() const noexcept { return history().canRedo() && !strokeRuns(); }
  /// Puts a step read back from a session in front of those held.
  void prepend(engine::Step step) { steps_.prepend(std::move(step)); }
  /// Puts other marks in place as one step of kind kMark: `marked` is a version of the newest field
  /// (upright(), the same memory) with marks set and cleared. Strokes made since `marked` was taken are kept.
  void replaceMarks(const engine::Version& base, const engine::Version& marked, std::string name);

  /// Called when a filter begins to be computed on field(): its number from then on.
  [[nodiscard]] std::uint64_t noteFilterBase() { return steps_.journal().filterBase(place_); }
  /// Called when its result is about to be brought in through the port, under a name for the list of steps.
  void noteFilterBegun(std::uint64_t base, const engine::FilterSpec& spec, std::string name);
  [[nodiscard]] haptic::AdoptionPort& port() noexcept { return mailbox_; }
  /// Releases a worker that waits at the port, with kCancelled; until allowPort().
  void closePort() { mailbox_.close(); }
  void allowPort();

  /// As DeviceLoop has them.
  void arm() { loop_.arm(); }
  void disarm() { loop_.disarm(); }
  void calibrate() { loop_.calibrate(); }
  void setView(double azimuth_deg, double zoom) { loop_.setView(azimuth_deg, zoom); }
  [[nodiscard]] haptic::MouseStylus* mouse() noexcept { return loop_.mouse(); }
  [[nodiscard]] const haptic::Device& device() const noexcept { return loop_.device(); }
  /// The newest tick.
  [[nodiscard]] haptic::LoopState state() noexcept { return loop_.loop().state(); }
  [[nodiscard]] const haptic::LoopTiming& timing() const noexcept { return loop_.loop().timing(); }
  [[nodiscard]] const haptic::RealTimeReport& realTime() const noexcept { return loop_.loop().realTime(); }
  [[nodiscard]] double rate() const noexcept { return loop_.rate(); }
  [[nodiscard]] double measuredRate() const noexcept { return loop_.measuredRate(); }
  /// Ends the loop as finish() does - the force fades to zero, a running stroke becomes a step - and starts
  /// another at this rate [Hz], 1000 .. 10000, from the history's state: some 10 ms, 30 with a device that
  /// gives force. A device that pushes is to be armed again; who had disarmed stays disarmed. Figures of the
  /// timing start at zero, and a simulated hand begins its way again. A filter under way is cancelled, and
  /// results computed before are not to be brought in afterwards: the journal no longer has their base.
  /// Errors: a rate out of range, or one at which the device does not hold the scene, and nothing has
  /// happened; those of start(), after which it runs at the old rate, or is finished().
  [[nodiscard]] engine::Status setRate(double rate_hz);

  [[nodiscard]] std::vector<Notice> takeNotices() { return std::exchange(notices_, {}); }
  [[nodiscard]] EditLatency& latency() noexcept { return latency_; }

  [[nodiscard]] static engine::Version upright(const engine::Version& version) {
    return version.reader().sign() < 0.0F ? version.inverted() : version;
  }

 private:
  Touch(engine::History history, const engine::Version& original, const haptic::Scene& scene,
        const TouchOptions& options, haptic::SessionSink* sink);
  [[nodiscard]] engine::Status startLoop(double rate_hz);
  void takeTicks();
  void take(haptic::LoopEvent&& event);
  void restore(const engine::Version& upright_version);
  void sendQuestion();
  [[nodiscard]] bool strokeRuns() const noexcept;
  void keepStroke();

  engine::Version original_;
  haptic::Scene scene_;
  haptic::Tool tool_ = haptic::Tool::kFeel;
  StepKeeper steps_;
  DeviceLoop loop_;
  AdoptionMailbox mailbox_;
  EditLatency latency_;
  engine::Version field_;               // newest published
  haptic::LoopPlace place_;             // where in the loop's life that was
  std::deque<haptic::LoopEvent> held_;  // until the ticks before them are recorded
  std::uint64_t next_id_ = 1;           // of a command
  std::uint64_t restores_open_ = 0;     // asked for, not answered
  std::vector<Notice> notices_;
};

}  // namespace fettle::app

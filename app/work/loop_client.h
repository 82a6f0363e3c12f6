#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/sound/loop_sound.h"
#include "app/work/adoption_mailbox.h"
#include "app/work/device_loop.h"
#include "app/work/edit_latency.h"
#include "app/work/form_change.h"
#include "app/work/form_originals.h"
#include "app/work/step_keeper.h"
#include "app/work/stroke_path.h"
#include "engine/base/error.h"
#include "engine/field/upright.h"
#include "engine/history/history.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// Edges that were suggested and taken as they were.
struct TakenEdges {
  haptic::journal::EdgesSuggested numbers;
  engine::Version searched;  ///< upright: where they were found
};

/// The window's interface to the live loop: field, tools, undo, device. poll() takes over what the loop
/// published; the newest published version is shown.
///
/// Steps (StepKeeper). Undo and redo ask the loop to restore a version; the history moves immediately, the
/// field when the loop answers. Undo while a stroke runs makes a step of it first. A filter's result that the loop is just
/// taking over becomes a step first, too: both wait for that answer, some ticks. What the loop did between a request to
/// restore and its answer is replaced by the state restored and makes no step.
///
/// Forms. A field with a form over it is worked on as it is seen: history, field and filters have Version::seenOf(), and the
/// original is the scan under the same form. The session stores the samples.
///
/// Inversion is a sign that the scene sets: field() has it, history() and upright() do not.
///
/// Threading: main thread; a worker uses port(), whose requests poll() sends to the loop.
class LoopClient final {
 public:
  /// Opens and starts the device and the loop. `history` and `originals` upright; those under forms that are missing are
  /// made, a long job. `sink` outlives this; null:
  /// nothing is recorded. Errors: those of openDevice, HapticLoop::create and start; a scene with which the
  /// device is not stable, as in setScene().
  [[nodiscard]] static engine::Result<std::unique_ptr<LoopClient>> start(engine::History history,
                                                                         FormOriginals originals,
                                                                         const haptic::Scene& scene,
                                                                         const LoopClientOptions& options,
                                                                         haptic::SessionSink* sink);
  /// As finish(), if that was not called.
  ~LoopClient();
  LoopClient& operator=(LoopClient&&) = delete;

  /// Takes over the events and answers of the loop. Cheap; to be called often.
  void poll();
  /// Lets the force fade, ends the loop and takes over its last events: a running stroke becomes a step.
  /// About 30 ms with a force device. Afterwards only field and history may be read.
  void finish();
  [[nodiscard]] bool finished() const noexcept { return !loop_.running(); }

  /// As felt.
  [[nodiscard]] const engine::Version& field() const noexcept { return field_; }
  [[nodiscard]] engine::Version upright() const { return upright(field_); }
  /// Upright, including requests that the loop has not answered yet: after an undo the state restored, else
  /// upright(). Work in the background starts from it.
  [[nodiscard]] engine::Version newest() const {
    return restores_open_ > 0 ? history().current() : upright(field_);
  }
  /// Waits, some ticks at most, until field() is newest(): what is worked out from it has its form and original.
  void awaitRestored();
  [[nodiscard]] const engine::History& history() const noexcept { return steps_.history(); }
  /// The original scan under the form over field().
  [[nodiscard]] const engine::Version& original() const noexcept { return originals_.at(field_); }
  /// The same without a form.
  [[nodiscard]] const engine::Version& scan() const noexcept { return originals_.scan(); }
  [[nodiscard]] const haptic::Scene& scene() const noexcept { return scene_; }
  /// Where the last step changed something.
  [[nodiscard]] engine::SampleRect lastRect() const noexcept { return steps_.lastRect(); }

  void setTool(haptic::Tool tool);
  [[nodiscard]] haptic::Tool tool() const noexcept { return tool_; }
  /// Sets a scene; it is felt after one or two ticks. Errors (kInput), which change nothing: out of range
  /// (sceneProblem), or not stable with a force device at this rate (haptic::stabilityProblem): the message
  /// names the largest stable value.
  [[nodiscard]] engine::Status setScene(const haptic::Scene& scene);
  /// A scene that the user gave, as it is (SceneFitting::fits). Where it is felt at another scale the loop ends and another
  /// starts, as in setDeviceSetup(). Errors: those of setScene() and start(), after which the scene before is felt, or the loop is
  /// finished().
  [[nodiscard]] engine::Status openScene(const haptic::Scene& scene);
  /// Fits the lengths of the scene, those of the default scene, to field and device, and what that is not stable with is lowered; as
  /// openScene().
  [[nodiscard]] engine::Status fitScene();
  /// scene() as its user has it, also where it is lowered to what the device holds.
  [[nodiscard]] haptic::Scene unlowered() const { return loop_.unlowered(scene_); }
  /// The fit in force; nothing where the user gave the scene.
  [[nodiscard]] const std::optional<SceneFit>& fit() const noexcept { return loop_.fitting().last; }
  /// Why a scene that the user gave is felt badly; nothing where it is not.
  [[nodiscard]] std::optional<FeltProblem> feltProblem() const { return loop_.feltProblem(scene_); }
  /// The problem of a scene with which the device is not stable; empty for one without force.
  [[nodiscard]] std::optional<haptic::StabilityProblem> stabilityProblem(const haptic::Scene& scene) const {
    return loop_.stabilityProblem(scene, loop_.rate());
  }
  /// Largest stiffness [N/mm] that the device holds with the rest of the scene; none when it gives no force.
  [[nodiscard]] std::optional<double> largestStiffness() const { return loop_.largestStiffness(scene_); }

  /// Later edits after an undo replace the steps undone.
  void undo();
  void redo();
  void goTo(std::int64_t state);
  [[nodiscard]] bool canUndo() const noexcept { return history().canUndo() || strokeRuns(); }
  [[nodiscard]] bool canRedo() const noexcept { return history().canRedo() && !strokeRuns(); }
  /// Puts a step read back from a session in front of those held; `original` is that of the state before it.
  void prepend(engine::Step step, const engine::Version& original);
  /// Changes marks, or marks and edge lines, as one step of kind kMark or kLines: `changed` is `base`, a version of the
  /// newest field (upright(), the same memory), with marks set and cleared and with other lines. Strokes made since
  /// `base` was taken are kept. False, and no step: the lines are no longer those of `base`, `changed` is to be made
  /// again. The numbers of `edges` are recorded with the step where the heights are still those searched, so that the
  /// same search after the steps before it finds them again.
  [[nodiscard]] bool change(const engine::Version& base, const engine::Version& changed, std::string name,
                            const std::optional<TakenEdges>& edges = {});
  /// Changes the form over the field as one step of kind kForm, and with it the original, in one tick. Strokes made since
  /// it was worked out are kept. Not to be called while a filter is being adopted. False, and no step: too much changed
  /// since; it is to be moved to the newest field first.
  [[nodiscard]] bool changeForm(FormChange& change);
  /// Changes heights as one step of kind kFilter: `changed` is what computeHeights makes of `base`, a version of the newest field. Not to be
  /// called while a filter is being adopted. False, and no step: the field is no longer `base`, its heights are to be made again.
  [[nodiscard]] bool changeHeights(const engine::Version& base, const engine::Version& changed,
                                   std::string name, const haptic::HeightsMaker& maker);
  /// The strokes of tools that edit marks which ended since the last call, in their order; only where the session is
  /// recorded.
  [[nodiscard]] std::vector<MarkStroke> takeMarkStrokes() { return std::exchange(mark_strokes_, {}); }
  /// Whether a stroke has edited something, or marks, and has not ended.
  [[nodiscard]] bool strokeIsUnderWay() const noexcept { return !path_.empty() || strokeRuns(); }

  /// To be called when a filter starts on field(); returns the base's number.
  [[nodiscard]] std::uint64_t noteFilterBase() { return steps_.journal().filterBase(place_); }
  /// To be called before its result is adopted through the port, with a name for the list of steps.
  void noteFilterBegun(std::uint64_t base, const engine::FilterSpec& spec, std::string name);
  [[nodiscard]] haptic::AdoptionPort& port() noexcept { return mailbox_; }
  /// Releases a worker that waits at the port, with kCancelled; until allowPort().
  void closePort() { mailbox_.close(); }
  void allowPort();

  /// As DeviceLoop has them.
  void arm() { loop_.arm(); }
  void disarm() { loop_.disarm(); }
  void calibrate() { loop_.calibrate(); }
  [[nodiscard]] const DeviceSetup& deviceSetup() const noexcept { return loop_.setup(); }
  /// Uses the device so from now on: ends the loop and starts another, as setRate() does. Errors: those of start(), after which the
  /// device is used as before, or the loop is finished(); a scene that was given and is not stable so, likewise.
  [[nodiscard]] engine::Status setDeviceSetup(const DeviceSetup& setup);
  /// The words of the device (haptic::openDevice).
  [[nodiscard]] const std::string& deviceWords() const noexcept { return loop_.deviceWords(); }
  /// Uses another device from now on: lets the force fade and ends the loop as setRate() does, and starts another with that
  /// device, without force until its user arms it. Values of the scene that it does not hold are lowered, with a notice.
  /// Errors: those of openDevice and start(), after which the device is used as before, or the loop is finished().
  [[nodiscard]] engine::Status setDevice(const std::string& words);
  [[nodiscard]] DeviceChoices takeDeviceChoices() noexcept { return loop_.takeChoices(); }
  void setView(double azimuth_deg, double zoom) { loop_.setView(azimuth_deg, zoom); }
  /// At once; a device is open only while the scene lists sound.
  void setLoudness(Loudness loudness) noexcept { sound_.setLoudness(loudness); }
  /// What plays; null while the scene lists no sound, and where no audio device answered.
  [[nodiscard]] const SoundPlayer* soundPlayer() const noexcept { return sound_.player(); }
  [[nodiscard]] haptic::MouseStylus* mouse() noexcept { return loop_.mouse(); }
  /// Whether a headset's controller is the tip now, in place of the mouse.
  [[nodiscard]] bool controllerLeads() const noexcept { return loop_.controllerLeads(); }
  [[nodiscard]] const haptic::Device& device() const noexcept { return loop_.device(); }
  /// The newest tick.
  [[nodiscard]] haptic::LoopState state() noexcept { return loop_.loop().state(); }
  [[nodiscard]] const haptic::LoopTiming& timing() const noexcept { return loop_.loop().timing(); }
  [[nodiscard]] const haptic::RealTimeReport& realTime() const noexcept { return loop_.loop().realTime(); }
  [[nodiscard]] double rate() const noexcept { return loop_.rate(); }
  [[nodiscard]] double measuredRate() const noexcept { return loop_.measuredRate(); }
  /// Ends the loop as finish() does - the force fades to zero, a running stroke becomes a step - and starts
  /// another at this rate [Hz], 1000 .. 10000, from the history's state: about 10 ms, 30 with a force device.
  /// A force device must be armed again; a disarmed one stays disarmed. Timing figures restart at zero, and a
  /// simulated hand restarts its path. A running filter is cancelled, and results computed before must not be
  /// adopted afterwards: the journal no longer has their base. Errors: a rate out of range, or one at which
  /// the device is not stable with a scene that was given, with nothing changed (a fitted one is lowered); those of start(), after
  /// which it runs at the old rate, or is finished().
  [[nodiscard]] engine::Status setRate(double rate_hz);

  [[nodiscard]] std::vector<Notice> takeNotices() { return std::exchange(notices_, {}); }
  [[nodiscard]] EditLatency& latency() noexcept { return latency_; }

  [[nodiscard]] static engine::Version upright(const engine::Version& version) {
    return engine::upright(version);
  }

 private:
  LoopClient(engine::History history, FormOriginals originals, const haptic::Scene& scene,
             const LoopClientOptions& options, haptic::SessionSink* sink);
  // `device`: another one, by its words; empty: the same.
  [[nodiscard]] engine::Status startLoop(double rate_hz, const std::string& device = {});
  // Where no audio device answers, a notice.
  void hear();
  void endForAnother();
  /// Ends the loop and starts another with this scene; on errors with that before.
  [[nodiscard]] engine::Status startWith(const haptic::Scene& scene, const SceneFitting& fitting);
  // That a device which gave force has to be armed again.
  void noteDisarmed(const std::string& what);
  void takeTicks();
  void take(haptic::LoopEvent&& event);
  void restore(const engine::Version& upright_version);
  void sendQuestion();
  // Before the history moves: events, and the answer to a filter's result that was sent.
  void catchUp();
  // Polls while something is not answered, as long as a loop that runs needs to answer.
  template <class Open>
  void pollWhile(const Open& open);
  [[nodiscard]] bool strokeRuns() const noexcept;
  void keepStroke();
  // The paths of marking tools until an event become strokes.
  void endPath(const haptic::LoopEvent& event);

  FormOriginals originals_;
  engine::FieldForm sent_form_;  // over the field after all commands sent
  haptic::Scene scene_;
  haptic::Tool tool_ = haptic::Tool::kFeel;
  StepKeeper steps_;
  LoopSound sound_;
  DeviceLoop loop_;
  AdoptionMailbox mailbox_;
  EditLatency latency_;
  engine::Version field_;               // newest published
  haptic::LoopPlace place_;             // the loop's tick at that time
  std::deque<haptic::LoopEvent> held_;  // until the ticks before them are recorded
  std::uint64_t next_id_ = 1;           // of a command
  std::uint64_t restores_open_ = 0;     // requested, not answered
  bool offer_open_ = false;             // a filter's result was sent to the loop, and not answered
  StrokePath path_;                     // of the running stroke
  engine::Version path_base_;           // upright: the field before it
  std::vector<MarkStroke> mark_strokes_;
  std::vector<Notice> notices_;
};

}  // namespace fettle::app

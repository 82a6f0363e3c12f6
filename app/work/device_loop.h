#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/live/fitted_scene.h"
#include "app/sound/loudness.h"
#include "app/work/device_setup.h"
#include "engine/base/error.h"
#include "haptic/devices/device.h"
#include "haptic/devices/enumerate.h"
#include "haptic/devices/virtual/controller_stylus.h"
#include "haptic/devices/virtual/mouse_stylus.h"
#include "haptic/effects/stability.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/loop/timing.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// Something the user should read.
struct Notice {
  std::string what;
  std::string remedy;
  std::string several =
      {};  ///< in place of `what`, after a number, where it happens again: one line for all of them
  int times = 1;
  bool of_reading = false;  ///< about how the scan was read: shown with a button for the page of that
  bool passes = false;      ///< nothing is to be done about it: it goes by itself
  bool once = false;        ///< it is as it is: said in one start of the program only once
  std::optional<std::chrono::steady_clock::time_point> seen = {};  ///< since when it is on the screen
};

/// What went wrong and where, and what to do about it.
[[nodiscard]] Notice noticeOf(const engine::Error& error);

/// Adds a notice; one with Notice::several is counted where it stands already.
void addNotice(std::vector<Notice>& notices, Notice notice);

/// What becomes of a scene that a device starts with.
struct SceneFitting {
  /// It is fitted to field and device: for a mouse spring and depth follow the field's spacing, for a device on the desk all
  /// lengths the field's size (fittedScene). Off when the user gave the scene.
  bool fits = true;
  /// The last fit, also of another device: what of it is still in the scene is fitted again.
  std::optional<SceneFit> last = {};
  /// Values with which the device is not stable (haptic::stabilityProblem) are lowered to the largest stable
  /// ones, with a notice, as they are in a scene that is fitted; otherwise such a scene is refused.
  bool lowers = false;
  /// The last lowering, also for another device: `plain` before and `fitted` after it. It is undone for the next start.
  std::optional<SceneFit> lowering = {};
};

struct LoopClientOptions {
  std::string device = "mouse";  ///< a word of haptic::openDevice
  double rate_hz = 1000.0;
  SceneFitting fitting = {};
  Loudness loudness;         ///< of scenes with sound
  DeviceSetups setups = {};  ///< of the devices that are known
  /// Of a headset's controllers, which are then the tip as well where the device is the mouse; null: there are none.
  std::shared_ptr<haptic::ControllerLink> controllers = nullptr;
};

/// Where a headset's controllers may be the tip: beside the mouse. Another device stays it, and this is null: it gives forces, or
/// its user chose it. `device`: as LoopClientOptions::device.
[[nodiscard]] std::shared_ptr<haptic::ControllerLink> controllersBeside(const std::string& device);

/// Choices that were made by buttons of the device (haptic::StylusButtons): how often the next one was chosen.
struct DeviceChoices {
  std::uint64_t tools = 0;
  std::uint64_t tips = 0;
  std::uint64_t menus = 0;  ///< the tools around the tip
};

/// A device and its haptic loop: a new loop for each change of the rate. Arms devices without force
/// automatically. Threading: main.
class DeviceLoop {
 public:
  /// For fields of a grid.
  DeviceLoop(LoopClientOptions options, const engine::Grid& grid);

  /// Opens the device; a mouse's scene is fitted to the field here, one on the desk's at each start. Errors: those of haptic::openDevice.
  [[nodiscard]] engine::Status openDevice(haptic::Scene& scene);
  /// Starts device and loop at a rate from an upright field. A simulated hand restarts its path when it is
  /// not the first loop. Errors: a scene with which the device is not stable, those of HapticLoop::create and
  /// start; the previous loop can still be read then.
  struct Start {
    engine::Version field;
    engine::Version original;        ///< upright: what Scene::max_change is measured against
    haptic::Scene* scene = nullptr;  ///< fitted, and lowered to the stable values (SceneFitting)
    haptic::Tool tool = haptic::Tool::kFeel;
    bool records = false;  ///< every tick's input (HapticLoop::pollRecord)
    double rate_hz = 1000.0;
    std::shared_ptr<haptic::SoundRing> sounds;  ///< see haptic::PreparedScene
  };
  [[nodiscard]] engine::Status start(const Start& start, std::vector<Notice>& notices);
  /// The same with another device, by the words of haptic::openDevice, after stop(): its scene is lowered to what it holds
  /// stably, with a notice. Errors: those of openDevice() and start(); the device before is there then, as after stop().
  [[nodiscard]] engine::Status startOn(const std::string& device, const Start& start,
                                       std::vector<Notice>& notices);
  /// From the next start on.
  void setFitting(const SceneFitting& fitting) { options_.fitting = fitting; }
  [[nodiscard]] const SceneFitting& fitting() const noexcept { return options_.fitting; }
  /// Whether values with which a device is not stable are lowered at a start (SceneFitting).
  [[nodiscard]] bool lowers() const noexcept { return options_.fitting.fits || options_.fitting.lowers; }
  /// A scene as its user has it: without the lowering, with what was changed since.
  [[nodiscard]] haptic::Scene unlowered(const haptic::Scene& scene) const;
  /// Whether another scene of the user is felt at another scale than that of the start.
  [[nodiscard]] bool movesOtherwise(const haptic::Scene& scene) const;
  /// feltProblem() of a scene that was not fitted, at the scale of the start.
  [[nodiscard]] std::optional<FeltProblem> feltProblem(const haptic::Scene& scene) const;
  /// The words of the device.
  [[nodiscard]] const std::string& deviceWords() const noexcept { return options_.device; }
  /// Ends the loop with a last tick of zero force; its events and records can still be polled.
  void stop();
  [[nodiscard]] bool running() const noexcept { return running_; }

  /// Sends a command as soon as the ring has room, in order.
  void send(haptic::LoopCommand&& command);
  /// How far the workspace of a device on the desk must move with a field that is restored under another form, upright
  /// [mm of the field]: the hand stays above its highest place.
  [[nodiscard]] double liftTo(const engine::Version& field, const haptic::Scene& scene);
  /// Sends waiting commands, arms automatically, measures the rate, adds notices of faults. Cheap; to be
  /// called often.
  void poll(std::vector<Notice>& notices);

  /// Those that poll() has seen since the last call.
  [[nodiscard]] DeviceChoices takeChoices() noexcept { return std::exchange(choices_, {}); }

  /// Allows force, as soon as the device is ready and the commanded force small (ForceGuard::arm). A device
  /// without force, and a simulated hand, are armed automatically when they are connected and after a fault.
  void arm();
  /// No force from the next tick on, before all commands sent earlier; only arm() arms again.
  void disarm();
  /// Whether disarm() was called since the last arm().
  [[nodiscard]] bool disarmed() const noexcept { return disarmed_; }
  /// Sets disarmed() without a command to the loop.
  void setDisarmed(bool disarmed) noexcept { disarmed_ = disarmed; }
  /// Only for a device without force: a force device is armed by its user.
  [[nodiscard]] bool armsItself() const;
  /// Whether a disarmed force has faded and everything sent has been taken.
  [[nodiscard]] bool atRest();
  void calibrate() { device_->calibrate(); }
  /// How the device is used; another one from the next start() on.
  [[nodiscard]] const DeviceSetup& setup() const noexcept { return setup_; }
  void setSetup(const DeviceSetup& setup) { setup_ = setup; }
  /// The view turned or zoomed: "away" on the desk stays "into the picture". No effect for devices in field
  /// coordinates.
  void setView(double azimuth_deg, double zoom);

  /// The problem of a scene with which the device is not stable at a rate; empty for one without force.
  [[nodiscard]] std::optional<haptic::StabilityProblem> stabilityProblem(const haptic::Scene& scene,
                                                                         double rate_hz) const;
  /// Largest stiffness [N/mm] that the device holds with the rest of the scene; none when it gives no force.
  [[nodiscard]] std::optional<double> largestStiffness(const haptic::Scene& scene) const;

  [[nodiscard]] haptic::MouseStylus* mouse() noexcept { return mouse_; }
  /// Whether a headset's controller is the tip now.
  [[nodiscard]] bool controllerLeads() const noexcept {
    return options_.controllers && options_.controllers->leads.load(std::memory_order_relaxed);
  }
  [[nodiscard]] const haptic::Device& device() const noexcept { return *device_; }
  [[nodiscard]] haptic::HapticLoop& loop() noexcept { return *loop_; }
  [[nodiscard]] const haptic::HapticLoop& loop() const noexcept { return *loop_; }
  [[nodiscard]] double rate() const noexcept { return options_.rate_hz; }
  /// Ticks per second, over about the last second.
  [[nodiscard]] double measuredRate() const noexcept { return rate_meter_.hz; }

 private:
  struct RateMeter {
    std::uint64_t tick = 0;
    std::int64_t time_ns = 0;
    double hz = 0.0;
    void measure(const haptic::LoopState& state);
  };
  [[nodiscard]] engine::Status startLoop(const Start& start, std::vector<Notice>& notices);
  /// Of the whole field, or that at which a scene of the user is stable.
  [[nodiscard]] double scaleFor(const haptic::Scene& scene) const;
  /// `fitted`: of the scene as it was before a fit. What the user changed since the last fit stays.
  template <class Fitted>
  void fit(haptic::Scene& scene, Fitted fitted);
  void undoLowering(haptic::Scene& scene);
  [[nodiscard]] bool simulatesHand() const { return driver_ != nullptr && driver_->simulates_hand; }
  void armByItself(const haptic::LoopState& state);
  void watch(const haptic::LoopState& state, std::vector<Notice>& notices);

  LoopClientOptions options_;
  const haptic::KnownDriver* driver_;  // null for a path
  engine::Grid grid_;
  std::unique_ptr<haptic::Device> device_;
  DeviceSetup setup_;
  haptic::MouseStylus* mouse_ = nullptr;  // device_, or the one in it
  std::unique_ptr<haptic::HapticLoop> loop_;
  bool running_ = false;
  std::vector<haptic::LoopCommand> unsent_;  // when the ring was full
  bool disarmed_ = false;                    // by the user, who did not arm since
  haptic::LoopState seen_;
  DeviceChoices choices_;
  double scale_at_start_ = 1.0;  // the largest scale: see setView()
  double top_mm_ = 0.0;          // of the field, as felt, that the workspace was moved to
  double view_azimuth_deg_ = 0.0, view_zoom_ = 1.0;
  RateMeter rate_meter_;
  std::int64_t armed_try_ns_ = 0;
};

}  // namespace fettle::app

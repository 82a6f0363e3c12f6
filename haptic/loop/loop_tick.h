#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "haptic/base/latest_slot.h"
#include "haptic/base/rings.h"
#include "haptic/devices/device.h"
#include "haptic/loop/edits_since.h"
#include "haptic/loop/input_motion.h"
#include "haptic/loop/messages.h"
#include "haptic/loop/running_stroke.h"
#include "haptic/loop/stylus_buttons.h"
#include "haptic/loop/tile_prefetcher.h"
#include "haptic/safety/safety.h"

namespace fettle::haptic {

/// When an editing tool acts.
enum class ToolSwitch : std::uint8_t {
  kButton,  ///< while the primary button is held
  kAlways,  ///< whenever in contact: devices without a button
};

/// When an editing tool may act at all.
enum class EditRule : std::uint8_t {
  kAnytime,
  /// Only while the guard passes force to the device (Ramping, Active): a hand that feels no surface - not
  /// armed yet, or after a Fault - would press through it. For force devices.
  kWhileForceIsGiven,
};

struct LoopOptions {
  Tool tool = Tool::kFeel;
  ToolSwitch tool_switch = ToolSwitch::kButton;
  EditRule edit_rule = EditRule::kAnytime;
  /// Buttons that hold the clutch (see Workspace); 0 = none.
  std::uint32_t clutch_buttons = kSecondaryButton;
  /// Buttons that open a menu (see StylusButtons); 0 = none.
  std::uint32_t menu_buttons = 0;
  Workspace workspace;  ///< ignored by devices whose positions are in the field already
  SafetyLimits limits;
  /// Ticks between two publications of edits, which an edit waits before a frame can show it. Each costs the loop the copy of a tile
  /// that the next edit makes, some 5 us: 4 ms of waiting are worth that at 1 kHz, 1 ms would not be.
  static constexpr std::uint32_t kPublishTicks = 4;
  std::uint32_t publish_ticks = kPublishTicks;
  /// Ticks without contact that end a stroke although the tool is still switched on.
  std::uint32_t stroke_gap_ticks = 100;
  std::size_t command_capacity = 256;  ///< power of two
  std::size_t event_capacity = 256;    ///< power of two, >= 8
  std::size_t record_capacity = 0;     ///< ticks, power of two; 0 = ticks are not recorded
};

/// The two rings and the slot between the loop and the main side. The loop never waits on any of them.
///
/// Disarming does not use the ring of commands: it cannot find a full ring, does not wait behind a command
/// whose answer has no place yet, and takes effect with the next tick. It overtakes commands sent before it,
/// so a command to arm carries the number of disarms at its time, and is ignored when that number has changed
/// by the time the loop reads it.
struct LoopChannels {
  explicit LoopChannels(const LoopOptions& options)
      : commands(options.command_capacity),
        events(options.event_capacity),
        records(std::max<std::size_t>(options.record_capacity, 1)) {}

  /// Main thread, wait-free, never refused: no force from the next tick on (ForceGuard::disarm), whatever was
  /// commanded before.
  void disarm() noexcept {
    // Release: earlier writes are visible to the tick that removes the force.
    disarms.fetch_add(1, std::memory_order_release);
  }
  /// Main thread: a command to arm, to be sent as any command; ignored once disarm() is called after it.
  [[nodiscard]] LoopCommand armCommand() const noexcept {
    LoopCommand command;
    command.kind = CommandKind::kArm;
    command.id = disarms.load(std::memory_order_relaxed);  // only this thread writes it
    return command;
  }

  SpscRing<LoopCommand> commands;
  SpscRing<LoopEvent> events;
  SpscRing<TickRecord> records;  ///< not used with a record_capacity of 0
  LatestSlot<LoopState> state;
  std::atomic<std::uint64_t> disarms{0};
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// One tick of the live loop, without the thread and the clock, so that tests and benchmarks run the same
/// code:
///
///   commands --> device.read --> workspace --> Tick::run (the tick of replay) --> ForceGuard
///            --> device.write, device.show --> sound --> dirty rectangle --> publish (every n ticks) --> state slot
///
/// Edits. The loop keeps one dirty rectangle. Every publish_ticks ticks it sends {rectangle, snapshot} if the
/// field's root changed since. A snapshot is O(1); its later cost is one tile copy (17 KB, about 1 us) for
/// each tile written again after it: sending the samples would cost as much and the receiver would have to
/// assemble tiles that exist already. A full ring loses nothing: the rectangle grows until there is room,
/// counted, and writes continue in place, so that a stalled reader holds at most the ring's versions.
///
/// Adoption of a job's result during a stroke, in a bounded tick:
///   1. main asks for a snapshot S and gets it within a tick; the loop starts a list of tiles edited since;
///   2. a worker makes the new version M: S with the result's tiles inserted, O(changed tiles),
///      off the loop (mergeResult in adopt_filtered.h);
///   3. the loop takes over M's root, O(1), and puts back the tiles of its list whose memory is no longer
///      S's: at most EditsSince::kMostTiles, half a microsecond each (measured: 29 us for 64). Nothing else can differ,
///      so nothing is lost.
/// Because S is requested immediately before step 2 and not when the filter starts, the list holds the edits
/// of some milliseconds (a few tiles), however long the filter took. The answer is kAdoptRefused, with
/// nothing changed, when S is not the newest snapshot, the list overflowed, or the pool is empty; the request
/// can always be repeated. changedTiles(M, event.version) gives the tiles that were carried over: the worker
/// filters these again.
///
/// Restoring (undo) takes exactly the requested version and returns the state before it, the edits of the
/// running stroke included; the stroke continues as a new one.
///
/// A command that has an answer is left in its ring until the answer has a place.
///
/// A field in a store (engine/field/tile_store.h). A tick whose samples are still on the disk runs without
/// input: contact ends, the guard lets the force fade, and ramps it when the surface is available again.
/// Counted, and recorded as a tick without input, so that a replay does the same.
///
/// Time. A tick receives seconds since the first one, so that exactly its input is recorded.
///
/// Threading: constructed on the main side (allocates); run() and stop() on one thread. run(): noexcept,
/// wait-free, bounded (kMostCommands commands, of which one that swaps versions), no allocation, no lock, no
/// system call except the device's wake-up.
class LoopTick {
 public:
  static constexpr int kMostCommands = 8;

  /// Starts from `start`, upright (the scene's inversion is applied here). `device` and `channels` outlive
  /// this; `options.limits` in range. `tile_prefetcher`: for a field in a store, outlives this; null: every
  /// sample is in memory.
  LoopTick(std::unique_ptr<PreparedScene> scene, engine::Version start, Device& device,
           LoopChannels& channels, const LoopOptions& options, TilePrefetcher* tile_prefetcher = nullptr);

  /// One tick. `now_ns`: engine::steadyNs() at wake-up; `since_ns`: since the previous tick's.
  void run(std::int64_t now_ns, std::int64_t since_ns) noexcept;

  /// The last tick: zero force, the rest of the edits published if the ring has room.
  void stop() noexcept;

  /// The scene in effect; for tests on the loop's own thread.
  [[nodiscard]] PreparedScene& scene() noexcept { return *scene_; }
  [[nodiscard]] const ForceGuard& guard() const noexcept { return guard_; }
  [[nodiscard]] const LoopState& state() const noexcept { return state_; }

 private:
  void takeDisarm(std::uint64_t times) noexcept;
  void takeCommands() noexcept;
  void take(LoopCommand& command) noexcept;
  void swapScene(LoopCommand& command) noexcept;
  void adopt(LoopCommand& command) noexcept;
  void restore(LoopCommand& command) noexcept;
  [[nodiscard]] LoopEvent eventNow(EventKind kind, std::uint64_t id) noexcept;
  void send(LoopEvent&& event) noexcept;
  [[nodiscard]] engine::SampleRect wholeField() const noexcept;

  void noteEdit(const ForceSample& force, Tool tool) noexcept;
  void publish() noexcept;

  [[nodiscard]] Tool toolInEffect(const DeviceInput& input, double age_s) const noexcept;
  [[nodiscard]] std::optional<glm::dvec3> stylusAxis(const DeviceInput& input) const noexcept;
  [[nodiscard]] Touched touched(const ForceSample& force, std::int64_t now_ns) const noexcept;
  void record(const StrokeSample& input, const ForceSample& force, std::int64_t since_ns) noexcept;
  void sound(std::int64_t since_ns) noexcept;
  [[nodiscard]] bool samplesArePrefetched(const glm::dvec3& tip_mm) noexcept;

  // Places of the event ring that edits leave free for answers.
  static constexpr std::size_t kAnswerPlaces = 2;

  std::unique_ptr<PreparedScene> scene_;
  Device& device_;
  LoopChannels& channels_;
  LoopOptions options_;
  ForceGuard guard_;
  Workspace workspace_;
  StylusButtons buttons_;
  Tool tool_;
  bool tool_replaced_ = false;  // in this tick, by another during a stroke: none acts, which ends the stroke
  LoopCommand waiting_;         // popped, but its answer has no place yet
  bool has_waiting_ = false;
  std::uint64_t disarms_ = 0;  // of LoopChannels::disarms, done
  Disturbance disturbance_ = Disturbance::kNone;
  TilePrefetcher* tile_prefetcher_;
  bool was_prefetched_ = true;

  engine::Version published_;  // of the newest event; moved into the next one
  engine::SampleRect dirty_;
  std::uint32_t since_publish_ = 0;
  std::uint32_t merged_ = 0;

  RunningStroke stroke_;
  Tool edited_with_ = Tool::kFeel;
  EditsSince since_snapshot_;

  std::int64_t first_ns_ = -1;        // wake-up of the first tick: the session's time 0
  std::uint64_t refused_before_ = 0;  // by previous scenes
  InputMotion motion_;
  bool clutched_ = false;
  LoopState state_;
};

}  // namespace fettle::haptic

#include "haptic/loop/loop_player.h"

#include <cmath>
#include <utility>

#include "engine/field/node_pool.h"
#include "haptic/base/rt_thread.h"

namespace fettle::haptic {

namespace {

// Free tiles and nodes before each tick: more than the largest brush uses in one tick.
constexpr std::size_t kTiles = 64;
constexpr std::size_t kNodes = 256;

LoopOptions optionsOfAPlayer() {
  LoopOptions options;
  options.edit_rule = EditRule::kAnytime;  // what was recorded is the tool that was in effect
  return options;
}

}  // namespace

// The device: returns the given input.
class LoopPlayer::Input final : public Device {
 public:
  Input() {
    profile_.name = "recorded ticks";
    profile_.space = DeviceSpace::kField;
  }
  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override { return input; }
  void write(const glm::dvec3&) noexcept override {}
  [[nodiscard]] engine::Status start() override { return {}; }
  void stop() noexcept override {}

  DeviceInput input;

 private:
  DeviceProfile profile_;
};

LoopPlayer::LoopPlayer(const engine::Version& start, const engine::Version& original, const Scene& scene)
    : memory_(start.memory()),
      input_(std::make_unique<Input>()),
      options_(optionsOfAPlayer()),
      channels_(options_),
      loop_(std::make_unique<PreparedScene>(scene, original), start, *input_, channels_, options_) {}

LoopPlayer::~LoopPlayer() = default;

engine::Result<std::unique_ptr<LoopPlayer>> LoopPlayer::create(const engine::Version& start,
                                                               const engine::Version& original,
                                                               const Scene& scene) {
  if (auto problem = sceneProblem(scene)) return engine::inputError(*problem, "scene");
  if (start.grid().width != original.grid().width || start.grid().height != original.grid().height)
    return engine::inputError("the original field has another size than the field", "replay",
                              "give the scan that the field was made from");
  return std::unique_ptr<LoopPlayer>(new LoopPlayer(start, original, scene));
}

engine::Status LoopPlayer::run(const StrokeSample& input) {
  // What was published is not needed here: it is released, so that the ring never fills.
  for (LoopEvent event; channels_.events.pop(event);) event = {};
  if (!memory_->tiles.reserve(kTiles) || !memory_->nodes.reserve(kNodes))
    return engine::failure("memory for the edited tiles could not be allocated", "replay",
                           "close other programs");
  DeviceInput& read = input_->input;
  ++read.sequence;
  // The loop derives the seconds of a tick from its clock: the same number results.
  read.arrival_ns = std::llround(input.t * 1e9);
  read.position_mm = input.tip_mm;
  read.tool = input.tool;
  read.link = LinkState::kConnected;
  const DenormalScope as_in_the_loop;
  loop_.run(read.arrival_ns, 0);
  return {};
}

engine::Result<LoopEvent> LoopPlayer::run(const StrokeSample& input, LoopCommand&& command) {
  if (!channels_.commands.push(std::move(command)))
    return engine::failure("the ring of commands is full", "replay");
  if (auto done = run(input); !done) return tl::unexpected(done.error());
  LoopEvent answer;
  if (!channels_.events.pop(answer)) return engine::failure("a command without an answer", "replay");
  return answer;
}

std::uint64_t LoopPlayer::ticks() const noexcept {
  return loop_.state().tick;
}

engine::Version LoopPlayer::field() const {
  return loop_.scene().field.snapshot();
}

}  // namespace fettle::haptic

#include "engine/filter/work_sample.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <tbb/info.h>

#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/field/node_pool.h"
#include "engine/field/tile.h"
#include "engine/field/version.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine {

namespace {

using Place = std::pair<std::int32_t, std::int32_t>;

Place placeOf(const TileRect& block) {
  return {block.row0, block.column0};
}

// Works out chosen blocks alone, and measures them.
class Sampler final : public FilterWork {
 public:
  explicit Sampler(std::set<Place> chosen) : chosen_(std::move(chosen)) {}

  Result<State> begin(const Version& input) override { return State{0, input}; }
  Status beginPass(const State&) override { return {}; }
  void addMade(std::vector<NewTile>&) override {}

  bool isDone(const TileRect& block) override {
    const std::lock_guard lock(mutex_);
    blocks_.push_back(block);
    if (!chosen_.contains(placeOf(block))) return true;
    if (worked_.empty() && !begun_) begun_ = Stopwatch();
    return false;
  }

  void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) override {
    const std::lock_guard lock(mutex_);
    Share& share = shares_[std::this_thread::get_id()];
    ++share.blocks;
    share.seconds = begun_ ? begun_->seconds() : 0.0;
    worked_.push_back(block);
    changed_ += made.size() - first;
    tiles_ += static_cast<std::size_t>(block.column1 - block.column0) *
              static_cast<std::size_t>(block.row1 - block.row0);
  }

  [[nodiscard]] const std::vector<TileRect>& blocks() const noexcept { return blocks_; }
  [[nodiscard]] const std::vector<TileRect>& worked() const noexcept { return worked_; }
  [[nodiscard]] std::size_t changed() const noexcept { return changed_; }
  [[nodiscard]] std::size_t tiles() const noexcept { return tiles_; }
  // Of one block with all threads at work: each counts to its own last block, so that what another does alone at the end
  // does not.
  [[nodiscard]] double secondsPerBlock() const {
    double rate = 0.0;
    for (const auto& [thread, share] : shares_)
      if (share.seconds > 0.0) rate += share.blocks / share.seconds;
    return rate > 0.0 ? 1.0 / rate : 0.0;
  }
  [[nodiscard]] std::size_t threads() const noexcept { return shares_.size(); }
  // From the first block to the end of the last one.
  [[nodiscard]] double seconds() const {
    double most = 0.0;
    for (const auto& [thread, share] : shares_) most = std::max(most, share.seconds);
    return most;
  }

 private:
  std::set<Place> chosen_;
  std::mutex mutex_;  // over all below; one block takes milliseconds
  std::vector<TileRect> blocks_, worked_;
  struct Share {
    double blocks = 0.0, seconds = 0.0;  // to the end of its last one
  };
  std::map<std::thread::id, Share> shares_;
  std::optional<Stopwatch> begun_;  // the first block
  std::size_t changed_ = 0, tiles_ = 0;
};

}  // namespace

Result<std::optional<WorkSample>> sampleWork(const FilterSpec& spec, const ApplyFilter& apply,
                                             const SampleOptions& options, JobControl& job) {
  if (!filterOf(spec.kind).sampled) return std::nullopt;
  FilterSpec once = spec;
  once.passes = 1;
  const int cores = tbb::info::default_concurrency();
  const int threads = spec.threads == 0 ? cores : std::min(spec.threads, cores);
  JobControl own = JobControl::partOf(job);  // whose stages are not shown
  Sampler all({});
  const Stopwatch empty_watch;
  const auto seen = apply(once, all, own);
  if (!seen) return tl::unexpected(seen.error());
  const double empty = empty_watch.seconds();
  std::vector<TileRect> blocks = all.blocks();
  const auto count = static_cast<double>(blocks.size());
  if (blocks.empty() || threads / (count * spec.passes) > options.most_share) return std::nullopt;
  std::ranges::sort(blocks, {}, placeOf);
  std::shuffle(blocks.begin(), blocks.end(), std::mt19937(1));

  const ResidentMemory before = residentMemory();
  const bool peak_known = resetPeak();
  std::size_t wanted = std::min(blocks.size(), static_cast<std::size_t>(threads));
  WorkSample sample;
  // Held, so that each block takes memory that is new, as in a whole field.
  std::vector<Version> held;
  std::uint64_t made = 0;
  const std::uint64_t free = seen->field.memory()->bulk().freeObjects() * sizeof(Tile);
  for (bool enough = false; !enough;) {
    std::set<Place> chosen;
    for (std::size_t i = 0; i < wanted; ++i) chosen.insert(placeOf(blocks[i]));
    Sampler sampler(std::move(chosen));
    const Stopwatch watch;
    auto filtered = apply(once, sampler, own);
    const double whole = watch.seconds();
    if (!filtered) return tl::unexpected(filtered.error());
    // On a device all squares of a batch take their time together.
    const double block = options.on_device ? whole / static_cast<double>(wanted) : sampler.secondsPerBlock();
    // Putting the tiles together, in proportion to their number.
    const double after = options.on_device
                             ? 0.0
                             : std::max(0.0, whole - empty - sampler.seconds()) / static_cast<double>(wanted);
    sample.seconds = (empty + (block + after) * count) * spec.passes;
    sample.changed_share =
        sampler.tiles() == 0 ? 0.0
                             : static_cast<double>(sampler.changed()) / static_cast<double>(sampler.tiles());
    sample.worked = filtered->field;
    held.push_back(std::move(filtered->field));
    sample.block = sampler.worked().empty() ? blocks[0] : sampler.worked()[0];
    const std::uint64_t peak = peak_known ? residentMemory().peak : residentMemory().now;
    made += sampler.changed() * sizeof(Tile);
    const std::uint64_t explained = before.now + (made > free ? made - free : 0);
    if (peak > explained) {
      // On a busy machine one thread may have worked out the blocks of all; in a whole field each comes to its turn.
      const std::uint64_t at_work = std::max<std::uint64_t>(1, sampler.threads());
      const std::uint64_t of_all =
          options.on_device ? at_work : std::max<std::uint64_t>(at_work, static_cast<std::uint64_t>(threads));
      sample.scratch_bytes = std::max(sample.scratch_bytes, (peak - explained) * of_all / at_work);
    }
    const std::size_t before_now = wanted;
    const double affordable = block > 0.0 ? options.seconds / block : 16.0 * threads;
    // A quarter of the field is a good sample of it.
    wanted = static_cast<std::size_t>(std::min({affordable, count / 4.0, 4096.0}));
    enough = wanted <= 2 * before_now;
  }
  return sample;
}

}  // namespace fettle::engine

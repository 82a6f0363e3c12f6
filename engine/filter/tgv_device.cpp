#include "engine/filter/tgv_device.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <iterator>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/filter/block_pass.h"
#include "engine/filter/filter_work.h"
#include "engine/filter/tgv_schedule.h"

namespace fettle::engine {

namespace {

// A job is cancelled without a signal: waits look at it so often.
constexpr std::chrono::milliseconds kLook{20};

// A square on its way: prepared, stepped, written.
struct SquareOnItsWay {
  SquareOnItsWay(double noise, CpuLevel level) : square(noise, level) {}
  TgvSquare square;
  BlockScratch scratch;
  Block block;
  TileRect tiles{};
};

// One pass. Workers prepare squares and write those that are stepped; one thread drives the device.
class OnDevice {
 public:
  OnDevice(const Version& input, const Version& original, const FilterSpec& spec, TgvDevice& device,
           FilterWork* work, JobControl& job)
      : device_(device),
        work_(work),
        job_(job),
        noise_(spec.range_sigma),
        blocks_(input, original, spec, tgv::kHalo, tgv::kHalo, bestCpuLevel()) {
    constexpr std::int32_t kTiles = tgv::kSide / kTileSide;
    const FieldReader& reader = blocks_.reader();
    for (std::int32_t r = 0; r < reader.tileRows(); r += kTiles)
      for (std::int32_t c = 0; c < reader.tileColumns(); c += kTiles) {
        const TileRect square{c, r, std::min(c + kTiles, reader.tileColumns()),
                              std::min(r + kTiles, reader.tileRows())};
        if (work_ != nullptr && work_->isDone(square))
          job_.advance(static_cast<std::uint64_t>(blocks_.samplesOf(square)));
        else
          squares_.push_back(square);
      }
  }

  Result<PassResult> run() {
    const auto workers = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    workers_ = workers;
    most_ = 3 * device_.mostTogether() + workers;
    std::vector<std::vector<NewTile>> made(workers);
    {
      // Ends with the workers, in an exception as well.
      const std::jthread driver([this] { drive(); });
      const Stop stop(*this);
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, workers, 1),
          [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) work(made[i]);
          },
          tbb::simple_partitioner());
    }
    if (thrown_) std::rethrow_exception(thrown_);
    if (job_.cancelled()) return cancelled();
    if (!failed_) return tl::unexpected(failed_.error());
    std::vector<NewTile> tiles;
    for (std::vector<NewTile>& some : made)
      tiles.insert(tiles.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
    if (work_ != nullptr) work_->addMade(tiles);
    return blocks_.finish(std::move(tiles));
  }

 private:
  // At the end of a scope no thread waits for another any more.
  class Stop {
   public:
    explicit Stop(OnDevice& pass) : pass_(pass) {}
    Stop(const Stop&) = delete;
    Stop& operator=(const Stop&) = delete;
    ~Stop() { pass_.stop(); }

   private:
    OnDevice& pass_;
  };

  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }

  void work(std::vector<NewTile>& made) try {
    for (;;) {
      std::unique_lock lock(mutex_);
      while (!stopped_ && stepped_.empty() && !canBegin() && !allWritten()) {
        changed_.wait_for(lock, kLook);
        stopped_ |= job_.cancelled();
      }
      if (stopped_ || job_.cancelled()) return;
      if (!stepped_.empty()) {
        SquareOnItsWay* one = stepped_.front();
        stepped_.pop_front();
        lock.unlock();
        if (!write(*one, made)) return stop();
      } else if (canBegin()) {
        const TileRect tiles = squares_[next_++];
        SquareOnItsWay* one = take();
        lock.unlock();
        begin(*one, tiles);
      } else {
        return;
      }
    }
  } catch (...) {
    stop();
    throw;
  }

  [[nodiscard]] bool canBegin() const noexcept {
    return next_ < squares_.size() && (!free_.empty() || all_.size() < most_);
  }
  [[nodiscard]] bool allWritten() const noexcept {
    return next_ == squares_.size() && free_.size() == all_.size();
  }

  SquareOnItsWay* take() {
    if (free_.empty()) {
      all_.push_back(std::make_unique<SquareOnItsWay>(noise_, blocks_.level()));
      return all_.back().get();
    }
    SquareOnItsWay* one = free_.back();
    free_.pop_back();
    return one;
  }

  void begin(SquareOnItsWay& one, const TileRect& tiles) {
    const bool steps = !blocks_.toChange(tiles).empty();
    if (steps) {
      one.tiles = tiles;
      one.block = blocks_.gather(tiles, one.scratch);
      one.square.prepare(one.block);
    } else {
      std::vector<NewTile> none;
      if (work_ != nullptr) work_->done(tiles, none, 0);
      job_.advance(static_cast<std::uint64_t>(blocks_.samplesOf(tiles)));
    }
    const std::lock_guard lock(mutex_);
    if (steps)
      ready_.push_back(&one);
    else
      free_.push_back(&one);
    changed_.notify_all();
  }

  bool write(SquareOnItsWay& one, std::vector<NewTile>& made) {
    one.square.write(one.block);
    const std::size_t first = made.size();
    if (!blocks_.merge(one.tiles, blocks_.reader().sign(), 0, one.scratch, made)) return false;
    if (work_ != nullptr) work_->done(one.tiles, made, first);
    job_.advance(static_cast<std::uint64_t>(blocks_.samplesOf(one.tiles)));
    const std::lock_guard lock(mutex_);
    free_.push_back(&one);
    changed_.notify_all();
    return true;
  }

  // Of squares that are ready those to start now. A full batch beside the one under way, so that the device does not
  // wait for its samples; else whatever is there.
  std::vector<SquareOnItsWay*> nextBatch() {
    std::unique_lock lock(mutex_);
    while (!stopped_ && device_.underWay() == 0 && ready_.empty()) {
      changed_.wait_for(lock, kLook);
      stopped_ |= job_.cancelled();
    }
    std::vector<SquareOnItsWay*> batch;
    const std::size_t most = device_.mostTogether();
    most_ = std::max(most_, 3 * most + workers_);
    const std::size_t fewest = device_.underWay() == 0 ? 1 : most;
    if (stopped_ || device_.underWay() == TgvDevice::kMostBatches || ready_.size() < fewest) return batch;
    while (!ready_.empty() && batch.size() < most) {
      batch.push_back(ready_.front());
      ready_.pop_front();
    }
    return batch;
  }

  [[nodiscard]] bool stopped() {
    const std::lock_guard lock(mutex_);
    return stopped_ |= job_.cancelled();
  }

  void drive() {
    try {
      std::vector<TgvSquare*> squares;
      while (!stopped()) {
        const std::vector<SquareOnItsWay*> batch = nextBatch();
        squares.clear();
        for (SquareOnItsWay* one : batch) squares.push_back(&one->square);
        Status status;
        if (!squares.empty()) {
          status = device_.start(squares);
          squares.clear();
        } else if (device_.underWay() > 0) {
          status = device_.proceed(squares);
        }
        if (!status) {
          failed_ = std::move(status);
          break;
        }
        pass(squares);
      }
    } catch (...) {
      thrown_ = std::current_exception();
    }
    device_.drop();
    stop();
  }

  // On to the workers.
  void pass(const std::vector<TgvSquare*>& finished) {
    const std::lock_guard lock(mutex_);
    for (const std::unique_ptr<SquareOnItsWay>& one : all_)
      if (std::ranges::find(finished, &one->square) != finished.end()) stepped_.push_back(one.get());
    if (!finished.empty()) changed_.notify_all();
  }

  TgvDevice& device_;
  FilterWork* work_;  // may be null
  JobControl& job_;
  double noise_;
  BlockPass blocks_;
  std::vector<TileRect> squares_;
  std::size_t workers_ = 0;

  // Of the driver, read when it has ended.
  Status failed_;
  std::exception_ptr thrown_;

  std::mutex mutex_;  // over all below
  std::condition_variable changed_;
  std::size_t next_ = 0;  // of squares_
  std::size_t most_ = 0;  // on their way
  std::vector<std::unique_ptr<SquareOnItsWay>> all_;
  std::vector<SquareOnItsWay*> free_;
  std::deque<SquareOnItsWay*> ready_, stepped_;
  bool stopped_ = false;
};

}  // namespace

Result<PassResult> tgvPassOnDevice(const Version& input, const Version& original, const FilterSpec& spec,
                                   TgvDevice& device, FilterWork* work, JobControl& job) {
  return OnDevice(input, original, spec, device, work, job).run();
}

}  // namespace fettle::engine

#include "engine/resume/kept_work.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "engine/base/thread_priority.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"

namespace fettle::engine {

namespace {

// Of the whole time, writing takes at most one part of so many.
constexpr double kParts = 20.0;

std::string whatDiffers(const std::string& word) {
  if (word == "revision") return "made by another version of fettle";
  if (word == "filter") return "of another filter or other numbers of it";
  if (word == "compute") return "made on another processor or graphics device";
  if (word == "original") return "for another original";
  if (word == "lines") return "for other edge lines";
  return "of another scan, or of other marks on it";
}

}  // namespace

KeptWork::KeptWork(KeepOptions options, const WorkIdentity& identity, const Version& input)
    : options_(std::move(options)),
      identity_(identity.text()),
      input_(input),
      tile_columns_(input.reader().tileColumns()),
      tile_rows_(input.reader().tileRows()),
      rounds_(roundsOf(options_.path), identity_) {
  start_ = {0, input};
}

Result<std::unique_ptr<KeptWork>> KeptWork::open(KeepOptions options, const WorkIdentity& identity,
                                                 const Version& input) {
  const auto there = WorkFile::look(options.path);
  if (!there) return tl::unexpected(there.error());
  if (there->there)
    if (const std::string word = identity.differsIn(there->identity); !word.empty())
      return inputError(fmt::format("the kept work is {}", whatDiffers(word)), options.path,
                        "give the same command as before, or delete the file and its .rounds to begin from "
                        "the beginning");
  std::unique_ptr<KeptWork> kept(new KeptWork(std::move(options), identity, input));
  if (there->bytes > 0)
    if (Status read = kept->read(); !read) return tl::unexpected(read.error());
  if (!kept->file_.isOpen()) {
    auto file = WorkFile::create(kept->options_.path, kept->identity_, 0, {});
    if (!file) return tl::unexpected(file.error());
    kept->file_ = *std::move(file);
  }
  kept->most_bytes_ = kept->file_.bytes();
  kept->writer_ = std::thread([work = kept.get()] {
    takeNormalPriority();
    work->writeRegularly();
  });
  return kept;
}

// Takes back what the file holds. What does not fit the field is as good as damaged.
Status KeptWork::read() {
  auto taken =
      WorkFile::open(options_.path, [this](std::int32_t column, std::int32_t row, const float* samples) {
        return restored(column, row, samples);
      });
  if (!taken) return tl::unexpected(taken.error());
  const WorkFile::Content& content = taken->content;
  if (!content.there) {
    damaged_ = content.bytes;
    return {};
  }
  if (content.identity != identity_)
    return inputError("another process works on this output", options_.path,
                      "wait for it, or name another output");
  damaged_ = content.bytes - content.whole;
  LiveField live(input_, Growth::kAllowed);
  for (NewTile& t : taken->tiles)
    if (!live.replaceTile(t.column, t.row, std::move(t.tile)))
      return failure("memory for the kept work could not be had", options_.path);
  start_ = {content.passes, live.snapshot()};
  done_before_.assign(static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows_), false);
  for (const TileRect& b : taken->pass.blocks)
    for (std::int32_t r = std::max(b.row0, 0); r < std::min(b.row1, tile_rows_); ++r)
      for (std::int32_t c = std::max(b.column0, 0); c < std::min(b.column1, tile_columns_); ++c)
        done_before_[static_cast<std::size_t>(r) * static_cast<std::size_t>(tile_columns_) +
                     static_cast<std::size_t>(c)] = true;
  taken_ = std::move(taken->pass);
  file_ = std::move(taken->file);
  return {};
}

// A tile with the marks and holes of the input and these samples; none where holes differ. Throws std::bad_alloc.
TileRef KeptWork::restored(std::int32_t column, std::int32_t row, const float* samples) const {
  if (column < 0 || row < 0 || column >= tile_columns_ || row >= tile_rows_) return {};
  const Tile& before = input_.reader().tile(column, row);
  for (std::size_t i = 0; i < kTileSamples; ++i)
    if (std::isnan(samples[i]) != std::isnan(before.samples[i]) || std::isinf(samples[i])) return {};
  TileRef tile = TileRef::adopt(input_.memory()->bulk().acquire());
  if (!tile) throw std::bad_alloc();
  *tile = before;
  std::copy_n(samples, kTileSamples, tile->samples.begin());
  refreshBounds(*tile, 0, 0, kTileSide, kTileSide);
  return tile;
}

KeptWork::~KeptWork() {
  if (writer_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    wake_.notify_one();
    writer_.join();
  }
  if (file_.isOpen()) (void)keep();
}

double KeptWork::shareAtStart(int passes) const noexcept {
  const auto all = static_cast<double>(tile_columns_) * tile_rows_;
  const auto of_pass = static_cast<double>(std::count(done_before_.begin(), done_before_.end(), true));
  return (start_.passes + of_pass / all) / passes;
}

double KeptWork::secondsWriting() const {
  const std::lock_guard lock(mutex_);
  return seconds_;
}

std::uint64_t KeptWork::mostBytes() const {
  const std::lock_guard lock(mutex_);
  return most_bytes_;
}

Status KeptWork::keep() {
  const std::lock_guard writing(writing_);
  return writePending();
}

Status KeptWork::writePending() {
  DoneBlocks part;
  {
    const std::lock_guard lock(mutex_);
    std::swap(part, pending_);
  }
  if (part.blocks.empty() || !file_.isOpen()) return {};
  const Stopwatch watch;
  Status written = file_.append(part);
  const std::lock_guard lock(mutex_);
  last_seconds_ = watch.seconds();
  seconds_ += last_seconds_;
  most_bytes_ = std::max(most_bytes_, file_.bytes());
  if (!written) {
    std::swap(part, pending_);
    pending_.blocks.insert(pending_.blocks.end(), part.blocks.begin(), part.blocks.end());
    std::move(part.tiles.begin(), part.tiles.end(), std::back_inserter(pending_.tiles));
  }
  return written;
}

void KeptWork::finish() {
  const std::lock_guard writing(writing_);
  file_.remove();
  rounds_.remove();
}

double KeptWork::pauseAfter(double seconds) const noexcept {
  return options_.every_seconds > 0.0 ? std::max(options_.every_seconds, (kParts - 1.0) * seconds) : 0.0;
}

void KeptWork::writeRegularly() {
  std::unique_lock lock(mutex_);
  while (!ended_) {
    const double pause = pauseAfter(last_seconds_);
    wake_.wait_for(lock, std::chrono::duration<double>(pause), [this] { return ended_; });
    if (pause < 0.01) wake_.wait(lock, [this] { return ended_ || !pending_.blocks.empty(); });
    if (ended_ || pending_.blocks.empty()) continue;
    lock.unlock();
    const Status written = keep();
    if (!written) report(written.error());
    lock.lock();
  }
}

// Once, until a write succeeds.
void KeptWork::report(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(troubled_, true)) return;
  }
  if (options_.on_trouble) options_.on_trouble(error);
}

Result<FilterWork::State> KeptWork::begin(const Version&) {
  return start_;
}

std::optional<FilterWork::Rounds> KeptWork::roundsBefore() {
  std::optional<Rounds> before = rounds_.read(pass_);
  if (before) rounds_at_start_ = before->done;
  since_rounds_ = {};
  return before;
}

bool KeptWork::wantsRounds() {
  return since_rounds_.seconds() >= pauseAfter(last_rounds_seconds_);
}

void KeptWork::roundDone(const Rounds& rounds) {
  const Stopwatch watch;
  const Status kept = rounds_.keep(pass_, rounds);
  last_rounds_seconds_ = watch.seconds();
  since_rounds_ = {};
  if (!kept) return report(kept.error());
  const std::lock_guard lock(mutex_);
  seconds_ += last_rounds_seconds_;
  most_bytes_ = std::max<std::uint64_t>(most_bytes_, rounds.numbers.size());
}

Status KeptWork::beginPass(const State& before) {
  pass_ = before.passes;
  const std::lock_guard writing(writing_);
  if (std::exchange(first_pass_, false)) {
    keeps_this_pass_ = true;
    return {};
  }
  start_.field = {};
  done_before_.clear();
  // What is pending of the pass before still belongs to what the file holds.
  keeps_this_pass_ = false;
  if (since_state_.seconds() < pauseAfter(last_state_seconds_)) return {};
  std::vector<NewTile> tiles;
  for (TileChange& change : changedTiles(input_, before.field))
    tiles.push_back({change.tile_column, change.tile_row, std::move(change.after), {}});
  const Stopwatch watch;
  auto file = WorkFile::create(options_.path, identity_, before.passes, tiles);
  last_state_seconds_ = watch.seconds();
  {
    const std::lock_guard lock(mutex_);
    seconds_ += last_state_seconds_;
    if (file) {
      // Both are there until the new one has the name.
      most_bytes_ = std::max(most_bytes_, file_.bytes() + file->bytes());
      pending_ = {};
    }
  }
  since_state_ = {};
  if (file) {
    file_ = *std::move(file);
    keeps_this_pass_ = true;
  } else {
    report(file.error());
  }
  return {};
}

bool KeptWork::isDone(const TileRect& block) {
  if (done_before_.empty()) return false;
  for (std::int32_t r = block.row0; r < block.row1; ++r)
    for (std::int32_t c = block.column0; c < block.column1; ++c)
      if (!wasDone(c, r)) return false;
  return true;
}

void KeptWork::done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) {
  // Of a block that reaches over some that were done, as with another number of threads.
  if (!done_before_.empty())
    made.erase(std::remove_if(made.begin() + static_cast<std::ptrdiff_t>(first), made.end(),
                              [this](const NewTile& t) { return wasDone(t.column, t.row); }),
               made.end());
  if (!keeps_this_pass_) return;
  {
    const std::lock_guard lock(mutex_);
    pending_.blocks.push_back(block);
    pending_.tiles.insert(pending_.tiles.end(), made.begin() + static_cast<std::ptrdiff_t>(first),
                          made.end());
  }
  if (options_.every_seconds <= 0.0) wake_.notify_one();
}

void KeptWork::addMade(std::vector<NewTile>& made) {
  std::move(taken_.tiles.begin(), taken_.tiles.end(), std::back_inserter(made));
  taken_ = {};
  // The pass is over; its rounds are in its blocks.
  rounds_.remove();
}

}  // namespace fettle::engine

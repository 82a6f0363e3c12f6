#include "render/live/live_fields.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "engine/field/difference.h"
#include "render/config.h"
#include "render/live/live_frame.h"

namespace fettle::render {
namespace {

// The finest level that stays on the device permanently: what `most_bytes` and a quarter of the pool hold if
// `textures` fields do so. The coarsest patch, which is drawn when nothing else can be, has vertices every
// 2^top samples and searches for heights around holes at an eighth of that step: these samples are always
// present.
int fixedLevel(const engine::Grid& grid, const PagePool& pool, std::size_t textures,
               std::uint64_t most_bytes) {
  int top = 0;
  while ((std::max(grid.width, grid.height) - 2) / DetailMeasure::side(top) > 0) ++top;
  const int coarsest = std::clamp((top - 3) / 2, 0, kDataLevels - 1);
  const PageGrid pages(grid.width, grid.height, pool.log2Side());
  const auto fits = [&](int level) {
    const auto fixed = static_cast<std::uint64_t>(PageSet::fixedPages(pages, level));
    return fixed * textures * 4 <= pool.slots().count() &&
           fixed << (2 * pool.log2Side()) <= most_bytes / sizeof(float);
  };
  int level = 0;
  while (level < coarsest && !fits(level)) ++level;
  return level;
}

std::uint64_t largestHeap(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
  vk::DeviceSize largest = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      largest = std::max(largest, memory.memoryHeaps[i].size);
  return largest;
}

// The signs of all that is shown, the original's last: nothing on the device depends on them, but ranges do.
// Repetitions do not count, so that one more state of the same sign is no change.
struct Signs {
  float first = 1.0F;
  bool mixed = false;  // some version has another one
  float original = 0.0F;
  explicit Signs(const Shown& shown) {
    if (shown.versions.empty()) return;
    first = shown.versions.front().reader().sign();
    for (const engine::Version& v : shown.versions) mixed = mixed || v.reader().sign() != first;
    if (shown.original) original = shown.original->reader().sign();
  }
  [[nodiscard]] Signs inverted() const {
    Signs other = *this;
    other.first = -first;
    other.original = -original;
    return other;
  }
  friend bool operator==(const Signs&, const Signs&) = default;
};

bool sameSize(const engine::Version& a, const engine::Version& b) {
  return a.grid().width == b.grid().width && a.grid().height == b.grid().height;
}

}  // namespace

bool related(const engine::Version& a, const engine::Version& b) {
  return !a.empty() && !b.empty() && a.memory() == b.memory() && sameSize(a, b);
}

LiveFields::LiveFields(Context& context, Submissions& submissions, StagingRing& staging,
                       const LiveOptions& options)
    : context_(context), submissions_(submissions), staging_(staging), options_(options) {
  max_side_ = context.limits().maxImageDimension2D;
  if (options.max_image_side > 0)
    max_side_ = std::min(max_side_, static_cast<std::uint32_t>(std::max(64, options.max_image_side)));
  memory_budget_ = static_cast<std::uint64_t>(std::max<std::int64_t>(0, options.memory_budget_bytes));
  if (memory_budget_ == 0) memory_budget_ = largestHeap(context.physical()) / 2;
}

// Uploads all that is pending, however long it takes: a small field.
void LiveFields::uploadAll(LiveTexture& texture) {
  std::vector<glm::ivec2> moved;
  while (texture.pending() > 0) {
    if (submissions_.begin() > 0.5) ++uploaded_.stalls;
    staging_.release(submissions_.done());
    UploadStatistics count;
    texture.uploadPending(staging_, submissions_.next(), submissions_.commands(),
                          UploadBudget{kUploadBytesPerSubmission}, count, moved);
    uploaded_.tiles += count.tiles;
    uploaded_.bytes += count.bytes;
    uploaded_.changed_samples += count.changed_samples;
    submissions_.submit({});
  }
}

// Whether what is to be shown is loaded on demand.
bool LiveFields::needsPool(const Shown& next) const {
  // Leaving a pool would upload all of a field at once: not between versions of one field.
  if (pool_ && !shown_.versions.empty() && related(shown_.versions.front(), next.versions.front()))
    return true;
  const std::uint64_t most = std::min(memory_budget_, kWholeBytes);
  std::uint64_t all = 0;
  const auto add = [&](const engine::Version& v, MarksOverlay marks) {
    const std::uint64_t bytes = LiveTexture::bytesOfWhole(context_, v.grid(), marks, max_side_);
    all = bytes == 0 ? most + 1 : all + bytes;
    return all <= most;
  };
  for (const engine::Version& v : next.versions)
    if (!add(v, next.marks)) return true;
  return next.original && !add(*next.original, MarksOverlay::kHide);
}

// Bytes that a pool for `next` may take: room for all that is shown, so that a picture of several states of
// which every page differs reaches the same quality as a picture of one.
std::uint64_t LiveFields::poolBudget(const Shown& next) const {
  std::uint64_t bytes = 0;
  const auto add = [&](const engine::Version& v) {
    const PageGrid pages(v.grid().width, v.grid().height, kLargestLog2Page);
    bytes += static_cast<std::uint64_t>(pages.entries() + 2) << (2 * pages.log2Side());
  };
  for (const engine::Version& v : next.versions) add(v);
  if (next.original || next.versions.size() == 1) add(next.original.value_or(next.versions.front()));
  const bool marks = next.marks == MarksOverlay::kShow || (pool_ && pool_->hasMarks());
  // A pool consists of whole layers and may lose an eighth of its pages by that (choosePool).
  return std::min({memory_budget_, kPoolBytes, bytes * (marks ? 5 : 4) / 8 * 9});
}

// Creates the pool for `next`, or grows it; an empty one where its kind changes.
void LiveFields::arrangePool(const Shown& next) {
  const bool on_demand = needsPool(next);
  const bool marks = next.marks == MarksOverlay::kShow;
  const bool fits =
      !pool_ || shown_.versions.empty() || sameSize(next.versions.front(), shown_.versions.front());
  if (on_demand == (pool_ != nullptr) && (!on_demand || (fits && (pool_->hasMarks() || !marks)))) {
    // More states than it was made for. Its pages stay, and the larger pool stays when fewer states are
    // shown.
    if (!on_demand || poolBudget(next) <= pool_budget_) return;
    pool_budget_ = poolBudget(next);
    pool_->grow(context_, pool_budget_, max_side_, submissions_);
    return;
  }
  submissions_.finish();
  // The measures stay valid: they describe the versions to be shown as soon as the pending tiles are applied.
  for (Field& f : fields_) {
    if (f.texture.pending() > 0) f.measure.invalidate(f.texture.version().reader(), f.texture.pendingTiles());
    f.texture.clear();
  }
  original_.clear();
  pool_.reset();
  if (!on_demand) return;
  pool_budget_ = poolBudget(next);  // after the old pool is gone
  pool_ = std::make_unique<PagePool>(context_, pool_budget_,
                                     marks ? PagePool::Marks::kInclude : PagePool::Marks::kNone, max_side_);
}

engine::Result<LiveTexture::Freshness> LiveFields::setVersion(LiveTexture& texture, const Shown& next,
                                                              const engine::Version& version,
                                                              MarksOverlay marks, Joins joins,
                                                              const engine::Version& accepted) {
  // Frames in flight may still read what is released.
  const auto idle = [this] { submissions_.finish(); };
  if (!pool_) return texture.setVersion(context_, version, marks, max_side_, idle, accepted);
  const std::uint64_t most = joins == Joins::kYes ? kFixedBytesOfOthers : kFixedBytes;
  return texture.setVersion(*pool_, fixedLevel(version.grid(), *pool_, next.versions.size() + 1, most),
                            version, idle, accepted);
}

// Sets version `i` of `next`; returns whether it is another field than before.
engine::Result<bool> LiveFields::setField(std::size_t i, const Shown& next) {
  Field& field = fields_[i];
  const engine::Version& v = next.versions[i];
  const auto state = setVersion(field.texture, next, v, next.marks, i == 0 ? Joins::kNo : Joins::kYes,
                                i == 0 ? next.accepted.value_or(engine::Version()) : engine::Version());
  if (!state) return tl::unexpected(state.error());
  if (*state != LiveTexture::Freshness::kFresh) {
    if (!shown_.versions.empty() && field.texture.pending() > 0 && next.marks != shown_.marks) {
      const std::vector<glm::ivec2> tiles = field.texture.pendingTiles();
      uploadAll(field.texture);
      field.measure.invalidate(v.reader(), tiles);
    }
    field.measured = v;
    return false;
  }
  if (!pool_) uploadAll(field.texture);
  const bool known = related(field.measured, v);
  if (known || (i > 0 && related(next.versions[0], v))) {
    std::vector<glm::ivec2> tiles;
    if (!known) {
      field.measure = fields_[0].measure;
      tiles = fields_[0].texture.pendingTiles();
    }
    for (const engine::TileChange& c : engine::changedTiles(known ? field.measured : next.versions[0], v))
      tiles.emplace_back(c.tile_column, c.tile_row);
    field.measure.invalidate(v.reader(), tiles);
  } else {
    field.measure.begin(v.reader());
  }
  field.measured = v;
  return !known;
}

engine::Result<LiveFields::Change> LiveFields::update(const Shown& next) {
  const engine::Stopwatch watch;
  if (next.versions.empty() || next.versions.size() > kMostPanels)
    return engine::inputError(fmt::format("{} versions in one picture", next.versions.size()), "picture",
                              fmt::format("show one to {}", kMostPanels));
  for (const engine::Version& v : next.versions) {
    if (v.empty() || (next.original && next.original->empty()))
      return engine::inputError("there is no field to draw", "picture");
    if (next.original && !sameSize(v, *next.original))
      return engine::inputError(
          fmt::format("the fields have different sizes: {} x {} against {} x {}", v.grid().width,
                      v.grid().height, next.original->grid().width, next.original->grid().height),
          "deviation", "compare a field with its own original");
  }
  if (next.accepted && !related(*next.accepted, next.versions.front()))
    return engine::inputError("the accepted marks are those of another field", "picture",
                              "show states of one field");
  // A field that fails halfway is dropped.
  const bool was_broken = broken_;
  broken_ = true;
  if (was_broken) {
    submissions_.finish();
    fields_.clear();
    original_.clear();
  }
  arrangePool(next);
  bool another = next.original.has_value() != shown_.original.has_value();
  // What is uploaded to a pool's pages comes after all frames that are on their way.
  if (fields_.size() > next.versions.size() && !pool_) submissions_.finish();
  fields_.resize(next.versions.size());
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const engine::Result<bool> fresh = setField(i, next);
    if (!fresh) return tl::unexpected(fresh.error());
    another = another || (i == 0 && *fresh);
  }
  if (next.original) {
    const auto state = setVersion(original_, next, *next.original, MarksOverlay::kHide, Joins::kYes);
    if (!state) return tl::unexpected(state.error());
    if (*state == LiveTexture::Freshness::kFresh) {
      if (!pool_) uploadAll(original_);
      another = true;
    }
  } else if (!original_.version().empty()) {
    if (!pool_) submissions_.finish();
    original_.clear();
  }
  const Signs before(shown_), now(next);
  const bool inverted = !shown_.versions.empty() && now == before.inverted();
  another = another || !(inverted || now == before);
  shown_ = next;
  broken_ = false;
  uploaded_.ms += watch.ms();
  return another ? Change::kAnother : inverted ? Change::kInverted : Change::kChanged;
}

// What a frame measures of one version: some tiles, and more of them while there is time.
std::size_t LiveFields::measureInFrame(DetailMeasure& measure, const engine::FieldReader& reader) const {
  const engine::Stopwatch watch;
  std::size_t measured = 0;
  do measured += measure.measureSome(reader, kMeasuredAtOnce);
  while (measure.unknown() > 0 && measured + kMeasuredAtOnce <= kMeasuredPerFrame &&
         watch.ms() < options_.measuring_ms);
  return measured;
}

// Uploads the permanent pages, in submissions before the frame's.
void LiveFields::uploadFixed(UploadStatistics& all) {
  const auto left = [this] {
    return original_.fixedLeft() > 0 ||
           std::ranges::any_of(fields_, [](const Field& f) { return f.texture.fixedLeft() > 0; });
  };
  UploadStatistics count;
  std::vector<glm::ivec2> moved;
  const auto upload = [&](LiveTexture& texture) {
    moved.clear();
    if (texture.fixedLeft() > 0)
      texture.uploadPending(staging_, submissions_.next(), submissions_.commands(), {}, count, moved);
  };
  while (left()) {
    for (Field& f : fields_) {
      upload(f.texture);
      if (!moved.empty()) f.measure.invalidate(f.texture.version().reader(), moved);
    }
    upload(original_);
    // By themselves: of a frame that fails later nothing is submitted, but pages count as there.
    submissions_.submit({});
    (void)submissions_.begin();
    staging_.release(submissions_.done());
  }
  all.tiles += count.tiles;
  all.bytes += count.bytes;
  all.changed_samples += count.changed_samples;
}

void LiveFields::uploadPending(UploadStatistics& all) {
  const engine::Stopwatch watch;
  // Each has its share of the time, whatever others need and measuring takes.
  const double share_ms = options_.uploading_ms / static_cast<double>(fields_.size() + 1);
  const auto budget = [&] { return UploadBudget{options_.upload_bytes_per_frame, share_ms}; };
  UploadStatistics count;
  uploadFixed(uploaded_);
  std::vector<glm::ivec2> moved;
  for (Field& f : fields_) {
    moved.clear();
    f.texture.uploadPending(staging_, submissions_.next(), submissions_.commands(), budget(), count, moved);
    const engine::FieldReader reader = f.texture.version().reader();
    if (!moved.empty()) f.measure.invalidate(reader, moved);
    count.measured_tiles += static_cast<std::int64_t>(measureInFrame(f.measure, reader));
    count.unmeasured_tiles += static_cast<std::int64_t>(f.measure.unknown());
  }
  moved.clear();
  if (!original_.version().empty())
    original_.uploadPending(staging_, submissions_.next(), submissions_.commands(), budget(), count, moved);
  bytes_left_ = options_.upload_bytes_per_frame - count.bytes;
  all = uploaded_;
  all.tiles += count.tiles;
  all.bytes += count.bytes;
  all.changed_samples += count.changed_samples;
  all.pending_of_first = fields_.empty() ? 0 : static_cast<std::int64_t>(fields_.front().texture.pending());
  all.measured_tiles = count.measured_tiles;
  all.unmeasured_tiles = count.unmeasured_tiles;
  all.pending_tiles = count.pending_tiles + count.unmeasured_tiles;
  all.ms += watch.ms();
  uploaded_ = {};
}

std::int64_t LiveFields::measureFor(double ms) {
  const engine::Stopwatch watch;
  std::int64_t left = 0;
  for (Field& f : fields_) {
    const engine::FieldReader reader = f.texture.version().reader();
    while (f.measure.unknown() > 0 && watch.ms() < ms) (void)f.measure.measureSome(reader, kMeasuredAtOnce);
    left += static_cast<std::int64_t>(f.measure.unknown());
  }
  return left;
}

void LiveFields::uploadPages(PageDemand& demand, FrameStatistics& stats) {
  UploadStatistics count;
  ResidencyStatistics& r = stats.residency;
  const PageDemand::Outcome outcome =
      demand.upload(*pool_, staging_, submissions_.next(), submissions_.commands(),
                    {bytes_left_, options_.uploading_ms}, count);
  stats.upload.bytes += count.bytes;
  stats.upload.pending_tiles += count.pending_tiles;
  r.on_demand = true;
  r.device_bytes = static_cast<std::int64_t>(pool_->bytes());
  r.pages = pool_->slots().count();
  r.pages_used = pool_->slots().used();
  r.pages_requested = outcome.requested;
  r.pages_loaded = outcome.loaded;
  r.pages_waiting = outcome.waiting;
  r.pages_over_budget = outcome.over_budget;
}

}  // namespace fettle::render

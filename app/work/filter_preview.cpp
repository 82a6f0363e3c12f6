#include "app/work/filter_preview.h"

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "engine/filter/noise_range.h"
#include "engine/filter/region.h"

namespace fettle::app {
namespace {

// Rounds of adoption: each leaves only the edits of some milliseconds, so without edits one is enough.
constexpr int kMostRounds = 50;
constexpr double kSeenFirst_s = 1.0;
constexpr std::int32_t kFarthestReach = 512;  // [samples]

bool same(const engine::FilterSpec& a, const engine::FilterSpec& b) {
  return a.kind == b.kind && a.window == b.window && a.sigma == b.sigma && a.range_sigma == b.range_sigma &&
         a.nesting_mm == b.nesting_mm && a.element == b.element && a.passes == b.passes &&
         a.scope == b.scope && a.max_change == b.max_change;
}

// Filters the visible part and calls `done` after each piece. Limited to about a second, since this work is
// done twice.
void filterSeen(const engine::Version& base, const engine::Version& original, const engine::FilterSpec& spec,
                const std::vector<engine::TileRange>& seen, engine::JobControl& job, const auto& done) {
  const engine::Stopwatch watch;
  std::int64_t tiles = 0;
  for (const engine::TileRange& range : seen) tiles += range.tiles();
  // With a filter of a large reach, a part takes as long as the whole.
  if (engine::reachOf(spec, base) > kFarthestReach) return;
  const bool most = 2 * tiles > engine::allTiles(base.grid()).tiles();
  engine::Version so_far = base;
  for (const engine::TileRange& range : seen) {
    if (job.cancelled() || (most && watch.seconds() > kSeenFirst_s)) return;
    auto next = engine::filterRange(base, original, so_far, spec, range, job);
    if (!next) return;  // filtering the whole will report why
    so_far = std::move(*next);
    done(so_far);
  }
}

}  // namespace

std::string filterName(const engine::FilterSpec& spec) {
  const engine::Filter& filter = engine::filterOf(spec.kind);
  std::string text = filter.title;
  if (filter.window.exists()) text += fmt::format(" {} x {}", spec.window, spec.window);
  if (filter.has_element)
    text += fmt::format(", {}", engine::kElementWords[static_cast<std::size_t>(spec.element)]);
  if (filter.nesting.exists()) text += fmt::format(" {:.4g} mm", spec.nesting_mm);
  if (spec.passes > 1) text += fmt::format(", {} passes", spec.passes);
  if (spec.scope == engine::FilterScope::kOnlyMarks) text += ", only marks";
  return text;
}

void FilterPreview::compute(LoopClient& client, Keep keep, std::vector<engine::TileRange> seen_first) {
  keep_ = keep;
  apply_when_done_ = false;
  // After a jump over a step that changes the form, field and original are still those under the form before.
  client.awaitRestored();
  so_far_ = std::make_shared<SoFar>();
  so_far_->spec = spec;
  seen_so_far_ = {};
  computing_.start([base = client.field(), id = client.noteFilterBase(), so_far = so_far_,
                    seen = std::move(seen_first), original = client.original(), asked = spec,
                    inverted = client.scene().invert](engine::JobControl& job) -> engine::Result<Variant> {
    const engine::Version limit = inverted ? original.inverted() : original;
    // Before any part of it is filtered: the result is adopted into the field in parts, and replayed.
    const auto ready = engine::withMeasuredRange(asked, base, job);
    if (!ready) return tl::unexpected(ready.error());
    const engine::FilterSpec& what = *ready;
    filterSeen(base, limit, what, seen, job, [&](const engine::Version& part) {
      const std::scoped_lock lock(so_far->mutex);
      so_far->field = part;
    });
    auto result = engine::applyFilter(base, limit, what, job);
    if (!result) return tl::unexpected(result.error());
    return Variant{asked, what, base, std::move(*result), id};
  });
}

void FilterPreview::apply(LoopClient& client) {
  if (applying()) return;
  client.awaitRestored();
  if (client.newest().formOver() != form_) {
    variants_.clear();
    computing_.cancel();
    form_ = client.newest().formOver();
  }
  if (!variants_.empty() && same(variants_.back().asked, spec)) {
    adopt(client, variants_.back());
    return;
  }
  if (!computing()) compute(client, Keep::kReplace);
  apply_when_done_ = true;
}

void FilterPreview::adopt(LoopClient& client, Variant variant) {
  client.noteFilterBegun(variant.base_id, variant.spec, filterName(variant.spec));
  client.allowPort();
  applying_.start([port = &client.port(), original = client.original(), inverted = client.scene().invert,
                   v = std::move(variant)](engine::JobControl& job) {
    return haptic::adoptFiltered(*port, v.base, v.result.field, inverted ? original.inverted() : original,
                                 v.spec, kMostRounds, job);
  });
}

void FilterPreview::cancel(LoopClient& client) {
  computing_.cancel();
  applying_.cancel();
  if (applying_.busy()) client.closePort();
  apply_when_done_ = false;
  variants_.clear();
  so_far_.reset();
  seen_so_far_ = {};
}

void FilterPreview::finish(LoopClient& client) {
  cancel(client);
  (void)applying_.wait();
}

void FilterPreview::drop(std::size_t variant) {
  if (variant < variants_.size()) variants_.erase(variants_.begin() + static_cast<std::ptrdiff_t>(variant));
}

std::vector<FilterPreview::Picture> FilterPreview::pictures() const {
  std::vector<Picture> pictures;
  const bool additional = seen_so_far_.empty() || keep_ == Keep::kAdd;
  if (additional)
    for (const Variant& variant : variants_)
      pictures.push_back({variant.result.field, filterName(variant.spec)});
  if (!seen_so_far_.empty()) pictures.push_back({seen_so_far_, filterName(so_far_->spec) + " ..."});
  if (pictures.size() > kMostVariants)
    pictures.erase(pictures.begin(), pictures.end() - static_cast<std::ptrdiff_t>(kMostVariants));
  return pictures;
}

bool FilterPreview::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  // What was computed under another form cannot be adopted.
  if (const engine::FieldForm& form = client.newest().formOver(); form != form_) {
    form_ = form;
    if (computing() || !variants_.empty()) {
      computing_.cancel();
      apply_when_done_ = false;
      variants_.clear();
      changed = true;
    }
  }
  if (so_far_) {
    const std::scoped_lock lock(so_far_->mutex);
    if (!(so_far_->field == seen_so_far_) && !computing_.cancelling()) {
      seen_so_far_ = so_far_->field;
      changed = true;
    }
  }
  // A cancelled job may have finished meanwhile.
  const bool dropped = computing_.cancelling();
  if (auto done = computing_.take(); done && dropped) {
    changed = true;
  } else if (done) {
    changed = true;
    so_far_.reset();
    seen_so_far_ = {};
    if (*done) {
      if (keep_ == Keep::kReplace) variants_.clear();
      if (variants_.size() == kMostVariants) variants_.erase(variants_.begin());
      variants_.push_back(std::move(**done));
      if (apply_when_done_) adopt(client, variants_.back());
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
    apply_when_done_ = false;
  }
  if (auto done = applying_.take()) {
    changed = true;
    if (*done) {
      ++applied_;
      variants_.clear();
      if (!(*done)->rest.empty())
        notices.push_back({fmt::format("{} tiles under the brush are not filtered", (*done)->rest.size()),
                           "apply again when the stroke has ended"});
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  return changed;
}

}  // namespace fettle::app

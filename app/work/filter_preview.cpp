#include "app/work/filter_preview.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "engine/filter/noise_range.h"
#include "engine/filter/unjudged.h"

namespace fettle::app {
namespace {

// Rounds of adoption: each leaves only the edits of some milliseconds, so without edits one is enough.
constexpr int kMostRounds = 50;
// All of the view at once looks better than one part after the other, if it does not take longer.
constexpr auto kWaitForAll = std::chrono::milliseconds(200);

bool same(const engine::FilterSpec& a, const engine::FilterSpec& b) {
  return a.kind == b.kind && a.window == b.window && a.sigma == b.sigma && a.range_sigma == b.range_sigma &&
         a.nesting_mm == b.nesting_mm && a.element == b.element && a.passes == b.passes &&
         a.scope == b.scope && a.max_change == b.max_change;
}

// A filter with the limit of change of another.
engine::FilterSpec limitedAs(const engine::FilterSpec& other, engine::FilterSpec filter) {
  filter.max_change = other.max_change;
  return filter;
}

}  // namespace

bool FilterPreview::Fields::operator==(const Fields& other) const {
  return same(spec, other.spec);
}

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

std::string previewState(const engine::FilterView::Picture& picture, const engine::Grid& grid) {
  return soFarText({picture.step != 0,
                    picture.off ? offText(picture.off->rms, picture.off->estimated, grid) : std::string(),
                    picture.exact, picture.untouched});
}

void FilterPreview::compute(LoopClient& client, Keep keep, const engine::FieldView& view) {
  keep_ = keep;
  apply_when_done_ = false;
  // After a jump over a step that changes the form, field and original are still those under the form before.
  client.awaitRestored();
  const engine::Version original = client.scene().invert ? client.original().inverted() : client.original();
  // What was seen of the values before stays until something of these is.
  const bool stays = std::exchange(again_, std::nullopt).has_value();
  approximating_.cancel();
  if (!stays) so_far_ = {};
  seen_ = follows_ = false;
  fields_.settle({spec});
  view_ = std::make_shared<engine::FilterView>(client.field(), original, view);
  of_view_ = spec;
  begun_ = looked_ = Clock::now();
  if (!view.tiles.empty()) paces_[spec.kind].begin(begun_, view.tiles.tiles());
  // The same number as would be measured again.
  engine::FilterSpec ready = spec;
  if (const auto range = rangeOfNoise(client); range && spec.range_sigma == 0.0) ready.range_sigma = *range;
  computing_.replace([base = client.field(), id = client.noteFilterBase(), filtering = view_, asked = spec,
                      ready](engine::JobControl& job) -> engine::Result<Variant> {
    auto done = filtering->run(ready, job);
    if (!done) return tl::unexpected(done.error());
    const auto unjudged = done->spec.kind == engine::FilterKind::kOutliers
                              ? engine::countUnjudged(base, done->spec, job)
                              : std::int64_t{0};
    if (!unjudged) return engine::cancelled();
    return Variant{asked, done->spec, base, std::move(done->filtered), id, *unjudged};
  });
}

std::optional<double> FilterPreview::rangeOfNoise(const LoopClient& client) {
  if (!engine::hasRange(spec.kind)) return std::nullopt;
  noise_.want();
  const engine::NoiseEstimate* const noise = noise_.of(client.original());
  if (noise == nullptr) return std::nullopt;
  engine::FilterSpec of_noise = spec;
  of_noise.range_sigma = 0.0;
  const auto ready = engine::withRangeOf(of_noise, *noise);
  return ready ? std::optional(ready->range_sigma) : std::nullopt;
}

void FilterPreview::chooseKind(engine::FilterKind kind, const engine::Grid& grid) {
  if (kind == spec.kind) return;
  said_[spec.kind] = spec;
  const auto said = said_.find(kind);
  engine::FilterSpec next;
  if (said != said_.end()) {
    next = said->second;
  } else {
    next.kind = kind;
    next.nesting_mm = engine::usualNesting(engine::filterOf(kind), grid);
  }
  next.max_change = spec.max_change;
  next.scope = spec.scope;
  spec = next;
}

void FilterPreview::choose(const engine::FilterSpec& filter) {
  spec = limitedAs(spec, filter);
}

bool FilterPreview::says(const engine::FilterSpec& filter) const {
  return same(spec, limitedAs(spec, filter));
}

void FilterPreview::follow(LoopClient& client, const std::function<engine::FieldView()>& view) {
  const auto now = Clock::now();
  const bool changed = fields_.look({spec}, now);
  const bool asked = again_.has_value() || computes();
  if (applying() || apply_when_done_ || !(asked || !variants_.empty())) return stopFollowing();
  const engine::FilterSpec& newest = asked ? of_view_ : variants_.back().asked;
  if (changed && spec.kind != newest.kind) return stopFollowing();
  if (!fields_.changed()) return;
  const engine::FieldView seen = view();
  if (changed && !paces_[spec.kind].isSoon(seen.tiles.tiles())) return stopFollowing();
  if (changed && computes()) {
    again_ = keep_;
    computing_.cancel();
    approximating_.cancel();
    view_.reset();
  }
  // One that was cancelled ends first: nothing waits for it here.
  if (!fields_.rest(now) || computing()) return;
  if (!again_ && same(newest, spec)) return fields_.settle();
  compute(client, again_.value_or(Keep::kRenew), seen);
  follows_ = true;
}

void FilterPreview::stopFollowing() {
  fields_.settle();
  if (std::exchange(again_, std::nullopt)) dropSoFar();
}

bool FilterPreview::isBehind() const {
  const auto current = [&](const Variant& v) { return isCurrent(v); };
  return !variants_.empty() && !computes() && std::none_of(variants_.begin(), variants_.end(), current);
}

bool FilterPreview::followsSoon() const {
  return awaitsRest() || (follows_ && Clock::now() - begun_ < PreviewPace::kSoon);
}

bool FilterPreview::wantsView() const {
  return view_ != nullptr && computing() && Clock::now() - looked_ >= PreviewPace::kLookAgain;
}

void FilterPreview::look(const engine::FieldView& view) {
  if (view_) view_->look(view);
}

void FilterPreview::dropSoFar() {
  approximating_.cancel();
  view_.reset();
  so_far_ = {};
}

// The picture so far, some times in a second.
void FilterPreview::takeSoFar() {
  (void)approximating_.take();
  if (!view_ || !computes()) return;
  const auto now = Clock::now();
  const bool first = !seen_;
  if (!first && now - looked_ < PreviewPace::kLookAgain) return;
  if (!approximating_.busy() && view_->wantsCoarse() && !first)
    approximating_.start([view = view_](engine::JobControl& job) -> engine::Result<bool> {
      if (auto done = view->coarsen(job); !done) return tl::unexpected(done.error());
      return true;
    });
  engine::FilterView::Picture picture = view_->picture();
  if (picture.field.empty() || (first && picture.untouched > 0.0 && now - begun_ < kWaitForAll)) return;
  looked_ = now;
  if (picture.field == so_far_.field) return;
  so_far_ = std::move(picture);
  of_so_far_ = of_view_;
  noteSeen();
}

void FilterPreview::noteSeen() {
  seen_ = true;
  paces_[of_view_.kind].see(Clock::now());
}

bool FilterPreview::isCurrent(const Variant& variant) const {
  return same(variant.asked, spec);
}

void FilterPreview::apply(LoopClient& client) {
  if (applying()) return;
  client.awaitRestored();
  if (client.newest().formOver() != form_) {
    variants_.clear();
    computing_.cancel();
    form_ = client.newest().formOver();
  }
  if (!variants_.empty() && isCurrent(variants_.back())) {
    adopt(client, variants_.back());
    return;
  }
  const auto other = [&](const Variant& v) { return v.asked.kind != spec.kind; };
  if (!computes() && !variants_.empty() && std::ranges::all_of(variants_, other)) {
    compute(client, Keep::kReplace);
    shown_instead_ = true;
    return;
  }
  if (!computes() || !same(of_view_, spec)) compute(client, Keep::kReplace);
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
  dropSoFar();
  stopFollowing();
}

void FilterPreview::finish(LoopClient& client) {
  cancel(client);
  said_.clear();  // its lengths may mean nothing in another field
  noise_.clear();
  (void)applying_.wait();
}

void FilterPreview::drop(std::size_t variant) {
  if (variant < variants_.size()) variants_.erase(variants_.begin() + static_cast<std::ptrdiff_t>(variant));
  stopFollowing();
}

std::vector<PreviewPicture> FilterPreview::pictures() const {
  std::vector<PreviewPicture> pictures;
  // As many of the variants as stay beside what is computed.
  std::size_t beside = variants_.size();
  if (!so_far_.field.empty() && keep_ == Keep::kReplace) beside = 0;
  if (!so_far_.field.empty() && keep_ == Keep::kRenew && beside > 0) --beside;
  for (std::size_t i = 0; i < beside; ++i)
    pictures.push_back({variants_[i].result.field, filterName(variants_[i].spec)});
  if (!so_far_.field.empty())
    pictures.push_back({so_far_.field, fmt::format("{}: {}", filterName(of_so_far_),
                                                   previewState(so_far_, so_far_.field.grid()))});
  if (pictures.size() > kMostVariants)
    pictures.erase(pictures.begin(), pictures.end() - static_cast<std::ptrdiff_t>(kMostVariants));
  return pictures;
}

bool FilterPreview::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  if (std::exchange(shown_instead_, false))
    notices.push_back({trFormat("the preview was of another filter: now it is of {}", filterName(spec)),
                       tr("Apply again makes it a step")});
  // What was computed under another form cannot be adopted.
  if (const engine::FieldForm& form = client.newest().formOver(); form != form_) {
    form_ = form;
    if (computing() || !variants_.empty()) {
      computing_.cancel();
      apply_when_done_ = false;
      variants_.clear();
      stopFollowing();
      changed = true;
    }
  }
  takeSoFar();
  changed |= noise_.poll(client.original());
  // A cancelled job may have finished meanwhile.
  const bool dropped = computing_.cancelling();
  if (auto done = computing_.take(); done && dropped) {
    changed = true;
  } else if (done) {
    changed = true;
    if (*done && !seen_) noteSeen();
    dropSoFar();
    if (*done) {
      if (keep_ == Keep::kReplace) variants_.clear();
      if (keep_ == Keep::kRenew && !variants_.empty()) variants_.pop_back();
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
        notices.push_back({trFormat("{} tiles under the brush are not filtered", (*done)->rest.size()),
                           textOf("apply again when the stroke has ended")});
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  return changed;
}

}  // namespace fettle::app

#include "app/work/filter_preview.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace fettle::app {
namespace {

// Rounds of adoption: each leaves only the edits of some milliseconds, so without edits one is enough.
constexpr int kMostRounds = 50;
// Between two looks at what is there so far: each is drawn.
constexpr auto kLookAgain = std::chrono::milliseconds(200);
// All of the view at once looks better than one part after the other, if it does not take longer.
constexpr auto kWaitForAll = std::chrono::milliseconds(200);

bool same(const engine::FilterSpec& a, const engine::FilterSpec& b) {
  return a.kind == b.kind && a.window == b.window && a.sigma == b.sigma && a.range_sigma == b.range_sigma &&
         a.nesting_mm == b.nesting_mm && a.element == b.element && a.passes == b.passes &&
         a.scope == b.scope && a.max_change == b.max_change;
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

std::string previewState(const engine::FilterView::Picture& picture, const engine::Grid& grid) {
  const auto percent = [](double share) { return static_cast<int>(100.0 * share); };
  if (picture.step == 0)
    return picture.exact == 1.0 ? "exact in view" : fmt::format("{} % so far", percent(picture.exact));
  std::string text =
      picture.off ? offText(picture.off->rms, picture.off->estimated, grid) : std::string("approximate");
  if (const int done = percent(picture.exact); done > 0) text += fmt::format(", {} % exact", done);
  if (picture.untouched > 0.0) text += fmt::format(", {} % to come", std::max(1, percent(picture.untouched)));
  return text;
}

void FilterPreview::compute(LoopClient& client, Keep keep, const engine::FieldView& view) {
  keep_ = keep;
  apply_when_done_ = false;
  // After a jump over a step that changes the form, field and original are still those under the form before.
  client.awaitRestored();
  const engine::Version original = client.scene().invert ? client.original().inverted() : client.original();
  dropSoFar();
  view_ = std::make_shared<engine::FilterView>(client.field(), original, view);
  of_view_ = spec;
  begun_ = looked_ = Clock::now();
  computing_.replace([base = client.field(), id = client.noteFilterBase(), filtering = view_,
                      asked = spec](engine::JobControl& job) -> engine::Result<Variant> {
    auto done = filtering->run(asked, job);
    if (!done) return tl::unexpected(done.error());
    return Variant{asked, done->spec, base, std::move(done->filtered), id};
  });
}

bool FilterPreview::wantsView() const {
  return view_ != nullptr && computing() && Clock::now() - looked_ >= kLookAgain;
}

void FilterPreview::look(const engine::FieldView& view) {
  if (view_) view_->look(view);
}

void FilterPreview::dropSoFar() {
  approximating_.cancel();
  view_.reset();
  so_far_ = {};
}

// The picture so far, some times in a second. True when it is another one.
bool FilterPreview::takeSoFar() {
  (void)approximating_.take();
  if (!view_ || !computing() || computing_.cancelling()) return false;
  const auto now = Clock::now();
  const bool first = so_far_.field.empty();
  if (!first && now - looked_ < kLookAgain) return false;
  if (!approximating_.busy() && view_->wantsCoarse() && !first)
    approximating_.start([view = view_](engine::JobControl& job) -> engine::Result<bool> {
      if (auto done = view->coarsen(job); !done) return tl::unexpected(done.error());
      return true;
    });
  engine::FilterView::Picture picture = view_->picture();
  if (picture.field.empty() || (first && picture.untouched > 0.0 && now - begun_ < kWaitForAll)) return false;
  looked_ = now;
  if (picture.field == so_far_.field) return false;
  so_far_ = std::move(picture);
  return true;
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
  dropSoFar();
}

void FilterPreview::finish(LoopClient& client) {
  cancel(client);
  (void)applying_.wait();
}

void FilterPreview::drop(std::size_t variant) {
  if (variant < variants_.size()) variants_.erase(variants_.begin() + static_cast<std::ptrdiff_t>(variant));
}

std::vector<PreviewPicture> FilterPreview::pictures() const {
  std::vector<PreviewPicture> pictures;
  const bool additional = so_far_.field.empty() || keep_ == Keep::kAdd;
  if (additional)
    for (const Variant& variant : variants_)
      pictures.push_back({variant.result.field, filterName(variant.spec)});
  if (!so_far_.field.empty())
    pictures.push_back({so_far_.field, fmt::format("{}: {}", filterName(of_view_),
                                                   previewState(so_far_, so_far_.field.grid()))});
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
  changed |= takeSoFar();
  // A cancelled job may have finished meanwhile.
  const bool dropped = computing_.cancelling();
  if (auto done = computing_.take(); done && dropped) {
    changed = true;
  } else if (done) {
    changed = true;
    dropSoFar();
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

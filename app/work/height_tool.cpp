#include "app/work/height_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/hole_count.h"
#include "app/work/read_units.h"
#include "engine/remove/remove_step.h"

namespace fettle::app {

namespace {

struct MakerName {
  std::string operator()(const engine::FillOptions& fill) const {
    return fill.method == engine::FillMethod::kMembrane ? "Fill holes: membrane"
                                                        : "Fill holes: least curvature";
  }
  std::string operator()(const engine::LineOptions& lines) const {
    constexpr const char* kMethods[] = {"median", "polynomial", "difference", "matching"};
    const char* axis = lines.axis == engine::ScanAxis::kX ? "rows" : "columns";
    const std::string degree =
        lines.method == engine::LineMethod::kPolynomial ? fmt::format(" {}", lines.degree) : "";
    const char* form = lines.form_degree ? ", form stays" : "";
    return fmt::format("Level {}: {}{}{}", axis, kMethods[static_cast<std::size_t>(lines.method)], degree,
                       form);
  }
  std::string operator()(const engine::RemoveOptions& chosen) const {
    constexpr const char* kOf[] = {"all samples", "marked samples", "unmarked samples"};
    const engine::RemoveOptions remove = field->reader().sign() < 0.0F ? engine::upsideDown(chosen) : chosen;
    const engine::LengthUnit& unit = field->grid().height_unit;
    const bool low = std::isfinite(remove.low), high = std::isfinite(remove.high);
    const ReadAs as = readLengthAs(
        std::max(low ? std::abs(remove.low) : 0.0, high ? std::abs(remove.high) : 0.0), unit.mm, unit.name);
    const auto height = [&as](double limit) { return fmt::format("{:.6g} {}", limit / as.size, as.name); };
    const bool between = remove.heights == engine::RemoveOptions::Heights::kBetween;
    std::string by;
    if (low && high)
      by = between ? fmt::format(" between {} and {}", height(remove.low), height(remove.high))
                   : fmt::format(" below {} and above {}", height(remove.low), height(remove.high));
    else if (low)
      by = (between ? " from " : " below ") + height(remove.low) + (between ? " up" : "");
    else if (high)
      by = (between ? " up to " : " above ") + height(remove.high);
    return fmt::format("{} {}{}", engine::kRemoveStep, kOf[static_cast<std::size_t>(remove.region)], by);
  }

  const engine::Version* field;
};

std::string removedText(const engine::RemoveCounts& counts, bool done) {
  std::string text = done ? trFormat("{} of {} samples removed", counts.removed, counts.heights)
                          : trFormat("removes {} of {} samples", counts.removed, counts.heights);
  if (counts.spared > 0) text += trFormat("; {} stay since they are marked", counts.spared);
  return text;
}

// Where levelling made it worse, and what else there is: short, the panel has place for four lines.
std::string apartText(const engine::LinesApart& apart, engine::LineMethod method) {
  if (!apart.worse()) return {};
  const bool from_line_to_line =
      method == engine::LineMethod::kDifference || method == engine::LineMethod::kMatching;
  const bool neighbours = apart.lag == 1, were_level = !(apart.before > apart.least);
  const char* const rather = !from_line_to_line         ? tr("try matching or difference")
                             : neighbours || were_level ? tr("they were level")
                                                        : tr("errors add up, try median");
  if (were_level) return trFormat("; lines lie further apart now: {}", rather);
  const double times = apart.after / apart.before;
  return neighbours ? trFormat("; neighbours lie {:.2g} times as far apart now: {}", times, rather)
                    : trFormat("; lines lie {:.2g} times as far from the {}th after them now: {}", times,
                               apart.lag, rather);
}

// `holes`: samples without a height that are left; `done`: it is a step.
std::string foundIn(const haptic::ComputedHeights& heights, const haptic::HeightsMaker& maker,
                    const engine::Version& before, std::int64_t holes, bool done) {
  const engine::Grid& grid = before.grid();
  if (std::holds_alternative<engine::RemoveOptions>(maker)) return removedText(heights.removed, done);
  if (std::holds_alternative<engine::LineOptions>(maker)) {
    const ReadAs as = readOnScreenAs(heights.rows_rms, grid.height_unit.mm, grid.height_unit.name);
    std::string text = trFormat("lines were off by {:.3g} {} (rms)", heights.rows_rms / as.size, as.name);
    const std::string apart = apartText(heights.rows_apart, std::get<engine::LineOptions>(maker).method);
    if (!(heights.rows_form_rms > 0.0)) return text + apart;
    const ReadAs form = readOnScreenAs(heights.rows_form_rms, grid.height_unit.mm, grid.height_unit.name);
    return text +
           trFormat("; form across them of {:.3g} {} (rms) stays", heights.rows_form_rms / form.size,
                    form.name) +
           apart;
  }
  const engine::Filled& filled = heights.filled;
  std::string text =
      trFormat("{} of {} holes filled, {} samples", filled.filled_holes, filled.holes, filled.filled);
  const auto stay = [&](std::int64_t count, const char* why) {
    if (count > 0) text += fmt::format("; {} {}", count, why);
  };
  if (const std::int64_t left = filled.holes - filled.filled_holes; left > 0)
    text += trFormat("; {} holes of {} samples in all are left", left, holes);
  stay(filled.larger, tr("are larger"));
  stay(filled.at_border, tr("reach the border"));
  stay(filled.too_many, tr("have too many samples"));
  stay(filled.no_rim, tr("have no height next to them"));
  const engine::BeyondBefore beyond = engine::beyondBefore(before, heights.field);
  const ReadAs as = readOnScreenAs(beyond.below + beyond.above, before.grid().height_unit.mm,
                                   before.grid().height_unit.name);
  if (beyond.below > 0.0)
    text += trFormat("; down to {:.3g} {} below all else: a membrane stays between the heights of the rim",
                     beyond.below / as.size, as.name);
  if (beyond.above > 0.0)
    text += trFormat("; up to {:.3g} {} above all else: a membrane stays between the heights of the rim",
                     beyond.above / as.size, as.name);
  return text;
}

}  // namespace

std::string makerName(const haptic::HeightsMaker& maker, const engine::Version& field) {
  return std::visit(MakerName{&field}, maker);
}

std::string earlyState(const engine::EarlyPicture& picture) {
  const auto& off = picture.off;
  return soFarText({off.has_value(),
                    off ? offText(off->rms, off->estimated, picture.field.grid()) : std::string(),
                    picture.exact, picture.untouched});
}

double HeightTool::usualExtentMm(const engine::Grid& grid) noexcept {
  constexpr double kUsual = 20.0;
  return kUsual * std::max(grid.spacingXMm(), grid.spacingYMm());
}

void HeightTool::make(const haptic::HeightsMaker& maker) {
  stopFollowing();
  if (previews(maker)) return applyPreview();
  // On its way as a preview: it becomes a step when it is there.
  if (working_.busy() && !working_.cancelling() && !asked_ && wanted_.maker == maker) {
    wanted_.becomes = Becomes::kStep;
    return dropEarly();
  }
  cancel();
  preview_.reset();
  asked_ = Wanted{maker, Becomes::kStep, {}};
}

void HeightTool::preview(const haptic::HeightsMaker& maker, const engine::FieldView& view) {
  cancel();
  preview_.reset();
  fields_[maker.index()].settle(maker);
  asked_ = Wanted{maker, Becomes::kPreview, view};
}

haptic::HeightsMaker HeightTool::fieldsOf(std::size_t kind) const {
  using Maker = haptic::HeightsMaker;
  static_assert(std::variant_size_v<Maker> == kKinds);
  if (kind == Maker(fill).index()) return fill;
  return kind == Maker(lines).index() ? Maker(lines) : Maker(remove);
}

const haptic::HeightsMaker* HeightTool::newestPreview() const noexcept {
  if (asked_ && asked_->becomes == Becomes::kPreview) return &asked_->maker;
  if (computesPreview() || again_) return &wanted_.maker;
  return preview_ ? &preview_->maker : nullptr;
}

void HeightTool::follow(const std::function<engine::FieldView()>& view) {
  const auto now = PreviewPace::Clock::now();
  bool changed[kKinds];
  for (std::size_t kind = 0; kind < kKinds; ++kind) changed[kind] = fields_[kind].look(fieldsOf(kind), now);
  const haptic::HeightsMaker* const newest = newestPreview();
  if (newest == nullptr) return stopFollowing();
  const std::size_t kind = newest->index();
  for (std::size_t other = 0; other < kKinds; ++other)
    if (other != kind) fields_[other].settle();
  if (!fields_[kind].changed()) return;
  const engine::FieldView seen = view();
  if (changed[kind] && !paces_[kind].isSoon(seen.tiles.tiles())) return stopFollowing();
  if (changed[kind] && (computesPreview() || asked_)) {
    again_ = !asked_;
    working_.cancel();
    dropEarly();
  }
  if (!fields_[kind].rest(now) || (working_.busy() && !asked_)) return;
  const bool same = !again_ && !asked_ && *newest == fieldsOf(kind);
  stopFollowing();
  // The one that is shown stays until this is there.
  if (!same) asked_ = Wanted{fieldsOf(kind), Becomes::kPreview, seen};
  follows_ = !same;
}

void HeightTool::stopFollowing() noexcept {
  for (auto& fields : fields_) fields.settle();
  again_ = false;
  follows_ = false;
}

bool HeightTool::awaitsRest() const noexcept {
  return std::ranges::any_of(fields_, &RestingFields<haptic::HeightsMaker>::changed);
}

bool HeightTool::followsSoon() const {
  return awaitsRest() || (follows_ && (asked_ || PreviewPace::Clock::now() - begun_ < PreviewPace::kSoon));
}

void HeightTool::applyPreview() {
  if (!preview_) return;
  cancel();
  wanted_ = {preview_->maker, Becomes::kStep, {}};
  done_ = std::move(preview_->work);
  preview_.reset();
}

void HeightTool::dropPreview() {
  preview_.reset();
  stopFollowing();
  forgetFound();
}

void HeightTool::forgetFound() noexcept {
  found_.clear();
  made_from_.reset();
  made_ = false;
  changed_nothing_ = false;
}

bool HeightTool::forgetUndone(const LoopClient& client) {
  if (!made_from_) return false;
  const bool is_before = client.newest() == *made_from_;
  // There is no step to undo: it is of that state, and says nothing of another one.
  if (changed_nothing_ && !is_before) {
    forgetFound();
    return true;
  }
  made_ |= !is_before;  // the loop takes it in some ticks later
  if (!is_before || !made_) return false;
  forgetFound();
  return true;
}

void HeightTool::cancel() noexcept {
  stopFollowing();
  working_.cancel();
  asked_.reset();
  done_.reset();
  dropEarly();
}

void HeightTool::dropEarly() {
  moving_.cancel();
  seeing_.reset();
  early_.reset();
}

void HeightTool::Seeing::see(const engine::FieldView& view, engine::JobControl& job) {
  const auto show = [&](engine::EarlyPicture picture) {
    const std::scoped_lock lock(mutex);
    newest = Early{std::move(picture), view.tiles};
  };
  // Errors of the picture are those of the whole, which reports them.
  (void)heights.see(view, show, job);
}

bool HeightTool::wantsView() const {
  return seeing_ != nullptr && computesPreview() &&
         PreviewPace::Clock::now() - looked_ >= PreviewPace::kLookAgain;
}

void HeightTool::look(const engine::FieldView& view) {
  looked_ = PreviewPace::Clock::now();
  view_ = view;
}

// One view after the other: the newest when the one before is there.
void HeightTool::seeMoved() {
  (void)moving_.take();
  if (!seeing_ || !computesPreview() || moving_.busy() || view_.tiles == asked_tiles_) return;
  asked_tiles_ = view_.tiles;
  moving_.start([seeing = seeing_, view = view_](engine::JobControl& job) -> engine::Result<bool> {
    seeing->see(view, job);
    return true;
  });
}

bool HeightTool::moved() const noexcept {
  // Means are of all of the field.
  return early_->picture.step == 1 && !view_.tiles.empty() && !(early_->tiles == view_.tiles);
}

bool HeightTool::dropOutdated(const LoopClient& client) {
  const bool computing = computesPreview();
  if (!computing && !preview_) return false;
  const engine::Version now = client.newest();
  bool dropped = false;
  if (computing && !(base_ == now)) {
    cancel();
    dropped = true;
  }
  if (preview_ && !(preview_->work.base == now)) {
    dropPreview();
    dropped = true;
  }
  return dropped;
}

bool HeightTool::takeEarly() {
  if (!seeing_) return false;
  const std::scoped_lock lock(seeing_->mutex);
  if (!seeing_->newest) return false;
  early_ = std::exchange(seeing_->newest, std::nullopt);
  paces_[wanted_.maker.index()].see(PreviewPace::Clock::now());
  return true;
}

bool HeightTool::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = dropOutdated(client);
  changed |= takeEarly();
  changed |= forgetUndone(client);
  seeMoved();
  const bool dropped = working_.cancelling();
  if (auto result = working_.take()) {
    changed = true;
    base_ = {};
    dropEarly();
    if (!dropped && *result) {
      done_ = *std::move(*result);
    } else if (!dropped && result->error().kind != engine::ErrorKind::kCancelled) {
      // Of values on their way to others a notice would come for each of them: the panel says it, and the next values are
      // shown again.
      if (follows_ && wanted_.becomes == Becomes::kPreview) {
        found_ = result->error().what;
        again_ = true;
      } else {
        notices.push_back({result->error().what, result->error().remedy});
      }
    }
  }
  const bool step = wanted_.becomes == Becomes::kStep;
  // Under a stroke the field is another one every tick.
  if (done_ && !(step && client.strokeIsUnderWay())) {
    changed = true;
    forgetFound();
    found_ = foundIn(done_->heights, wanted_.maker, done_->base, done_->holes, step);
    if (step) {
      made_from_ = done_->base;
      changed_nothing_ = done_->base == done_->heights.field;
    }
    if (!step) {
      paces_[wanted_.maker.index()].see(PreviewPace::Clock::now());
      preview_ = Preview{wanted_.maker, *std::move(done_)};
    } else if (!(done_->base == done_->heights.field) &&
               !client.changeHeights(done_->base, done_->heights.field, makerName(wanted_.maker, done_->base),
                                     wanted_.maker)) {
      asked_ = wanted_;
    }
    done_.reset();
  }
  if (asked_ && !working_.busy() && !client.strokeIsUnderWay()) start(client);
  return changed;
}

void HeightTool::start(LoopClient& client) {
  wanted_ = *std::exchange(asked_, std::nullopt);
  client.awaitRestored();
  engine::Version base = client.newest();
  if (wanted_.becomes == Becomes::kPreview) {
    base_ = base;
    seeing_ = std::make_shared<Seeing>(base, wanted_.maker);
    view_ = wanted_.view;
    asked_tiles_ = view_.tiles;
    begun_ = looked_ = PreviewPace::Clock::now();
    paces_[wanted_.maker.index()].begin(begun_, wanted_.view.tiles.tiles());
  }
  working_.replace([base = std::move(base), wanted = wanted_,
                    seeing = seeing_](engine::JobControl& job) -> engine::Result<Work> {
    if (seeing) seeing->see(wanted.view, job);
    if (job.cancelled()) return engine::cancelled();
    auto heights = haptic::computeHeights(base, wanted.maker, job);
    if (!heights) return tl::unexpected(heights.error());
    const std::int64_t holes =
        std::holds_alternative<engine::FillOptions>(wanted.maker) ? holesIn(heights->field) : 0;
    return Work{base, *std::move(heights), holes};
  });
}

std::string HeightTool::previewName() const {
  return preview_ ? makerName(preview_->maker, preview_->work.base) : std::string();
}

std::string HeightTool::soFar() const {
  if (!early_) return {};
  return moved() ? tr("to come in view") : earlyState(early_->picture);
}

std::optional<PreviewPicture> HeightTool::picture() const {
  if (early_)
    return PreviewPicture{early_->picture.field,
                          fmt::format("{}: {}", makerName(wanted_.maker, base_), soFar())};
  if (preview_)
    return PreviewPicture{preview_->work.heights.field, makerName(preview_->maker, preview_->work.base)};
  return std::nullopt;
}

void HeightTool::clear() {
  cancel();
  preview_.reset();
  base_ = {};
  forgetFound();
}

}  // namespace fettle::app

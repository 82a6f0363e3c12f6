#include "app/work/section_tool.h"

#include <algorithm>
#include <cmath>

#include "app/texts/texts.h"
#include "app/work/section_noise.h"

namespace fettle::app {

namespace {

// A cut-off for roughness to begin with: the series of ISO 21920-3, of which five sampling lengths and two halves fit between the cursors.
double firstCutoff(double length_mm) {
  constexpr double kSeries_mm[] = {8.0, 2.5, 0.8, 0.25, 0.08, 0.025};
  for (const double cutoff : kSeries_mm)
    if (6.0 * cutoff <= length_mm) return cutoff;
  return length_mm / 6.0;
}

// Each figure, or why there is none.
std::vector<SectionLine> linesOf(const SectionWants& wants, const engine::Section& section,
                                 const engine::SectionNoise& noise, const SectionUnits& units,
                                 Report& report) {
  std::vector<SectionLine> lines;
  std::vector<SectionMark> marks;
  for (const std::string_view key : sectionFigureKeys()) {
    if (!wantsFigure(wants, key)) continue;
    auto figure = sectionFigure(key, wants, section, noise, marks);
    if (!figure) {
      lines.push_back({std::string(key), trFormat("not stated: {}", figure.error().what)});
      continue;
    }
    Report one;
    one[std::string(key)] = *figure;
    for (SectionLine& line : sectionLines(one, units)) lines.push_back(std::move(line));
    report[std::string(key)] = *std::move(figure);
  }
  return lines;
}

}  // namespace

void SectionTool::setFrom(const glm::dvec2& mm) {
  KeptSection changed = section() != nullptr ? *section() : KeptSection{.to = mm};
  changed.from = mm;
  set(changed);
}

void SectionTool::setTo(const glm::dvec2& mm) {
  KeptSection changed = section() != nullptr ? *section() : KeptSection{.from = mm};
  changed.to = mm;
  set(changed);
}

void SectionTool::set(const KeptSection& section) {
  if (chosen_ == sections_.size()) sections_.emplace_back();
  KeptSection& kept = sections_[chosen_];
  if (kept == section) return;
  const bool line = kept.from != section.from || kept.to != section.to,
             profile = kept.width_mm != section.width_mm;
  const double before = kept.lengthMm();
  kept = section;
  const double length = kept.lengthMm();
  if (line && before > 0.0 && length > 0.0)
    kept.scaleStretches(length / before);
  else if (line)
    kept.placeStretches();
  kept.placeSecond();
  if (!(kept.cutoff_mm > 0.0) && length > 0.0) kept.cutoff_mm = firstCutoff(0.5 * length);
  if (line || profile)
    lineChanged();
  else
    figures_due_ = profiles_.has_value();
}

void SectionTool::writeIn(const SectionUnits& units) {
  if (units == units_) return;
  units_ = units;
  figures_due_ = profiles_.has_value();
}

void SectionTool::lineChanged() {
  const KeptSection* const now = section();
  due_ = now != nullptr && now->lengthMm() > 0.0;
  if (!due_) {
    working_.cancel();
    measuring_.cancel();
    profiles_.reset();
    figures_ = {};
    figures_due_ = false;
  }
  ++revision_;
}

void SectionTool::beginNew() {
  chosen_ = sections_.size();
  lineChanged();
}

void SectionTool::next() {
  if (!sections_.empty()) choose(chosen_ + 1 < sections_.size() ? chosen_ + 1 : 0);
}

void SectionTool::choose(std::size_t section) {
  if (section >= sections_.size() || section == chosen_) return;
  chosen_ = section;
  profiles_.reset();
  figures_ = {};
  lineChanged();
}

void SectionTool::remove() {
  if (section() == nullptr) return;
  sections_.erase(sections_.begin() + static_cast<std::ptrdiff_t>(chosen_));
  if (chosen_ > 0 && chosen_ == sections_.size()) --chosen_;
  profiles_.reset();
  figures_ = {};
  lineChanged();
}

void SectionTool::restore(std::vector<KeptSection> sections) {
  reset();
  sections_ = taken_sections_ = std::move(sections);
  lineChanged();
}

void SectionTool::reset() {
  sections_.clear();
  taken_sections_.clear();
  chosen_ = 0;
  lineChanged();
  taken_ = noise_of_ = {};
  noise_.reset();
}

std::optional<std::size_t> SectionTool::chosen() const noexcept {
  return chosen_ < sections_.size() ? std::optional(chosen_) : std::nullopt;
}

std::optional<std::string> SectionTool::takeKept() {
  if (sections_ == taken_sections_) return std::nullopt;
  taken_sections_ = sections_;
  return sectionsText(sections_);
}

const KeptSection* SectionTool::section() const noexcept {
  return chosen_ < sections_.size() ? &sections_[chosen_] : nullptr;
}

void SectionTool::start(const LoopClient& client) {
  due_ = false;
  taken_ = client.newest();
  const std::optional<engine::SectionNoise> known = noise_of_ == client.original() ? noise_ : std::nullopt;
  working_.replace([field = taken_, scan = client.original(), kept = *section(),
                    known](engine::JobControl& job) -> engine::Result<Work> {
    engine::SectionOptions options;
    options.width_mm = kept.width_mm;
    const glm::dvec2 points[] = {kept.from, kept.to};
    auto now = engine::sectionAlong(field, points, options, job);
    if (!now) return tl::unexpected(now.error());
    Work work{{*std::move(now), {}, known.value_or(engine::SectionNoise{})}, scan};
    if (engine::measureChange(scan, field).tiles > 0) {
      auto before = engine::sectionAlong(scan, points, options, job);
      // Where the scan has holes that were filled there is no section of it.
      if (before) work.profiles.before = *std::move(before);
      if (job.cancelled()) return engine::cancelled();
    }
    if (!known) {
      const auto noise = sectionNoiseOf(scan, job);
      if (!noise) return tl::unexpected(noise.error());
      work.profiles.noise = *noise;
    }
    return work;
  });
}

void SectionTool::startFigures() {
  figures_due_ = false;
  measuring_.replace([profiles = *profiles_, wants = wantsOf(*section()),
                      units = units_](engine::JobControl&) -> engine::Result<Figures> {
    Figures figures;
    Report unused;
    figures.now = linesOf(wants, profiles.now, profiles.noise, units, figures.report);
    if (profiles.before.size() > 0)
      figures.before = linesOf(wants, profiles.before, profiles.noise, units, unused);
    return figures;
  });
}

bool SectionTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  bool changed = false;
  if (auto done = working_.take()) {
    changed = true;
    if (!dropped && *done) {
      noise_of_ = std::move((*done)->scan);
      noise_ = (*done)->profiles.noise;
      profiles_ = std::move((*done)->profiles);
      figures_due_ = true;
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      profiles_.reset();
      figures_ = {};
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  const bool unwanted = measuring_.cancelling();
  if (auto done = measuring_.take()) {
    changed = true;
    if (!unwanted && *done) figures_ = **std::move(done);
  }
  if (section() == nullptr) return changed;
  if (!due_ && (profiles_ || working_.busy()) && !(client.newest() == taken_)) due_ = true;
  // One that runs is ended first: waiting for it here would take a frame.
  if (due_ && working_.busy()) {
    working_.cancel();
  } else if (due_) {
    start(client);
  }
  if (figures_due_ && profiles_ && !working_.busy()) {
    if (measuring_.busy())
      measuring_.cancel();
    else
      startFigures();
  }
  return changed;
}

void SectionTool::moveCursor(double along_mm) {
  if (!profiles_ || section() == nullptr) return;
  KeptSection moved = *section();
  const double at = std::clamp(along_mm, 0.0, profiles_->now.lengthMm());
  double* nearest = &moved.cursors.first;
  const auto offer = [&](double& cursor) {
    if (std::abs(at - cursor) < std::abs(at - *nearest)) nearest = &cursor;
  };
  offer(moved.cursors.second);
  if (moved.angle) {
    offer(moved.others.first);
    offer(moved.others.second);
  }
  *nearest = at;
  set(moved);
}

}  // namespace fettle::app

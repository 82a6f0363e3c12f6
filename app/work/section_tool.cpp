#include "app/work/section_tool.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "engine/inspect/noise.h"

namespace fettle::app {

void SectionTool::setFrom(const glm::dvec2& mm) {
  setLine({mm, line_ ? line_->to : mm});
}

void SectionTool::setTo(const glm::dvec2& mm) {
  setLine({line_ ? line_->from : mm, mm});
}

void SectionTool::setLine(const Line& line) {
  if (line_ == line) return;
  line_ = line;
  lineChanged();
}

void SectionTool::setWidth(double mm) {
  if (width_mm_ == mm) return;
  width_mm_ = mm;
  if (line_) lineChanged();
}

// Cursors at a quarter and three quarters, until they are moved.
void SectionTool::lineChanged() {
  const double length = glm::distance(line_->from, line_->to);
  cursors_ = {0.25 * length, 0.75 * length};
  due_ = length > 0.0;
  if (!due_) profiles_.reset();
  ++revision_;
}

void SectionTool::clear() {
  working_.cancel();
  line_.reset();
  profiles_.reset();
  due_ = false;
  ++revision_;
}

void SectionTool::reset() {
  clear();
  taken_ = noise_of_ = {};
  noise_mm_.reset();
}

void SectionTool::start(const LoopClient& client) {
  due_ = false;
  taken_ = client.newest();
  const std::optional<double> known = noise_of_ == client.original() ? noise_mm_ : std::nullopt;
  working_.start([field = taken_, scan = client.original(), line = *line_, width = width_mm_,
                  known](engine::JobControl& job) -> engine::Result<Work> {
    engine::SectionOptions options;
    options.width_mm = width;
    const glm::dvec2 points[] = {line.from, line.to};
    auto now = engine::sectionAlong(field, points, options, job);
    if (!now) return tl::unexpected(now.error());
    Work work{{*std::move(now), {}, known.value_or(0.0)}, scan};
    if (engine::measureChange(scan, field).tiles > 0) {
      auto before = engine::sectionAlong(scan, points, options, job);
      // Where the scan has holes that were filled there is no section of it.
      if (before) work.profiles.before = *std::move(before);
      if (job.cancelled()) return engine::cancelled();
    }
    if (!known) {
      const auto noise = engine::estimateNoise(scan, job);
      if (!noise) return tl::unexpected(noise.error());
      work.profiles.noise_mm = noise->sigma * scan.grid().height_unit.mm;
    }
    return work;
  });
}

bool SectionTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  bool changed = false;
  if (auto done = working_.take()) {
    changed = true;
    if (!dropped && *done) {
      noise_of_ = std::move((*done)->scan);
      noise_mm_ = (*done)->profiles.noise_mm;
      profiles_ = std::move((*done)->profiles);
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      profiles_.reset();
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  if (!line_) return changed;
  if (!due_ && (profiles_ || working_.busy()) && !(client.newest() == taken_)) due_ = true;
  // One that runs is ended first: waiting for it here would take a frame.
  if (due_ && working_.busy()) {
    working_.cancel();
  } else if (due_) {
    start(client);
  }
  return changed;
}

void SectionTool::moveCursor(double along_mm) {
  if (!profiles_) return;
  const double at = std::clamp(along_mm, 0.0, profiles_->now.lengthMm());
  double& nearer =
      std::abs(at - cursors_.first) <= std::abs(at - cursors_.second) ? cursors_.first : cursors_.second;
  nearer = at;
}

std::optional<engine::CursorFigures> SectionTool::between() const {
  if (!profiles_) return std::nullopt;
  const auto figures =
      engine::cursorFigures(profiles_->now, cursors_.first, cursors_.second, profiles_->noise_mm);
  return figures ? std::optional(*figures) : std::nullopt;
}

std::optional<engine::CursorFigures> SectionTool::betweenBefore() const {
  if (!profiles_ || profiles_->before.size() == 0) return std::nullopt;
  const auto figures =
      engine::cursorFigures(profiles_->before, cursors_.first, cursors_.second, profiles_->noise_mm);
  return figures ? std::optional(*figures) : std::nullopt;
}

}  // namespace fettle::app

#include "app/work/compare_tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/texts/texts.h"
#include "app/work/estimate_text.h"
#include "app/work/less_distances.h"
#include "app/work/read_units.h"
#include "app/work/repeat_text.h"
#include "engine/compare/compare.h"
#include "engine/field/difference.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/measure/moved_onto.h"

namespace fettle::app {

namespace {

// None: the other stays where it is.
std::optional<engine::AlignOptions> alignOptionsOf(const CompareTool::Options& what,
                                                   const std::string& path) {
  if (!what.moves) return std::nullopt;
  engine::AlignOptions how;
  how.words = {
      .first = tr("this scan"),
      .second = std::filesystem::path(path).filename().string(),
      .wider = trFormat("a turn by more than {:.3g} degrees is not looked for here", how.most_rotation_deg)};
  how.moves = *what.moves;
  how.region = what.region;
  return how;
}

std::string figureLine(const char* name, double value, double error, double scale, const std::string& unit) {
  if (!(error > 0.0)) return fmt::format("{}: not free", name);
  return fmt::format("{} {} +- {:.2g} {}", name, shownTo(value * scale, error * scale), error * scale, unit);
}

std::vector<std::string> linesOf(const CompareTool::Compared& compared) {
  std::vector<std::string> lines;
  if (const auto& found = compared.alignment) {
    const glm::dvec3 &shift = found->motion.shift, &error = found->shift_error;
    const ReadAs as =
        readOnScreenAs(std::max({std::abs(shift.x), std::abs(shift.y), std::abs(shift.z)}), 1.0, "mm");
    lines.push_back(figureLine("shift x", shift.x, error.x, 1.0 / as.size, as.name));
    lines.push_back(figureLine("shift y", shift.y, error.y, 1.0 / as.size, as.name));
    lines.push_back(figureLine("shift z", shift.z, error.z, 1.0 / as.size, as.name));
    lines.push_back(
        figureLine("rotation z", found->angles.rotation_z, found->angle_error.rotation_z, 1.0, "degrees"));
    lines.push_back(figureLine("tilt x", found->angles.tilt_x, found->angle_error.tilt_x, 1.0, "degrees"));
    lines.push_back(figureLine("tilt y", found->angles.tilt_y, found->angle_error.tilt_y, 1.0, "degrees"));
    lines.push_back(
        fmt::format("{:.3g} % of the samples lie apart and do not count", 100.0 * found->left_out));
    if (found->repeat)
      lines.push_back(repeatText(*found->repeat, readOnScreenAs(glm::length(*found->repeat), 1.0, "mm")));
  }
  const ReadAs height = readOnScreenAs(compared.rms_mm, 1.0, "mm");
  lines.push_back(fmt::format("deviation: rms {:.4g}, mean {:.4g}, largest {:.4g} {}, {} samples",
                              compared.rms_mm / height.size, compared.mean_mm / height.size,
                              compared.most_mm / height.size, height.name, compared.samples));
  if (compared.tolerated) {
    const auto& [within, above, below] = *compared.tolerated;
    const ReadAs as = readOnScreenAs(compared.tolerance_mm, 1.0, "mm");
    lines.push_back(fmt::format(
        "within {:.4g} {}: {:.4g} % ({}), above {}, below {}", compared.tolerance_mm / as.size, as.name,
        100.0 * static_cast<double>(within) / static_cast<double>(compared.samples), within, above, below));
  }
  lines.insert(lines.end(), compared.remarks.begin(), compared.remarks.end());
  if (compared.restored) lines.emplace_back("heights count with the form that was taken out");
  return lines;
}

}  // namespace

void CompareTool::compareWith(const LoopClient& client, std::string path, const ScanOptions& reading) {
  reading_ = reading;
  following_ = false;
  path_ = std::move(path);
  read_ = std::make_shared<std::atomic<bool>>(false);
  work_.begin([field = client.newest(), path = path_, reading = reading_, what = options,
               read = read_](engine::JobControl& job) {
    return isNominalFile(path) ? withMesh(field, path, what, job)
                               : withScan(field, path, reading, what, *read, job);
  });
}

engine::Result<CompareTool::Work> CompareTool::withScan(const engine::Version& field, const std::string& path,
                                                        const ScanOptions& reading, const Options& what,
                                                        std::atomic<bool>& read, engine::JobControl& job) {
  const auto import = importOptions(reading);
  if (!import) return tl::unexpected(import.error());
  const auto other = engine::importField(path, *import, job);
  if (!other) return tl::unexpected(other.error());
  // Until the next stage the bar is at its beginning again.
  job.begin("comparing", 0);
  read.store(true, std::memory_order_relaxed);  // it is only shown
  // Both as they were measured: one may be seen without a form that the other still has.
  const auto samples = engine::withoutLayer(field, job);
  if (!samples) return tl::unexpected(samples.error());
  const auto others = engine::withoutLayer(other->field, job);
  if (!others) return tl::unexpected(others.error());
  Work work;
  work.samples = *samples;
  work.compared.path = path;
  work.compared.restored = field.formOver() != nullptr || other->field.formOver() != nullptr;
  engine::RigidMotion motion;
  if (const auto how = alignOptionsOf(what, path)) {
    const auto found = engine::alignFields(*samples, *others, *how, job);
    if (!found) return tl::unexpected(found.error());
    motion = found->motion;
    work.compared.alignment = *found;
  }
  auto moved = engine::movedOnto(*others, motion, samples->grid(), job);
  if (!moved) return tl::unexpected(moved.error());
  const auto deviation = engine::compareFields(*moved, *samples, job);
  if (!deviation) return tl::unexpected(deviation.error());
  if (deviation->samples == 0)
    return engine::inputError("nothing of it lies over the field", path, "let it be moved: choose all");
  const double mm = samples->grid().height_unit.mm;
  work.compared.rms_mm = deviation->rms * mm;
  work.compared.mean_mm = deviation->mean * mm;
  work.compared.most_mm = deviation->max_abs * mm;
  work.compared.samples = deviation->samples;
  work.compared.moved = *std::move(moved);
  if (auto seen = see(work, field, job); !seen) return tl::unexpected(seen.error());
  return work;
}

engine::Result<CompareTool::Work> CompareTool::withMesh(const engine::Version& field, const std::string& path,
                                                        const Options& what, engine::JobControl& job) {
  const auto samples = engine::withoutLayer(field, job);
  if (!samples) return tl::unexpected(samples.error());
  const auto found = compareWithNominal(*samples, path, what.nominal, alignOptionsOf(what, path), job);
  if (!found) return tl::unexpected(found.error());
  auto moved = lessDistances(*samples, found->deviation.field, job);
  if (!moved) return tl::unexpected(moved.error());
  const engine::NominalDeviation& deviation = found->deviation;
  const double mm = samples->grid().height_unit.mm;
  Work work;
  work.samples = *samples;
  Compared& compared = work.compared;
  compared.path = path;
  compared.restored = field.formOver() != nullptr;
  compared.alignment = found->alignment;
  compared.rms_mm = deviation.rms * mm;
  compared.mean_mm = deviation.mean * mm;
  compared.most_mm = deviation.max_abs * mm;
  compared.samples = deviation.samples;
  compared.remarks = found->remarks;
  compared.moved = *std::move(moved);
  if (what.nominal.tolerance > 0.0) {
    compared.tolerated = {deviation.within, deviation.above, deviation.below};
    compared.tolerance_mm = what.nominal.tolerance * mm;
  }
  if (auto seen = see(work, field, job); !seen) return tl::unexpected(seen.error());
  return work;
}

engine::Status CompareTool::see(Work& work, const engine::Version& field, engine::JobControl& job) {
  const auto seen = engine::seenLike(work.compared.moved, field, job);
  if (!seen) return tl::unexpected(seen.error());
  work.compared.other = *seen;
  work.compared.under = field.formOver();
  work.field = field;
  return {};
}

// A form came over the field or went: the other scan is seen under it as well, what was found stays.
void CompareTool::followForm(const LoopClient& client) {
  following_ = true;
  work_.begin([field = client.newest(),
               work = *work_.get()](engine::JobControl& job) mutable -> engine::Result<Work> {
    const engine::Version before = work.field;
    if (auto seen = see(work, field, job); !seen) return tl::unexpected(seen.error());
    const auto samples = engine::withoutLayer(field, job);
    if (!samples) return tl::unexpected(samples.error());
    if (!engine::sameHeights(work.samples, *samples)) work.field = before;
    return work;
  });
}

std::string CompareTool::doing() const {
  if (following_) return tr("comparing");
  const std::string_view stage = work_.stage();
  // A session is read in several stages. Before the first one a file is opened.
  const bool reads = isNominalFile(path_) ? stage.empty() || stage == "reading"
                                          : read_ && !read_->load(std::memory_order_relaxed);
  if (reads) return trFormat("reading {}", std::filesystem::path(path_).filename().string());
  return stage == "aligning" ? tr("aligning") : tr("comparing");
}

bool CompareTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const auto polled = work_.poll(client, notices);
  if (polled.taken) lines_ = linesOf(*compared());
  // Else it would be tried again for ever.
  if (polled.failed && following_) clear();
  if (compared() == nullptr || work_.busy() || client.newest().formOver() == compared()->under)
    return polled.changed;
  followForm(client);
  return true;
}

const engine::Version* CompareTool::beside(const engine::Version& field) const noexcept {
  return compared() != nullptr && compared()->under == field.formOver() ? &compared()->other : nullptr;
}

void CompareTool::clear() {
  work_.clear();
  lines_.clear();
}

}  // namespace fettle::app

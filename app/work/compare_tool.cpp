#include "app/work/compare_tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/work/estimate_text.h"
#include "app/work/read_units.h"
#include "engine/compare/compare.h"
#include "engine/formats/formats.h"
#include "engine/measure/moved_onto.h"

namespace fettle::app {

namespace {

constexpr engine::AlignMoves kMovesOf[] = {
    {true, true, true}, {true, true, false}, {true, false, false}, {false, false, true}};

std::string figureLine(const char* name, double value, double error, double scale, const std::string& unit) {
  if (!(error > 0.0)) return fmt::format("{} {:.4g} {}, not free", name, value * scale, unit);
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
  }
  const ReadAs height = readOnScreenAs(compared.rms_mm, 1.0, "mm");
  lines.push_back(fmt::format("deviation: rms {:.4g}, mean {:.4g}, largest {:.4g} {}, {} samples",
                              compared.rms_mm / height.size, compared.mean_mm / height.size,
                              compared.most_mm / height.size, height.name, compared.samples));
  return lines;
}

}  // namespace

void CompareTool::compareWith(const LoopClient& client, std::string path, const ScanOptions& reading) {
  reading_ = reading;
  working_.start([field = client.newest(), path = std::move(path), reading = reading_,
                  what = options](engine::JobControl& job) -> engine::Result<Work> {
    const auto import = importOptions(reading);
    if (!import) return tl::unexpected(import.error());
    const auto other = engine::importField(path, *import, job);
    if (!other) return tl::unexpected(other.error());
    Work work{field, {}};
    work.compared.path = path;
    engine::RigidMotion motion;
    if (what.moves != Moves::kNone) {
      engine::AlignOptions how;
      how.moves = kMovesOf[static_cast<std::size_t>(what.moves)];
      how.region = what.region;
      const auto found = engine::alignFields(field, other->field, how, job);
      if (!found) return tl::unexpected(found.error());
      motion = found->motion;
      work.compared.alignment = *found;
    }
    auto moved = engine::movedOnto(other->field, motion, field.grid(), job);
    if (!moved) return tl::unexpected(moved.error());
    const auto deviation = engine::compareFields(*moved, field, job);
    if (!deviation) return tl::unexpected(deviation.error());
    if (deviation->samples == 0)
      return engine::inputError("nothing of it lies over the field", path, "let it be moved: choose all");
    const double mm = field.grid().height_unit.mm;
    work.compared.other = *std::move(moved);
    work.compared.rms_mm = deviation->rms * mm;
    work.compared.mean_mm = deviation->mean * mm;
    work.compared.most_mm = deviation->max_abs * mm;
    work.compared.samples = deviation->samples;
    return work;
  });
}

bool CompareTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  bool changed = false;
  if (auto done = working_.take()) {
    changed = true;
    if (!dropped && *done) {
      of_ = std::move((*done)->field);
      compared_ = std::move((*done)->compared);
      lines_ = linesOf(*compared_);
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().line(), done->error().remedy});
    }
  }
  if (!compared_) return changed;
  const bool outdated = !(client.newest() == of_);
  return std::exchange(outdated_, outdated) != outdated || changed;
}

void CompareTool::clear() {
  working_.cancel();
  compared_.reset();
  lines_.clear();
  of_ = {};
  outdated_ = false;
}

}  // namespace fettle::app

#include "app/work/fit_tool.h"

#include <utility>

#include <fmt/format.h>

#include "app/work/less_distances.h"
#include "engine/inspect/noise.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

std::vector<engine::ShapeKind> kindsOf(const FitTool::Options& options) {
  if (options.shape) return {*options.shape};
  std::vector<engine::ShapeKind> kinds;
  for (const engine::ShapeInfo& info : engine::shapeInfos()) kinds.push_back(info.kind);
  return kinds;
}

engine::Result<std::vector<engine::FitRegion>> fittedRegions(const engine::Version& field,
                                                             const FitTool::Options& options,
                                                             engine::JobControl& job) {
  const bool lines = options.between_lines && field.lines() != nullptr && !field.lines()->empty();
  if (lines) {
    engine::FitRegionOptions how;
    how.region = options.region;
    auto regions = engine::regionsBetween(field, *field.lines(), how, job);
    if (regions && regions->empty())
      return engine::inputError(fmt::format("nothing between the edge lines has {} samples", how.least), "",
                                "let all samples count, or fit across the lines");
    return regions;
  }
  auto whole = engine::wholeRegion(field, options.region, job);
  if (!whole) return tl::unexpected(whole.error());
  if (whole->samples == 0)
    return engine::inputError("no sample counts", "",
                              options.region == engine::Region::kAll ? "every sample is a hole"
                                                                     : "mark samples, or fit to all of them");
  return std::vector<engine::FitRegion>{*std::move(whole)};
}

}  // namespace

void FitTool::fit(const LoopClient& client) {
  working_.replace(
      [field = client.newest(), what = options](engine::JobControl& job) -> engine::Result<Work> {
        const auto noise = engine::estimateNoise(field, job);
        if (!noise) return tl::unexpected(noise.error());
        auto regions = fittedRegions(field, what, job);
        if (!regions) return tl::unexpected(regions.error());
        engine::FitOptions how;
        how.vertical = what.vertical;
        how.robust = what.robust;
        how.noise_mm = noise->sigma * field.grid().height_unit.mm;
        auto fits = fitEach(field, *std::move(regions), kindsOf(what), how, job);
        if (!fits) return tl::unexpected(fits.error());
        const auto distances = residualField(field, fits->fitted, what.vertical, job);
        if (!distances) return tl::unexpected(distances.error());
        auto surface = lessDistances(field, *distances, job);
        if (!surface) return tl::unexpected(surface.error());
        return Work{field, *std::move(fits), *std::move(surface)};
      });
}

bool FitTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  bool changed = false;
  if (auto done = working_.take()) {
    changed = true;
    if (!dropped && *done) {
      work_ = **std::move(done);
      pair_.reset();
      if (work_->fits.fitted.size() > 1) setPair(0, 1);
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  if (!work_) return changed;
  const bool outdated = !(client.newest() == work_->field);
  return std::exchange(outdated_, outdated) != outdated || changed;
}

const engine::Version* FitTool::surface(const engine::Version& field) const noexcept {
  return work_ && work_->field.formOver() == field.formOver() ? &work_->surface : nullptr;
}

void FitTool::setPair(std::size_t first, std::size_t second) {
  pair_ = std::pair(first, second);
  const std::vector<FittedRegion>& fitted = work_->fits.fitted;
  // Both have a fit.
  (void)addRelation(work_->fits, fitted[first].number, fitted[second].number);
}

void FitTool::clear() {
  working_.cancel();
  work_.reset();
  pair_.reset();
  outdated_ = false;
}

engine::Status writeFits(const FieldFits& fits, const engine::Version& field, const std::string& path) {
  const std::string ending = engine::extensionOf(path);
  if (ending == ".csv") return engine::writeFileAtomically(path, fitCsv(fits.report));
  if (ending == ".step" || ending == ".stp")
    return engine::writeFileAtomically(path, fitStep(field, fits.fitted));
  if (ending == ".json") {
    Report report{{"schema", "fettle.fit/1"}};
    report.update(fits.report);
    return engine::writeFileAtomically(path, report.dump(2) + "\n");
  }
  return engine::inputError(fmt::format("fits are not written as {}", ending), path,
                            "take .csv, .json, .step or .stp");
}

}  // namespace fettle::app

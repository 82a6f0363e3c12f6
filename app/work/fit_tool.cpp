#include "app/work/fit_tool.h"

#include <utility>

#include <fmt/format.h>

#include "app/work/fit_noise.h"
#include "app/work/hole_count.h"
#include "app/work/less_distances.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"
#include "engine/measure/region.h"

namespace fettle::app {
namespace {

std::vector<engine::ShapeKind> kindsOf(const FitTool::Options& options) {
  if (options.shape) return {*options.shape};
  std::vector<engine::ShapeKind> kinds;
  for (const engine::ShapeInfo& info : engine::shapeInfos()) kinds.push_back(info.kind);
  return kinds;
}

// Who has marked something and fits means that.
engine::Region countedIn(const engine::Version& field, const FitTool::Options& options) {
  if (options.region) return *options.region;
  return engine::anyIn(field.reader(), engine::Region::kMarked) ? engine::Region::kMarked
                                                                : engine::Region::kAll;
}

engine::Result<std::vector<engine::FitRegion>> fittedRegions(const engine::Version& field,
                                                             const FitTool::Options& options,
                                                             engine::Region region, engine::JobControl& job) {
  const bool lines = options.between_lines && field.lines() != nullptr && !field.lines()->empty();
  if (lines) {
    engine::FitRegionOptions how;
    how.region = region;
    auto regions = engine::regionsBetween(field, *field.lines(), how, job);
    if (regions && regions->empty())
      return engine::inputError(fmt::format("nothing between the edge lines has {} samples", how.least), "",
                                "let all samples count, or fit across the lines");
    return regions;
  }
  auto whole = engine::wholeRegion(field, region, job);
  if (!whole) return tl::unexpected(whole.error());
  if (whole->samples == 0) return engine::nothingIn(region, "");
  return std::vector<engine::FitRegion>{*std::move(whole)};
}

}  // namespace

void FitTool::fit(const LoopClient& client) {
  work_.begin([field = client.newest(), what = options](engine::JobControl& job) -> engine::Result<Work> {
    const engine::Region region = countedIn(field, what);
    auto regions = fittedRegions(field, what, region, job);
    if (!regions) return tl::unexpected(regions.error());
    engine::FitOptions how;
    how.vertical = what.vertical;
    how.robust = what.robust;
    if (auto status = setNoise(how, field, job); !status) return tl::unexpected(status.error());
    auto fits = fitEach(field, *std::move(regions), kindsOf(what), how, job);
    if (!fits) return tl::unexpected(fits.error());
    const auto distances = residualField(field, fits->fitted, what.vertical, job);
    if (!distances) return tl::unexpected(distances.error());
    auto surface = lessDistances(field, *distances, job);
    if (!surface) return tl::unexpected(surface.error());
    const bool leaves_out = holesIn(*surface) > holesIn(field);
    return Work{field, *std::move(fits), *std::move(surface), region, leaves_out};
  });
}

bool FitTool::poll(const LoopClient& client, std::vector<Notice>& notices) {
  const auto polled = work_.poll(client, notices);
  if (polled.taken) {
    pair_.reset();
    if (work_.get()->fits.fitted.size() > 1) setPair(0, 1);
  }
  return polled.changed;
}

void FitTool::setPair(std::size_t first, std::size_t second) {
  pair_ = std::pair(first, second);
  const std::vector<FittedRegion>& fitted = work_.get()->fits.fitted;
  // Both have a fit.
  (void)addRelation(work_.get()->fits, fitted[first].number, fitted[second].number);
}

void FitTool::clear() {
  work_.clear();
  pair_.reset();
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

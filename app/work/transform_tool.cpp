#include "app/work/transform_tool.h"

#include <cmath>
#include <utility>

#include "app/texts/texts.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

engine::Result<engine::Version> transformedBy(const engine::Version& field,
                                              const TransformTool::Options& options,
                                              const engine::SampleRect& seen, engine::JobControl& job) {
  engine::Version now = field;
  if (options.crop) {
    auto piece = engine::cropped(now, seen, job);
    if (!piece) return piece;
    now = *std::move(piece);
  }
  // Whole quarters need no new height.
  const bool resamples = options.resample || std::fmod(options.angle_deg, 90.0) != 0.0;
  engine::Turning turning = options.turning;
  if (!resamples)
    turning.quarters = ((turning.quarters + static_cast<int>(options.angle_deg / 90.0)) % 4 + 4) % 4;
  if (!turning.none()) {
    auto turned = engine::turned(now, turning, job);
    if (!turned) return turned;
    now = *std::move(turned);
  }
  if (!resamples) return now;
  const engine::Grid& grid = now.grid();
  engine::ResampleOptions resampling;
  resampling.method = options.method;
  resampling.angle_deg = options.angle_deg;
  const double spacing = options.spacing_mm / grid.lateral_unit.mm;
  resampling.spacing_x = options.resample ? spacing : grid.spacing_x;
  resampling.spacing_y = options.resample ? spacing : grid.spacing_y;
  return engine::resampled(now, resampling, job);
}

}  // namespace

void TransformTool::write(const LoopClient& client, const engine::SampleRect& seen, std::string path) {
  working_.start([field = client.newest(), scan = client.scan(), what = options, seen,
                  path = std::move(path)](engine::JobControl& job) -> engine::Result<Work> {
    if (what.none())
      return engine::inputError("nothing is to be done", "", "choose a crop, a turn or a spacing");
    if (what.crop && (seen.columns <= 0 || seen.rows <= 0))
      return engine::inputError("nothing of the field is visible", "", "move the view to it");
    const auto made = transformedBy(field, what, seen, job);
    if (!made) return tl::unexpected(made.error());
    // What the session begins with lies under the same form.
    const engine::FieldForm& form = field.formOver();
    const auto first = form == nullptr ? engine::Result<engine::Version>(scan)
                                       : engine::seenNear(scan.withForm(form), field, job);
    if (!first) return tl::unexpected(first.error());
    auto original = transformedBy(*first, what, seen, job);
    if (!original) return tl::unexpected(original.error());
    engine::ExportOptions writing;
    writing.original = *std::move(original);
    writing.recipe = writing.steps =
        "recipe = 1\n# Left out: what made the scan of step 0: the window transformed it\n";
    if (auto done = engine::exportField(*made, path, writing, job); !done)
      return tl::unexpected(done.error());
    return Work{path, form != nullptr && made->formOver() == nullptr};
  });
}

std::optional<std::string> TransformTool::poll(std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  auto done = working_.take();
  if (!done || dropped) return std::nullopt;
  if (*done) {
    if ((*done)->form_left_out)
      notices.push_back(
          {textOf("the form that lies over the scan has no place over the new samples: they have their "
                  "heights with it"),
           textOf("put a form over them, or choose a larger part")});
    return std::move((*done)->path);
  }
  if (done->error().kind != engine::ErrorKind::kCancelled) notices.push_back(noticeOf(done->error()));
  return std::nullopt;
}

}  // namespace fettle::app

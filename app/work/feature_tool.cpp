#include "app/work/feature_tool.h"

#include <utility>

#include "app/work/layer_over.h"
#include "app/work/less_distances.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/form.h"

namespace fettle::app {

void FeatureTool::find(const LoopClient& client) {
  work_.begin([field = client.newest(), what = options](engine::JobControl& job) -> engine::Result<Work> {
    const auto fit =
        engine::fitForm(field, {.degree = what.degree, .region = what.what.region, .robust = false}, job);
    auto features = fit ? featuresOf(field, fit->form, what.what, "", job)
                        : engine::Result<FieldFeatures>(tl::unexpected(fit.error()));
    if (!features) return tl::unexpected(features.error());
    const auto heights = featureHeights(*features, field.grid(), job);
    if (!heights) return tl::unexpected(heights.error());
    auto saddles = lessDistances(field, *heights, job);
    if (!saddles) return tl::unexpected(saddles.error());
    Report report;
    addLayer(report, field);
    report.update(featureReport(*features, field.grid()));
    return Work{field, std::move(report), *std::move(saddles)};
  });
}

engine::Status writeFeatures(const Report& report, const std::string& path) {
  return engine::writeFileAtomically(path, featureCsv(report));
}

}  // namespace fettle::app

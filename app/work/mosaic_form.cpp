#include "app/work/mosaic_form.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "app/work/read_units.h"
#include "engine/inspect/noise_model.h"
#include "engine/measure/form_kind.h"
#include "engine/mosaic/common_form.h"
#include "engine/transform/form_along.h"

namespace fettle::app {

engine::Result<FormedMosaic> underCommonForm(const engine::JoinedScans& joined,
                                             const std::vector<engine::Version>& scans,
                                             const std::vector<engine::FieldForm>& forms,
                                             const std::vector<std::string>& names, engine::JobControl& job) {
  constexpr const char* kInstead =
      "the mosaic has its heights with the form: put one over it (fettle level --layer put)";
  const auto with = std::ranges::find_if(forms, [](const auto& form) { return form != nullptr; });
  if (with == forms.end()) return FormedMosaic{joined.field, {}};
  if (const auto without = std::ranges::find(forms, nullptr); without != forms.end())
    return FormedMosaic{
        joined.field,
        fmt::format("a form, {}, lies over {} and none over {}: {}", engine::infoOf(**with).word,
                    names[static_cast<std::size_t>(with - forms.begin())],
                    names[static_cast<std::size_t>(without - forms.begin())], kInstead)};
  const auto common = engine::commonForm(scans, forms, joined.poses, joined.field.grid());
  if (!common)
    return FormedMosaic{joined.field,
                        fmt::format("the form {} of {} cannot be continued over all scans: {}",
                                    engine::infoOf(*forms.front()).word, names.front(), kInstead)};
  const auto noise = engine::measureNoise(scans.front(), job);
  if (!noise) return tl::unexpected(noise.error());
  // What rounding makes of forms that are the same.
  constexpr double kRounding = 1e-9;
  const double sigma = noise->sigma * scans.front().grid().height_unit.mm;
  if (common->apart_mm > std::max(sigma, kRounding)) {
    const ReadAs height = readLengthAs(common->apart_mm, 1.0, "mm");
    return FormedMosaic{
        joined.field,
        fmt::format(
            "the forms that lie over {} and {} are {:.3g} {} apart, more than the noise of {:.3g} {}: {}",
            names.front(), names[common->farthest], common->apart_mm / height.size, height.name,
            sigma / height.size, height.name, kInstead)};
  }
  auto seen = engine::seenUnder(joined.field, common->form, job);
  if (!seen) return tl::unexpected(seen.error());
  return FormedMosaic{*std::move(seen), {}};
}

}  // namespace fettle::app

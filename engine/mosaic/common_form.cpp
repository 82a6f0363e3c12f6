#include "engine/mosaic/common_form.h"

#include <cassert>
#include <cmath>

#include <glm/vec3.hpp>

#include "engine/field/moved_form.h"

namespace fettle::engine {

std::optional<CommonForm> commonForm(const std::vector<Version>& scans, const std::vector<FieldForm>& forms,
                                     const AdjustedPoses& poses, const Grid& grid) {
  assert(forms.size() == scans.size() && poses.poses.size() == scans.size());
  const Grid& first = scans.front().grid();
  // Whole samples, which far from zero are rounded.
  const PlaceMap places{.first = {std::round((grid.origin_x - first.origin_x) / first.spacing_x),
                                  std::round((grid.origin_y - first.origin_y) / first.spacing_y)}};
  auto form = movedForm(*forms.front(), places, grid.width, grid.height);
  if (!form) return std::nullopt;
  CommonForm common{*std::move(form)};
  constexpr int kPlaces = 24;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    const Grid& own = scans[k].grid();
    for (int r = 0; r <= kPlaces; ++r)
      for (int c = 0; c <= kPlaces; ++c) {
        const double column = (own.width - 1) * c / double{kPlaces},
                     row = (own.height - 1) * r / double{kPlaces};
        const glm::dvec3 p = poses.poses[k].moved({column * own.spacingXMm(), row * own.spacingYMm(),
                                                   own.height_unit.mm * forms[k]->heightAt(column, row)});
        const double there =
            grid.height_unit.mm * common.form.heightAt(p.x / grid.spacingXMm() - places.first.x,
                                                       p.y / grid.spacingYMm() - places.first.y);
        if (const double apart = std::abs(p.z - there); apart > common.apart_mm) {
          common.apart_mm = apart;
          common.farthest = k;
        }
      }
  }
  return common;
}

}  // namespace fettle::engine

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/transform/rearrange.h"
#include "tests/engine/filter/reference.h"
#include "tests/support/shared_data.h"

namespace fettle::engine::tests {
namespace {

// The middle of a field, 256 x 192 samples at most.
Version middleOf(const Version& field) {
  const std::int32_t columns = std::min(field.grid().width, 256), rows = std::min(field.grid().height, 192);
  JobControl job;
  Result<Version> middle = cropped(
      field, {(field.grid().width - columns) / 2, (field.grid().height - rows) / 2, columns, rows}, job);
  EXPECT_TRUE(middle);
  return std::move(*middle);
}

class Scans : public testing::TestWithParam<const char*> {};

TEST_P(Scans, AreFilteredAsNearTheReferenceAsStatedAndTheMedianExactly) {
  FETTLE_SCAN_OR_SKIP(path, GetParam());
  JobControl job;
  ImportOptions options;
  if (path.find("_u16") != std::string::npos) options.no_data = 0.0;  // these files cannot say so
  const Result<Imported> imported = importField(path, options, job);
  ASSERT_TRUE(imported) << imported.error().line();
  // What is solved over the whole of a field takes a minute for some of these.
  const Version whole = imported->field, middle = middleOf(whole);
  const PlainField plain_whole = toPlain(whole), plain_middle = toPlain(middle);
  for (const FilterKind kind : kEveryKind) {
    const bool in_part = separatesScales(filterOf(kind));
    for (const int window : windowsOf(kind, {3, 9, 31})) {
      SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(window));
      FilterSpec spec = makeSpec(kind, window);
      // Scans in counts: a step is a difference to be smoothed.
      if (hasRange(kind)) spec.range_sigma = path.find("_u16") != std::string::npos ? 2.0 : 0.25;
      const Filtered result = filtered(in_part ? middle : whole, spec);
      // Holes and their neighbours everywhere, windows at about 1000 places.
      EXPECT_EQ(checkPass(in_part ? plain_middle : plain_whole, toPlain(result.field), spec, 1000), "");
      // Of some scans no sample stands apart by so much.
      if (kind != FilterKind::kOutliers) {
        EXPECT_GT(result.report.changed, 0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Real, Scans,
                         testing::Values("dsm_ahn_buildings.tif", "dsm_village_sjtsk.tif",
                                         "shapes_plate_u16.png", "tray_bags_aniso_u16.tif",
                                         "kinect_boxes_depth_u16.tif", "tidal_marsh.asc",
                                         "chip_confocal_points.xyz", "cylinders_cloud_le.ply",
                                         "afm_line_noise_f32.tif"),
                         [](const auto& scan) {
                           std::string text = scan.param;
                           for (char& c : text) c = c == '.' ? '_' : c;
                           return text;
                         });

}  // namespace
}  // namespace fettle::engine::tests

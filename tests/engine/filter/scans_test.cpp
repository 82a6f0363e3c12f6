#include <string>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/engine/filter/reference.h"
#include "tests/support/shared_data.h"

namespace fettle::engine::tests {
namespace {

class Scans : public testing::TestWithParam<const char*> {};

TEST_P(Scans, AreFilteredAsNearTheReferenceAsStatedAndTheMedianExactly) {
  FETTLE_SCAN_OR_SKIP(path, GetParam());
  JobControl job;
  ImportOptions options;
  if (path.find("_u16") != std::string::npos) options.no_data = 0.0;  // these files cannot say so
  const Result<Imported> imported = importField(path, options, job);
  ASSERT_TRUE(imported) << imported.error().line();
  const PlainField plain = toPlain(imported->field);
  for (const FilterKind kind : kEveryKind)
    for (const int window : windowsOf(kind, {3, 9, 31})) {
      SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(window));
      FilterSpec spec = makeSpec(kind, window);
      // Scans in counts: a step is a difference to be smoothed.
      if (hasRange(kind)) spec.range_sigma = path.find("_u16") != std::string::npos ? 2.0 : 0.25;
      const Filtered result = filtered(imported->field, spec);
      // Holes and their neighbours everywhere, windows at about 1000 places.
      EXPECT_EQ(checkPass(plain, toPlain(result.field), spec, 1000), "");
      EXPECT_GT(result.report.changed, 0);
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

#pragma once

#include <string>
#include <vector>

#include "app/report.h"
#include "app/work/read_units.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"
#include "engine/measure/hills.h"
#include "engine/measure/region.h"
#include "engine/measure/surface.h"

namespace fettle::app {

/// What counts as a feature.
struct FeatureOptions {
  bool dales = false;  ///< around pits; else hills, around peaks
  double prune = 5.0;  ///< lower ones become part of their neighbour [% of Sz]
  engine::Region region = engine::Region::kAll;
};

/// Hills or dales of a field about a form, by watersheds. Heights of dales are below it.
struct FieldFeatures {
  engine::Surface surface;  ///< upside down for dales
  engine::HillMap map;
  std::vector<engine::HillFigures> figures;
  double sz = 0.0, least = 0.0;  ///< [height_unit]
  bool dales = false;
};

/// Errors: kInput where no sample counts, or more than 2^31 - 1 do, about `where`; kFailed without memory; kCancelled. Throws std::bad_alloc.
/// Thread: any; a long job.
[[nodiscard]] engine::Result<FieldFeatures> featuresOf(const engine::Version& field,
                                                       const engine::NominalForm& form,
                                                       const FeatureOptions& options,
                                                       const std::string& where, engine::JobControl& job);

/// A field of the numbers of the features, from 1, at each sample; a hole where there is none. Errors: kInput with more features than a
/// sample has whole numbers; kFailed without memory; kCancelled.
[[nodiscard]] engine::Result<engine::Version> featureLabels(const FieldFeatures& features,
                                                            const engine::Grid& of, engine::JobControl& job);
/// How high samples lie above the saddle of their hill, below 0 as far as they lie below that of their dale; holes elsewhere.
[[nodiscard]] engine::Result<engine::Version> featureHeights(const FieldFeatures& features,
                                                             const engine::Grid& of, engine::JobControl& job);
/// The field with the samples marked that have a neighbour of another feature along their row or column, with a higher number: one
/// sample wide. Errors: kCancelled, kFailed without memory.
[[nodiscard]] engine::Result<engine::Version> featureOutlines(const FieldFeatures& features,
                                                              const engine::Version& field,
                                                              engine::JobControl& job);

/// As `fettle features` reports them: kind, units, sz, least_height, count, features, means of heights and volumes of the closed ones, of areas of those that nothing cuts.
[[nodiscard]] Report featureReport(const FieldFeatures& features, const engine::Grid& grid);
/// A row for each of a report, with the form over the scan.
[[nodiscard]] std::string featureCsv(const Report& report);

/// The units in which a report of featureReport() is read at ease: of heights by Sz, of places and areas by the spacing.
struct FeatureUnits {
  ReadAs height, length;
};
[[nodiscard]] FeatureUnits featureUnits(const Report& report);

}  // namespace fettle::app

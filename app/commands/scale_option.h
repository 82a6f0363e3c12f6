#pragma once

#include <string>
#include <string_view>

#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/io/import.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// The scales that a surface is limited to: nesting indices as typed, in millimetres or with a unit; empty: none.
struct ScaleArguments {
  std::string s_filter;
  std::string l_filter;
  std::string s_kind =
      "areal-gaussian";  ///< words of the filters that separate scales; balls where they roll a body
  std::string l_kind = "areal-gaussian";
};

/// --s-filter, --l-filter, and their kinds.
void addScaleOptions(Command command, ScaleArguments& arguments);

/// A field as it is measured: `field` about `form`.
struct ScaleLimited {
  engine::Version field;
  engine::FittedForm fit;    ///< what was taken out between the filters
  engine::NominalForm form;  ///< that of `fit`, or of height 0 where an L-filter made the form's rest heights
};

/// S-filter, form (F-operation) and L-filter, in the order of ISO 25178-3: the S-F or S-L surface. Errors: as
/// engine::scaleFiltered and formOf, naming the option; an L-filter not longer than the S-filter, where both are
/// wavelengths or both are radii (kInput).
[[nodiscard]] engine::Result<ScaleLimited> scaleLimited(const engine::Version& field, const std::string& scan,
                                                        const engine::Imported& imported,
                                                        const FormArguments& form,
                                                        const ScaleArguments& scale, engine::JobControl& job);

/// The S-F or S-L surface as a field of its own: heights about the form, rounded to float once, holes where `region` of
/// `limited` has no sample. Marks are those of `scan`. Errors: kFailed without memory; kCancelled.
[[nodiscard]] engine::Result<engine::Version> surfaceField(const ScaleLimited& limited, engine::Region region,
                                                           const engine::Version& scan,
                                                           engine::JobControl& job);

/// s_filter and l_filter [mm], and their kinds where these are not areal-gaussian, of those that are there.
void addScale(Report& report, const ScaleArguments& scale);
/// Those of a report in words, "S-filter 2.5 mm, areal-gaussian", with `between` between them; empty without.
[[nodiscard]] std::string scaleText(const Report& report, std::string_view between);

}  // namespace fettle::app

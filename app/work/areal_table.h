#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/report.h"
#include "app/work/read_units.h"
#include "engine/field/grid.h"
#include "engine/measure/areal.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::app {

// The parameters of `fettle measure` as one table: their groups, keys, names and units, from which the report, the text
// and the CSV are made.

/// A group of parameters: "height", "spatial", "hybrid", "functional", "feature".
struct ArealGroup {
  const char* word;
  const char* heading;
  const char* text;  ///< the parameters that it has
};
[[nodiscard]] std::span<const ArealGroup> arealGroups() noexcept;

/// Adds the parameters of these groups and of height (empty: of all) to a report: a key each, null for one that is not stated, and
/// `not_stated` with the reasons. Heights in the height unit of the grid; lengths, densities and curvatures in its
/// lateral unit; ratios as shares of 1.
void addAreal(Report& report, const engine::ArealParameters& measured, const std::vector<std::string>& groups,
              const engine::Grid& grid);

/// What the noise of a scan does to its parameters.
struct ArealNoise {
  double sigma = 0.0;  ///< of a sample [height_unit]
  int trials = 0;
  std::vector<engine::NoiseEffect> effects;  ///< as of engine::valuesOf()
};
/// Adds it to a report of addAreal(), after its `smr`, `smc` and `sdc`: `noise` with `sigma`, `trials` and, of each parameter that the report has,
/// `without` and `error`; both also to each of `smr` and `smc`, its volumes, and `sdc`.
void addNoise(Report& report, const ArealNoise& noise, const engine::Grid& grid);

/// One line each under the heading of its group, in units that read at ease where the scan's are metric, else in the
/// scan's. `report` has what addAreal adds.
void printAreal(const Report& report);

/// A parameter of several reports side by side.
struct ArealLine {
  std::string group, name, unit, text;
  std::vector<std::string> values;   ///< one for each report: a figure, or the reason why none is stated
  std::vector<std::string> without;  ///< without noise, "12.3 +- 0.2"; empty where it is not stated
};
/// The parameters that the reports of addAreal and addChosen have: lengths across the field in the unit of everything beside them,
/// `across`; heights in one unit, too, which is that of everything beside them, `heights` (nothing: that in which Sq of the first
/// reads at ease), unless more of them are readable in another.
[[nodiscard]] std::vector<ArealLine> arealLines(const std::vector<Report>& reports, const ReadAs& across,
                                                const std::optional<ReadAs>& heights);

/// The same lines without values and units: of parameters that are still to be measured, with Sdc or without.
enum class WithSdc : std::uint8_t { kNo, kYes };
[[nodiscard]] std::vector<ArealLine> arealNames(WithSdc sdc);

/// Rows of kArealHeading of a report of addAreal, in the scan's units, ratios in per cent; the last one is the form that lies
/// over the scan, `layer` of the report.
[[nodiscard]] std::string arealRows(const std::string& scan, const Report& report);
inline constexpr const char* kArealHeading =
    "scan,group,parameter,value,unit,remark,without_noise,error,layer\n";

}  // namespace fettle::app

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/region_option.h"
#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/io/import.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// What is taken out of a surface before it is measured, and the samples that count.
struct FormArguments : RegionArguments {
  std::string form = "plane";  ///< a word of formWords()
  bool robust = false;
  std::string through =
      {};  ///< X,Y:X,Y:X,Y [mm]: a plane through three points; empty: one that is nearest to all samples
  std::optional<double> probe_mm = {};  ///< around each of these
};

/// "none", "mean", "plane", "poly2" to "poly5", "sphere", "cylinder", "cone".
[[nodiscard]] std::vector<Word> formWords();

/// The word of a form.
[[nodiscard]] std::string formWordOf(const engine::NominalForm& form);

/// --form, --robust, --region, --marks, --through, --probe.
void addFormOptions(Command command, FormArguments& arguments);

/// What the arguments mean, as typed and checked by their rows and by checkForm().
[[nodiscard]] engine::FormChoice formChoiceOf(const FormArguments& arguments);

/// The same points and radius as arguments.
void setThrough(const std::optional<engine::ThreePoints>& points, FormArguments& arguments);

/// Refuses arguments that say nothing together: marks without a region of marked or unmarked samples, three points of another
/// form than a plane or of a robust one, a radius without them; and points that are not three.
[[nodiscard]] engine::Status checkForm(const FormArguments& arguments);

/// Warns of a polynomial of a region that leaves the heights of the field beyond it (engine::FittedForm::leaves): for those who
/// take it out of the whole field. `scan` is its path.
void warnOfLeaving(const engine::FittedForm& fit, const std::string& scan);

/// The form of a field; of "none" the form whose height is 0 everywhere. Warns of a polynomial that so few samples do not
/// determine, of samples beyond the outline of a shape, and of a scan in a camera's perspective. `scan` is its path. Errors: as
/// engine::fitNominalForm, naming the scan.
[[nodiscard]] engine::Result<engine::FittedForm> formOf(const engine::Version& field, const std::string& scan,
                                                        const engine::Imported& imported,
                                                        const FormArguments& arguments,
                                                        engine::JobControl& job);

/// The form as keys of a report: form, robust, region; of a plane and more tilt_x, tilt_y [degrees], tilted up to
/// higher x and y; of three points their standard errors and through, the mean heights; of a shape, as `fettle fit` names them, point_mm, direction, radius_mm or half_angle_deg, hollow, left_out, and
/// beyond, samples beyond its outline.
void addForm(Report& report, const FormArguments& arguments, const engine::FittedForm& fit,
             const engine::Grid& grid);

}  // namespace fettle::app

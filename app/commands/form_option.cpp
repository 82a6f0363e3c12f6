#include "app/commands/form_option.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/fill/filled_samples.h"

namespace fettle::app {

namespace {

constexpr const char* kNoForm = "none";
constexpr const char* kMeasured = "measured";

}  // namespace

std::vector<Word> formWords() {
  std::vector<Word> words;
  words.emplace_back(kNoForm, "none: heights are measured from their mean all the same");
  for (const engine::FormInfo& form : engine::formInfos())
    words.emplace_back(std::string(form.word), std::string(form.text));
  return words;
}

std::string formWordOf(const engine::NominalForm& form) {
  return std::string(engine::infoOf(form).word);
}

void addFormOptions(Command command, FormArguments& arguments) {
  command.add({
      {.name = "--form",
       .to = &arguments.form,
       .text = "The form that is taken out, fitted by least squares: polynomials of heights, shapes of "
               "orthogonal "
               "distances, as fettle fit has it",
       .words = formWords()},
      {.name = "--robust",
       .to = &arguments.robust,
       .text = "Steps, spikes and other samples far from the form do not count when it is fitted"},
      {.name = "--region",
       .to = &arguments.region,
       .text = "The samples that count",
       .words = {{"all", "every sample that is no hole"},
                 {"marked", "those that are marked"},
                 {"unmarked", "those that are not"},
                 {"measured", "those of a session that were not filled"}}},
      {.name = "--marks",
       .to = &arguments.marks,
       .text = "Picture of marks for --region, instead of the marks of a session",
       .kind = ValueKind::kMarks},
  });
}

engine::FormChoice formChoiceOf(const FormArguments& arguments) {
  const engine::FormInfo* form = engine::formNamed(arguments.form);
  return {form != nullptr ? form->kind : engine::FormKind::kMean,
          engine::regionNamed(arguments.region).value_or(engine::Region::kAll), arguments.robust};
}

engine::Result<engine::Version> countedOf(const engine::Version& field,
                                          const std::optional<engine::Version>& original,
                                          const std::string& scan, const FormArguments& arguments,
                                          engine::JobControl& job) {
  if (arguments.region != kMeasured) return withMarks(field, arguments.marks, job);
  if (!original)
    return engine::inputError("the file does not say which samples were filled", shownInput(scan),
                              "give the session of fettle fill, or its --filled-out as --marks with --region "
                              "unmarked");
  return engine::withoutFilled(field, *original, job);
}

engine::Status checkForm(const FormArguments& arguments) {
  if (!arguments.marks.empty() && arguments.region != "marked" && arguments.region != "unmarked")
    return engine::inputError("marks choose nothing in this region", "--marks",
                              "add --region marked or --region unmarked");
  return {};
}

engine::Result<engine::FittedForm> formOf(const engine::Version& field, const std::string& scan,
                                          const engine::Imported& imported, const FormArguments& arguments,
                                          engine::JobControl& job) {
  const engine::FormChoice choice = formChoiceOf(arguments);
  auto fit = engine::fitNominalForm(field, choice, job);
  if (!fit) {
    if (fit.error().kind != engine::ErrorKind::kInput) return fit;
    // What a shape lacks is said by the fit.
    const bool no_sample = fit.error().where == "form";
    return engine::inputError(fit.error().what, shownInput(scan),
                              !no_sample                  ? fit.error().remedy
                              : arguments.region == "all" ? "is every sample a hole? fettle info counts them"
                                                          : "give marks with --marks, or take --region all");
  }
  if (!fit->decided)
    warn(fmt::format(
        "{}: {} samples do not determine the form {}: of those that come nearest to them it is the flattest",
        shownInput(scan), fit->samples, arguments.form));
  if (fit->beyond > 0)
    warn(
        fmt::format("{}: {} of {} samples lie beyond the outline of the {}: there it is continued by a plane",
                    shownInput(scan), fit->beyond, fit->samples, arguments.form));
  if (imported.in_perspective)
    warn(
        fmt::format("{}: in a camera's perspective a plane is bent: form and figures are those of the "
                    "picture of distances, convert the scan to points and grid them first",
                    shownInput(scan)));
  if (arguments.form == kNoForm)
    fit->form = engine::PolynomialForm{0, fit->form.width(), fit->form.height(), 0.0, {0.0}};
  return fit;
}

void addForm(Report& report, const FormArguments& arguments, const engine::FittedForm& fit,
             const engine::Grid& grid) {
  report["form"] = arguments.form;
  report["robust"] = arguments.robust;
  report["region"] = arguments.region;
  const auto degreesOf = [](double radians) { return radians * 180.0 / std::numbers::pi; };
  if (fit.fit) {
    const engine::Shape& shape = fit.fit->shape;
    const auto vector = [](const glm::dvec3& v) { return Report::array({v.x, v.y, v.z}); };
    report["point_mm"] = vector(shape.point);
    if (shape.kind != engine::ShapeKind::kSphere) report["direction"] = vector(shape.direction);
    if (shape.kind == engine::ShapeKind::kCone)
      report["half_angle_deg"] = degreesOf(shape.half_angle);
    else
      report["radius_mm"] = shape.radius;
    report["hollow"] = shape.hollow;
    report["left_out"] = fit.fit->left_out;
    report["beyond"] = fit.beyond;
    return;
  }
  const engine::PolynomialForm& form = *fit.form.polynomial();
  if (form.degree == 0) return;
  const engine::PolynomialForm::Gradient gradient = form.gradient();
  const auto degrees = [&](double per_sample, double spacing_mm) {
    return degreesOf(std::atan(per_sample * grid.height_unit.mm / spacing_mm));
  };
  report["tilt_x"] = degrees(gradient.by_column, grid.spacingXMm());
  report["tilt_y"] = degrees(gradient.by_row, grid.spacingYMm());
}

}  // namespace fettle::app

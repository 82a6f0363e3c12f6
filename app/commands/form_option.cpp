#include "app/commands/form_option.h"

#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/form_figures.h"
#include "app/work/section_report.h"
#include "app/work/streams.h"

namespace fettle::app {

namespace {

constexpr const char* kNoForm = "none";

// Nothing where the text is not three points.
std::optional<engine::ThreePoints> throughOf(const FormArguments& arguments) {
  if (arguments.through.empty()) return std::nullopt;
  const auto points = polylineOf(arguments.through, "--through");
  if (!points || points->size() != 3) return std::nullopt;
  return engine::ThreePoints{{points->at(0), points->at(1), points->at(2)}, arguments.probe_mm.value_or(0.0)};
}

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
  });
  addRegionOptions(command, arguments, "The samples that count");
  command.add({
      {.name = "--through",
       .to = &arguments.through,
       .text = "The plane through the mean heights around three points instead, from the lower left sample",
       .unit = "mm",
       .shown = "X,Y:X,Y:X,Y"},
      {.name = "--probe",
       .to = &arguments.probe_mm,
       .text = "Samples this near to a point of --through count",
       .range = Range{1e-9, 1e9},
       .unit = "mm",
       .otherwise = "5 samples"},
  });
}

engine::FormChoice formChoiceOf(const FormArguments& arguments) {
  const engine::FormInfo* form = engine::formNamed(arguments.form);
  return {form != nullptr ? form->kind : engine::FormKind::kMean, regionOf(arguments.region),
          arguments.robust, throughOf(arguments)};
}

void setThrough(const std::optional<engine::ThreePoints>& points, FormArguments& arguments) {
  arguments.through.clear();
  arguments.probe_mm.reset();
  if (!points) return;
  const auto& [first, second, third] = points->at_mm;
  arguments.through =
      fmt::format("{},{}:{},{}:{},{}", first.x, first.y, second.x, second.y, third.x, third.y);
  if (points->radius_mm > 0.0) arguments.probe_mm = points->radius_mm;
}

engine::Status checkForm(const FormArguments& arguments) {
  if (auto status = checkRegion(arguments); !status) return status;
  if (arguments.through.empty() && arguments.probe_mm)
    return engine::inputError("there are no points around which samples would count", "--probe",
                              "add --through X,Y:X,Y:X,Y");
  if (arguments.through.empty()) return {};
  if (!throughOf(arguments))
    return engine::inputError(fmt::format("'{}' is not three points", arguments.through), "--through",
                              "give X,Y:X,Y:X,Y from the lower left sample, in mm or as 12.5mm,3mm");
  if (arguments.form != engine::infoOf(engine::FormKind::kPlane).word)
    return engine::inputError("three points are those of a plane", "--form", "omit it, or take plane");
  if (arguments.robust)
    return engine::inputError("around three points all samples count", "--robust",
                              "omit it, or leave samples out by --region with --marks");
  return {};
}

engine::Result<engine::FittedForm> formOf(const engine::Version& field, const std::string& scan,
                                          const engine::Imported& imported, const FormArguments& arguments,
                                          engine::JobControl& job) {
  const engine::FormChoice choice = formChoiceOf(arguments);
  auto fit = engine::fitNominalForm(field, choice, job);
  if (!fit) {
    if (fit.error().kind != engine::ErrorKind::kInput) return fit;
    return engine::inputError(fit.error().what, shownInput(scan), fit.error().remedy);
  }
  if (!fit->open.empty())
    warn(fmt::format("{}: {}: of the planes that come nearest to them it is the flattest", shownInput(scan),
                     fit->open));
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

void warnOfLeaving(const engine::FittedForm& fit, const std::string& scan) {
  if (!fit.leaves.empty())
    warn(fmt::format("{}: {}: beyond its region it is a guess, take a lower degree or a larger region",
                     shownInput(scan), fit.leaves));
}

void addForm(Report& report, const FormArguments& arguments, const engine::FittedForm& fit,
             const engine::Grid& grid) {
  report["form"] = arguments.form;
  report["robust"] = arguments.robust;
  report["region"] = arguments.region;
  if (fit.fit) {
    addShape(report, fit.fit->shape);
    report["left_out"] = fit.fit->left_out;
    report["beyond"] = fit.beyond;
    return;
  }
  const auto tilt = engine::tiltOf(fit, grid);
  if (!tilt) return;
  report["tilt_x"] = tilt->x_deg;
  report["tilt_y"] = tilt->y_deg;
  if (!fit.through) return;
  report["tilt_x_error"] = numberOrNull(tilt->x_error_deg);
  report["tilt_y_error"] = numberOrNull(tilt->y_error_deg);
  report["through"] = Report::array();
  for (const engine::ThreePointPlane::Mean& mean : fit.through->means)
    report["through"].push_back(
        {{"x", mean.at_mm.x}, {"y", mean.at_mm.y}, {"height", mean.height}, {"samples", mean.samples}});
}

}  // namespace fettle::app

#include "app/commands/form_option.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/fill/filled_samples.h"

namespace fettle::app {

namespace {

struct NamedForm {
  const char* word;
  const char* text;
  int degree;
};
constexpr NamedForm kForms[] = {
    {"none", "none: heights are measured from their mean all the same", 0},
    {"mean", "the mean height", 0},
    {"plane", "a plane", 1},
    {"poly2", "a polynomial of total degree 2", 2},
    {"poly3", "of total degree 3", 3},
    {"poly4", "of total degree 4", 4},
    {"poly5", "of total degree 5", 5},
};

}  // namespace

std::vector<Word> formWords() {
  std::vector<Word> words;
  words.reserve(std::size(kForms));
  for (const NamedForm& form : kForms) words.emplace_back(form.word, form.text);
  return words;
}

std::string formWordOf(const engine::PolynomialForm& form) {
  // From the end: "none" is of degree 0, too.
  const auto* found = std::find_if(std::rbegin(kForms), std::rend(kForms), [&](const NamedForm& row) {
                        return row.degree == form.degree;
                      }).base();
  return std::prev(found)->word;
}

void addFormOptions(Command command, FormArguments& arguments) {
  command.add({
      {.name = "--form",
       .to = &arguments.form,
       .text = "The form that is taken out, fitted by least squares",
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

engine::FormOptions formOptionsOf(const FormArguments& arguments) {
  engine::FormOptions options;
  for (const NamedForm& form : kForms)
    if (arguments.form == form.word) options.degree = form.degree;
  options.robust = arguments.robust;
  options.region = arguments.region == "marked"     ? engine::Region::kMarked
                   : arguments.region == "unmarked" ? engine::Region::kUnmarked
                                                    : engine::Region::kAll;
  return options;
}

engine::Result<engine::Version> countedOf(const engine::Version& field,
                                          const std::optional<engine::Version>& original,
                                          const std::string& scan, const FormArguments& arguments,
                                          engine::JobControl& job) {
  if (arguments.region != "measured") return withMarks(field, arguments.marks, job);
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

engine::Result<engine::FormFit> formOf(const engine::Version& field, const std::string& scan,
                                       const engine::Imported& imported, const FormArguments& arguments,
                                       engine::JobControl& job) {
  const engine::FormOptions options = formOptionsOf(arguments);
  auto fit = engine::fitForm(field, options, job);
  if (!fit) {
    if (fit.error().kind != engine::ErrorKind::kInput) return fit;
    return engine::inputError(fit.error().what, shownInput(scan),
                              arguments.region == "all" ? "is every sample a hole? fettle info counts them"
                                                        : "give marks with --marks, or take --region all");
  }
  if (fit->samples <= engine::PolynomialForm::terms(options.degree))
    warn(fmt::format(
        "{}: {} samples do not determine the form {}: of those that come nearest to them it is the flattest",
        shownInput(scan), fit->samples, arguments.form));
  if (imported.in_perspective)
    warn(
        fmt::format("{}: in a camera's perspective a plane is bent: form and figures are those of the "
                    "picture of distances, convert the scan to points and grid them first",
                    shownInput(scan)));
  if (arguments.form == "none") {
    fit->form.base = 0.0;
    fit->form.coefficients.front() = 0.0;
  }
  return fit;
}

void addForm(Report& report, const FormArguments& arguments, const engine::FormFit& fit,
             const engine::Grid& grid) {
  report["form"] = arguments.form;
  report["robust"] = arguments.robust;
  report["region"] = arguments.region;
  if (fit.form.degree == 0) return;
  const engine::PolynomialForm::Gradient gradient = fit.form.gradient();
  const auto degrees = [&](double per_sample, double spacing_mm) {
    return std::atan(per_sample * grid.height_unit.mm / spacing_mm) * 180.0 / std::numbers::pi;
  };
  report["tilt_x"] = degrees(gradient.by_column, grid.spacingXMm());
  report["tilt_y"] = degrees(gradient.by_row, grid.spacingYMm());
}

}  // namespace fettle::app

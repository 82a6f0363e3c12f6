#include "app/commands/form_option.h"

#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>

namespace fettle::app {

namespace {

struct NamedForm {
  const char* word;
  const char* text;
  int degree;
};
constexpr NamedForm kForms[] = {
    {"none", "heights as they are", 0},
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
                 {"unmarked", "those that are not"}}},
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

engine::Result<engine::FormFit> formOf(const engine::Version& field, const FormArguments& arguments,
                                       engine::JobControl& job) {
  auto fit = engine::fitForm(field, formOptionsOf(arguments), job);
  if (fit && arguments.form == "none") {
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

#include "app/work/form_change.h"

#include <utility>

#include <fmt/format.h>

#include "app/work/form_originals.h"

namespace fettle::app {
namespace {

std::string stepName(FormStep step, const engine::NominalForm& form) {
  switch (step) {
    case FormStep::kTakeOut:
      return fmt::format("Form out: {}", formName(form));
    case FormStep::kPutBack:
      return fmt::format("Form back: {}", formName(form));
    case FormStep::kMakeHeights:
      return fmt::format("Heights without {}", formName(form));
  }
  return {};
}

}  // namespace

std::string formName(const engine::NominalForm& form) {
  return std::string(engine::infoOf(form).title);
}

engine::Status FormChange::moveTo(const engine::Version& field, engine::JobControl& job) {
  if (step == FormStep::kMakeHeights) {
    changed = engine::madeHeights(field);
  } else {
    const auto samples = stored.of(field, job);
    if (!samples) return tl::unexpected(samples.error());
    const engine::Version near = changed.empty() ? field : changed;
    const auto seen = engine::seenNear(samples->withForm(form), near, job);
    if (!seen) return tl::unexpected(seen.error());
    changed = *seen;
  }
  base = field;
  return {};
}

engine::Result<FormChange> makeFormChange(FormStep step, engine::FieldForm form, const engine::Version& field,
                                          const engine::Version& scan, engine::JobControl& job) {
  FormChange change;
  change.step = step;
  change.form = step == FormStep::kTakeOut ? std::move(form) : nullptr;
  const engine::FieldForm& named = step == FormStep::kTakeOut ? change.form : field.formOver();
  if (named == nullptr) return engine::inputError("no form lies over the field", "form");
  change.name = stepName(step, *named);
  if (auto done = change.moveTo(field, job); !done) return tl::unexpected(done.error());
  auto original = FormOriginals::make(scan, change.changed, job);
  if (!original) return tl::unexpected(original.error());
  change.original = *std::move(original);
  return change;
}

}  // namespace fettle::app

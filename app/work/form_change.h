#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/seen_field.h"
#include "engine/field/version.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// "plane", "polynomial of degree 2", "mean height", "sphere".
[[nodiscard]] std::string formName(const engine::NominalForm& form);

/// What is done to the form over a field.
enum class FormStep : std::uint8_t {
  kTakeOut,      ///< a form lies over it: it is seen without
  kPutBack,      ///< none lies over it
  kMakeHeights,  ///< what is seen of it are its samples
};

/// A step that changes the form over a field, worked out beside the loop: LoopClient::changeForm() makes it. Upright.
struct FormChange {
  FormStep step = FormStep::kPutBack;
  engine::FieldForm form;                    ///< of kTakeOut
  std::string name;                          ///< of the step
  std::optional<engine::FormChoice> choice;  ///< that found `form`
  engine::Version base;                      ///< the newest field it was worked out on
  engine::Version changed;                   ///< as it is seen then
  engine::Version original;                  ///< the original scan under the same form
  engine::StoredStates stored;

  /// Works `changed` out for another state of the field: time proportional to the tiles in which it differs from `base`.
  /// Errors: memory, cancelled. Thread: any.
  [[nodiscard]] engine::Status moveTo(const engine::Version& field, engine::JobControl& job);
};

/// Works it out for a field. `scan`: the original without a form. A long job on all workers.
[[nodiscard]] engine::Result<FormChange> makeFormChange(FormStep step, engine::FieldForm form,
                                                        const engine::Version& field,
                                                        const engine::Version& scan, engine::JobControl& job);

}  // namespace fettle::app

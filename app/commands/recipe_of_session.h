#pragma once

#include "app/commands/recipe_file.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/session/session.h"

namespace fettle::app {

/// The steps that commands did, as its notes say (engine::kRecipeNote, engine::kStepsNote), and those that led
/// from there to its present state, undone ones left out. Strokes, and marks and lines that were set by
/// hand, belong to one scan and are left out, and forms fitted to samples that such marks chose, as are steps whose numbers the
/// session does not store: those of a command before 0.2, suggested edges that were searched in other heights than those of the
/// step before, forms of sessions of Fettle 0.1. A form is fitted again on the other scan. A range sigma that is that of the noise before the step is left to each scan's noise. `session` was opened with its
/// journal and with every step. Errors: cancelled.
[[nodiscard]] engine::Result<Recipe> recipeOf(const engine::Session& session, engine::JobControl& job);

}  // namespace fettle::app

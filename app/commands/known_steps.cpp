#include "app/commands/known_steps.h"

#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/original_scan.h"
#include "app/commands/recipe_of_session.h"
#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/session/session.h"

namespace fettle::app {

namespace {

Recipe noted(const std::string& note) {
  auto recipe = parseNote(note);
  if (recipe) return *std::move(recipe);
  Recipe unknown;
  unknown.left_out.push_back("what made the scan of step 0: " + recipe.error().line());
  return unknown;
}

// With as much of the history as a session is opened with; what is older is named as left out.
engine::Result<Recipe> recipeStored(const std::string& file, engine::JobControl& job) {
  const auto session = loadSession(file, {}, job);
  if (!session) return tl::unexpected(session.error());
  if (const std::int64_t first = session->history.first(); first > 0)
    warn(
        fmt::format("{}: its history is long, the recipe of the output begins after step {}; fettle recipe "
                    "on the input has all",
                    file, first));
  return recipeOf(*session, job);
}

}  // namespace

engine::Result<KnownSteps> KnownSteps::of(const engine::Imported& imported, const BatchTask& task,
                                          engine::JobControl& job) {
  KnownSteps known;
  known.begin_ = known.whole_ = noted(imported.recipe);
  known.worked_on_ = isWorkedOn(imported);
  if (!known.worked_on_) return known;
  const bool in_memory = memoryPlace(task.in) != nullptr;
  if (!imported.steps.empty()) {
    known.whole_ = noted(imported.steps);
  } else if (imported.format == "Fettle" && !isStream(task.in) && !in_memory && writesSession(task)) {
    auto recipe = recipeStored(task.in, job);
    if (recipe) {
      known.whole_ = *std::move(recipe);
    } else if (recipe.error().kind == engine::ErrorKind::kCancelled) {
      return tl::unexpected(recipe.error());
    } else {
      // The field was read, and the work on it does not need to know what was done before.
      known.whole_.left_out.push_back("what was done before the last commands: " + recipe.error().line());
    }
  } else {
    known.whole_.left_out.emplace_back(
        "what was done before the last commands: their input stored its result");
  }
  return known;
}

void KnownSteps::did(const RecipeStep& step) {
  worked_on_ = true;
  whole_.steps.push_back(step);
}

void KnownSteps::didToBoth(const RecipeStep& step) {
  begin_.steps.push_back(step);
  whole_.steps.push_back(step);
}

void KnownSteps::beganWith(const RecipeStep& step) {
  whole_.steps.push_back(step);
  begin_ = whole_;
  worked_on_ = false;
}

void KnownSteps::leftOut(const std::string& why) {
  whole_.left_out.push_back(why);
  if (!worked_on_) begin_.left_out.push_back(why);
}

void KnownSteps::levelledBoth(const RecipeLevel& step) {
  if (!worked_on_) return didToBoth(step);
  begin_.left_out.emplace_back("a level of step 0: its form was that of later heights");
  whole_.steps.emplace_back(step);
}

void KnownSteps::note(engine::ExportOptions& writing) const {
  const auto text = [](const Recipe& recipe) {
    return recipe.steps.empty() && recipe.left_out.empty() ? std::string() : recipeText(recipe);
  };
  writing.recipe = text(begin_);
  writing.steps = text(whole_);
}

}  // namespace fettle::app

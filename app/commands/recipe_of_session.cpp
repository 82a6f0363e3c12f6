#include "app/commands/recipe_of_session.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/level_layer.h"
#include "app/commands/region_option.h"
#include "engine/field/seen_field.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/session_player.h"

namespace fettle::app {

namespace {

// What led to the states of a session, as its journal says: the last entry of a number counts, since a step after an undo
// replaces those above it.
struct Made {
  haptic::journal::StepMade step;
  std::optional<engine::FilterSpec> filter;
};

std::map<std::int64_t, Made> madeBy(const engine::Session& session) {
  std::map<std::int64_t, Made> made;
  std::optional<engine::FilterSpec> begun;
  for (const engine::JournalEntry& row : session.journal) {
    const auto entry = haptic::journalEntry(row.action);
    if (!entry) continue;
    if (const auto* filter = std::get_if<haptic::journal::FilterBegun>(&*entry)) begun = filter->spec;
    if (const auto* step = std::get_if<haptic::journal::StepMade>(&*entry)) {
      const bool filtered = step->kind == engine::StepKind::kFilter && !step->maker;
      made[step->state] = {*step, filtered ? begun : std::nullopt};
      if (filtered) begun.reset();
    }
  }
  return made;
}

// What is known of the states that no entry of the journal made.
struct Noted {
  std::optional<RecipeForm> over;  // that a command laid over the scan with which the session begins
  bool lies = false;               // whether one is over the last of these states
  std::int64_t states = 0;         // that a command made after that scan
};

// How many states a command wrote, and noted what led to them: one of its steps, then a form, then an inversion.
std::int64_t statesOfCommands(const engine::Session& session, const std::map<std::int64_t, Made>& made) {
  const engine::History& history = session.history;
  if (!session.notes.contains(engine::kStepsNote) || history.first() != 0) return 0;
  std::int64_t states = 0;
  for (std::int64_t k = 1; k <= history.number() && !made.contains(k); ++k) {
    const engine::StepInfo& info = history.info(k);
    const bool by_commands =
        info.kind == engine::StepKind::kImport && info.name == engine::kByCommands && k == 1;
    if (!by_commands && info.kind != engine::StepKind::kForm && info.kind != engine::StepKind::kInvert) break;
    states = k;
  }
  // An undo in the window left some of them out: the note has more than is there.
  const std::int64_t written = session.journal.empty() ? history.last() : haptic::journalStart(session);
  return states < written ? 0 : states;
}

// What commands did before the first step of the journal.
Noted addNoted(const engine::Session& session, const std::map<std::int64_t, Made>& made, Recipe& recipe) {
  Noted known;
  known.states = statesOfCommands(session, made);
  const auto note = session.notes.find(known.states > 0 ? engine::kStepsNote : engine::kRecipeNote);
  if (note == session.notes.end()) return known;
  auto noted = parseNote(note->second);
  if (!noted) {
    recipe.left_out.push_back(fmt::format("what made the scan of step 0: {}", noted.error().line()));
    return known;
  }
  recipe.left_out = std::move(noted->left_out);
  if (noted->steps.empty()) return known;
  if (const auto* last = std::get_if<RecipeForm>(&noted->steps.back());
      known.states == 0 && last != nullptr && last->layer == kLayerPut) {
    known.over = *last;
    noted->steps.pop_back();
  }
  bool marks = false;       // that steps set
  bool& lies = known.lies;  // a form that is not left out
  for (RecipeStep& step : noted->steps) {
    const auto* level = std::get_if<RecipeLevel>(&step);
    const auto* form = std::get_if<RecipeForm>(&step);
    const FormArguments* by = level != nullptr ? &level->form : form != nullptr ? &form->form : nullptr;
    if (std::holds_alternative<RecipeEdges>(step)) marks = true;
    // Marks that steps set again choose the samples again.
    const bool chosen = !marks || !recipe.left_out.empty();
    if (by != nullptr && choosesByMarks(by->region) && chosen) {
      recipe.left_out.push_back(
          fmt::format("the {} of the {} samples of step 0: which these are belongs to this scan",
                      level != nullptr ? "level" : "form", by->region));
      lies = false;
    } else if (form != nullptr && form->layer != kLayerPut && !lies) {
      recipe.left_out.push_back(
          fmt::format("to {} the form of step 0, which is left out itself", form->layer));
    } else {
      lies = form != nullptr ? form->layer == kLayerPut : lies;
      recipe.steps.push_back(std::move(step));
    }
  }
  return known;
}

bool hasMarks(const engine::Version& field) {
  return field.reader().root().marked_children != 0;
}

RecipeFill recipeFillOf(const engine::FillOptions& fill) {
  RecipeFill step;
  step.what.method = fill.method == engine::FillMethod::kMembrane ? "membrane" : "curvature";
  step.what.at_border = fill.at_border;
  if (std::isfinite(fill.most_extent_mm)) step.what.most_extent = fmt::format("{}mm", fill.most_extent_mm);
  if (std::isfinite(fill.most_area_mm2)) step.what.most_area = fill.most_area_mm2;
  return step;
}

// Heights with the unit of the scan, where a recipe can read that.
RecipeRemove recipeRemoveOf(const engine::RemoveOptions& remove, const engine::Grid& grid) {
  const auto typed = [&](double height) {
    if (!std::isfinite(height)) return std::string();
    const RecipeLength length = recipeLength(height, grid);
    return fmt::format("{}{}", length.value, length.unit ? length.unit->name : "");
  };
  RecipeRemove step;
  const std::string low = typed(remove.low), high = typed(remove.high);
  if (remove.heights == engine::RemoveOptions::Heights::kOutside) {
    step.what.below = low;
    step.what.above = high;
  } else if (!low.empty() && !high.empty()) {
    step.what.between = {low, high};
  }
  step.what.region = engine::wordOf(remove.region);
  return step;
}

// Whether the steps so far leave a field upside down: the journal has heights of the upright one.
bool isTurned(const Recipe& recipe) {
  return std::ranges::count_if(
             recipe.steps,
             [](const RecipeStep& step) { return std::holds_alternative<RecipeInvert>(step); }) %
             2 !=
         0;
}

using Reason = tl::unexpected<const char*>;

// The steps of the form over the field, as they follow each other.
class FormSteps {
 public:
  // `chosen`: whether marks of a hand chose samples of the scan.
  FormSteps(const Noted& noted, bool chosen) : over_(noted.over), chosen_(chosen), lies_(noted.lies) {}

  // Marks that the recipe does not set again.
  void marksLeftOut() noexcept { chosen_ = true; }

  // The step that led to `after`, or why it is left out. `made`: what the journal says of it, if anything.
  tl::expected<RecipeForm, const char*> next(const haptic::journal::StepMade* made,
                                             const engine::Version& after) {
    std::optional<RecipeForm> step;
    bool chosen = chosen_;
    if (made == nullptr) {
      step = std::exchange(over_, std::nullopt);
      chosen = true;
    } else if (made->heights) {
      step = RecipeForm{kLayerBake, {}};
    } else if (made->fitted) {
      step = RecipeForm{kLayerPut, {}};
      step->form.form = made->fitted->form;
      step->form.robust = made->fitted->robust;
      step->form.region = made->fitted->region;
      setThrough(made->fitted->through, step->form);
    } else if (after.formOver() == nullptr) {
      step = RecipeForm{kLayerRemove, {}};
    }
    if (!step) {
      lies_ = false;
      return Reason("the session stores the form, not how it was fitted");
    }
    if (step->layer == kLayerPut) {
      lies_ = !choosesByMarks(step->form.region) || !chosen;
      if (!lies_) return Reason("which samples it was fitted to belongs to this scan");
      return *step;
    }
    if (!std::exchange(lies_, false)) return Reason("the form that was over the field is left out");
    return *step;
  }

 private:
  std::optional<RecipeForm> over_;
  bool chosen_;
  bool lies_;  // a form, after the steps that are not left out
};

}  // namespace

engine::Result<Recipe> recipeOf(const engine::Session& session, engine::JobControl& job) {
  const engine::History& history = session.history;
  const std::map<std::int64_t, Made> made = madeBy(session);
  const auto length = [&](double value) { return recipeLength(value, history.current().grid()); };
  Recipe recipe;
  const Noted noted = addNoted(session, made, recipe);
  if (history.first() > 0)
    recipe.left_out.push_back(fmt::format("steps 1 to {}: more history than was read", history.first()));
  FormSteps forms(noted, hasMarks(history.state(std::max(noted.states, history.first()))));
  for (std::int64_t k = std::max(noted.states, history.first()) + 1; k <= history.number(); ++k) {
    const engine::StepInfo& info = history.info(k);
    const auto leave = [&](const char* why) {
      if (info.kind == engine::StepKind::kMark || info.kind == engine::StepKind::kLines ||
          info.kind == engine::StepKind::kImport)
        forms.marksLeftOut();
      recipe.left_out.push_back(fmt::format("step {}, {}: {}", k, info.name, why));
    };
    const auto entry = made.find(k);
    if (info.kind == engine::StepKind::kInvert) {
      recipe.steps.emplace_back(RecipeInvert{});
    } else if (info.kind == engine::StepKind::kForm) {
      const auto step = forms.next(entry == made.end() ? nullptr : &entry->second.step, history.state(k));
      if (step)
        recipe.steps.emplace_back(*step);
      else
        leave(step.error());
    } else if (entry != made.end() && entry->second.step.suggested) {
      const haptic::journal::EdgesSuggested& numbers = *entry->second.step.suggested;
      RecipeEdges step;
      step.become = info.kind == engine::StepKind::kLines ? EdgesBecome::kLines : EdgesBecome::kMarks;
      step.scale = numbers.scale;
      step.choice.sensitivity = numbers.sensitivity;
      step.choice.thickness = numbers.thickness;
      recipe.steps.emplace_back(step);
    } else if (entry != made.end() && entry->second.step.maker) {
      if (const auto* fill = std::get_if<engine::FillOptions>(&*entry->second.step.maker))
        recipe.steps.emplace_back(recipeFillOf(*fill));
      else if (const auto* remove = std::get_if<engine::RemoveOptions>(&*entry->second.step.maker);
               remove != nullptr && remove->region != engine::Region::kMarked)
        recipe.steps.emplace_back(recipeRemoveOf(isTurned(recipe) ? engine::upsideDown(*remove) : *remove,
                                                 history.current().grid()));
      else if (remove != nullptr)
        leave("which samples were marked belongs to this scan");
      else
        leave("a recipe levels lines together with a form: fettle level --rows");
    } else if (info.kind != engine::StepKind::kFilter) {
      leave(info.kind == engine::StepKind::kImport ? "the session stores its result, not how it was made"
                                                   : "it belongs to this scan");
    } else if (entry == made.end() || !entry->second.filter) {
      leave("the session stores its result, not the numbers of the filter");
    } else {
      RecipeFilter step;
      step.spec = *entry->second.filter;
      if (engine::hasRange(step.spec.kind)) {
        engine::FilterSpec of_noise = step.spec;
        of_noise.range_sigma = 0.0;
        const auto before = engine::SeenField::of(history.state(k - 1), job);
        if (!before) return tl::unexpected(before.error());
        // Of the field before the step, as all were before the window took that of the scan; else of the scan, under the form of the step.
        auto scan = engine::seenLike(session.original, before->seen(), job);
        if (!scan) return tl::unexpected(scan.error());
        bool found = false;
        for (const NoiseOf of : {NoiseOf::kField, NoiseOf::kOriginal}) {
          const auto measured =
              engine::withMeasuredRange(of_noise, of == NoiseOf::kField ? before->seen() : *scan, job);
          if (!measured && measured.error().kind == engine::ErrorKind::kCancelled)
            return tl::unexpected(measured.error());
          found = measured && measured->range_sigma == step.spec.range_sigma;
          step.noise_of = found ? of : NoiseOf::kField;
          if (found) break;
        }
        if (!found) step.range_sigma = length(step.spec.range_sigma);
        step.spec.range_sigma = 0.0;
      }
      if (step.spec.max_change) step.max_change = length(*step.spec.max_change);
      step.spec.max_change.reset();
      recipe.steps.emplace_back(step);
    }
  }
  return recipe;
}

}  // namespace fettle::app

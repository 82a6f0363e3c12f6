#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/command.h"
#include "app/commands/recipe_file.h"
#include "app/commands/recipe_of_session.h"
#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

engine::Result<Report> recipe(const std::string& path, engine::JobControl& job) {
  engine::SessionOpenOptions open;
  open.history_bytes = engine::History::kNoBound;
  const auto session = loadSession(path, open, job);
  if (!session) return tl::unexpected(session.error());
  const auto recipe = recipeOf(*session, job);
  if (!recipe) return tl::unexpected(recipe.error());
  if (recipe->steps.empty())
    return engine::inputError(recipe->left_out.empty()
                                  ? "the session has no steps"
                                  : fmt::format("no step of the session can be repeated on another scan ({})",
                                                fmt::join(recipe->left_out, "; ")),
                              path, "write a recipe by hand, see the page File formats of the documentation");
  for (const std::string& step : recipe->left_out) warn(fmt::format("{}: left out: {}", path, step));
  return Report{
      {"recipe", recipeText(*recipe)}, {"steps", recipe->steps.size()}, {"left_out", recipe->left_out}};
}

}  // namespace

void addRecipe(Command root, Chosen& chosen) {
  auto session = std::make_shared<std::string>();
  Command command = addCommand(
      root, chosen, "recipe", "The steps of a session as a recipe for other scans, on standard output",
      [session](engine::JobControl& job) { return recipe(*session, job); },
      [](const Report& report) { fmt::print("{}", report["recipe"].get<std::string>()); }, Progress::kLine,
      {}, Printing::kResult);
  command.add({{.name = "SESSION",
                .to = session.get(),
                .text = "The session, NAME.fettle; - for standard input",
                .kind = ValueKind::kInput,
                .required = true}});
  command.notes(
      "Filters, suggested edges, inversions, forms that are put over the field, removed or made heights, and "
      "the "
      "levels and transforms with which a session begins are repeated; a form is fitted to each scan again. "
      "Strokes, "
      "and marks and lines that a hand drew, "
      "belong to their scan: a warning and a comment name each that is left out. fettle apply does the "
      "steps.");
}

}  // namespace fettle::app

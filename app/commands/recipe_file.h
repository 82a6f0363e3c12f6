#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/commands/filling.h"
#include "app/commands/form_option.h"
#include "app/commands/levelling.h"
#include "app/commands/removing.h"
#include "app/commands/transforming.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/filter/filter.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::app {

// A recipe: what was done to one scan, to be done to others. A TOML file that a person can read and change;
// docs/formats.md describes it.

/// A difference of heights.
struct RecipeLength {
  double value = 0.0;
  std::optional<engine::LengthUnit> unit;  ///< none: the height unit of each scan

  [[nodiscard]] double in(const engine::Grid& grid) const noexcept;  ///< [height_unit]
};

/// Whose noise gives a range that is not given.
enum class NoiseOf : std::uint8_t {
  kField,     ///< as the step finds it
  kOriginal,  ///< the scan that changes are limited from: as the window has it, also after other filters
};

/// A filter over the whole field.
struct RecipeFilter {
  engine::FilterSpec spec;                  ///< without lengths, which are set when the scan is known
  std::optional<RecipeLength> range_sigma;  ///< above 0; none: from the noise of each scan
  NoiseOf noise_of = NoiseOf::kField;
  std::optional<RecipeLength> max_change;  ///< at least 0; none: no limit
};

/// What the suggested edges become.
enum class EdgesBecome : std::uint8_t {
  kMarks,  ///< on top of the marks there are
  kLines,  ///< edge lines, and marks where an edge cannot be located (drawSuggestion)
};

struct RecipeEdges {
  EdgesBecome become = EdgesBecome::kMarks;
  double scale = engine::EdgeMap::kUsualSigma;  ///< of the search [samples]
  engine::EdgeChoice choice;
};

/// The field is turned upside down.
struct RecipeInvert {};

/// A form is taken out, as `fettle level` does; of its arguments not `marks`.
struct RecipeLevel {
  LineArguments lines;
  FormArguments form;
};

/// Holes are filled, as `fettle fill` does.
struct RecipeFill {
  FillArguments what;
};

/// Samples become holes, as `fettle remove` does.
struct RecipeRemove {
  RemoveArguments what;
};

/// Crop, mirror, turn and resample, as `fettle transform` does.
struct RecipeTransform {
  TransformArguments what;
};

/// The layer of form over the field is changed, as `fettle level --layer` does.
struct RecipeForm {
  std::string layer = "put";  ///< a word of layerWords()
  FormArguments form;         ///< that is put; of it not `marks`
};

using RecipeStep = std::variant<RecipeFilter, RecipeEdges, RecipeInvert, RecipeLevel, RecipeFill,
                                RecipeRemove, RecipeTransform, RecipeForm>;

struct Recipe {
  std::vector<RecipeStep> steps;
  /// Steps of the session that the recipe does not repeat, and why; written as comments, empty after reading.
  std::vector<std::string> left_out;
};

[[nodiscard]] std::string recipeText(const Recipe& recipe);

/// A recipe as a session has it in a note: it may be empty or without steps, and what is left out is read back from the
/// comments of recipeText. Errors: those of parseRecipe.
[[nodiscard]] engine::Result<Recipe> parseNote(const std::string& text);

/// The comment of a step that is left out, which may be added to such a text.
[[nodiscard]] std::string leftOutLine(const std::string& step);

/// A difference of heights of a scan [height_unit], with the unit where that is one which a recipe can read: volts are not.
[[nodiscard]] RecipeLength recipeLength(double value, const engine::Grid& grid);

/// Whether the last step of such a text puts a form over the field.
[[nodiscard]] bool putsForm(const std::string& recipe);

/// Errors (kInput), with the line: no TOML, another version, an unknown or missing key, a value out of range,
/// no steps.
[[nodiscard]] engine::Result<Recipe> parseRecipe(const std::string& text, const std::string& name);

/// "-" is standard input. Errors: those of parseRecipe; the file cannot be read or is longer than a megabyte.
[[nodiscard]] engine::Result<Recipe> readRecipe(const std::string& path, engine::JobControl& job);

}  // namespace fettle::app

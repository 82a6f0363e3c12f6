#include "app/commands/recipe_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "app/commands/level_layer.h"
#include "app/commands/region_option.h"
#include "app/work/spelling.h"
#include "app/work/streams.h"
#include "app/work/typed_lengths.h"
#include "engine/filter/catalogue.h"
#include "engine/io/import.h"
#include "engine/session/session.h"

namespace fettle::app {

namespace {

constexpr int kRecipeVersion = 1;
constexpr const char* kFilterWord = "filter";
constexpr const char* kOriginalWord = "original";
constexpr const char* kEdgesWord = "mark_edges";
constexpr const char* kLinesWord = "locate_edges";
constexpr const char* kInvertWord = "invert";
constexpr const char* kLevelWord = "level";
constexpr const char* kFillWord = "fill";
constexpr const char* kRemoveWord = "remove";
constexpr const char* kTransformWord = "transform";
constexpr const char* kFormWord = "form";
constexpr std::string_view kLeftOut = "# Left out: ";
constexpr const char* kRecipeRemedy = "the page File formats of the documentation describes every key";

// Reads one table of a recipe; the first problem is kept, and what follows it is not read.
class StepReader {
 public:
  explicit StepReader(const toml::table& table) : table_(table) {}

  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  [[nodiscard]] RecipeStep read() {
    const std::string what = word("do",
                                  {kFilterWord, kEdgesWord, kLinesWord, kInvertWord, kLevelWord, kFillWord,
                                   kRemoveWord, kTransformWord, kFormWord},
                                  "");
    if (what == kFilterWord) {
      onlyKeys(what, {"do", "filter", "window", "sigma", "passes", "marks", "range_sigma", "noise_of",
                      "max_change", "cutoff", "radius", "element"});
      return filter();
    }
    if (what == kEdgesWord || what == kLinesWord) {
      onlyKeys(what, {"do", "scale", "sensitivity", "thickness"});
      return edges(what == kLinesWord ? EdgesBecome::kLines : EdgesBecome::kMarks);
    }
    if (what == kLevelWord) {
      onlyKeys(what,
               {"do", "rows", "scan_axis", "keep_form", "form", "robust", "region", "through", "probe"});
      return level();
    }
    if (what == kFillWord) {
      onlyKeys(what, {"do", "method", "max_extent", "max_area", "border"});
      return fill();
    }
    if (what == kRemoveWord) {
      onlyKeys(what, {"do", "below", "above", "between", "region"});
      return remove();
    }
    if (what == kTransformWord) {
      onlyKeys(what, {"do", "crop", "crop_samples", "mirror", "turn", "angle", "to_spacing", "method"});
      return transform();
    }
    if (what == kFormWord) {
      onlyKeys(what, {"do", "layer", "form", "robust", "region", "through", "probe"});
      return form();
    }
    onlyKeys(what, {"do"});
    return RecipeInvert{};
  }

 private:
  void complain(const toml::node& at, const std::string& text) {
    if (problem_.empty()) problem_ = fmt::format("line {}: {}", at.source().begin.line, text);
  }

  // First of all, since a misspelt key is also one that is missing.
  void onlyKeys(const std::string& what, const std::vector<std::string>& keys) {
    for (const auto& [key, value] : table_) {
      const std::string name(key.str());
      if (std::find(keys.begin(), keys.end(), name) != keys.end()) continue;
      const std::string meant = didYouMean(name, keys);
      complain(value, fmt::format("{} has no key \"{}\"{}{}", what, name, meant.empty() ? "" : "; ", meant));
    }
  }

  // One of `words`, or `usual` where the key is missing; an empty one must be there.
  std::string word(const std::string& key, const std::vector<std::string>& words, const std::string& usual) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) {
      if (usual.empty()) complain(table_, fmt::format("the step has no \"{}\"", key));
      return usual;
    }
    std::string value = node->value_or(std::string());
    if (std::find(words.begin(), words.end(), value) == words.end()) {
      const std::string meant = didYouMean(value, words);
      complain(*node, fmt::format("{} is not one of {}{}{}", key, fmt::join(words, ", "),
                                  meant.empty() ? "" : "; ", meant));
    }
    return value;
  }

  void number(const std::string& key, double& value, double lowest, double highest) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const std::optional<double> read = node->value<double>();
    if (!read || !(*read >= lowest && *read <= highest))
      complain(*node, fmt::format("{} is not a number from {:g} to {:g}{}", key, lowest, highest,
                                  node->is_string() ? ": write it without quotes" : ""));
    else
      value = *read;
  }

  void whole(const std::string& key, int& value, int lowest, int highest) {
    double read = value;
    number(key, read, lowest, highest);
    if (read != static_cast<int>(read))
      complain(*table_.get(key), key + " is not a whole number");
    else
      value = static_cast<int>(read);
  }

  void length(const std::string& key, std::optional<RecipeLength>& value, double least) {
    if (const toml::node* node = table_.get(key)) value = lengthOf(key, *node, least);
  }

  std::optional<RecipeLength> lengthOf(const std::string& key, const toml::node& node, double least) {
    RecipeLength read;
    bool is_length = false;
    if (const std::optional<double> number = node.value<double>()) {
      read.value = *number;
      is_length = true;
    } else if (node.is_string()) {
      if (const auto typed = typedLengthOf(node.value_or(std::string()))) {
        read.value = typed->value;
        read.unit = engine::lengthUnitFromName(typed->unit);
      }
      is_length = read.unit.has_value();
    }
    if (is_length && std::isfinite(read.value) && read.value >= least) return read;
    complain(node, is_length ? fmt::format("{} is below {:g} or not finite", key, least)
                             : key + R"( is no length: give one with its unit, "20um", or a number in the )"
                                     "scan's own unit");
    return std::nullopt;
  }

  // A length as it is typed on a command line, which reads it in the unit of the scan.
  std::string typedLength(const std::string& key, const toml::node& node, double least = 1e-15) {
    const std::optional<RecipeLength> read = lengthOf(key, node, least);
    return read ? fmt::format("{}{}", read->value, read->unit ? read->unit->name : "") : std::string();
  }

  void yesOrNo(const std::string& key, bool& value) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const std::optional<bool> read = node->value_exact<bool>();
    if (!read)
      complain(*node, key + " is neither true nor false");
    else
      value = *read;
  }

  // Four numbers, of a rectangle.
  template <class Number>
  void four(const std::string& key, std::vector<Number>& values, const char* numbers) {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    for (std::size_t k = 0; list != nullptr && k < list->size(); ++k)
      if (const auto number = list->get(k)->value<Number>()) values.push_back(*number);
    if (list == nullptr || list->size() != 4 || values.size() != 4)
      complain(*node, fmt::format("{} is not a list of four {}", key, numbers));
  }

  RecipeFilter filter() {
    RecipeFilter step;
    std::vector<std::string> filters;
    for (const engine::Filter& each : engine::filters()) filters.emplace_back(each.word);
    const std::string name = word("filter", filters, "");
    if (!problem_.empty()) return step;
    step.spec.kind = engine::filterNamed(name)->kind;
    whole("window", step.spec.window, 1, engine::FilterSpec::kMaxWindow);
    whole("passes", step.spec.passes, 1, engine::FilterSpec::kMaxPasses);
    number("sigma", step.spec.sigma, 0.0, 1e6);
    if (word("marks", {"keep", "only"}, "keep") == "only") step.spec.scope = engine::FilterScope::kOnlyMarks;
    for (const std::string key : {"cutoff", "radius"}) {
      std::optional<RecipeLength> nesting;
      length(key, nesting, 0.0);
      if (!nesting) continue;
      if (key != engine::filterOf(step.spec.kind).nesting_word)
        complain(*table_.get(key), fmt::format("{} has no {}", name, key));
      else
        step.spec.nesting_mm = nesting->value * (nesting->unit ? nesting->unit->mm : 1.0);
    }
    const std::vector<std::string> elements(engine::kElementWords.begin(), engine::kElementWords.end());
    const std::string element = word("element", elements, elements.front());
    step.spec.element = static_cast<engine::Element>(std::ranges::find(elements, element) - elements.begin());
    length("range_sigma", step.range_sigma, engine::FilterSpec::kLeastRange);
    length("max_change", step.max_change, 0.0);
    if (const toml::node* node = table_.get("noise_of")) {
      if (word("noise_of", {"field", kOriginalWord}, "field") == kOriginalWord)
        step.noise_of = NoiseOf::kOriginal;
      if (step.range_sigma || !engine::hasRange(step.spec.kind))
        complain(*node, step.range_sigma ? "range_sigma says already what noise is"
                                         : fmt::format("{} has no range", name));
    }
    engine::FilterSpec ranged = step.spec;
    if (engine::hasRange(step.spec.kind) || step.range_sigma) ranged.range_sigma = 1.0;
    if (const auto valid = engine::validate(ranged); !valid) {
      const toml::node* named = table_.get(valid.error().where);
      complain(named != nullptr ? *named : table_, valid.error().what);
    }
    return step;
  }

  RecipeEdges edges(EdgesBecome become) {
    RecipeEdges step;
    step.become = become;
    number("scale", step.scale, 0.7, 8.0);
    number("sensitivity", step.choice.sensitivity, 0.0, 1.0);
    number("thickness", step.choice.thickness, 0.0, 64.0);
    return step;
  }

  RecipeLevel level() {
    RecipeLevel step;
    if (table_.contains("rows")) {
      std::vector<std::string> methods;
      for (const Word& method : lineWords()) methods.push_back(method.word);
      step.lines.rows = word("rows", methods, "");
    }
    step.lines.scan_axis = word("scan_axis", {"x", "y"}, step.lines.scan_axis);
    if (step.lines.rows.empty() && table_.contains("scan_axis"))
      complain(*table_.get("scan_axis"), "scan_axis is that of lines: add rows");
    whole("keep_form", step.lines.keep_form, 0, engine::LineOptions::kMostFormDegree);
    if (step.lines.rows.empty() && table_.contains("keep_form"))
      complain(*table_.get("keep_form"), "keep_form is that of lines: add rows");
    fitted(step.form, !step.lines.rows.empty());
    return step;
  }

  // Which form, and by which samples.
  void fitted(FormArguments& what, bool with_none) {
    std::vector<std::string> forms;
    for (const Word& form : formWords())
      if (form.word != "none" || with_none) forms.push_back(form.word);
    what.form = word("form", forms, what.form);
    region(what.region, {"all", "marked", "unmarked"});
    yesOrNo("robust", what.robust);
    if (const toml::node* node = table_.get("through")) through(*node, what);
    if (const toml::node* node = table_.get("probe")) {
      double radius = 0.0;
      number("probe", radius, 1e-9, 1e9);
      what.probe_mm = radius;
      if (what.through.empty()) complain(*node, "probe is that of three points: add through");
    }
  }

  // One of these words, or a shape in the coordinates of each scan.
  void region(std::string& value, std::vector<Word> known) {
    const toml::node* node = table_.get("region");
    if (node == nullptr) return;
    for (Word& shape : shapeWords()) known.push_back(std::move(shape));
    value = node->value_or(std::string());
    if (const std::string problem = regionProblem(value, known); !problem.empty())
      complain(*node, fmt::format("region: {}", problem));
  }

  // Three points of a plane.
  void through(const toml::node& node, FormArguments& what) {
    std::vector<double> numbers;
    if (const toml::array* list = node.as_array(); list != nullptr && list->size() == 3)
      for (const toml::node& point : *list)
        if (const toml::array* xy = point.as_array(); xy != nullptr && xy->size() == 2)
          for (const toml::node& each : *xy)
            if (const auto value = each.value<double>(); value && std::isfinite(*value))
              numbers.push_back(*value);
    if (numbers.size() != 6) return complain(node, "through is not a list of three points, [x, y] in mm");
    setThrough(engine::ThreePoints{{glm::dvec2(numbers[0], numbers[1]), glm::dvec2(numbers[2], numbers[3]),
                                    glm::dvec2(numbers[4], numbers[5])}},
               what);
    if (what.form != "plane" || what.robust) complain(node, "through is that of a plane which is not robust");
  }

  RecipeForm form() {
    RecipeForm step;
    std::vector<std::string> layers;
    for (const Word& layer : layerWords()) layers.push_back(layer.word);
    step.layer = word("layer", layers, "");
    if (step.layer == kLayerPut)
      fitted(step.form, false);
    else
      for (const char* key : {"form", "robust", "region", "through", "probe"})
        if (const toml::node* node = table_.get(key))
          complain(*node, fmt::format("{} is that of a form that is put, and the field has its own", key));
    return step;
  }

  RecipeFill fill() {
    RecipeFill step;
    step.what.method = word("method", {"curvature", "membrane"}, step.what.method);
    if (const toml::node* node = table_.get("max_extent"))
      step.what.most_extent = typedLength("max_extent", *node);
    number("max_area", step.what.most_area, 1e-15, 1e15);
    yesOrNo("border", step.what.at_border);
    return step;
  }

  RecipeRemove remove() {
    RecipeRemove step;
    RemoveArguments& what = step.what;
    constexpr double kAnySign = -1e30;
    if (const toml::node* node = table_.get("below")) what.below = typedLength("below", *node, kAnySign);
    if (const toml::node* node = table_.get("above")) what.above = typedLength("above", *node, kAnySign);
    if (const toml::node* node = table_.get("between")) {
      const toml::array* list = node->as_array();
      if (list == nullptr || list->size() != 2)
        complain(*node, "between is not a list of two heights");
      else
        for (std::size_t k = 0; k < 2; ++k)
          what.between.push_back(typedLength("between", *list->get(k), kAnySign));
    }
    region(what.region, {"unmarked", "marked", "all"});
    if (!problem_.empty()) return step;
    // In millimetres, since the unit of each scan is not known: what may not come together is known without.
    if (const auto valid = removeOptionsOf(what, engine::Grid{}); !valid)
      complain(table_, valid.error().what);
    return step;
  }

  RecipeTransform transform() {
    RecipeTransform step;
    TransformArguments& what = step.what;
    four("crop", what.crop, "numbers, two corners in mm");
    four("crop_samples", what.crop_samples, "whole numbers, row, column, rows and columns");
    if (!what.crop.empty() && !what.crop_samples.empty())
      complain(*table_.get("crop_samples"), "crop says already what is kept");
    if (table_.contains("mirror")) what.mirror = word("mirror", {"x", "y"}, "");
    if (const toml::node* node = table_.get("turn")) {
      const std::int64_t degrees = node->value_exact<std::int64_t>().value_or(0);
      if (degrees != 90 && degrees != 180 && degrees != 270)
        complain(*node, "turn is not one of 90, 180, 270");
      else
        what.turn = std::to_string(degrees);
    }
    number("angle", what.angle, -360.0, 360.0);
    if (const toml::node* node = table_.get("to_spacing")) {
      const toml::array* list = node->as_array();
      if (list == nullptr)
        what.to_spacing.push_back(typedLength("to_spacing", *node));
      else if (list->size() != 2)
        complain(*node, "to_spacing is not one length or a list of two");
      else
        for (std::size_t k = 0; k < 2; ++k)
          what.to_spacing.push_back(typedLength("to_spacing", *list->get(k)));
    }
    if (table_.contains("method")) what.method = word("method", {"area", "linear", "cubic"}, "");
    if (!problem_.empty()) return step;
    if (what.crop.empty() && what.crop_samples.empty() && what.mirror.empty() && what.turn.empty() &&
        what.angle == 0.0 && what.to_spacing.empty())
      complain(table_,
               "the step changes nothing: give crop, crop_samples, mirror, turn, angle or to_spacing");
    else if (!what.method.empty() && !what.resamples())
      complain(*table_.get("method"),
               "method is that of new samples: add to_spacing, or an angle that is no multiple of 90");
    return step;
  }

  const toml::table& table_;
  std::string problem_;
};

// Numbers as they are read back to the same bits.
std::string textOf(const RecipeLength& length) {
  return length.unit ? fmt::format("\"{}{}\"", length.value, length.unit->name)
                     : fmt::format("{}  # in the height unit of the scan", length.value);
}

std::string textOf(const RecipeFilter& step) {
  const engine::Filter& filter = engine::filterOf(step.spec.kind);
  const engine::FilterSpec usual;
  std::string text = fmt::format("do = \"{}\"\nfilter = \"{}\"\n", kFilterWord, filter.word);
  if (filter.window.exists()) text += fmt::format("window = {}\n", step.spec.window);
  if (step.spec.passes != usual.passes) text += fmt::format("passes = {}\n", step.spec.passes);
  if (filter.sigma.exists() && step.spec.sigma != usual.sigma)
    text += fmt::format("sigma = {}\n", step.spec.sigma);
  if (filter.nesting.exists())
    text += fmt::format("{} = \"{}mm\"\n", filter.nesting_word, step.spec.nesting_mm);
  if (filter.has_element)
    text +=
        fmt::format("element = \"{}\"\n", engine::kElementWords[static_cast<std::size_t>(step.spec.element)]);
  if (step.range_sigma)
    text += fmt::format("range_sigma = {}\n", textOf(*step.range_sigma));
  else if (filter.range_sigma.exists())
    text += step.noise_of == NoiseOf::kOriginal
                ? fmt::format("noise_of = \"{}\"  # range_sigma: from the noise of each scan as it was\n",
                              kOriginalWord)
                : "# range_sigma: from the noise of each scan\n";
  if (step.spec.scope == engine::FilterScope::kOnlyMarks) text += "marks = \"only\"\n";
  if (step.max_change) text += fmt::format("max_change = {}\n", textOf(*step.max_change));
  return text;
}

std::string textOf(const RecipeEdges& step) {
  return fmt::format("do = \"{}\"\nscale = {}\nsensitivity = {}\nthickness = {}\n",
                     step.become == EdgesBecome::kLines ? kLinesWord : kEdgesWord, step.scale,
                     step.choice.sensitivity, step.choice.thickness);
}

std::string textOf(const FormArguments& form) {
  std::string text =
      fmt::format("form = \"{}\"\nrobust = {}\nregion = \"{}\"\n", form.form, form.robust, form.region);
  if (const auto points = formChoiceOf(form).through) {
    text += "through = [";
    for (const glm::dvec2& at : points->at_mm) text += fmt::format("[{}, {}], ", at.x, at.y);
    text.replace(text.size() - 2, 2, "]  # mm\n");
  }
  if (form.probe_mm) text += fmt::format("probe = {}  # mm\n", *form.probe_mm);
  return text;
}

std::string textOf(const RecipeLevel& step) {
  std::string text = fmt::format("do = \"{}\"\n", kLevelWord);
  if (!step.lines.rows.empty())
    text += fmt::format("rows = \"{}\"\nscan_axis = \"{}\"\n", step.lines.rows, step.lines.scan_axis);
  if (step.lines.keep_form != LineArguments::kNoForm)
    text += fmt::format("keep_form = {}\n", step.lines.keep_form);
  return text + textOf(step.form);
}

// A length as typed: one without a unit is a number.
std::string shownLength(const std::string& typed) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(typed.data(), typed.data() + typed.size(), value);
  return error == std::errc{} && end == typed.data() + typed.size() ? typed : fmt::format("\"{}\"", typed);
}

std::string textOf(const RecipeFill& step) {
  std::string text = fmt::format("do = \"{}\"\nmethod = \"{}\"\n", kFillWord, step.what.method);
  if (!step.what.most_extent.empty())
    text += fmt::format("max_extent = {}\n", shownLength(step.what.most_extent));
  if (step.what.most_area > 0.0) text += fmt::format("max_area = {}  # mm^2\n", step.what.most_area);
  if (step.what.at_border) text += "border = true\n";
  return text;
}

std::string textOf(const RecipeRemove& step) {
  const RemoveArguments& what = step.what;
  std::string text = fmt::format("do = \"{}\"\n", kRemoveWord);
  if (!what.below.empty()) text += fmt::format("below = {}\n", shownLength(what.below));
  if (!what.above.empty()) text += fmt::format("above = {}\n", shownLength(what.above));
  if (what.between.size() == 2)
    text += fmt::format("between = [{}, {}]\n", shownLength(what.between[0]), shownLength(what.between[1]));
  if (!what.region.empty()) text += fmt::format("region = \"{}\"\n", what.region);
  return text;
}

std::string textOf(const RecipeTransform& step) {
  const TransformArguments& what = step.what;
  std::string text = fmt::format("do = \"{}\"\n", kTransformWord);
  if (!what.crop.empty()) text += fmt::format("crop = [{}]  # mm\n", fmt::join(what.crop, ", "));
  if (!what.crop_samples.empty())
    text += fmt::format("crop_samples = [{}]\n", fmt::join(what.crop_samples, ", "));
  if (!what.mirror.empty()) text += fmt::format("mirror = \"{}\"\n", what.mirror);
  if (!what.turn.empty()) text += fmt::format("turn = {}\n", what.turn);
  if (what.angle != 0.0) text += fmt::format("angle = {}\n", what.angle);
  if (what.to_spacing.size() == 1) text += fmt::format("to_spacing = {}\n", shownLength(what.to_spacing[0]));
  if (what.to_spacing.size() == 2)
    text += fmt::format("to_spacing = [{}, {}]\n", shownLength(what.to_spacing[0]),
                        shownLength(what.to_spacing[1]));
  if (!what.method.empty()) text += fmt::format("method = \"{}\"\n", what.method);
  return text;
}

std::string textOf(const RecipeForm& step) {
  std::string text = fmt::format("do = \"{}\"\nlayer = \"{}\"\n", kFormWord, step.layer);
  if (step.layer != kLayerPut) return text;
  return text + textOf(step.form);
}

std::string textOf(const RecipeInvert&) {
  return fmt::format("do = \"{}\"\n", kInvertWord);
}

}  // namespace

double RecipeLength::in(const engine::Grid& grid) const noexcept {
  return unit ? value * unit->mm / grid.height_unit.mm : value;
}

std::string leftOutLine(const std::string& step) {
  return fmt::format("{}{}\n", kLeftOut, step);
}

std::string recipeText(const Recipe& recipe) {
  std::string text = fmt::format(
      "# Steps of a session, for other scans: fettle apply RECIPE IN... --out-dir FOLDER\nrecipe = {}\n",
      kRecipeVersion);
  for (const std::string& step : recipe.left_out) text += leftOutLine(step);
  for (const RecipeStep& step : recipe.steps)
    text += "\n[[step]]\n" + std::visit([](const auto& each) { return textOf(each); }, step);
  return text;
}

RecipeLength recipeLength(double value, const engine::Grid& grid) {
  const auto known = engine::lengthUnitFromName(grid.height_unit.name);
  return {value, known && known->mm == grid.height_unit.mm ? known : std::nullopt};
}

engine::Result<Recipe> parseNote(const std::string& text) {
  Recipe recipe;
  if (text.find("[[step]]") != std::string::npos) {
    auto read = parseRecipe(text, engine::kRecipeNote);
    if (!read) return read;
    recipe = *std::move(read);
  }
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kLeftOut)) recipe.left_out.push_back(line.substr(kLeftOut.size()));
  return recipe;
}

bool putsForm(const std::string& recipe) {
  const auto read = parseNote(recipe);
  const auto* last = read && !read->steps.empty() ? std::get_if<RecipeForm>(&read->steps.back()) : nullptr;
  return last != nullptr && last->layer == kLayerPut;
}

engine::Result<Recipe> parseRecipe(const std::string& text, const std::string& name) try {
  const toml::table file = toml::parse(text, name);
  const auto refused = [&](const std::string& what) { return engine::inputError(what, name, kRecipeRemedy); };
  if (const auto* version = file["recipe"].as_integer();
      version == nullptr || version->get() != kRecipeVersion)
    return refused(fmt::format("this is no recipe of version {}", kRecipeVersion));
  for (const auto& [key, value] : file)
    if (key.str() != "recipe" && key.str() != "step")
      return refused(
          fmt::format("line {}: a recipe has no key \"{}\"", value.source().begin.line, key.str()));
  Recipe recipe;
  const toml::array* steps = file["step"].as_array();
  if (const toml::node* other = file.get("step"); other != nullptr && steps == nullptr)
    return refused(fmt::format("line {}: step is no list: write [[step]]", other->source().begin.line));
  if (steps == nullptr || steps->empty()) return refused("the recipe has no steps");
  for (const toml::node& node : *steps) {
    const toml::table* table = node.as_table();
    if (table == nullptr) return refused(fmt::format("line {}: a step is a table", node.source().begin.line));
    StepReader reader(*table);
    recipe.steps.push_back(reader.read());
    if (!reader.problem().empty()) return refused(reader.problem());
  }
  return recipe;
} catch (const toml::parse_error& error) {
  return engine::inputError(fmt::format("line {}: {}", error.source().begin.line, error.description()), name,
                            "correct the line");
}

engine::Result<Recipe> readRecipe(const std::string& path, engine::JobControl& job) {
  std::optional<StandardInput> input;
  if (isStream(path)) {
    auto read = StandardInput::read("", job);
    if (!read) return tl::unexpected(read.error());
    input.emplace(*std::move(read));
  }
  std::ifstream file;
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) file.open(input ? input->path() : path, std::ios::binary);
  if (!file.is_open())
    return engine::inputError("the recipe cannot be read", shownInput(path), "check path and rights");
  // A recipe is a page of text; a path given by mistake must not fill the memory.
  constexpr std::size_t kLongest = 1U << 20U;
  std::string text(kLongest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLongest)
    return engine::inputError("the file is too long for a recipe", shownInput(path));
  return parseRecipe(text, shownInput(path));
}

}  // namespace fettle::app

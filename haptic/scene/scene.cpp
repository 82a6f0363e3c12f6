#include "haptic/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "haptic/base/search_limits.h"

namespace fettle::haptic {

namespace {

// Ranges, in one place: sceneProblem and loadScene both use them.
constexpr int kMaxCertifiedRadius = 64;
constexpr double kMaxStiffness = 1000.0;
constexpr double kMaxForce = 1000.0;
constexpr double kMaxTipRadius = 100.0;

constexpr std::array<std::string_view, 2> kMediumNames = {"contact", "everywhere"};
constexpr std::array<std::string_view, 2> kPatternNames = {"noise", "grating"};

std::string rangeOf(const EffectNumber& number) {
  return fmt::format("{} in [{}] must be {} {} and at most {}", number.key, number.table,
                     number.low_end == LowEnd::kExcluded ? "above" : "at least", number.low, number.high);
}

constexpr std::array<std::string_view, 3> kLevelNames = {"paper", "descent", "certified"};

constexpr std::array<std::string_view, 2> kMinimaNames = {"pieces", "all"};  // as in BallMinima
constexpr std::array<std::string_view, 2> kStepsNames = {"space", "plan"};   // as in BallSteps

constexpr const char* kDynamicAboveStatic = "the dynamic friction must not be above the static one";

constexpr const char* kRoundsNeedDescent =
    "fewer search_rounds than 2048 hold for the level \"descent\" and for a ball; the level \"paper\" always "
    "searches "
    "to the end";

bool roundsWithoutUse(const Scene& scene) noexcept {
  return scene.tip == TipShape::kPoint && scene.level == ContactLevel::kPaper &&
         scene.search_rounds != kMaxRounds;
}

// A listed effect that comes before the spring it needs, or has none.
std::optional<std::string> springProblem(const std::vector<EffectKind>& effects) {
  const auto spring = std::find(effects.begin(), effects.end(), EffectKind::kSpring);
  const auto early =
      std::find_if(effects.begin(), effects.end(), [](EffectKind kind) { return rowOf(kind).needs_spring; });
  if (early == effects.end() || (spring != effects.end() && spring < early)) return std::nullopt;
  return fmt::format("the effect \"{}\" needs \"spring\" listed before it", effectName(*early));
}

bool positiveUpTo(double value, double limit) noexcept {
  return value > 0.0 && value <= limit;
}
bool radiusInRange(double value) noexcept {
  return value >= 0.0 && value <= kMaxBrushRadius;
}

bool spacingInRange(double spacing) noexcept {
  return spacing >= 0.0 && spacing <= kMaxBrushSpacing;
}

// Reads the tables of one scene file; the first problem stops it.
class SceneReader {
 public:
  SceneReader(Scene& scene, const toml::table& file, int contact_revision)
      : scene_(scene), contact_revision_(contact_revision) {
    top(file);
  }
  [[nodiscard]] const std::optional<std::string>& problem() const noexcept { return problem_; }

 private:
  void complain(const toml::node& at, std::string text) {
    if (!problem_) problem_ = fmt::format("line {}: {}", at.source().begin.line, std::move(text));
  }

  // Calls f(key, value) for every entry; f returns false for a key it does not know.
  void entries(const toml::table& table, std::string_view where, auto&& f) {
    for (const auto& [key, value] : table)
      if (!f(key.str(), value))
        complain(value, fmt::format("unknown key \"{}\"{}{}", key.str(), where.empty() ? "" : " in ", where));
  }

  void number(const toml::node& value, std::string_view key, double& out) {
    // An integer is a fine number; a string that holds one is not.
    if (value.is_number())
      out = *value.value<double>();
    else
      complain(value, fmt::format("{} must be a number", key));
  }

  const toml::table* table(const toml::node& value, std::string_view key) {
    if (value.is_table()) return value.as_table();
    complain(value, fmt::format("{} must be a table, as [{}]", key, key));
    return nullptr;
  }

  void require(const toml::node& value, bool holds, const char* text) {
    if (!holds) complain(value, text);
  }

  template <std::size_t N>
  std::optional<std::size_t> word(const toml::node& value, std::string_view key,
                                  const std::array<std::string_view, N>& known) {
    if (const auto text = value.value<std::string_view>())
      for (std::size_t i = 0; i < N; ++i)
        if (*text == known[i]) return i;
    complain(value, fmt::format("{} must be one of \"{}\"", key, fmt::join(known, "\", \"")));
    return std::nullopt;
  }

  void top(const toml::table& file) {
    entries(file, "", [&](std::string_view key, const toml::node& value) {
      if (key == "tip") {
        if (const auto i = word(value, key, std::array<std::string_view, 2>{"point", "sphere"}))
          scene_.tip = static_cast<TipShape>(*i);
      } else if (key == "tip_radius_mm") {
        number(value, key, scene_.tip_radius_mm);
        require(value, positiveUpTo(scene_.tip_radius_mm, kMaxTipRadius),
                "tip_radius_mm must be above 0 and at most 100");
      } else if (key == "invert") {
        if (value.is_boolean())
          scene_.invert = *value.value<bool>();
        else
          complain(value, "invert must be true or false");
      } else if (key == "effects") {
        effects(value);
      } else if (key == "contact") {
        if (const toml::table* t = table(value, key)) contact(*t);
      } else if (key == "force") {
        if (const toml::table* t = table(value, key)) force(*t);
      } else if (key == "brush") {
        if (const toml::table* t = table(value, key)) brush(*t);
      } else if (std::any_of(kEffectNumbers.begin(), kEffectNumbers.end(),
                             [&](const EffectNumber& number) { return number.table == key; })) {
        if (const toml::table* t = table(value, key)) effectTable(key, *t);
      } else {
        return false;
      }
      return true;
    });
    if (contact_revision_ < 2 && scene_.level == ContactLevel::kPaper) scene_.level = ContactLevel::kDescent;
    if (!problem_ && roundsWithoutUse(scene_)) complain(*file.get("contact"), kRoundsNeedDescent);
    if (scene_.params.friction.dynamic_coefficient > scene_.params.friction.static_coefficient)
      complain(*file.get("friction"), kDynamicAboveStatic);
  }

  void effects(const toml::node& value) {
    const toml::array* list = value.as_array();
    if (list == nullptr) return complain(value, "effects must be a list of names");
    scene_.effects.clear();
    for (const toml::node& entry : *list) {
      const auto i = word(entry, "an effect", kEffectWords);
      if (!i) return;
      const auto effect = static_cast<EffectKind>(*i);
      if (std::find(scene_.effects.begin(), scene_.effects.end(), effect) != scene_.effects.end())
        return complain(entry, fmt::format("the effect \"{}\" is listed twice", kEffectWords[*i]));
      scene_.effects.push_back(effect);
    }
    if (auto problem = springProblem(scene_.effects)) complain(value, std::move(*problem));
  }

  void contact(const toml::table& table) {
    entries(table, "[contact]", [&](std::string_view key, const toml::node& value) {
      if (key == "level") {
        if (const auto i = word(value, key, kLevelNames)) scene_.level = static_cast<ContactLevel>(*i);
      } else if (key == "certified_radius_cells") {
        const auto radius = value.is_integer() ? *value.value<std::int64_t>() : 0;
        require(value, radius >= 1 && radius <= kMaxCertifiedRadius,
                "certified_radius_cells must be a whole number from 1 to 64");
        if (!problem_) scene_.certified_radius_cells = static_cast<int>(radius);
      } else if (key == "search_rounds") {
        const auto rounds = value.is_integer() ? *value.value<std::int64_t>() : 0;
        require(value, rounds >= 2 && rounds <= kMaxRounds,
                "search_rounds must be a whole number from 2 to 2048");
        if (!problem_) scene_.search_rounds = static_cast<int>(rounds);
      } else if (key == "ball_searches") {
        const auto searches = value.is_integer() ? *value.value<std::int64_t>() : -1;
        require(value, searches >= 0 && searches <= kMostBallSearches,
                "ball_searches must be a whole number from 0 to 4096");
        if (!problem_) scene_.ball_searches = static_cast<int>(searches);
      } else if (key == "ball_minima") {
        if (const auto i = word(value, key, kMinimaNames)) scene_.ball_minima = static_cast<BallMinima>(*i);
      } else if (key == "ball_steps") {
        if (const auto i = word(value, key, kStepsNames)) scene_.ball_steps = static_cast<BallSteps>(*i);
      } else {
        return false;
      }
      return true;
    });
  }

  void force(const toml::table& table) {
    entries(table, "[force]", [&](std::string_view key, const toml::node& value) {
      if (key == "stiffness_n_per_mm") {
        number(value, key, scene_.stiffness_n_per_mm);
        require(value, positiveUpTo(scene_.stiffness_n_per_mm, kMaxStiffness),
                "stiffness_n_per_mm must be above 0 and at most 1000");
      } else if (key == "limit_n") {
        number(value, key, scene_.force_limit_n);
        require(value, positiveUpTo(scene_.force_limit_n, kMaxForce),
                "limit_n must be above 0 and at most 1000");
      } else {
        return false;
      }
      return true;
    });
  }

  void brush(const toml::table& table) {
    entries(table, "[brush]", [&](std::string_view key, const toml::node& value) {
      if (key == "radius_samples") {
        number(value, key, scene_.brush_radius_samples);
        require(value, radiusInRange(scene_.brush_radius_samples), "radius_samples must be 0 to 64");
      } else if (key == "mark_radius_samples") {
        number(value, key, scene_.mark_radius_samples);
        require(value, radiusInRange(scene_.mark_radius_samples), "mark_radius_samples must be 0 to 64");
      } else if (key == "falloff") {
        if (const auto i = word(value, key, kFalloffWords)) scene_.brush_falloff = static_cast<Falloff>(*i);
      } else if (key == "spacing") {
        number(value, key, scene_.brush_spacing);
        require(value, spacingInRange(scene_.brush_spacing), "spacing must be 0 to 2");
      } else if (key == "max_change") {
        double limit = -1.0;
        number(value, key, limit);
        require(value, limit >= 0.0 && std::isfinite(limit), "max_change must be 0 or more");
        scene_.max_change = limit;
      } else {
        return false;
      }
      return true;
    });
  }

  // A table of an effect: its numbers, and the words of the two that have one.
  void effectTable(std::string_view name, const toml::table& table) {
    entries(table, fmt::format("[{}]", name), [&](std::string_view key, const toml::node& value) {
      for (const EffectNumber& known : kEffectNumbers) {
        if (known.table != name || known.key != key) continue;
        double& out = known.of(scene_.params);
        number(value, key, out);
        if (!known.holds(out)) complain(value, rangeOf(known));
        return true;
      }
      if (name == "viscosity" && key == "in") {
        if (const auto i = word(value, key, kMediumNames))
          scene_.params.viscosity.medium = static_cast<ViscousMedium>(*i);
      } else if (name == "texture" && key == "pattern") {
        if (const auto i = word(value, key, kPatternNames))
          scene_.params.texture.pattern = static_cast<TexturePattern>(*i);
      } else {
        return false;
      }
      return true;
    });
  }

  Scene& scene_;
  int contact_revision_;
  std::optional<std::string> problem_;
};

}  // namespace

std::string_view levelName(ContactLevel level) noexcept {
  return kLevelNames[static_cast<std::size_t>(level)];
}

Scene defaultScene() {
  return {};
}

std::optional<std::string> sceneProblem(const Scene& scene) {
  if (scene.certified_radius_cells < 1 || scene.certified_radius_cells > kMaxCertifiedRadius)
    return fmt::format("the certified radius must be 1 to {} cells", kMaxCertifiedRadius);
  if (scene.search_rounds < 2 || scene.search_rounds > kMaxRounds)
    return fmt::format("the search must have 2 to {} rounds", kMaxRounds);
  if (scene.ball_searches < 0 || scene.ball_searches > kMostBallSearches)
    return fmt::format("a ball must have 0 to {} searches", kMostBallSearches);
  if (roundsWithoutUse(scene)) return kRoundsNeedDescent;
  if (scene.tip == TipShape::kSphere && !positiveUpTo(scene.tip_radius_mm, kMaxTipRadius))
    return fmt::format("the tip's radius must be above 0 and at most {} mm", kMaxTipRadius);
  if (!positiveUpTo(scene.stiffness_n_per_mm, kMaxStiffness))
    return fmt::format("the stiffness must be above 0 and at most {} N/mm", kMaxStiffness);
  if (!positiveUpTo(scene.force_limit_n, kMaxForce))
    return fmt::format("the force limit must be above 0 and at most {} N", kMaxForce);
  if (!radiusInRange(scene.brush_radius_samples) || !radiusInRange(scene.mark_radius_samples))
    return fmt::format("a brush radius must be 0 to {} samples", kMaxBrushRadius);
  if (!spacingInRange(scene.brush_spacing))
    return fmt::format("the brush's spacing must be 0 to {}", kMaxBrushSpacing);
  if (scene.max_change && !(*scene.max_change >= 0.0 && std::isfinite(*scene.max_change)))
    return "the largest change must be 0 or more";
  EffectParams params = scene.params;
  for (const EffectNumber& number : kEffectNumbers)
    if (!number.holds(number.of(params))) return rangeOf(number);
  if (params.friction.dynamic_coefficient > params.friction.static_coefficient) return kDynamicAboveStatic;
  if (auto problem = springProblem(scene.effects)) return problem;
  for (auto it = scene.effects.begin(); it != scene.effects.end(); ++it)
    if (std::find(scene.effects.begin(), it, *it) != it)
      return fmt::format("the effect {} is listed twice", effectName(*it));
  return std::nullopt;
}

engine::Result<Scene> parseScene(const std::string& text, const std::string& name, int contact_revision) {
  if (contact_revision < 1 || contact_revision > kContactRevision)
    return engine::inputError(fmt::format("contact revision {} is unknown", contact_revision), name,
                              "open it with the version of the program that wrote it");
  Scene scene = defaultScene();
  if (contact_revision < 4) {
    constexpr int kThen = 64;
    scene.ball_searches = contact_revision < 3 ? 0 : kThen;
    scene.ball_minima = BallMinima::kPieces;
    scene.ball_steps = BallSteps::kInSpace;
  }
  try {
    const toml::table file = toml::parse(text, name);
    const SceneReader reader(scene, file, contact_revision);
    if (reader.problem())
      return engine::inputError(*reader.problem(), name, "assets/scenes/default.toml documents every key");
  } catch (const toml::parse_error& error) {
    return engine::inputError(fmt::format("line {}: {}", error.source().begin.line, error.description()),
                              name, "correct the line");
  }
  return scene;
}

engine::Result<Scene> loadSceneOrDefault(const std::string& path) {
  return path.empty() ? defaultScene() : loadScene(path);
}

engine::Result<Scene> loadScene(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  // A folder opens and then fails to read.
  if (!in || !(text << in.rdbuf()).good() || in.bad())
    return engine::inputError("the scene cannot be read or is empty", path, "give a readable scene file");
  return parseScene(text.str(), path);
}

std::string sceneText(const Scene& scene) {
  std::vector<std::string_view> effects;
  for (const EffectKind effect : scene.effects) effects.push_back(effectName(effect));
  std::string text = fmt::format(
      "tip = \"{}\"\ntip_radius_mm = {}\ninvert = {}\neffects = [{}{}{}]\n"
      "[contact]\nlevel = \"{}\"\ncertified_radius_cells = {}\nsearch_rounds = {}\nball_searches = {}\n"
      "ball_minima = \"{}\"\nball_steps = \"{}\"\n"
      "[force]\nstiffness_n_per_mm = {}\nlimit_n = {}\n"
      "[brush]\nradius_samples = {}\nmark_radius_samples = {}\n",
      scene.tip == TipShape::kSphere ? "sphere" : "point", scene.tip_radius_mm, scene.invert,
      effects.empty() ? "" : "\"", fmt::join(effects, "\", \""), effects.empty() ? "" : "\"",
      levelName(scene.level), scene.certified_radius_cells, scene.search_rounds, scene.ball_searches,
      kMinimaNames[static_cast<std::size_t>(scene.ball_minima)],
      kStepsNames[static_cast<std::size_t>(scene.ball_steps)], scene.stiffness_n_per_mm, scene.force_limit_n,
      scene.brush_radius_samples, scene.mark_radius_samples);
  // Left out where they are as before there were these keys: older programs read such a scene.
  if (scene.brush_falloff != Falloff::kFlat)
    text += fmt::format("falloff = \"{}\"\n", rowOf(scene.brush_falloff).word);
  if (scene.brush_spacing != 0.0) text += fmt::format("spacing = {}\n", scene.brush_spacing);
  if (scene.max_change) text += fmt::format("max_change = {}\n", *scene.max_change);
  EffectParams params = scene.params;
  std::string_view table;
  for (const EffectNumber& number : kEffectNumbers) {
    if (number.table != table) {
      table = number.table;
      text += fmt::format("[{}]\n", table);
      if (table == "viscosity")
        text += fmt::format("in = \"{}\"\n", kMediumNames[static_cast<std::size_t>(params.viscosity.medium)]);
      if (table == "texture")
        text += fmt::format("pattern = \"{}\"\n",
                            kPatternNames[static_cast<std::size_t>(params.texture.pattern)]);
    }
    text += fmt::format("{} = {}\n", number.key, number.of(params));
  }
  return text;
}

}  // namespace fettle::haptic

#include "haptic/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "haptic/base/search_limits.h"
#include "haptic/scene/scene_numbers.h"

namespace fettle::haptic {

namespace {

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

bool isTable(std::string_view name) noexcept {
  return !name.empty() && std::ranges::find(kSceneNumbers, name, &SceneNumber::table) != kSceneNumbers.end();
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

  // A value of a number's row, in range.
  void number(const toml::node& value, const SceneNumber& row) {
    // An integer is a fine number; a string that holds one is not.
    if (!value.is_number()) return complain(value, fmt::format("{} must be a number", row.key));
    const double read = *value.value<double>();
    // 2.0 is no whole number of a file.
    if (!row.holds(read) || (row.kind == NumberKind::kWhole && !value.is_integer()))
      return complain(value, rangeProblem(row));
    row.set(scene_, read);
  }

  const toml::table* table(const toml::node& value, std::string_view key) {
    if (value.is_table()) return value.as_table();
    complain(value, fmt::format("{} must be a table, as [{}]", key, key));
    return nullptr;
  }

  std::optional<std::size_t> word(const toml::node& value, std::string_view key,
                                  std::span<const std::string_view> known) {
    if (const auto text = value.value<std::string_view>())
      for (std::size_t i = 0; i < known.size(); ++i)
        if (*text == known[i]) return i;
    complain(value, fmt::format("{} must be one of \"{}\"", key, fmt::join(known, "\", \"")));
    return std::nullopt;
  }

  // A key that has a row; false for every other.
  bool row(std::string_view table, std::string_view key, const toml::node& value) {
    for (const SceneNumber& each : kSceneNumbers) {
      if (each.table != table || each.key != key) continue;
      number(value, each);
      return true;
    }
    for (const SceneWord& each : kSceneWords) {
      if (each.table != table || each.key != key) continue;
      if (const auto i = word(value, key, each.words)) each.set(scene_, *i);
      return true;
    }
    return false;
  }

  void top(const toml::table& file) {
    entries(file, "", [&](std::string_view key, const toml::node& value) {
      if (key == "invert") {
        if (value.is_boolean())
          scene_.invert = *value.value<bool>();
        else
          complain(value, "invert must be true or false");
      } else if (key == "effects") {
        effects(value);
      } else if (isTable(key)) {
        if (const toml::table* t = table(value, key)) rows(key, *t);
      } else {
        return row("", key, value);
      }
      return true;
    });
    if (contact_revision_ < 2 && scene_.level == ContactLevel::kPaper) scene_.level = ContactLevel::kDescent;
    if (!problem_ && roundsWithoutUse(scene_)) complain(*file.get("contact"), kRoundsNeedDescent);
    if (scene_.params.friction.dynamic_coefficient > scene_.params.friction.static_coefficient)
      complain(*file.get("friction"), kDynamicAboveStatic);
  }

  void rows(std::string_view name, const toml::table& table) {
    entries(table, fmt::format("[{}]", name), [&](std::string_view key, const toml::node& value) {
      if (name != "brush" || key != "max_change") return row(name, key, value);
      const double limit = value.is_number() ? *value.value<double>() : -1.0;
      if (limit >= 0.0 && std::isfinite(limit))
        scene_.max_change = limit;
      else
        complain(value, "max_change must be a number of 0 or more");
      return true;
    });
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

  Scene& scene_;
  int contact_revision_;
  std::optional<std::string> problem_;
};

}  // namespace

std::string_view levelName(ContactLevel level) noexcept {
  return kLevelWords[static_cast<std::size_t>(level)];
}

Scene defaultScene() {
  return {};
}

std::optional<std::string> sceneProblem(const Scene& scene) {
  for (const SceneNumber& number : kSceneNumbers)
    if (!number.holds(number.of(scene))) return rangeProblem(number);
  if (roundsWithoutUse(scene)) return kRoundsNeedDescent;
  if (scene.max_change && !(*scene.max_change >= 0.0 && std::isfinite(*scene.max_change)))
    return "the largest change must be 0 or more";
  if (scene.params.friction.dynamic_coefficient > scene.params.friction.static_coefficient)
    return kDynamicAboveStatic;
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
  if (contact_revision < 5) scene.ball_work = 0;
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
  const Scene usual = defaultScene();
  std::string text;
  const auto writeTable = [&](std::string_view table) {
    for (const SceneWord& word : kSceneWords)
      if (word.table == table && (word.written == Written::kAlways || word.of(scene) != word.of(usual)))
        text += fmt::format("{} = \"{}\"\n", word.key, word.words[word.of(scene)]);
    for (const SceneNumber& number : kSceneNumbers)
      if (number.table == table &&
          (number.written == Written::kAlways || number.of(scene) != number.of(usual)))
        text += fmt::format("{} = {}\n", number.key, number.of(scene));
  };
  std::vector<std::string_view> effects;
  for (const EffectKind effect : scene.effects) effects.push_back(effectName(effect));
  writeTable("");
  text += fmt::format("invert = {}\neffects = [{}{}{}]\n", scene.invert, effects.empty() ? "" : "\"",
                      fmt::join(effects, "\", \""), effects.empty() ? "" : "\"");
  std::string_view table;
  for (const SceneNumber& number : kSceneNumbers) {
    if (number.table == table) continue;
    table = number.table;
    text += fmt::format("[{}]\n", table);
    writeTable(table);
    if (table == "brush" && scene.max_change) text += fmt::format("max_change = {}\n", *scene.max_change);
  }
  return text;
}

}  // namespace fettle::haptic

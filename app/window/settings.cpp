#include "app/window/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string_view>

#include <nlohmann/json.hpp>

#include "app/work/device_check.h"
#include "render/plan/material.h"

namespace fettle::app {
namespace {

using nlohmann::json;

constexpr double kFarthest_mm = 2000.0;  // of a stylus: no arm reaches farther
constexpr std::array kMaps{"automatic", "viridis", "cividis", "grey", "diverging"};
constexpr std::array kRangeRules{"automatic", "share", "all"};
constexpr auto kHabits = [] {
  std::array<std::string_view, kMousePresets.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = kMousePresets[i].word;
  return words;
}();

std::array<std::string_view, render::kMaterials> materialWordsOfFile() {
  std::array<std::string_view, render::kMaterials> words;
  std::ranges::transform(render::materials(), words.begin(), &render::MaterialRow::word);
  return words;
}

void take(const json& from, const char* name, bool& value) {
  if (const auto it = from.find(name); it != from.end() && it->is_boolean()) value = it->get<bool>();
}
template <class T>
void take(const json& from, const char* name, T low, T high, T& value) {
  const auto it = from.find(name);
  if (it == from.end() || !it->is_number()) return;
  const double number = it->get<double>();
  if (number >= static_cast<double>(low) && number <= static_cast<double>(high))
    value = static_cast<T>(number);
}
template <class Word, std::size_t N, class Enum>
void take(const json& from, const char* name, const std::array<Word, N>& words, Enum& value) {
  const auto it = from.find(name);
  if (it == from.end() || !it->is_string()) return;
  for (std::size_t i = 0; i < N; ++i)
    if (it->get<std::string>() == words[i]) value = static_cast<Enum>(i);
}

void takeTheme(const json& from, const char* name, render::Theme& theme) {
  bool light = theme == render::Theme::kLight;
  take(from, name, light);
  theme = light ? render::Theme::kLight : render::Theme::kDark;
}

json numbers(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

json jsonOf(const DeviceSetups& devices) {
  json all = json::object();
  for (const auto& [key, setup] : devices) {
    json one{{"motion", setup.motion},
             {"clutch_buttons", setup.clutch_buttons},
             {"menu_buttons", setup.menu_buttons}};
    if (setup.reach) {
      one["low_mm"] = numbers(setup.reach->low_mm);
      one["high_mm"] = numbers(setup.reach->high_mm);
    }
    all[key] = std::move(one);
  }
  return all;
}

bool take(const json& from, const char* name, glm::dvec3& value) {
  const auto it = from.find(name);
  if (it == from.end() || !it->is_array() || it->size() != 3) return false;
  for (int i = 0; i < 3; ++i) {
    const json& number = (*it)[static_cast<std::size_t>(i)];
    if (!number.is_number() || !(std::abs(number.get<double>()) <= kFarthest_mm)) return false;
    value[i] = number.get<double>();
  }
  return true;
}

DeviceSetup setupOf(const json& from) {
  DeviceSetup setup;
  take(from, "motion", DeviceSetup::kLeastMotion, 1.0, setup.motion);
  take(from, "clutch_buttons", std::uint32_t{0}, std::uint32_t{0xFFFF}, setup.clutch_buttons);
  take(from, "menu_buttons", std::uint32_t{0}, std::uint32_t{0xFFFF}, setup.menu_buttons);
  DeviceReach reach;
  if (take(from, "low_mm", reach.low_mm) && take(from, "high_mm", reach.high_mm) &&
      2.0 * reach.radius() >= DeviceCheck::kLeastReach_mm)
    setup.reach = reach;
  return setup;
}

// Ends that were typed are of one scan.
const char* wordOf(const RangeRule& rule) {
  return kRangeRules[rule.kind == RangeRule::Kind::kTyped ? 0 : static_cast<std::size_t>(rule.kind)];
}

}  // namespace

std::string Settings::text() const {
  const Display& d = display;
  return json{{"deviation", d.deviation},
              {"contours", d.contours},
              {"split", d.split},
              {"split_at", d.split_at},
              {"colours", kMaps[static_cast<std::size_t>(d.map)]},
              {"height_range", wordOf(d.heights)},
              {"height_share", d.heights.share},
              {"change_range", wordOf(d.changes)},
              {"change_share", d.changes.share},
              {"colour_steps", d.colour_steps},
              {"light_background", d.theme == render::Theme::kLight},
              {"marks_opacity", d.marks_opacity},
              {"light_azimuth", d.light_azimuth_deg},
              {"light_elevation", d.light_elevation_deg},
              {"decorations", d.decorations},
              {"axes", d.axes},
              {"flights", d.flights},
              {"reduced_motion", d.reduced_motion},
              {"half_in_motion", d.half_in_motion},
              {"smooth_at_rest", d.smooth_at_rest},
              {"filtered_normals", d.form.filtered_normals},
              {"occlusion", d.form.occlusion},
              {"cavity", d.form.cavity},
              {"material", render::rowOf(d.form.material).word},
              {"material_colours", d.form.value_colours},
              {"stylus_pen", d.stylus.pen},
              {"stylus_shadow", d.stylus.shadow},
              {"stylus_force", d.stylus.force},
              {"stylus_trail", d.stylus.trail},
              {"vertices", d.vertices},
              {"mouse", kHabits[static_cast<std::size_t>(habits)]},
              {"light_panels", panels_theme == render::Theme::kLight},
              {"ui_scale", ui_scale},
              {"side_panel", side_panel},
              {"side_width", side_width},
              {"panels", panels},
              {"pen_presses", pen.presses},
              {"pen_firmness", pen.firmness},
              {"edge_lines", draw_lines},
              {"volume", loudness.volume},
              {"muted", loudness.muted},
              {"devices", jsonOf(devices)},
              {"ask_before_quitting", ask_before_quitting}}
      .dump(2);
}

Settings Settings::load(const std::string& path) {
  Settings settings;
  std::ifstream in(path);
  const json file = json::parse(in, nullptr, false);
  if (!file.is_object()) return settings;
  Display& d = settings.display;
  take(file, "deviation", d.deviation);
  take(file, "contours", d.contours);
  take(file, "split", d.split);
  take(file, "split_at", 0.02, 0.98, d.split_at);
  take(file, "colours", kMaps, d.map);
  take(file, "height_range", kRangeRules, d.heights.kind);
  take(file, "height_share", 0.01, 1.0, d.heights.share);
  take(file, "change_range", kRangeRules, d.changes.kind);
  take(file, "change_share", 0.01, 1.0, d.changes.share);
  take(file, "colour_steps", d.colour_steps);
  takeTheme(file, "light_background", d.theme);
  takeTheme(file, "light_panels", settings.panels_theme);
  take(file, "marks_opacity", 0.0F, 1.0F, d.marks_opacity);
  take(file, "light_azimuth", 0.0F, 360.0F, d.light_azimuth_deg);
  take(file, "light_elevation", 5.0F, 90.0F, d.light_elevation_deg);
  take(file, "decorations", d.decorations);
  take(file, "axes", d.axes);
  take(file, "flights", d.flights);
  take(file, "reduced_motion", d.reduced_motion);
  take(file, "half_in_motion", d.half_in_motion);
  take(file, "smooth_at_rest", d.smooth_at_rest);
  take(file, "filtered_normals", d.form.filtered_normals);
  take(file, "occlusion", 0.0, 1.0, d.form.occlusion);
  take(file, "cavity", 0.0, 1.0, d.form.cavity);
  take(file, "material", materialWordsOfFile(), d.form.material);
  take(file, "material_colours", 0.0, 1.0, d.form.value_colours);
  take(file, "stylus_pen", d.stylus.pen);
  take(file, "stylus_shadow", d.stylus.shadow);
  take(file, "stylus_force", d.stylus.force);
  take(file, "stylus_trail", d.stylus.trail);
  take(file, "vertices", std::int64_t{4096}, std::int64_t{1} << 22, d.vertices);
  take(file, "mouse", kHabits, settings.habits);
  take(file, "ui_scale", 0.5, 4.0, settings.ui_scale);
  take(file, "side_panel", settings.side_panel);
  take(file, "side_width", 0.0F, 4096.0F, settings.side_width);
  if (const auto it = file.find("panels"); it != file.end() && it->is_object())
    for (const auto& [name, open] : it->items())
      if (open.is_boolean()) settings.panels[name] = open.get<bool>();
  take(file, "pen_presses", settings.pen.presses);
  take(file, "pen_firmness", PenUse::kSoftest, PenUse::kFirmest, settings.pen.firmness);
  take(file, "edge_lines", settings.draw_lines);
  take(file, "volume", 0.0F, 1.0F, settings.loudness.volume);
  take(file, "muted", settings.loudness.muted);
  take(file, "ask_before_quitting", settings.ask_before_quitting);
  if (const auto it = file.find("devices"); it != file.end() && it->is_object())
    for (const auto& [key, setup] : it->items())
      if (setup.is_object()) settings.devices[key] = setupOf(setup);
  return settings;
}

void Settings::save(const std::string& path) const {
  if (path.empty()) return;
  const std::string written = path + ".new";
  {
    std::ofstream out(written, std::ios::trunc);
    out << text() << '\n';
    if (!out.flush()) return;
  }
  std::error_code ignored;
  std::filesystem::rename(written, path, ignored);
}

}  // namespace fettle::app

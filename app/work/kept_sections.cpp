#include "app/work/kept_sections.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>

namespace fettle::app {

namespace {

struct FigureWord {
  const char* word;
  bool KeptSection::*wanted;
};
constexpr FigureWord kKeptFigures[] = {
    {"line", &KeptSection::line}, {"step", &KeptSection::step},   {"groove", &KeptSection::groove},
    {"arc", &KeptSection::arc},   {"angle", &KeptSection::angle}, {"roughness", &KeptSection::roughness}};

double finite(const Report& value) {
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw std::out_of_range("a number that is not finite");
  return number;
}

KeptSection sectionOf(const Report& in) {
  KeptSection section;
  section.from = {finite(in.at("from").at(0)), finite(in.at("from").at(1))};
  section.to = {finite(in.at("to").at(0)), finite(in.at("to").at(1))};
  section.width_mm = std::max(0.0, finite(in.at("width_mm")));
  section.cursors = {finite(in.at("cursors_mm").at(0)), finite(in.at("cursors_mm").at(1))};
  // Written where there is one.
  if (in.contains("others_mm"))
    section.others = {finite(in["others_mm"].at(0)), finite(in["others_mm"].at(1))};
  section.cutoff_mm = std::max(0.0, finite(in.at("cutoff_mm")));
  for (const Report& word : in.at("figures"))
    for (const FigureWord& figure : kKeptFigures)
      if (word.get_ref<const std::string&>() == figure.word) section.*figure.wanted = true;
  return section;
}

}  // namespace

double KeptSection::lengthMm() const noexcept {
  return glm::distance(from, to);
}

void KeptSection::placeStretches() noexcept {
  const double length = lengthMm();
  cursors = {0.25 * length, 0.75 * length};
  if (!angle) return;
  cursors = {0.1 * length, 0.4 * length};
  others = {0.6 * length, 0.9 * length};
}

void KeptSection::scaleStretches(double times) noexcept {
  for (double* const end : {&cursors.first, &cursors.second, &others.first, &others.second}) *end *= times;
}

void KeptSection::placeSecond() noexcept {
  if (!angle || others.first != others.second) return;
  const auto [low, high] = std::minmax(cursors.first, cursors.second);
  const double behind = lengthMm() - high;
  const double begin = behind >= low ? high : 0.0, free = std::max(behind, low);
  others = {begin + 0.1 * free, begin + 0.9 * free};
}

SectionWants wantsOf(const KeptSection& section) {
  const auto [low, high] = std::minmax(section.cursors.first, section.cursors.second);
  const std::vector<double> between = {low, high};
  SectionWants wants;
  wants.cursors = {section.cursors.first, section.cursors.second};
  if (!(low < high)) return wants;
  wants.within = between;
  if (section.line) wants.line = between;
  if (section.arc) wants.arc = between;
  if (const auto [from, to] = std::minmax(section.others.first, section.others.second);
      section.angle && from < to)
    wants.angle = {low, high, from, to};
  if (section.step) wants.step = "auto";
  if (section.groove) wants.groove = "auto";
  if (section.roughness && section.cutoff_mm > 0.0) wants.cutoff = section.cutoff_mm;
  return wants;
}

std::string sectionsText(const std::vector<KeptSection>& sections) {
  Report out = Report::array();
  for (const KeptSection& section : sections) {
    Report figures = Report::array();
    for (const FigureWord& figure : kKeptFigures)
      if (section.*figure.wanted) figures.push_back(figure.word);
    out.push_back({{"from", {section.from.x, section.from.y}},
                   {"to", {section.to.x, section.to.y}},
                   {"width_mm", section.width_mm},
                   {"cursors_mm", {section.cursors.first, section.cursors.second}},
                   {"figures", figures},
                   {"cutoff_mm", section.cutoff_mm}});
    if (section.others.first != section.others.second)
      out.back()["others_mm"] = {section.others.first, section.others.second};
  }
  return out.dump();
}

engine::Result<std::vector<KeptSection>> sectionsOf(std::string_view text) try {
  std::vector<KeptSection> sections;
  for (const Report& each : Report::parse(text)) sections.push_back(sectionOf(each));
  return sections;
} catch (const std::exception& error) {
  return engine::inputError("the sections kept in the session cannot be read", "sections", error.what());
}

}  // namespace fettle::app

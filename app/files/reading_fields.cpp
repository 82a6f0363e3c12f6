#include "app/files/reading_fields.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/texts/texts.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

constexpr std::array kFields{
    ReadingField{"--spacing", textOf("spacing"), true,
                 textOf("How far two samples lie apart, in the unit below: along a row, and from row to row. "
                        "Empty: as the "
                        "file says, else 1.")},
    ReadingField{
        "--unit", textOf("unit"), true,
        textOf(
            "The unit of spacing and heights, where the file does not say it. Counts of a depth camera are "
            "often mm.")},
    ReadingField{
        "--z-scale", textOf("z scale"), true,
        textOf(
            "How high one step of the stored numbers is: 0.001 where micrometres are stored and the unit is "
            "mm. Empty: as the file says, else 1.")},
    ReadingField{
        "--no-data", textOf("no data"), true,
        textOf("The stored number that means \"nothing was measured here\": often 0, -9999 or 65535. These "
               "samples become holes.")},
    ReadingField{
        "--cell-size", textOf("cell size"), false,
        textOf(
            "The points are gathered in square cells of this size, in the unit of the file. Empty: as large "
            "as the points lie apart.")},
    ReadingField{
        "--cell-rule", textOf("cell height"), false,
        textOf(
            "The height of a cell with several points: the median leaves out strays, the highest is what a "
            "laser from above sees first.")},
    ReadingField{
        "--depth-camera", textOf("depth camera"), false,
        textOf("The numbers are distances from a camera: its focal length fx in pixels. fy is the same, "
               "and its axis cx, cy "
               "goes through the middle of the picture, unless they are given.")},
};

// Formats whose points lie as they like, and pictures whose counts may be distances: FormatInfo::name.
constexpr std::array<std::string_view, 5> kOfPoints{"PLY", "PCD", "LAS", "XYZ", "STL"};
constexpr std::array<std::string_view, 2> kPictures{"GTiff", "PNG"};

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

bool names(std::string_view warning, std::string_view option) {
  return warning.find(option) != std::string_view::npos;
}

std::string pairText(const std::vector<double>& numbers) {
  return numbers.front() == numbers.back() ? fmt::format("{}", numbers.front())
                                           : fmt::format("{} x {}", numbers.front(), numbers.back());
}

}  // namespace

std::span<const ReadingField> readingFields() {
  return kFields;
}

const ReadingField& readingField(std::string_view option) {
  return *std::ranges::find(kFields, option, &ReadingField::option);
}

std::string inFieldWords(std::string_view warning) {
  std::string text(warning);
  for (const ReadingField& field : kFields) {
    const std::string option(field.option), name = fmt::format("\"{}\"", tr(field.name));
    for (const char* verb : {"give it with ", "give them with ", "give "})
      replaceAll(text, verb + option + " ", "set " + name + " to ");
    // "to" only before a value: none follows "and", "or", "if".
    for (const char* word : {"and", "or", "if"})
      replaceAll(text, "set " + name + " to " + word + " ", "set " + name + " " + word + " ");
    for (const char* verb : {"give it with ", "give them with ", "give "})
      replaceAll(text, verb + option, "set " + name);
    replaceAll(text, "with " + option, "as " + name);
    replaceAll(text, option, name);
  }
  return text;
}

bool isAssumed(const std::vector<std::string>& warnings, std::string_view option) {
  return std::ranges::any_of(warnings, [&](std::string_view warning) {
    const bool assumed = names(warning, " is assumed") || names(warning, " are assumed");
    return assumed && names(warning, option);
  });
}

bool isGuess(std::string_view warning) {
  return std::ranges::any_of(
      kFields, [&](const ReadingField& field) { return field.meaning && names(warning, field.option); });
}

bool anyGuess(const std::vector<std::string>& warnings) {
  return std::ranges::any_of(warnings, [](const std::string& warning) { return isGuess(warning); });
}

std::string readingText(const ScanOptions& reading) {
  std::vector<std::string> said;
  const auto say = [&](std::string_view option, const std::string& value) {
    said.push_back(fmt::format("{} {}", tr(readingField(option).name), value));
  };
  if (!reading.spacing.empty()) say("--spacing", pairText(reading.spacing));
  if (!reading.unit.empty()) say("--unit", reading.unit);
  if (reading.z_scale) say("--z-scale", fmt::format("{}", *reading.z_scale));
  if (reading.no_data) say("--no-data", fmt::format("{}", *reading.no_data));
  if (reading.cell_size) say("--cell-size", fmt::format("{}", *reading.cell_size));
  if (!reading.cell_rule.empty()) say("--cell-rule", reading.cell_rule);
  if (!reading.depth_camera.empty())
    say("--depth-camera", fmt::format("{}", fmt::join(reading.depth_camera, " ")));
  return fmt::format("{}", fmt::join(said, ", "));
}

FieldsThatApply fieldsThatApply(std::string_view format, bool counts) {
  FieldsThatApply apply;
  apply.cells = std::ranges::find(kOfPoints, format) != kOfPoints.end();
  apply.spacing = !apply.cells;
  apply.camera = counts && std::ranges::find(kPictures, format) != kPictures.end();
  return apply;
}

FieldsThatApply fieldsOfName(const std::string& path) {
  const std::string extension = engine::extensionOf(path);
  std::optional<FieldsThatApply> all;
  for (const engine::FormatInfo& format : engine::formats()) {
    if (std::ranges::find(format.extensions, extension) == format.extensions.end()) continue;
    const FieldsThatApply one = fieldsThatApply(format.name, false);
    if (!all) all = one;
    all->spacing = all->spacing || one.spacing;
    all->cells = all->cells || one.cells;
  }
  return all.value_or(fieldsThatApply({}, false));
}

ReadingSources readingSources(const ScanOptions& reading, const std::vector<std::string>& warnings,
                              const FieldsThatApply& apply) {
  std::vector<std::string_view> stated;
  const auto add = [&](std::string_view option, bool said) {
    if (!said && !isAssumed(warnings, option)) stated.push_back(tr(readingField(option).name));
  };
  if (apply.spacing) add("--spacing", !reading.spacing.empty() || !reading.depth_camera.empty());
  add("--unit", !reading.unit.empty());
  ReadingSources sources;
  if (!stated.empty()) sources.file = trFormat("from the file: {}", fmt::join(stated, ", "));
  if (const std::string said = readingText(reading); !said.empty())
    sources.person = trFormat("as you say: {}", said);
  return sources;
}

}  // namespace fettle::app

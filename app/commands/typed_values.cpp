#include "app/commands/typed_values.h"

#include <charconv>
#include <cstdint>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/work/typed_lengths.h"
#include "engine/io/import.h"
#include "engine/scanner/part.h"

namespace fettle::app {

engine::Result<double> parseHeight(const std::string& text, const engine::Grid& grid,
                                   const std::string& option) {
  const auto typed = typedLengthOf(text);
  if (!typed || typed->value < 0.0)
    return engine::inputError(fmt::format("{} is not a length", text), option,
                              "give a number at or above 0, such as 0.5 or 20um");
  if (typed->unit.empty()) return typed->value;
  if (!typed->unit_mm)
    return engine::inputError(fmt::format("unknown unit {}", typed->unit), option,
                              fmt::format("take one of {}", fmt::join(engine::lengthUnitNames(), ", ")));
  return typed->value * *typed->unit_mm / grid.height_unit.mm;
}

engine::Result<double> parseSignedHeight(const std::string& text, const engine::Grid& grid,
                                         const std::string& option) {
  const bool below = text.starts_with('-');
  const auto height = parseHeight(below ? text.substr(1) : text, grid, option);
  if (!height) return tl::unexpected(height.error());
  return below ? -*height : *height;
}

std::string seedProblem(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  return error == std::errc{} && end == text.data() + text.size()
             ? ""
             : "give a whole number from 0 to 18446744073709551615";
}

std::vector<Word> partWords() {
  std::vector<Word> words;
  words.reserve(engine::parts().size());
  for (const engine::PartInfo& part : engine::parts())
    words.emplace_back(std::string(part.name), std::string(part.description));
  return words;
}

engine::Result<std::pair<int, int>> parseSize(const std::string& text, const std::string& option,
                                              SideRange sides) {
  int width = 0;
  int height = 0;
  char rest = 0;
  const auto fits = [&](int side) { return side >= sides.smallest && side <= sides.largest; };
  if (std::sscanf(text.c_str(), "%6dx%6d%c", &width, &height, &rest) != 2 || !fits(width) || !fits(height))
    return engine::inputError(fmt::format("{} is not a size", text), option,
                              fmt::format("give WIDTHxHEIGHT, each {} to {}", sides.smallest, sides.largest));
  return std::pair{width, height};
}

}  // namespace fettle::app

#include "engine/resume/work_identity.h"

#include <bit>
#include <cstdint>
#include <sstream>

#include <fmt/format.h>
#include <xxhash.h>

#include "engine/filter/catalogue.h"

namespace fettle::engine {

namespace {

std::string hex(std::uint64_t bits) {
  return fmt::format("{:016x}", bits);
}

std::string bitsOf(double value) {
  return hex(std::bit_cast<std::uint64_t>(value));
}

// All members that a filter reads.
std::string printOf(const EdgeLines& lines) {
  if (lines == nullptr || lines->empty()) return "none";
  std::vector<double> numbers;
  for (const EdgeLine& line : *lines) {
    numbers.push_back(static_cast<double>(line.id));
    numbers.push_back(line.closed ? 1.0 : 0.0);
    numbers.push_back(static_cast<double>(line.points.size()));
    for (const EdgePoint& p : line.points)
      numbers.insert(numbers.end(),
                     {p.position.x, p.position.y, p.located ? 1.0 : 0.0, static_cast<double>(p.kind),
                      p.deviation, p.step, p.step_deviation, p.slope_change, p.slope_deviation});
  }
  return hex(XXH64(numbers.data(), numbers.size() * sizeof(double), 0));
}

}  // namespace

std::string WorkIdentity::text() const {
  std::string all;
  for (const auto& [word, value] : parts) all += fmt::format("{} {}\n", word, value);
  return all;
}

std::string WorkIdentity::differsIn(const std::string& other_text) const {
  std::istringstream other(other_text);
  for (const auto& [word, value] : parts) {
    std::string line;
    if (!std::getline(other, line) || line != fmt::format("{} {}", word, value)) return word;
  }
  std::string rest;
  return std::getline(other, rest) ? rest.substr(0, rest.find(' ')) : std::string();
}

WorkIdentity identityOf(const Version& input, const Version& original, const FilterSpec& spec,
                        const std::string& device) {
  const Grid& grid = input.grid();
  WorkIdentity id;
  id.parts = {
      {"revision", fmt::format("{}", kFilterRevision)},
      {"filter", fmt::format("{} window {} sigma {} range_sigma {}{}{} passes {} {} max_change {}",
                             name(spec.kind), spec.window, bitsOf(spec.sigma), bitsOf(spec.range_sigma),
                             spec.nesting_mm > 0.0 ? " nesting_mm " + bitsOf(spec.nesting_mm) : "",
                             filterOf(spec.kind).has_element
                                 ? fmt::format(" {}", kElementWords[static_cast<std::size_t>(spec.element)])
                                 : "",
                             spec.passes, spec.scope == FilterScope::kKeepMarks ? "keep" : "only",
                             spec.max_change ? bitsOf(*spec.max_change) : "none")},
      {"compute", device.empty() ? "cpu" : device},
      {"size", fmt::format("{} x {}", grid.width, grid.height)},
      {"scan", fmt::format("{} {}", hex(contentHash(input)), input.reader().sign() > 0.0F ? "+" : "-")},
      {"lines", printOf(input.lines())}};
  // An original upside down is the same original.
  if (spec.max_change)
    id.parts.emplace_back("original",
                          hex(contentHash(original.reader().sign() > 0.0F ? original : original.inverted())));
  return id;
}

}  // namespace fettle::engine

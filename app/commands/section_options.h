#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_options.h"
#include "engine/base/error.h"

namespace fettle::app {

/// What `fettle section` is asked for. Lengths and positions in millimetres.
struct SectionArguments {
  std::string scan;
  std::vector<double> from, to;
  std::vector<std::string> polylines;
  std::string lines;
  double width = 0.0;
  std::string interpolation = "bilinear";
  std::string region = "all";
  std::string marks;
  std::string compare;
  // What is measured.
  std::vector<double> within, cursors, line, angle, arc;
  std::string step, groove;
  std::optional<double> cutoff;
  std::vector<std::string> probes;
  std::optional<double> probe_radius;
  // Files.
  std::string csv, plot, dxf;
  Replacing replacing = Replacing::kNoWork;
  ScanOptions reading;
};

/// The options of the line, and of what is measured along it.
void addLineOptions(Command command, SectionArguments& options);
void addFigureOptions(Command command, SectionArguments& options);

/// Refuses texts that are no numbers, stretches out of order, options and marks that have no effect (kInput).
[[nodiscard]] engine::Status checkSectionWords(const SectionArguments& options);

/// Numbers with commas between them, exactly so many; none when the text is something else.
[[nodiscard]] std::vector<double> numbersOf(std::string_view text, std::size_t count);

/// The points of "X,Y:X,Y", two or more. Errors (kInput): another text, naming the option.
[[nodiscard]] engine::Result<std::vector<glm::dvec2>> polylineOf(const std::string& text,
                                                                 const std::string& option);

}  // namespace fettle::app

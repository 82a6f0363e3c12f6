#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_options.h"
#include "app/work/section_report.h"
#include "engine/base/error.h"
#include "engine/measure/section.h"

namespace fettle::app {

/// What `fettle section` is asked for. Lengths and positions in millimetres.
struct SectionArguments : SectionWants, RegionArguments {
  std::string scan;
  std::vector<double> from, to;
  std::vector<std::string> polylines;
  std::string lines;
  double width = 0.0;
  std::string interpolation = "bilinear";
  std::string compare;
  std::vector<std::string> at_heights;  ///< as typed: mm, or with a unit
  std::vector<double> between;          ///< two material ratios [%]; empty: none
  bool kept = false;                    ///< those of the session, each with its own width and figures
  // What is measured besides.
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

/// What they ask for of the material ratio curve. Errors (kInput): a text that is no height; ratios that are none or out of order.
[[nodiscard]] engine::Result<engine::AskedRatios> askedRatiosOf(const SectionArguments& options);

/// Refuses texts that are no numbers, stretches out of order, options and marks that have no effect (kInput).
[[nodiscard]] engine::Status checkSectionWords(const SectionArguments& options);

}  // namespace fettle::app

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/pages/report_page.h"
#include "app/work/kept_sections.h"
#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::app {

/// A state of the surface that a report shows: the scan as it was measured, or as it is.
struct ShownState {
  std::string name;  ///< "Before"
  engine::Version field;
};

/// The sections of a report: polylines "X,Y:X,Y" in mm from the lower left sample.
struct ReportSections {
  std::vector<std::string> lines;
  double width_mm = 0.0;
  std::optional<double> cutoff_mm;  ///< with it, roughness of the profiles
};

/// --section, --section-width, --cutoff.
void addSectionOptions(Command command, ReportSections& sections);

/// Refuses texts that are no lines, options without an effect, and drawings without gnuplot (kInput, kFailed).
[[nodiscard]] engine::Status checkSections(const ReportSections& sections);

/// Adds the states' profiles along each line over each other and a table of their figures. Errors: as engine::sectionAlong
/// and drawnByGnuplot; a cut-off that no profile allows is a note under the table.
[[nodiscard]] engine::Status addSections(ReportPage& page, const ReportSections& sections,
                                         const std::vector<ShownState>& states, engine::JobControl& job);

/// The same of the sections that the window kept with a session, each with what is measured between its cursors, with standard
/// errors. What heights do not determine is a note under the table. Needs gnuplot (plotsCanBeMade).
[[nodiscard]] engine::Status addKeptSections(ReportPage& page, const std::vector<KeptSection>& kept,
                                             const std::vector<ShownState>& states, engine::JobControl& job);

}  // namespace fettle::app

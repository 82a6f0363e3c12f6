#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/areal_option.h"
#include "app/commands/form_option.h"
#include "app/commands/noise_option.h"
#include "app/commands/report_sections.h"
#include "app/commands/scale_option.h"
#include "app/commands/scan_options.h"
#include "app/pages/report_page.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/compare/compare.h"
#include "engine/io/import.h"
#include "engine/measure/areal.h"

namespace fettle::app {

/// What `fettle report` is asked for.
struct ReportArguments {
  std::string scan, out, original;
  std::string name;   ///< of the scan in the page; empty: that of its file
  std::string title;  ///< empty: the scan's name
  std::string type;   ///< empty: by the name of `out`, else html
  FormArguments form;
  ScaleArguments scale;
  ArealArguments areal;
  int noise_trials = kUsualTrials;
  bool estimate = false;
  ReportSections sections;
  std::optional<std::string> kept;  ///< sectionsText() in place of those kept with the session
  ScanOptions reading;
};

/// A page about a scan while its parts are added to it, in the order of the page: each part uses what was read, and what parts before
/// it have found.
struct ReportDraft {
  ReportDraft(const ReportArguments& asked, engine::JobControl& control) : options(asked), job(control) {}

  const ReportArguments& options;
  engine::JobControl& job;
  engine::Imported imported;
  std::vector<ShownState> states;           ///< the scan; or what it was before it, and the scan
  std::optional<engine::Deviation> change;  ///< from before to after; of report_facts.h
  int noise_trials = 0;                     ///< that were made; of report_texture.h
  ReportPage page;
  Report report = Report::object();  ///< of the command

  /// Name of the scan in the page.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] const std::string& heightUnit() const { return imported.field.grid().height_unit.name; }
  /// Heads of a table: these, then the states.
  [[nodiscard]] std::vector<std::string> heads(std::vector<std::string> first) const;
};

/// The name of a file without its folder.
[[nodiscard]] std::string fileNameOf(const std::string& path);

/// Reads the scan and what it was before. Errors: as loadScan; an original of another size (kInput).
[[nodiscard]] engine::Status readForReport(ReportDraft& draft);

/// Adds all parts to a draft that was read, and writes the page as this extension says: ".pdf", else HTML. Errors: those of the
/// parts.
[[nodiscard]] engine::Result<std::string> reportText(ReportDraft& draft, const std::string& extension);

/// The whole command: checks, reads, and writes the page to options.out. Errors also of the options (kInput).
[[nodiscard]] engine::Result<Report> writeReport(const ReportArguments& options, engine::JobControl& job);

inline constexpr const char* kPdfExtension = ".pdf";

}  // namespace fettle::app

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/measuring.h"
#include "app/commands/output_checks.h"
#include "app/commands/report_draft.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "app/work/surface_numbers.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

// The page as it would be of a piece, with as many states.
engine::Status writeOfPiece(const ReportDraft& draft, const engine::Version& piece, const std::string& path,
                            const std::string& extension) {
  const KeptMessages said;
  ReportArguments options = draft.options;
  options.sections = {};
  options.form.region = "all";
  options.form.marks.clear();
  options.scale = {};
  options.noise_trials = 0;
  engine::JobControl own = engine::JobControl::partOf(draft.job);
  ReportDraft small(options, own);
  small.imported.field = piece;
  for (const ShownState& state : draft.states) small.states.push_back({.name = state.name, .field = piece});
  const auto text = reportText(small, extension);
  if (!text) return tl::unexpected(text.error());
  return engine::writeFileAtomically(path, *text);
}

// Pictures and plots take as long for any scan, and as much of the page: with --estimate a page of a piece is made.
engine::Result<Foreseen> foreseeReport(const ReportDraft& draft, const std::string& extension) {
  const engine::Version& field = draft.states.back().field;
  const auto counted =
      countedOf(field, draft.imported.original, draft.options.scan, draft.options.form, draft.job);
  if (!counted) return tl::unexpected(counted.error());
  engine::ArealOptions areal;
  areal.region = formChoiceOf(draft.options.form).region;
  areal.at_ratios = curveRatios();
  areal.analysis = true;
  choose(choiceOf(draft.options.areal), areal);
  PlannedWork planned{
      .field = field,
      .original = field,
      .steps = {plannedMeasuring({*counted, draft.options.scan, draft.imported, draft.options.form,
                                  draft.options.scale, areal, draft.options.noise_trials,
                                  static_cast<int>(draft.states.size())})},
      .out = {},
      .extension = extension,
      .writing = {}};
  if (draft.options.estimate) {
    planned.out = memoryPlace(draft.options.out) == nullptr ? draft.options.out : std::string();
    planned.alike = true;
    planned.write = [&](const engine::Version& piece, const std::string& path, engine::JobControl&) {
      return writeOfPiece(draft, piece, path, extension);
    };
  }
  return foresee(planned, shownOutput(draft.options.out), draft.options.estimate, draft.job);
}

// With its dot, in lower case.
engine::Result<std::string> extensionFor(const ReportArguments& options) {
  const bool named = !isStream(options.out) && memoryPlace(options.out) == nullptr;
  const std::string of_name =
      named ? withDot(std::filesystem::path(options.out).extension().string()) : std::string();
  if (options.type.empty()) return named ? of_name : std::string(".html");
  const std::string typed = withDot(options.type);
  if (named && (typed == kPdfExtension) != (of_name == kPdfExtension))
    return engine::inputError(fmt::format("--type {} is not what the file's name says", options.type),
                              options.out, "leave --type out, or name another file");
  return typed;
}

}  // namespace

engine::Result<Report> writeReport(const ReportArguments& options, engine::JobControl& job) {
  ReportDraft draft(options, job);
  const auto extension = extensionFor(options);
  if (!extension) return tl::unexpected(extension.error());
  // Before the work that the page would be lost with.
  if (*extension == kPdfExtension)
    if (auto status = pdfIsPossible(); !status) return tl::unexpected(status.error());
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  if (auto status = checkNoiseTrials(options.noise_trials); !status) return tl::unexpected(status.error());
  if (auto status = checkAreal(options.areal); !status) return tl::unexpected(status.error());
  if (auto status =
          checkOutputs({{options.out, OutputKind::kPage, *extension}},
                       {options.scan, options.original, options.form.marks}, Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  if (auto status = checkSections(options.sections); !status) return tl::unexpected(status.error());
  if (auto status = readForReport(draft); !status) return tl::unexpected(status.error());
  const auto foreseen = foreseeReport(draft, *extension);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *foreseen->only;
  const auto text = reportText(draft, *extension);
  if (!text) return tl::unexpected(text.error());
  if (MemoryPlace* place = memoryPlace(options.out)) {
    place->page = *text;
  } else {
    const auto written = writeTo(options.out, *extension, job, [&](const std::string& file) {
      return engine::writeFileAtomically(file, *text);
    });
    if (!written) return tl::unexpected(written.error());
  }
  return std::move(draft.report);
}

void addReport(Command root, Chosen& chosen) {
  auto options = std::make_shared<ReportArguments>();
  Command command =
      addCommand(root, chosen, "report", "A page about a scan or a session: pictures, figures, steps",
                 [options](engine::JobControl& job) { return writeReport(*options, job); });
  command.add({{.name = "SCAN",
                .to = &options->scan,
                .text = "The scan or session; - for standard input",
                .kind = ValueKind::kInput,
                .required = true},
               {.name = "OUT",
                .to = &options->out,
                .text = "The page to write, .html or .pdf; - for standard output",
                .kind = ValueKind::kOutput,
                .required = true},
               {.name = "--original",
                .to = &options->original,
                .text = "Figures and pictures beside those of this scan; of a session: the one it began with",
                .kind = ValueKind::kInput},
               {.name = "--title",
                .to = &options->title,
                .text = "Heading of the page",
                .otherwise = "the file's name"},
               {.name = "--type",
                .to = &options->type,
                .text = "What the page is written as",
                .words = {Word(std::string("html")), Word(std::string("pdf"))},
                .otherwise = "by the name of OUT; to standard output html"}});
  addSectionOptions(command, options->sections);
  addFormOptions(command, options->form);
  addScaleOptions(command, options->scale);
  addArealOptions(command, options->areal);
  addNoiseOption(command, options->noise_trials);
  addEstimateOption(command, options->estimate);
  addScanOptions(command, options->reading);
  command.notes(
      "One file without links to others: pictures from the side and from above, noise, surface texture about "
      "a form, its material ratio curve, autocorrelation and power spectrum, sections, of a session before "
      "and after, those that the window kept with it, too, with its settings, its steps and the hash of each "
      "state. The same scan gives the same "
      "page, "
      "on one machine to the byte. In a PDF text can be selected and searched; it is A4.");
  command.examples({{"fettle report scan.tif report.html", "Pictures and figures of a scan"},
                    {"fettle report work.fettle report.pdf --section 1,2:9,2",
                     "Of a session, with a section before and after"},
                    {"fettle report clean.tif report.html --original scan.tif --form poly2 --robust",
                     "What a filter has changed, about a slightly bent surface"}});
}

}  // namespace fettle::app

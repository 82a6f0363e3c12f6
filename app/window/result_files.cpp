#include "app/window/result_files.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/section_export.h"
#include "app/work/session_guard.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

using Kind = Question::Kind;
using Work = engine::Result<ResultWriting::Work>;

Work sectionsWork(Parts& parts) {
  const LoopClient& client = *parts.document.client();
  SectionTool& tool = parts.section;
  const bool one = tool.exporting.chosen_alone && tool.section() != nullptr;
  SectionsToWrite what{tool.sections(), client.newest(), {}};
  if (one) what.sections = {*tool.section()};
  std::erase_if(what.sections, [](const KeptSection& section) { return !(section.lengthMm() > 0.0); });
  if (what.sections.empty())
    return engine::inputError(tr("there is no section yet"), "",
                              tr("point at its ends and press Q and Shift+Q"));
  if (tool.exporting.with_scan && engine::measureChange(client.original(), what.field).tiles > 0)
    what.before = client.original();
  return [what = std::move(what)](const std::string& path, engine::JobControl& job) {
    return writeSections(what, path, job);
  };
}

// Of the session that keeps the work; without a step there is none, and the scan is all.
Work reportWork(Parts& parts) {
  const SessionKeeper& keeper = *parts.document.keeper();
  if (const auto error = keeper.error()) return tl::unexpected(*error);
  if (parts.document.client()->strokeIsUnderWay())
    return engine::inputError(tr("a stroke is under way"), "", tr("let the stylus go first"));
  const bool session = !keeper.path().empty();
  if (!session && parts.document.client()->history().last() > 0)
    return engine::inputError(tr("the first step is still being stored"), "", tr("ask for the report again"));
  parts.document.storeNotes(parts.view);
  ReportRequest request{session ? keeper.path() : parts.document.path(),
                        session ? ScanOptions() : parts.reading,
                        keeper.named() ? "" : parts.document.fileName(),
                        parts.section.sections().empty() ? "" : sectionsText(parts.section.sections())};
  return [request = std::move(request), write = parts.write_report](
             const std::string& path, engine::JobControl& job) { return write(request, path, job); };
}

Work fitsWork(Parts& parts) {
  if (parts.fit.fits() == nullptr)
    return engine::inputError(tr("nothing is fitted yet"), "", tr("open the panel Fit"));
  return [fits = *parts.fit.fits(), field = parts.fit.field()](const std::string& path, engine::JobControl&) {
    return writeFits(fits, field, path);
  };
}

Work featuresWork(Parts& parts) {
  if (parts.features.found() == nullptr)
    return engine::inputError(tr("no features were found yet"), "", tr("open the panel Features"));
  return [report = *parts.features.found()](const std::string& path, engine::JobControl&) {
    return writeFeatures(report, path);
  };
}

constexpr ResultFormat kSectionFormats[] = {
    {".csv", textOf("a table of lengths, positions and heights, mm"), OutputKind::kText},
    {".svg", textOf("heights over lengths, drawn"), OutputKind::kPlot},
    {".png", textOf("the same as a picture"), OutputKind::kPlot},
    {".dxf", textOf("polylines, length and height in mm"), OutputKind::kDrawing}};

constexpr ResultFormat kReportFormats[] = {{".html", textOf("one page for a browser"), OutputKind::kPage},
                                           {".pdf", textOf("A4 pages"), OutputKind::kPage}};

constexpr ResultFormat kFitFormats[] = {
    {".csv", textOf("a row for each figure, with its standard error"), OutputKind::kText},
    {".json", textOf("the report of fettle fit"), OutputKind::kText},
    {".step", textOf("the shapes for a CAD program, AP 214"), OutputKind::kText},
    {".stp", textOf("the same"), OutputKind::kText}};

constexpr ResultFormat kFeatureFormats[] = {
    {".csv", textOf("a row for each, in the scan's units"), OutputKind::kText}};

constexpr ResultFile kResultFiles[] = {
    {Kind::kExportSections, textOf("sections"), "_sections.csv",
     textOf("the sections kept with the work, as fettle section --kept writes them"), kSectionFormats,
     ResultWriting::Reads::kNothing, sectionsWork},
    {Kind::kExportReport, textOf("report"), "_report.html",
     textOf("pictures, figures, sections and steps, as fettle report writes them"), kReportFormats,
     ResultWriting::Reads::kSession, reportWork},
    {Kind::kExportFits, textOf("fits"), "_fits.csv",
     textOf("the fits of the panel Fit, as fettle fit writes them"), kFitFormats,
     ResultWriting::Reads::kNothing, fitsWork},
    {Kind::kExportFeatures, textOf("features"), "_features.csv",
     textOf("the table of the panel Features, as fettle features --csv writes it"), kFeatureFormats,
     ResultWriting::Reads::kNothing, featuresWork},
};

}  // namespace

const ResultFile* resultFileOf(Kind kind) {
  const auto* const row = std::ranges::find(kResultFiles, kind, &ResultFile::kind);
  return row == std::end(kResultFiles) ? nullptr : row;
}

const ResultFormat* formatOf(const ResultFile& file, const std::string& path) {
  const auto format = std::ranges::find(file.formats, engine::extensionOf(path), &ResultFormat::ending);
  return format == file.formats.end() ? nullptr : &*format;
}

void askForResult(Kind kind, Parts& parts) {
  const ResultFile& file = *resultFileOf(kind);
  if (const Work work = file.work(parts); !work) {
    parts.feedback.take({work.error().what, work.error().remedy});
    return;
  }
  parts.feedback.questions.ask(
      {.kind = kind, .path = parts.saving.suggestedPath(parts.document, file.usual)});
}

void confirmResult(Question question, Parts& parts) {
  const ResultFile& file = *resultFileOf(question.kind);
  const ResultFormat& format = *formatOf(file, question.path);
  const SessionKeeper& keeper = *parts.document.keeper();
  if (auto status = checkPlaces({{question.path, format.kind}},
                                {keeper.scanPath(), keeper.path(), parts.document.path()});
      !status) {
    // Back to the dialog in which it was chosen.
    parts.feedback.questions.ask(
        {.kind = question.kind, .path = std::move(question.path), .said = {status.error().line(), ""}});
    return;
  }
  ReplacedFiles files = replacedFiles({question.path}, keeper.scanPath());
  if (files.texts.empty())
    writeResult(question.kind, question.path, parts);
  else
    parts.feedback.questions.ask({.kind = Kind::kReplace,
                                  .path = std::move(question.path),
                                  .from = question.kind,
                                  .typed = true,
                                  .replaced = std::move(files.texts)});
}

void writeResult(Kind kind, const std::string& path, Parts& parts) {
  const ResultFile& file = *resultFileOf(kind);
  if (parts.results.busy()) {
    parts.feedback.message(trFormat("writing {} is under way", tr(parts.results.what())),
                           tr("wait for its end, or cancel it"));
    return;
  }
  Work work = file.work(parts);
  if (work)
    parts.results.start(path, file.what, file.reads, *std::move(work));
  else
    parts.feedback.message(work.error().line(), "");
}

}  // namespace fettle::app

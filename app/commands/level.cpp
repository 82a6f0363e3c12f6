#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/fill/filled_samples.h"
#include "engine/measure/line_offsets.h"
#include "engine/measure/lowered.h"

namespace fettle::app {

namespace {

struct LineWord {
  const char* word;
  const char* text;
  engine::LineMethod method;
  int degree;
};
constexpr LineWord kLineWords[] = {
    {"median", "the median of each", engine::LineMethod::kMedian, 0},
    {"mean", "the mean of each", engine::LineMethod::kPolynomial, 0},
    {"poly1", "a straight line along each", engine::LineMethod::kPolynomial, 1},
    {"poly2", "a polynomial of degree 2 along each", engine::LineMethod::kPolynomial, 2},
    {"poly3", "of degree 3", engine::LineMethod::kPolynomial, 3},
    {"difference", "the median of the differences to the line before", engine::LineMethod::kDifference, 0},
    {"matching", "of those differences the mean where both lines are alike", engine::LineMethod::kMatching,
     0},
};

struct LevelArguments {
  BatchOptions files;
  std::string rows;  // empty: lines stay
  std::string scan_axis = "x";
  FormArguments form;
  ScanOptions reading;
  engine::ExportOptions writing;
};

std::vector<Word> lineWords() {
  std::vector<Word> words;
  words.reserve(std::size(kLineWords));
  for (const LineWord& line : kLineWords) words.emplace_back(line.word, line.text);
  return words;
}

// What is taken from the lines of a field; added to the report.
engine::Result<engine::LineOffsets> lineOffsetsOf(const engine::Version& field, const LevelArguments& options,
                                                  const std::string& scan, Report& report,
                                                  engine::JobControl& job) {
  engine::LineOptions lines;
  for (const LineWord& row : kLineWords)
    if (options.rows == row.word) {
      lines.method = row.method;
      lines.degree = row.degree;
    }
  lines.axis = options.scan_axis == "y" ? engine::ScanAxis::kY : engine::ScanAxis::kX;
  const engine::FormOptions form = formOptionsOf(options.form);
  lines.region = form.region;
  lines.robust = form.robust;
  auto found = engine::findLineOffsets(field, lines, job);
  if (!found && found.error().kind == engine::ErrorKind::kInput)
    return engine::inputError(found.error().what, shownInput(scan), found.error().remedy);
  if (!found) return found;
  report.update({{"rows", options.rows},
                 {"scan_axis", options.scan_axis},
                 {"rows_rms", found->rms},
                 {"rows_empty", found->empty}});
  return found;
}

engine::Result<Report> levelOne(const LevelArguments& options, const BatchTask& task,
                                engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto counted = countedOf(imported->field, imported->original, task.in, options.form, job);
  if (!counted) return tl::unexpected(counted.error());
  Report report;
  std::optional<engine::LineOffsets> lines;
  if (!options.rows.empty()) {
    auto found = lineOffsetsOf(*counted, options, task.in, report, job);
    if (!found) return tl::unexpected(found.error());
    lines = *std::move(found);
    counted = engine::lowered(
        *counted, "levelling lines",
        [&](const engine::SampleRect& rect, double* out) { lines->readHeights(rect, out); }, job);
    if (!counted) return tl::unexpected(counted.error());
  }
  const auto fit = formOf(*counted, task.in, *imported, options.form, job);
  if (!fit) return tl::unexpected(fit.error());
  // Of the scan as it was read: the marks chose the samples that count, it keeps its own; and it is rounded once.
  const auto levelled = engine::lowered(
      imported->field, "levelling",
      [&](const engine::SampleRect& rect, double* out) {
        fit->form.readHeights(rect, out, engine::kTileSide);
        if (!lines) return;
        double more[engine::kTileSamples];
        lines->readHeights(rect, more);
        for (int r = 0; r < rect.rows; ++r)
          for (int k = r * engine::kTileSide; k < r * engine::kTileSide + rect.columns; ++k)
            out[k] += more[k];
      },
      job);
  if (!levelled) return tl::unexpected(levelled.error());
  // Changes are limited from here on, also of a session or in Python.
  engine::ExportOptions writing = options.writing;
  writing.original = *levelled;
  if (imported->original) {
    // What was filled stays known.
    auto measured = engine::withoutFilled(*levelled, *imported->original, job);
    if (!measured) return tl::unexpected(measured.error());
    writing.original = *std::move(measured);
  }
  if (auto status = saveField(*levelled, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  addForm(report, options.form, *fit, imported->field.grid());
  report.update({{"unit", imported->field.grid().height_unit.name},
                 {"samples", fit->samples},
                 {"rms", fit->rms},
                 {"rounds", fit->rounds},
                 {"hash", hashOf(*levelled)}});
  return report;
}

engine::Result<Report> level(const LevelArguments& options, engine::JobControl& job) {
  if (options.form.form == "none" && options.rows.empty())
    return engine::inputError("there is no form to take out", "--form",
                              "name another than none, or give --rows");
  if (options.scan_axis != "x" && options.rows.empty())
    return engine::inputError("there are no lines to level along y", "--scan-axis", "add --rows");
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  const auto tasks = batchTasks(options.files, {options.form.marks}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) { return levelOne(options, task, j); };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addLevel(Command root, Chosen& chosen) {
  auto options = std::make_shared<LevelArguments>();
  Command command = addCommand(
      root, chosen, "level", "Take a plane, another form or offsets of scanned lines out of scans",
      [options](engine::JobControl& job) { return level(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--rows",
       .to = &options->rows,
       .text = "First level the lines of a line scanner, each by this, of the samples of --region; --robust "
               "for mean and poly. "
               "Where features fill more than half of a line take matching, or leave them out by marks",
       .words = lineWords()},
      {.name = "--scan-axis",
       .to = &options->scan_axis,
       .text = "Along which its lines are",
       .words = {{"x", "rows"}, {"y", "columns"}}},
  });
  addFormOptions(command, options->form);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "What is written are heights less the form, rounded to float once; the form itself is not stored.");
  command.examples(
      {{"fettle level scan.tif level.tif", "The plane that is nearest to all samples becomes level"},
       {"fettle level scan.tif level.tif --form poly2 --robust",
        "A slightly bent plate becomes level, whatever stands on it"},
       {"fettle level scan.tif level.tif --rows median --region unmarked --marks marks.png",
        "Every line of an AFM scan at the same height, then the plane, by what is not marked"}});
}

}  // namespace fettle::app

#include <memory>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"

namespace fettle::app {

namespace {

struct LevelArguments {
  BatchOptions files;
  FormArguments form;
  ScanOptions reading;
  engine::ExportOptions writing;
};

engine::Result<Report> levelOne(const LevelArguments& options, const BatchTask& task,
                                engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto marked = withMarks(imported->field, options.form.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  const auto fit = formOf(*marked, task.in, *imported, options.form, job);
  if (!fit) return tl::unexpected(fit.error());
  // The marks chose the samples that count; the scan keeps its own.
  const auto levelled = engine::withoutForm(imported->field, fit->form, job);
  if (!levelled) return tl::unexpected(levelled.error());
  // Changes are limited from here on, also of a session or in Python.
  engine::ExportOptions writing = options.writing;
  writing.original = *levelled;
  if (auto status = saveField(*levelled, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  Report report;
  addForm(report, options.form, *fit, imported->field.grid());
  report.update({{"unit", imported->field.grid().height_unit.name},
                 {"samples", fit->samples},
                 {"rms", fit->rms},
                 {"rounds", fit->rounds},
                 {"hash", hashOf(*levelled)}});
  return report;
}

engine::Result<Report> level(const LevelArguments& options, engine::JobControl& job) {
  if (options.form.form == "none")
    return engine::inputError("there is no form to take out", "--form", "name another than none");
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
      root, chosen, "level", "Take a plane or another form out of scans: heights about it",
      [options](engine::JobControl& job) { return level(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  addFormOptions(command, options->form);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "What is written are heights less the form, rounded to float once; the form itself is not stored.");
  command.examples(
      {{"fettle level scan.tif level.tif", "The plane that is nearest to all samples becomes level"},
       {"fettle level scan.tif level.tif --form poly2 --robust",
        "A slightly bent plate becomes level, whatever stands on it"}});
}

}  // namespace fettle::app

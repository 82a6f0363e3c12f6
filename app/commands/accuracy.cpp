#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/accuracy_page/page.h"
#include "app/commands/command.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/plots/gnuplot.h"
#include "bench/accuracy/studies.h"
#include "bench/machine.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {
namespace {

struct AccuracyArguments {
  std::string folder;
  std::string scan;
  ScanOptions scan_options;
  std::vector<std::string> only;
  double effort = 1.0;
  int seeds = 0, side = 0;  // 0: by the effort
  std::vector<std::string> parts, methods;
};

constexpr struct {
  const char* id;
  engine::Result<bench::Study> (*run)(const bench::AccuracyOptions&, engine::JobControl&);
} kStudies[] = {
    {"contact", bench::contactStudy},
    {"paper", bench::paperStudy},
    {"surface", bench::surfaceStudy},
    {"rate", bench::rateStudy},
    {"energy", bench::energyStudy},
    {"detail", bench::detailStudy},
    {"filter", bench::filterStudy},
    {"upload", bench::uploadStudy},
    {"restoration", bench::restorationStudy},
    {"automatic", bench::automaticStudy},
    {"process", bench::processStudy},
    {"lines", bench::edgeLineStudy},
    {"hand", bench::handStudy},
    {"worth", bench::worthStudy},
    {"suggest", bench::suggestionStudy},
};

std::vector<Word> studyWords() {
  std::vector<Word> words;
  words.reserve(std::size(kStudies));
  for (const auto& study : kStudies) words.emplace_back(study.id);
  return words;
}

engine::Result<Report> accuracy(const AccuracyArguments& options, engine::JobControl& job) {
  if (auto ready = plotsCanBeMade(); !ready) return tl::unexpected(ready.error());
  bench::AccuracyOptions studied;
  studied.effort = options.effort;
  if (options.seeds > 0) studied.seeds = options.seeds;
  if (options.side > 0) studied.side = options.side;
  studied.parts = options.parts;
  studied.methods = options.methods;
  if (!options.scan.empty()) {
    auto scan = loadScan(options.scan, options.scan_options, job);
    if (!scan) return tl::unexpected(scan.error());
    studied.scan = {std::filesystem::path(options.scan).filename().string(), scan->field};
  }
  std::error_code error;
  const std::filesystem::path folder(options.folder);
  const bool made = std::filesystem::create_directories(folder, error);
  if (error)
    return engine::inputError("the folder cannot be created: " + error.message(), options.folder,
                              "name a folder with write permission");
  const auto ended = [&](engine::Error problem) {
    std::error_code ignored;
    if (made && std::filesystem::is_empty(folder, ignored)) std::filesystem::remove(folder, ignored);
    return tl::unexpected(std::move(problem));
  };
  std::vector<PlottedStudy> studies;
  Report rows = Report::array(), answers = Report::object();
  for (const auto& chosen : kStudies) {
    if (!options.only.empty() &&
        std::find(options.only.begin(), options.only.end(), chosen.id) == options.only.end())
      continue;
    auto study = chosen.run(studied, job);
    if (!study) return ended(study.error());
    auto svg = plotSvg(*study);
    if (!svg) return ended(svg.error());
    std::vector<std::string> views;
    for (const bench::Study& view : study->views) {
      auto drawn = plotSvg(view);
      if (!drawn) return ended(drawn.error());
      views.push_back(*std::move(drawn));
    }
    answers[study->id] = study->answer;
    for (const bench::AccuracyRow& row : study->rows) {
      rows.push_back({{"study", study->id},
                      {"subject", row.subject},
                      {"method", row.method},
                      {"cost", row.cost},
                      {"cost_unit", study->cost.unit},
                      {"error", row.error},
                      {"error_p99", row.error_p99},
                      {"error_worst", row.error_worst},
                      {"error_unit", study->error.unit},
                      {"wrong", row.wrong},
                      {"hash", fmt::format("{:016x}", row.hash)},
                      {"note", row.note}});
      for (std::size_t i = 0; i < row.more.size(); ++i) rows.back()[study->columns[i]] = row.more[i];
    }
    studies.push_back({*std::move(study), *std::move(svg), std::move(views)});
  }
  const std::string machine = bench::machine();
  const std::string made_with = fmt::format(
      "fettle accuracy, effort {:g}{}", options.effort,
      options.scan.empty() ? "" : ", with " + std::filesystem::path(options.scan).filename().string());
  const std::string page = (folder / "accuracy.html").string(), csv = (folder / "accuracy.csv").string();
  if (auto ok = engine::writeFileAtomically(csv, accuracyCsv(studies)); !ok) return ended(ok.error());
  for (const PlottedStudy& s : studies) {
    if (auto ok = engine::writeFileAtomically((folder / (s.study.id + ".svg")).string(), s.svg); !ok)
      return ended(ok.error());
    for (std::size_t i = 0; i < s.view_svgs.size(); ++i)
      if (auto ok =
              engine::writeFileAtomically((folder / (s.study.views[i].id + ".svg")).string(), s.view_svgs[i]);
          !ok)
        return ended(ok.error());
  }
  if (auto ok = engine::writeFileAtomically(page, accuracyPage(studies, machine, made_with)); !ok)
    return ended(ok.error());
  return Report{{"page", page},       {"csv", csv},  {"machine", machine}, {"effort", options.effort},
                {"answers", answers}, {"rows", rows}};
}

void printAccuracy(const Report& report) {
  for (const auto& [study, answer] : report["answers"].items())
    fmt::print("{}: {}\n\n", study, answer.get<std::string>());
  fmt::print("{}\n{}\n", report["page"].get<std::string>(), report["csv"].get<std::string>());
}

}  // namespace

void addAccuracy(Command root, Chosen& chosen) {
  auto options = std::make_shared<AccuracyArguments>();
  Command command = addCommand(
      root, chosen, "accuracy", "What accuracy costs in time: a page of plots, tables and answers",
      [options](engine::JobControl& job) { return accuracy(*options, job); }, printAccuracy);
  command.add({
      {.name = "FOLDER",
       .to = &options->folder,
       .text = "Folder for accuracy.html, accuracy.csv and the plots",
       .kind = ValueKind::kFolder,
       .required = true},
      {.name = "SCAN",
       .to = &options->scan,
       .text = "A scan to study in addition to the generated fields",
       .kind = ValueKind::kInput},
      {.name = "--only",
       .to = &options->only,
       .text = "Studies to make",
       .words = studyWords(),
       .otherwise = "all"},
      {.name = "--effort",
       .to = &options->effort,
       .text = "Share of the full work; less is faster and less exact",
       .range = Range{0.01, 1.0}},
      {.name = "--seeds",
       .to = &options->seeds,
       .text = "Of the study suggest: seeds of the noise",
       .range = Range{1.0, 100.0},
       .otherwise = "by the effort"},
      {.name = "--side",
       .to = &options->side,
       .text = "Of the study suggest: length of each side of its scans",
       .range = Range{64.0, 4096.0},
       .unit = "samples",
       .otherwise = "by the effort"},
      {.name = "--parts",
       .to = &options->parts,
       .text = "Of the studies suggest and process: the parts that are scanned",
       .words = partWords(),
       .otherwise = "all"},
      {.name = "--methods",
       .to = &options->methods,
       .text =
           "Of the study suggest: the filters that are run on the scans besides the one that is named, as "
           "\"tv 31\"; named: that one alone",
       .otherwise = "all"},
  });
  addScanOptions(command, options->scan_options);
  command.examples({{"fettle accuracy report --only contact --effort 0.05",
                     "What each level of contact costs, quickly, as a page in the folder report"}});
}

}  // namespace fettle::app

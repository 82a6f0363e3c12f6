#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/commands/areal_table.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/report_page.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/still_picture.h"
#include "app/terminal.h"
#include "app/work/form_change.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/compare/compare.h"
#include "engine/field/seen_field.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"
#include "engine/inspect/noise_model.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/areal.h"
#include "engine/session/session.h"
#include "render/live/picture_rows.h"

namespace fettle::app {

namespace {

struct ReportArguments {
  std::string scan, out, original;
  std::string title;  // empty: the scan's name
  FormArguments form;
  ScanOptions reading;
};

// A state of the surface that the page shows: the scan as it was measured, and as it is.
struct ShownState {
  std::string name;
  engine::Version field;
};

std::string nameOf(const std::string& path) {
  return std::filesystem::path(shownInput(path)).filename().string();
}

std::string plain(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "no sample";
}

class ScanReport {
 public:
  ScanReport(const ReportArguments& options, engine::JobControl& job) : options_(options), job_(job) {}

  engine::Result<Report> write() {
    if (auto status = checkForm(options_.form); !status) return tl::unexpected(status.error());
    if (auto status =
            checkOutputs({{options_.out, OutputKind::kPage, ".html"}},
                         {options_.scan, options_.original, options_.form.marks}, Replacing::kNoWork, job_);
        !status)
      return tl::unexpected(status.error());
    if (auto status = read(); !status) return tl::unexpected(status.error());
    page_.title = options_.title.empty() ? nameOf(options_.scan) : options_.title;
    page_.made_with = fmt::format("Made by fettle {} of {}, read as {}.", FETTLE_VERSION,
                                  nameOf(options_.scan), imported_.format);
    addScan();
    for (const auto part : {&ScanReport::addNoise, &ScanReport::addDeviation, &ScanReport::addTexture,
                            &ScanReport::addSteps, &ScanReport::addPictures})
      if (auto status = (this->*part)(); !status) return tl::unexpected(status.error());
    std::string text = reportPage(page_);
    if (MemoryPlace* place = memoryPlace(options_.out)) {
      place->page = std::move(text);
    } else {
      const auto written = writeTo(options_.out, ".html", job_, [&](const std::string& file) {
        return engine::writeFileAtomically(file, text);
      });
      if (!written) return tl::unexpected(written.error());
    }
    report_["pictures"] = page_.pictures.size();
    return std::move(report_);
  }

 private:
  engine::Status read() {
    auto imported = loadScan(options_.scan, options_.reading, job_);
    if (!imported) return tl::unexpected(imported.error());
    imported_ = *std::move(imported);
    std::optional<engine::Version> original = imported_.original;
    if (!options_.original.empty()) {
      auto other = loadScan(options_.original, options_.reading, job_);
      if (!other) return tl::unexpected(other.error());
      auto reference = engine::seenLike(other->field, imported_.field, job_);
      if (!reference) return tl::unexpected(reference.error());
      original = *std::move(reference);
    }
    if (original && !(*original == imported_.field)) {
      const engine::Grid &a = original->grid(), &b = imported_.field.grid();
      if (a.width != b.width || a.height != b.height)
        return engine::inputError(fmt::format("the original has {} x {} samples, the scan {} x {}", a.width,
                                              a.height, b.width, b.height),
                                  shownInput(options_.original), "give the scan that it was made from");
      states_.push_back({"Before", *std::move(original)});
    }
    states_.push_back({states_.empty() ? "Value" : "After", imported_.field});
    return {};
  }

  [[nodiscard]] const std::string& heightUnit() const { return imported_.field.grid().height_unit.name; }
  [[nodiscard]] std::vector<std::string> heads(std::vector<std::string> first) const {
    for (const ShownState& state : states_) first.push_back(state.name);
    return first;
  }

  void addScan() {
    const engine::Grid& grid = imported_.field.grid();
    ReportPage::Table about{"Scan", "", {"", ""}, {}};
    about.rows = {
        {"Samples", fmt::format("{} x {}", grid.width, grid.height)},
        {"Spacing",
         fmt::format("{:.6g} x {:.6g} {}", grid.spacing_x, grid.spacing_y, grid.lateral_unit.name)},
        {"Size", fmt::format("{:.6g} x {:.6g} {}", (grid.width - 1) * grid.spacing_x,
                             (grid.height - 1) * grid.spacing_y, grid.lateral_unit.name)},
        {"Lower left corner",
         fmt::format("{:.10g}, {:.10g} {}", grid.origin_x, grid.origin_y, grid.lateral_unit.name)},
    };
    if (imported_.field.lines() != nullptr)
      about.rows.push_back({"Edge lines", fmt::format("{}", imported_.field.lines()->size())});
    if (imported_.original)
      if (const std::int64_t filled = engine::countFilled(imported_.field, *imported_.original); filled > 0)
        about.rows.push_back({"Filled samples, not measured", fmt::format("{}", filled)});
    for (const std::string& warning : imported_.warnings) about.rows.push_back({"Note", warning});
    page_.tables.push_back(std::move(about));

    heights_ = {"Heights",
                "",
                heads({""}),
                {{"Holes"}, {"Marked samples"}, {"Least"}, {"Mean"}, {"Largest"}, {"Hash"}}};
    heights_.heads.emplace_back("Unit");
    for (const ShownState& state : states_) {
      const engine::FieldSummary summary = engine::summarize(state.field);
      const std::string cells[] = {fmt::format("{}", summary.no_data),
                                   fmt::format("{}", summary.marked),
                                   plain(summary.min),
                                   plain(summary.mean),
                                   plain(summary.max),
                                   fmt::format("#{}", hashOf(state.field))};
      for (std::size_t i = 0; i < std::size(cells); ++i) heights_.rows[i].push_back(cells[i]);
    }
    report_["hash"] = hashOf(states_.back().field);
    if (states_.size() > 1) report_["original_hash"] = hashOf(states_.front().field);
  }

  engine::Status addNoise() {
    std::vector<std::string> row = {"Noise, standard deviation"};
    for (const ShownState& state : states_) {
      const auto noise = engine::measureNoise(state.field, job_);
      if (!noise) return tl::unexpected(noise.error());
      row.push_back(plain(noise->sigma));
    }
    heights_.rows.insert(heights_.rows.end() - 1, std::move(row));
    for (std::size_t i = 0; i < heights_.rows.size(); ++i)
      heights_.rows[i].push_back(i >= 2 && i + 1 < heights_.rows.size() ? heightUnit() : "");
    page_.tables.push_back(std::move(heights_));
    return {};
  }

  engine::Status addDeviation() {
    if (states_.size() < 2) return {};
    const auto found = engine::compareFields(states_.front().field, states_.back().field, job_);
    if (!found) return tl::unexpected(found.error());
    p99_ = found->p99;
    page_.tables.push_back({"Change from before to after",
                            fmt::format("Over the {} samples that both have.", found->samples),
                            {"", "", "Unit"},
                            {{"Root mean square", plain(found->rms), heightUnit()},
                             {"Mean", plain(found->mean), heightUnit()},
                             {"99 % of the samples change by at most", plain(found->p99), heightUnit()},
                             {"Largest", plain(found->max_abs), heightUnit()}}});
    report_["rms_change"] = found->rms;
    report_["max_change"] = found->max_abs;
    return {};
  }

  engine::Status addTexture() {
    std::vector<Report> measured;
    std::string tilt;
    for (const ShownState& state : states_) {
      const auto counted = countedOf(state.field, imported_.original, options_.scan, options_.form, job_);
      if (!counted) return tl::unexpected(counted.error());
      const auto fit = formOf(*counted, options_.scan, imported_, options_.form, job_);
      if (!fit) return tl::unexpected(fit.error());
      engine::ArealOptions areal;
      areal.region = formChoiceOf(options_.form).region;
      const auto parameters = engine::measureAreal(*counted, fit->form, areal, job_);
      if (!parameters) return tl::unexpected(parameters.error());
      addForm(measured.emplace_back(), options_.form, *fit, state.field.grid());
      addAreal(measured.back(), *parameters, {}, state.field.grid());
      report_[measured.size() == states_.size() ? "sq" : "sq_before"] = measured.back()["sq"];
      if (fit->fit) tilt += fmt::format(" {}: {}.", state.name, formFigures(fit->form));
      if (measured.back().contains("tilt_x"))
        tilt += fmt::format(" {}: tilted {:.4g} degrees along x, {:.4g} along y.", state.name,
                            measured.back()["tilt_x"].get<double>(), measured.back()["tilt_y"].get<double>());
    }
    page_.tables.push_back(textureTable(
        arealLines(measured), heads({}),
        fmt::format("ISO 25178-2 about the form {}{}, over {} samples.{}", options_.form.form,
                    options_.form.robust ? " (robust)" : "",
                    options_.form.region == "all" ? "all" : "the " + options_.form.region, tilt)));
    return {};
  }

  // The steps of a session. One from standard input is gone after it was read, and Python's scans have none.
  engine::Status addSteps() {
    report_["steps"] = 0;
    if (imported_.format != "Fettle" || isStream(options_.scan) || memoryPlace(options_.scan) != nullptr)
      return {};
    engine::SessionOpenOptions opening;
    opening.history_bytes = engine::History::kNoBound;
    opening.journal = engine::JournalReading::kLeave;
    const auto session = loadSession(options_.scan, opening, job_);
    if (!session) return tl::unexpected(session.error());
    const engine::History& history = session->history;
    ReportPage::Table steps{
        "Steps",
        "Times are UTC. A hash is that of the samples and marks after the step, as fettle info and other "
        "reports print it; samples are counted from the lower left corner.",
        {"No.", "Step", "Kind", "When", "Where", "Hash"},
        {}};
    for (std::int64_t k = history.first() + 1; k <= history.number(); ++k) {
      if (job_.cancelled()) return engine::cancelled();
      const engine::StepInfo& step = history.info(k);
      steps.rows.push_back({fmt::format("{}", k), step.name, std::string(engine::stepKindName(step.kind)),
                            fmt::format("{:%F %T}", std::chrono::floor<std::chrono::seconds>(step.time)),
                            fmt::format("{} x {} samples from {}, {}", step.rect.columns, step.rect.rows,
                                        step.rect.column, step.rect.row),
                            fmt::format("#{}", hashOf(history.state(k)))});
    }
    report_["steps"] = steps.rows.size();
    if (!steps.rows.empty()) page_.tables.push_back(std::move(steps));
    return {};
  }

  engine::Status addPictures() {
    const auto picture = render::LivePicture::create();
    if (!picture) return tl::unexpected(picture.error());
    const auto scratch = ScratchFolder::create();
    if (!scratch) return tl::unexpected(scratch.error());
    const std::string file = (std::filesystem::path(scratch->path()) / "picture.png").string();
    render::View view;
    view.width = 1400;
    view.height = 640;
    const auto draw = [&](const render::Shown& shown, const render::FrameInput& input,
                          std::string caption) -> engine::Status {
      const auto drawn = drawPicture(**picture, shown, input, file, job_);
      if (!drawn) return tl::unexpected(drawn.error());
      std::ifstream in(file, std::ios::binary);
      page_.pictures.push_back({std::move(caption), std::string(std::istreambuf_iterator<char>(in),
                                                                std::istreambuf_iterator<char>())});
      return {};
    };
    render::Shown shown;
    render::FrameInput input = render::stillInput(view);
    const bool two = states_.size() > 1;
    for (const ShownState& state : states_) {
      shown.versions.push_back(state.field);
      input.titles.push_back(two ? state.name : page_.title);
    }
    const auto caption = [two](const char* where) {
      return fmt::format("{} {}", two ? "Before and after, from" : "From", where);
    };
    if (auto status = draw(shown, input, caption("the side")); !status) return status;
    input.view.azimuth_deg = 0.0;
    input.view.elevation_deg = 90.0;
    if (auto status = draw(shown, input, caption("above")); !status) return status;
    if (!two) return {};
    shown.versions = {states_.back().field};
    shown.original = states_.front().field;
    input.titles = {"Change"};
    if (p99_ > 0.0) input.range = render::ValueRange{-p99_, p99_};
    return draw(shown, input, "Change from before to after; colours end at 99 % of the samples");
  }

  const ReportArguments& options_;
  engine::JobControl& job_;
  engine::Imported imported_;
  std::vector<ShownState> states_;
  double p99_ = 0.0;
  ReportPage::Table heights_;
  ReportPage page_;
  Report report_ = Report::object();
};

}  // namespace

void addReport(Command root, Chosen& chosen) {
  auto options = std::make_shared<ReportArguments>();
  Command command =
      addCommand(root, chosen, "report", "A page about a scan or a session: pictures, figures, steps",
                 [options](engine::JobControl& job) { return ScanReport(*options, job).write(); });
  command.add({{.name = "SCAN",
                .to = &options->scan,
                .text = "The scan or session; - for standard input",
                .kind = ValueKind::kInput,
                .required = true},
               {.name = "HTML",
                .to = &options->out,
                .text = "The page to write; - for standard output",
                .kind = ValueKind::kOutput,
                .required = true},
               {.name = "--original",
                .to = &options->original,
                .text = "Figures and pictures beside those of this scan; of a session: the one it began with",
                .kind = ValueKind::kInput},
               {.name = "--title",
                .to = &options->title,
                .text = "Heading of the page",
                .otherwise = "the file's name"}});
  addFormOptions(command, options->form);
  addScanOptions(command, options->reading);
  command.notes(
      "One file without links to others: pictures from the side and from above, noise, surface texture about "
      "a form, of a "
      "session before and after, with its steps and the hash of each state. The same scan gives the same "
      "page, on one "
      "machine to the byte. A browser prints it to paper or PDF with text that can be searched.");
  command.examples({{"fettle report scan.tif report.html", "Pictures and figures of a scan"},
                    {"fettle report clean.tif report.html --original scan.tif --form poly2 --robust",
                     "What a filter has changed, about a slightly bent surface"}});
}

}  // namespace fettle::app

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/form_option.h"
#include "app/commands/layer_over.h"
#include "app/commands/measuring.h"
#include "app/commands/noise_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/plots/gnuplot.h"
#include "app/commands/report_sections.h"
#include "app/commands/scale_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/still_picture.h"
#include "app/commands/surface_plots.h"
#include "app/pages/report_page.h"
#include "app/terminal.h"
#include "app/work/areal_table.h"
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
  std::string type;   // empty: by the name of `out`, else html
  FormArguments form;
  ScaleArguments scale;
  int noise_trials = kUsualTrials;
  bool estimate = false;
  ReportSections sections;
  ScanOptions reading;
};

std::string nameOf(const std::string& path) {
  return std::filesystem::path(shownInput(path)).filename().string();
}

std::string plain(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "no sample";
}

// Surface texture, of one or several states side by side; `states` names them.
ReportPage::Table textureTable(const std::vector<ArealLine>& lines, const std::vector<std::string>& states,
                               std::string note) {
  ReportPage::Table table{"Surface texture", std::move(note), {}, {}};
  table.heads = {"Parameter", "Meaning"};
  table.heads.insert(table.heads.end(), states.begin(), states.end());
  table.heads.emplace_back("Unit");
  for (const ArealLine& line : lines) {
    std::vector<std::string> row = {line.name, line.text};
    row.insert(row.end(), line.values.begin(), line.values.end());
    row.push_back(line.unit);
    table.rows.push_back(std::move(row));
  }
  return table;
}

// The same without noise, with standard errors.
ReportPage::Table noiseTable(const std::vector<ArealLine>& lines, std::vector<std::string> heads,
                             int trials) {
  ReportPage::Table table{
      "Surface texture without noise",
      fmt::format(
          "+- the standard error that the noise of the scan puts on it, by {} trials with more of it. Noise "
          "that neighbours share in both directions, as in filtered scans, is not counted.",
          trials),
      std::move(heads),
      {}};
  table.heads.emplace_back("Unit");
  for (const ArealLine& line : lines) {
    std::vector<std::string> row = {line.name};
    for (const std::string& without : line.without) row.push_back(without.empty() ? "-" : without);
    row.push_back(line.unit);
    table.rows.push_back(std::move(row));
  }
  return table;
}

class ScanReport {
 public:
  ScanReport(const ReportArguments& options, engine::JobControl& job) : options_(options), job_(job) {}

  engine::Result<Report> write() {
    const auto extension = extensionOf();
    if (!extension) return tl::unexpected(extension.error());
    // Before the work that the page would be lost with.
    if (*extension == kPdf)
      if (auto status = pdfIsPossible(); !status) return tl::unexpected(status.error());
    if (auto status = checkForm(options_.form); !status) return tl::unexpected(status.error());
    if (auto status =
            checkOutputs({{options_.out, OutputKind::kPage, *extension}},
                         {options_.scan, options_.original, options_.form.marks}, Replacing::kNoWork, job_);
        !status)
      return tl::unexpected(status.error());
    if (auto status = checkSections(options_.sections); !status) return tl::unexpected(status.error());
    if (auto status = read(); !status) return tl::unexpected(status.error());
    const auto foreseen = foreseeWork(*extension);
    if (!foreseen) return tl::unexpected(foreseen.error());
    if (foreseen->only) return *foreseen->only;
    const auto text = page(*extension);
    if (!text) return tl::unexpected(text.error());
    if (MemoryPlace* place = memoryPlace(options_.out)) {
      place->page = *text;
    } else {
      const auto written = writeTo(options_.out, *extension, job_, [&](const std::string& file) {
        return engine::writeFileAtomically(file, *text);
      });
      if (!written) return tl::unexpected(written.error());
    }
    return std::move(report_);
  }

 private:
  static constexpr const char* kPdf = ".pdf";

  // Of what was read.
  engine::Result<std::string> page(const std::string& extension) {
    page_.title = options_.title.empty() ? nameOf(options_.scan) : options_.title;
    page_.made_with = fmt::format("Made by fettle {} of {}, read as {}.", FETTLE_VERSION,
                                  nameOf(options_.scan), imported_.format);
    for (const auto part :
         {&ScanReport::compare, &ScanReport::addPictures, &ScanReport::addScan, &ScanReport::addNoise,
          &ScanReport::addDeviation, &ScanReport::addTexture, &ScanReport::addCurves,
          &ScanReport::addSections, &ScanReport::addSettings, &ScanReport::addSteps})
      if (auto status = (this->*part)(); !status) return tl::unexpected(status.error());
    return extension == kPdf ? reportPdf(page_) : reportHtml(page_);
  }

  // Pictures and plots take as long for any scan, and as much of the page: with --estimate a page of a piece is made.
  engine::Result<Foreseen> foreseeWork(const std::string& extension) {
    const engine::Version& field = states_.back().field;
    const auto counted = countedOf(field, imported_.original, options_.scan, options_.form, job_);
    if (!counted) return tl::unexpected(counted.error());
    engine::ArealOptions areal;
    areal.region = formChoiceOf(options_.form).region;
    areal.at_ratios = curveRatios();
    areal.analysis = true;
    PlannedWork planned{
        .field = field,
        .original = field,
        .steps = {plannedMeasuring({*counted, options_.scan, imported_, options_.form, options_.scale, areal,
                                    options_.noise_trials, static_cast<int>(states_.size())})},
        .out = {},
        .extension = extension,
        .writing = {}};
    if (options_.estimate) {
      planned.out = memoryPlace(options_.out) == nullptr ? options_.out : std::string();
      planned.alike = true;
      planned.write = [&](const engine::Version& piece, const std::string& path, engine::JobControl&) {
        return writeOfPiece(piece, path, extension);
      };
    }
    return foresee(planned, shownOutput(options_.out), options_.estimate, job_);
  }

  // The page as it would be of a piece, with as many states.
  engine::Status writeOfPiece(const engine::Version& piece, const std::string& path,
                              const std::string& extension) {
    const KeptMessages said;
    ReportArguments options = options_;
    options.sections = {};
    options.form.region = "all";
    options.form.marks.clear();
    options.scale = {};
    options.noise_trials = 0;
    engine::JobControl own = engine::JobControl::partOf(job_);
    ScanReport small(options, own);
    small.imported_.field = piece;
    for (const ShownState& state : states_) small.states_.push_back({.name = state.name, .field = piece});
    const auto text = small.page(extension);
    if (!text) return tl::unexpected(text.error());
    return engine::writeFileAtomically(path, *text);
  }

  // With its dot, in lower case.
  [[nodiscard]] engine::Result<std::string> extensionOf() const {
    const bool named = !isStream(options_.out) && memoryPlace(options_.out) == nullptr;
    const std::string of_name =
        named ? withDot(std::filesystem::path(options_.out).extension().string()) : std::string();
    if (options_.type.empty()) return named ? of_name : std::string(".html");
    const std::string typed = withDot(options_.type);
    if (named && (typed == kPdf) != (of_name == kPdf))
      return engine::inputError(fmt::format("--type {} is not what the file's name says", options_.type),
                                options_.out, "leave --type out, or name another file");
    return typed;
  }

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
      states_.push_back({.name = "Before", .field = *std::move(original)});
    }
    states_.push_back({.name = states_.empty() ? "Value" : "After", .field = imported_.field});
    return {};
  }

  [[nodiscard]] const std::string& heightUnit() const { return imported_.field.grid().height_unit.name; }
  [[nodiscard]] std::vector<std::string> heads(std::vector<std::string> first) const {
    for (const ShownState& state : states_) first.push_back(state.name);
    return first;
  }

  engine::Status addScan() {
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
    if (const std::string layer = layerOver(imported_.field); !layer.empty())
      about.rows.push_back({"Form over the scan, left out of all figures", layer});
    if (imported_.original)
      if (const std::int64_t filled = engine::countFilled(imported_.field, *imported_.original); filled > 0)
        about.rows.push_back({"Filled samples, not measured", fmt::format("{}", filled)});
    for (const std::string& warning : imported_.warnings) about.rows.push_back({"Note", warning});
    page_.parts.emplace_back(std::move(about));

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
    addLayer(report_, imported_.field);
    if (states_.size() > 1) report_["original_hash"] = hashOf(states_.front().field);
    return {};
  }

  engine::Status addNoise() {
    std::vector<std::string> row = {"Noise, standard deviation"};
    for (ShownState& state : states_) {
      const auto noise = engine::measureNoise(state.field, job_);
      if (!noise) return tl::unexpected(noise.error());
      row.push_back(plain(noise->sigma));
      state.noise_mm = noise->sigma * state.field.grid().height_unit.mm;
    }
    heights_.rows.insert(heights_.rows.end() - 1, std::move(row));
    for (std::size_t i = 0; i < heights_.rows.size(); ++i)
      heights_.rows[i].push_back(i >= 2 && i + 1 < heights_.rows.size() ? heightUnit() : "");
    page_.parts.emplace_back(std::move(heights_));
    return {};
  }

  // The change, which the pictures' colours follow.
  engine::Status compare() {
    if (states_.size() < 2) return {};
    const auto found = engine::compareFields(states_.front().field, states_.back().field, job_);
    if (!found) return tl::unexpected(found.error());
    change_ = *found;
    return {};
  }

  engine::Status addDeviation() {
    if (!change_) return {};
    page_.parts.emplace_back(
        ReportPage::Table{"Change from before to after",
                          fmt::format("Over the {} samples that both have.", change_->samples),
                          {"", "", "Unit"},
                          {{"Root mean square", plain(change_->rms), heightUnit()},
                           {"Mean", plain(change_->mean), heightUnit()},
                           {"99 % of the samples change by at most", plain(change_->p99), heightUnit()},
                           {"Largest", plain(change_->max_abs), heightUnit()}}});
    report_["rms_change"] = change_->rms;
    report_["max_change"] = change_->max_abs;
    return {};
  }

  engine::Status addTexture() {
    std::vector<Report> reports;
    std::string tilt;
    for (const ShownState& state : states_) {
      const auto counted = countedOf(state.field, imported_.original, options_.scan, options_.form, job_);
      if (!counted) return tl::unexpected(counted.error());
      const auto limitedOf = [&](const engine::Version& field) {
        return scaleLimited(field, options_.scan, imported_, options_.form, options_.scale, job_);
      };
      const auto limited = limitedOf(*counted);
      if (!limited) return tl::unexpected(limited.error());
      engine::ArealOptions areal;
      areal.region = formChoiceOf(options_.form).region;
      areal.at_ratios = curveRatios();
      areal.analysis = true;
      auto parameters = engine::measureAreal(limited->field, limited->form, areal, job_);
      if (!parameters) return tl::unexpected(parameters.error());
      addForm(reports.emplace_back(), options_.form, limited->fit, state.field.grid());
      addScale(reports.back(), options_.scale);
      addAreal(reports.back(), *parameters, {}, state.field.grid());
      engine::ArealParameters stated = *parameters;
      stated.heights.clear();
      areal.at_ratios.clear();
      areal.analysis = false;
      const auto noise = arealNoise(
          *counted, stated,
          [&](const engine::Version& noisy) -> engine::Result<engine::ArealParameters> {
            const auto of = limitedOf(noisy);
            if (!of) return tl::unexpected(of.error());
            return engine::measureAreal(of->field, of->form, areal, job_);
          },
          options_.noise_trials, job_);
      if (!noise) return tl::unexpected(noise.error());
      if (*noise) {
        app::addNoise(reports.back(), **noise, state.field.grid());
        trials_ = (*noise)->trials;
      }
      measured_.push_back(*std::move(parameters));
      report_[reports.size() == states_.size() ? "sq" : "sq_before"] = reports.back()["sq"];
      if (limited->fit.fit) tilt += fmt::format(" {}: {}.", state.name, formFigures(limited->fit.form));
      if (reports.back().contains("tilt_x"))
        tilt += fmt::format(" {}: tilted {:.4g} degrees along x, {:.4g} along y.", state.name,
                            reports.back()["tilt_x"].get<double>(), reports.back()["tilt_y"].get<double>());
    }
    const std::vector<ArealLine> lines = arealLines(reports);
    addScale(report_, options_.scale);
    std::string scale = scaleText(report_, "; ");
    if (const std::string layer = layerText(layerOver(imported_.field)); !layer.empty())
      scale = layer + (scale.empty() ? "" : "; ") + scale;
    page_.parts.emplace_back(
        textureTable(lines, heads({}),
                     fmt::format("ISO 25178-2 about the form {}{}, over {} samples{}{}.{}",
                                 options_.form.form, options_.form.robust ? " (robust)" : "",
                                 options_.form.region == "all" ? "all" : "the " + options_.form.region,
                                 scale.empty() ? "" : "; ", scale, tilt)));
    if (trials_ > 0) page_.parts.emplace_back(noiseTable(lines, heads({"Parameter"}), trials_));
    return {};
  }

  // The curves of all states over each other. They are no reason to refuse a report: without gnuplot, or where there was
  // no memory for an autocorrelation, a sentence stands in their place.
  engine::Status addCurves() {
    page_.parts.emplace_back(ReportPage::Heading{"Curves"});
    report_["curves"] = 0;
    if (const auto able = plotsCanBeMade(); !able) {
      const std::string why = fmt::format("No curves are drawn: {}", able.error().line());
      warn(why);
      page_.parts.emplace_back(ReportPage::Paragraph{why + "."});
      return {};
    }
    std::vector<PlottedState> all, analysed;
    std::string none;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const PlottedState state{states_.size() > 1 ? states_[i].name : "", &measured_[i]};
      all.push_back(state);
      if (measured_[i].analysis != nullptr)
        analysed.push_back(state);
      else
        none = measured_[i].spatial.no_sal;
    }
    int drawn = 0;
    const auto draw = [&](const char* caption, const std::string& script) -> engine::Status {
      auto svg = drawnByGnuplot(script);
      if (!svg) return tl::unexpected(svg.error());
      page_.parts.emplace_back(ReportPage::Plot{caption, *std::move(svg)});
      ++drawn;
      return {};
    };
    const engine::Grid& grid = imported_.field.grid();
    if (auto status = draw("Material ratio (Abbott) curve", abbottPlot(all, grid)); !status) return status;
    if (!analysed.empty()) {
      if (auto status =
              draw("Autocorrelation in the directions of its fastest and slowest decay, or along x and y",
                   correlationPlot(analysed));
          !status)
        return status;
      if (auto status =
              draw("Power spectral density of profiles along x and along y", spectrumPlot(analysed, grid));
          !status)
        return status;
    }
    if (analysed.size() < all.size())
      page_.parts.emplace_back(ReportPage::Paragraph{
          fmt::format("No autocorrelation and no spectrum{}: {}.", analysed.empty() ? "" : " of one state",
                      none.empty() ? "there was no memory for it" : none)});
    report_["curves"] = drawn;
    return {};
  }

  engine::Status addSections() {
    report_["sections"] = options_.sections.lines.size();
    if (auto status = app::addSections(page_, options_.sections, states_, job_); !status) return status;
    if (imported_.sections.empty()) return {};
    const auto kept = sectionsOf(imported_.sections);
    if (!kept) return tl::unexpected(kept.error());
    report_["kept_sections"] = kept->size();
    if (const auto possible = plotsCanBeMade(); !possible) {
      page_.parts.emplace_back(
          ReportPage::Paragraph{fmt::format("{} sections that are kept with the session are not shown: {}.",
                                            kept->size(), possible.error().what)});
      return {};
    }
    return addKeptSections(page_, *kept, states_, job_);
  }

  // What the figures depend on besides the samples; of a session also what made its scan and how it was touched.
  engine::Status addSettings() {
    ReportPage::Table settings{"Settings", "", {"Setting", "Value"}, {}};
    const auto add = [&settings](const char* name, std::string value) {
      settings.rows.push_back({name, std::move(value)});
    };
    add("Form", options_.form.form + (options_.form.robust ? ", robust" : ""));
    add("Samples that count",
        options_.form.region + (options_.form.marks.empty() ? "" : " by " + nameOf(options_.form.marks)));
    for (const auto& [name, cut_off, kind] :
         {std::tuple("S-filter", &options_.scale.s_filter, &options_.scale.s_kind),
          {"L-filter", &options_.scale.l_filter, &options_.scale.l_kind}})
      add(name, cut_off->empty() ? "none" : fmt::format("{} mm, {}", *cut_off, *kind));
    add("Noise trials", fmt::format("{}", trials_));
    if (const std::string reading = scanOptionsText(options_.reading); !reading.empty())
      add("Read with", reading.substr(1));
    if (auto status = loadWork(); !status) return status;
    if (session_) {
      if (!session_->scan.path.empty()) add("Scan of the session", nameOf(session_->scan.path));
      if (!session_->scan.format.empty()) add("Format of that scan", session_->scan.format);
      for (const auto& [note, name] : {std::pair(engine::kRecipeNote, "Recipe of the scan"),
                                       {engine::kStepsNote, "Steps of commands"},
                                       {"scene", "Scene of touch"}})
        if (const auto found = session_->notes.find(note); found != session_->notes.end())
          add(name, settingsOf(found->second));
    }
    page_.parts.emplace_back(std::move(settings));
    return {};
  }

  // A TOML text as one line: its settings without comments.
  static std::string settingsOf(const std::string& toml) {
    std::string line, out;
    std::istringstream in(toml);
    while (std::getline(in, line))
      if (const std::size_t at = line.find_first_not_of(" \t\r"); at != std::string::npos && line[at] != '#')
        out += (out.empty() ? "" : "; ") + line.substr(at);
    return out;
  }

  // The session with all its steps. One from standard input is gone after it was read, and Python's scans have none.
  engine::Status loadWork() {
    if (imported_.format != "Fettle" || isStream(options_.scan) || memoryPlace(options_.scan) != nullptr)
      return {};
    engine::SessionOpenOptions opening;
    opening.history_bytes = engine::History::kNoBound;
    opening.journal = engine::JournalReading::kLeave;
    auto session = loadSession(options_.scan, opening, job_);
    if (!session) return tl::unexpected(session.error());
    session_ = *std::move(session);
    return {};
  }

  engine::Status addSteps() {
    report_["steps"] = 0;
    if (!session_) return {};
    const engine::History& history = session_->history;
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
    if (!steps.rows.empty()) page_.parts.emplace_back(std::move(steps));
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
    int drawn_pictures = 0;
    const auto draw = [&](const render::Shown& shown, const render::FrameInput& input,
                          std::string caption) -> engine::Status {
      const auto drawn = drawPicture(**picture, shown, input, file, job_);
      if (!drawn) return tl::unexpected(drawn.error());
      std::ifstream in(file, std::ios::binary);
      page_.parts.emplace_back(ReportPage::Picture{
          std::move(caption),
          std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>())});
      ++drawn_pictures;
      report_["pictures"] = drawn_pictures;
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
    if (change_->p99 > 0.0) input.range = render::ValueRange{-change_->p99, change_->p99};
    return draw(shown, input, "Change from before to after; colours end at 99 % of the samples");
  }

  const ReportArguments& options_;
  engine::JobControl& job_;
  engine::Imported imported_;
  std::vector<ShownState> states_;
  std::optional<engine::Deviation> change_;
  std::vector<engine::ArealParameters> measured_;  // of each state
  int trials_ = 0;                                 // with noise, for errors
  std::optional<engine::Session> session_;
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

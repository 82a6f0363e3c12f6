#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "engine/compare/compare.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/suggest/filter_suggestion.h"

namespace fettle::bench {
namespace {

constexpr double kNoises[] = {1.0, 3.0};
constexpr double kTolerance_mm = 0.012;  // of noise 1: that of the demonstration
// The method was chosen on seeds 101 and 102, and seen on 1.
constexpr int kFirstUnseen = 21;
constexpr double kClose = 0.1;
constexpr const char* kNamed = "the one that is named";
constexpr const char* kNamedAlone = "named";  // AccuracyOptions::methods

// What one filter was expected to leave of a scan, and left [um]. NaN: the part has no such samples.
struct Expectation {
  double flat = 0.0, flat_left = 0.0, near = 0.0, near_left = 0.0, seconds = 0.0;
};

// The expectations of one filter on one part and noise, one for each seed.
struct ExpectedOf {
  std::string method;
  std::vector<Expectation> seeds;
};

// How often an expectation was within a tenth.
struct Close {
  int within = 0, all = 0;

  void add(double expected, double left) {
    if (std::isnan(expected) || std::isnan(left)) return;
    ++all;
    within += std::abs(expected / left - 1.0) <= kClose ? 1 : 0;
  }
};

// A part without edges has no expectations near them.
std::string sharesOf(const Close& flat, const Close& near) {
  std::string text = fmt::format("{} of {} expectations for flats", flat.within, flat.all);
  if (near.all > 0) text += fmt::format(" and {} of {} near edges", near.within, near.all);
  return text;
}

engine::Result<engine::TruthFigures> leftBy(const engine::SimulatedScan& scan,
                                            const engine::FilterCandidate& candidate) {
  engine::JobControl quiet;
  engine::Version field = scan.scan;
  if (candidate.around_edges) {
    const auto map = engine::findEdges(field, engine::EdgeMap::kUsualSigma, quiet);
    if (!map) return tl::unexpected(map.error());
    engine::EdgeChoice choice;
    choice.thickness = candidate.thickness;
    auto marked = engine::suggestMarks(field, *map, choice, quiet);
    if (!marked) return tl::unexpected(marked.error());
    field = std::move(marked->field);
  }
  const auto filtered = engine::applyFilter(field, field, candidate.spec, quiet);
  if (!filtered) return tl::unexpected(filtered.error());
  return engine::compareToTruth(filtered->field, scan.truth, scan.edges, quiet);
}

bool isIn(const std::vector<std::string>& chosen, const std::string& one) {
  return chosen.empty() || std::ranges::find(chosen, one) != chosen.end();
}

// The parts of the catalogue that are chosen.
engine::Result<std::vector<engine::PartInfo>> partsOf(const AccuracyOptions& options) {
  for (const std::string& name : options.parts)
    if (std::ranges::none_of(engine::parts(), [&](const engine::PartInfo& p) { return p.name == name; }))
      return engine::inputError("there is no part \"" + name + "\"", "--parts",
                                "fettle synth --help names them");
  std::vector<engine::PartInfo> chosen;
  for (const engine::PartInfo& part : engine::parts())
    if (isIn(options.parts, std::string(part.name))) chosen.push_back(part);
  return chosen;
}

// Whether all that is chosen is tried.
engine::Status checkMethods(const std::vector<std::string>& methods,
                            const std::vector<engine::FilterCandidate>& tried) {
  for (const std::string& method : methods)
    if (method != kNamedAlone && std::ranges::none_of(tried, [&](const engine::FilterCandidate& c) {
          return engine::methodOf(c) == method;
        }))
      return engine::inputError("no filter \"" + method + "\" is tried", "--methods",
                                "name one as the study's table does");
  return {};
}

// Adds what one scan gives to each filter's row; the last is that of the filter that is named. Of `methods` alone, and
// the one that is named, it is found what they leave of the scan.
engine::Status addScan(const PartSubject& subject, std::int32_t side, int seed,
                       const std::vector<std::string>& methods, std::vector<ExpectedOf>& rows) {
  const auto scan = scanOf(subject, side, seed);
  if (!scan) return tl::unexpected(scan.error());
  engine::SuggestionRequest request;
  request.tolerance = kTolerance_mm * subject.noise;
  request.only_named = methods.size() == 1 && methods.front() == kNamedAlone;
  engine::JobControl quiet;
  const auto found = engine::suggestFilter(scan->scan, request, quiet);
  if (!found) return tl::unexpected(found.error());
  if (auto ok = checkMethods(methods, found->candidates); !ok) return ok;
  if (rows.empty()) {
    for (const engine::FilterCandidate& candidate : found->candidates)
      rows.push_back({engine::methodOf(candidate), {}});
    rows.push_back({kNamed, {}});
  }
  for (std::size_t i = 0; i < found->candidates.size(); ++i) {
    const engine::FilterCandidate& candidate = found->candidates[i];
    const bool chosen = isIn(methods, rows[i].method);
    if (!chosen && i != found->pick) continue;
    const auto left = leftBy(*scan, candidate);
    if (!left) return tl::unexpected(left.error());
    const Expectation expectation{1e3 * candidate.error_flat, 1e3 * left->rmse_flat,
                                  1e3 * candidate.error_edge, 1e3 * left->rmse_edge, candidate.seconds};
    if (chosen) rows[i].seeds.push_back(expectation);
    if (i == found->pick) rows.back().seeds.push_back(expectation);
  }
  return {};
}

// Median, least and largest of expected over left, and how many are within a tenth; then the median that was left.
void addFigures(const std::vector<Expectation>& seeds, double Expectation::*expected,
                double Expectation::*left, std::vector<double>& figures) {
  std::vector<double> ratios, lefts;
  Close close;
  for (const Expectation& e : seeds) {
    close.add(e.*expected, e.*left);
    if (std::isnan(e.*expected) || std::isnan(e.*left)) continue;
    ratios.push_back(e.*expected / e.*left);
    lefts.push_back(e.*left);
  }
  if (ratios.empty()) {
    figures.insert(figures.end(), 5, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const auto middle = [](std::vector<double>& values) {
    std::ranges::sort(values);
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  };
  const double median = middle(ratios);
  figures.insert(figures.end(),
                 {median, ratios.front(), ratios.back(), static_cast<double>(close.within), middle(lefts)});
}

AccuracyRow rowFor(const std::string& subject, const ExpectedOf& of) {
  AccuracyRow row;
  row.subject = subject;
  row.method = of.method;
  row.wrong = row.error_p99 = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> seconds;
  for (const Expectation& e : of.seeds) {
    seconds.push_back(e.seconds);
    double off = 0.0;
    for (const auto& [expected, left] : {std::pair{e.flat, e.flat_left}, std::pair{e.near, e.near_left}})
      if (!std::isnan(expected) && !std::isnan(left))
        off = std::max(off, 100.0 * std::abs(expected / left - 1.0));
    row.error += off / static_cast<double>(of.seeds.size());
    row.error_worst = std::max(row.error_worst, off);
  }
  spread(std::move(seconds), row);
  addFigures(of.seeds, &Expectation::flat, &Expectation::flat_left, row.more);
  addFigures(of.seeds, &Expectation::near, &Expectation::near_left, row.more);
  return row;
}

}  // namespace

engine::Result<Study> suggestionStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study;
  study.id = "suggest";
  study.title = "What a suggested filter is expected to leave";
  study.question = "How near is what --suggest expects of a filter to what the filter leaves?";
  study.cost.name = "time that is expected for the scan";
  study.cost.unit = "s";
  study.error.name = "expected off what is left, the worse of flats and near edges";
  study.error.unit = "%";
  for (const char* where : {"flats", "near edges"})
    for (const char* figure : {"expected / left, median", "expected / left, least", "expected / left, most",
                               "within 10 % [seeds]", "left, median [um]"})
      study.columns.push_back(fmt::format("{}: {}", where, figure));
  const int seeds = options.seeds.value_or(scanSizes(options.effort).seeds);
  const std::int32_t side = options.side.value_or(scanSizes(options.effort).side);
  const auto parts = partsOf(options);
  if (!parts) return tl::unexpected(parts.error());
  job.begin("expected errors", parts->size() * std::size(kNoises) * static_cast<std::size_t>(seeds));
  Close named_flat, named_near, all_flat, all_near;
  for (const engine::PartInfo& part : *parts)
    for (const double noise : kNoises) {
      const std::string name = fmt::format("{}, noise x {:g}", part.name, noise);
      const std::string part_name(part.name);
      std::vector<ExpectedOf> rows;
      for (int seed = kFirstUnseen; seed < kFirstUnseen + seeds; ++seed) {
        if (job.cancelled()) return engine::cancelled();
        if (auto ok = addScan({name.c_str(), part_name.c_str(), noise}, side, seed, options.methods, rows);
            !ok)
          return tl::unexpected(ok.error());
        job.advance();
      }
      for (const ExpectedOf& of : rows) {
        if (of.seeds.empty()) continue;
        for (const Expectation& e : of.seeds) {
          const bool named = of.method == kNamed;
          (named ? named_flat : all_flat).add(e.flat, e.flat_left);
          (named ? named_near : all_near).add(e.near, e.near_left);
        }
        study.rows.push_back(rowFor(name, of));
      }
    }
  study.reference = fmt::format(
      "The simulated parts' truth, scans of {} x {} samples, seeds {} to {} of noise, none of which the "
      "method was chosen "
      "by. The filter that is named is that for a tolerance of {:g} um times the noise.",
      side, side, kFirstUnseen, kFirstUnseen + seeds - 1, 1e3 * kTolerance_mm);
  study.answer = fmt::format("Of the filter that is named, {} are within 10 % of what it leaves",
                             sharesOf(named_flat, named_near));
  if (all_flat.all + all_near.all > 0)
    study.answer +=
        fmt::format("; of {}, {}", options.methods.empty() ? "all that are tried" : "those that were chosen",
                    sharesOf(all_flat, all_near));
  study.answer += ".";
  return study;
}

}  // namespace fettle::bench

#include "app/work/section_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/work/typed_lengths.h"
#include "engine/uncertainty/edge_place.h"
#include "engine/uncertainty/roughness_noise.h"

namespace fettle::app {

namespace {

using engine::Estimate;
using engine::Section;
using engine::Stretch;

// The last ones are those of profiles.
constexpr std::string_view kSectionKeys[] = {"cursors", "line",      "step",    "groove",  "angle",
                                             "arc",     "roughness", "primary", "waviness"};

Report lineReport(const engine::LineFigures& line) {
  Report report;
  addEstimate(report, "inclination", "deg", line.inclination_deg);
  addEstimate(report, "height", "mm", line.height_mm);
  report["rms_mm"] = line.rms_mm;
  report["places"] = line.places;
  return report;
}

Report stretchOf(const Stretch& stretch) {
  return Report::array({stretch.from_mm, stretch.to_mm});
}

void addMarks(const std::vector<double>& along, const char* name, std::vector<SectionMark>& marks) {
  for (const double at : along) marks.push_back({at, name});
}

// What was asked for, of one section. `marks`: places that a picture shows.
class SectionMeasurement {
  static constexpr int kRoughnessPairs = 32;  // of trials with noise

 public:
  SectionMeasurement(const SectionWants& options, const engine::SectionNoise& noise)
      : options_(options), noise_(noise) {}

  engine::Result<Report> of(std::string_view key, const Section& section,
                            std::vector<SectionMark>& marks) const {
    if (key == "cursors") return cursors(section, marks);
    if (key == "line") return line(section, marks);
    if (key == "step") return step(section, marks);
    if (key == "groove") return groove(section, marks);
    if (key == "angle") return angle(section, marks);
    if (key == "arc") return arc(section, marks);
    return profile(section, *profileCalled(key));
  }

 private:
  // Whether an offset that was searched for is more than the largest that noise makes somewhere, and than what the
  // rounding of heights to float does.
  [[nodiscard]] static bool standsOut(const Section& section, const Estimate& offset) {
    double most = 0.0;
    for (const double z : section.height)
      if (!std::isnan(z)) most = std::max(most, std::abs(z));
    return std::abs(offset.value) > std::max(5.0 * offset.error, 1e-6 * most);
  }

  [[nodiscard]] Stretch within(const Section& section) const {
    return options_.within.empty() ? Stretch{0.0, section.lengthMm()}
                                   : Stretch{options_.within[0], options_.within[1]};
  }

  engine::Result<Report> cursors(const Section& section, std::vector<SectionMark>& marks) const {
    const auto figures = engine::cursorFigures(section, options_.cursors[0], options_.cursors[1], noise_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.cursors, "cursor", marks);
    Report report{{"dx_mm", figures->dx_mm}};
    addEstimate(report, "dz", "mm", figures->dz_mm);
    report.update({{"slope_deg", numberOrNull(figures->slope_deg)},
                   {"distance_mm", figures->distance_mm},
                   {"first_mm", figures->first_mm},
                   {"second_mm", figures->second_mm}});
    return report;
  }
  engine::Result<Report> line(const Section& section, std::vector<SectionMark>& marks) const {
    const auto figures = engine::lineFigures(section, {options_.line[0], options_.line[1]}, noise_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.line, "line", marks);
    return lineReport(*figures);
  }
  // Where a step is sought: of a groove or a ridge up to its other wall, behind which no side of the step goes on; the wall with
  // more surface beside it.
  Stretch aroundStep(const Section& section) const {
    const Stretch all = within(section), groove = engine::grooveIn(section, all);
    if (std::isnan(groove.from_mm)) return all;
    const double clear_mm = (groove.to_mm - groove.from_mm) / 3.0;
    return groove.from_mm - all.from_mm >= all.to_mm - groove.to_mm
               ? Stretch{all.from_mm, groove.to_mm - clear_mm}
               : Stretch{groove.from_mm + clear_mm, all.to_mm};
  }
  engine::Result<Report> step(const Section& section, std::vector<SectionMark>& marks) const {
    const Stretch around = options_.step == "auto" ? aroundStep(section) : within(section);
    double edge = engine::edgeIn(section, around);
    if (options_.step != "auto") edge = lengthsOf(options_.step, 1).front();
    if (std::isnan(edge))
      return engine::inputError("the section has too few heights for a step", "--step", "give a longer line");
    const auto figures = engine::stepFigures(section, edge, around, noise_);
    if (!figures) return tl::unexpected(figures.error());
    if (options_.step == "auto" && !standsOut(section, figures->step_mm))
      return engine::inputError("no step stands out from the noise of the section", "--step auto",
                                "give a --width to average over, or the edge's length as --step A");
    addMarks({edge}, "step", marks);
    Report report{{"edge_mm", edge},
                  {"edge_error_mm",
                   options_.step == "auto" ? numberOrNull(engine::edgeError(section, *figures)) : Report()}};
    addEstimate(report, "step", "mm", figures->step_mm);
    addEstimate(report, "inclination", "deg", figures->inclination_deg);
    report.update({{"before", stretchOf(figures->before)},
                   {"after", stretchOf(figures->edge_after)},
                   {"rms_mm", figures->rms_mm},
                   {"places", figures->places}});
    return report;
  }
  engine::Result<Report> groove(const Section& section, std::vector<SectionMark>& marks) const {
    Stretch edges = engine::grooveIn(section, within(section));
    if (options_.groove != "auto") {
      const std::vector<double> typed = lengthsOf(options_.groove, 2);
      edges = {typed[0], typed[1]};
    }
    if (std::isnan(edges.from_mm))
      return engine::inputError("no groove or ridge stands out in the section", "--groove",
                                "give a longer line, or the lengths of both edges");
    const auto figures = engine::grooveFigures(section, edges.from_mm, edges.to_mm, noise_);
    if (!figures) return tl::unexpected(figures.error());
    if (options_.groove == "auto" && !standsOut(section, figures->step_mm))
      return engine::inputError(
          "no groove or ridge stands out from the noise of the section", "--groove auto",
          "give a --width to average over, or the lengths of both edges as --groove A,B");
    addMarks({edges.from_mm, edges.to_mm}, "groove", marks);
    const bool found = options_.groove == "auto";
    const double error = found ? engine::edgeError(section, *figures) : std::nan("");
    Report report{{"edges", stretchOf(edges)},
                  {"edges_error_mm", numberOrNull(error)},
                  {"width_mm", edges.to_mm - edges.from_mm},
                  {"width_error_mm", numberOrNull(std::sqrt(2.0) * error)}};
    addEstimate(report, "depth", "mm", figures->step_mm);
    addEstimate(report, "inclination", "deg", figures->inclination_deg);
    report.update({{"before", stretchOf(figures->before)},
                   {"inside", stretchOf(figures->edge_after)},
                   {"behind", stretchOf(figures->behind)},
                   {"rms_mm", figures->rms_mm},
                   {"places", figures->places}});
    return report;
  }
  engine::Result<Report> angle(const Section& section, std::vector<SectionMark>& marks) const {
    const auto figures = engine::angleFigures(section, {options_.angle[0], options_.angle[1]},
                                              {options_.angle[2], options_.angle[3]}, noise_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.angle, "angle", marks);
    Report report;
    addEstimate(report, "turn", "deg", figures->turn_deg);
    report["included_deg"] = figures->included_deg.value;
    addEstimate(report, "meet_along", "mm", figures->meet_along_mm);
    addEstimate(report, "meet_height", "mm", figures->meet_height_mm);
    report["first"] = lineReport(figures->first);
    report["second"] = lineReport(figures->second);
    return report;
  }
  engine::Result<Report> arc(const Section& section, std::vector<SectionMark>& marks) const {
    const auto figures = engine::arcFigures(section, {options_.arc[0], options_.arc[1]}, noise_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.arc, "arc", marks);
    Report report;
    addEstimate(report, "radius", "mm", figures->radius_mm);
    addEstimate(report, "centre_along", "mm", figures->centre_along_mm);
    addEstimate(report, "centre_height", "mm", figures->centre_height_mm);
    report.update({{"hollow", figures->hollow}, {"rms_mm", figures->rms_mm}, {"places", figures->places}});
    return report;
  }
  engine::Result<Report> profile(const Section& section, const engine::ProfileInfo& info) const {
    const engine::ProfileFilters filters{info.by_cutoff ? *options_.cutoff : 0.0,
                                         options_.lambda_s.value_or(0.0), info.kind};
    const auto figures = engine::roughnessOf(section, within(section), filters, options_.asked);
    if (!figures) return tl::unexpected(figures.error());
    const auto noise = engine::roughnessNoise(section, within(section), filters, *figures, noise_,
                                              {.pairs = kRoughnessPairs}, options_.asked);
    if (!noise) return tl::unexpected(noise.error());
    Report report{{"evaluated", stretchOf(figures->evaluated)}, {"lengths", figures->lengths}};
    if (info.by_cutoff) report["cutoff_mm"] = *options_.cutoff;
    if (options_.lambda_s) report["lambda_s_mm"] = *options_.lambda_s;
    const std::span<const engine::RoughnessInfo> infos = engine::roughnessInfos();
    for (std::size_t f = 0; f < infos.size(); ++f) {
      const RoughnessKeys keys = keysOf(infos[f], info);
      report[keys.value] = numberOrNull((*figures).*infos[f].figure);
      report[keys.without] = numberOrNull((*noise)[f].without);
      report[keys.error] = numberOrNull((*noise)[f].error);
      if (!(*noise)[f].why.empty()) report[keys.reason] = (*noise)[f].why;
    }
    addAsked(report, info, *figures, std::span(*noise).subspan(infos.size()));
    return report;
  }
  // Rmr(c) and Rdc; `noise`: of these.
  void addAsked(Report& report, const engine::ProfileInfo& info, const engine::Roughness& figures,
                std::span<const engine::NoiseEffect> noise) const {
    const auto put = [](Report& to, const engine::NoiseEffect& effect, const char* ending) {
      to[std::string("without") + ending] = numberOrNull(effect.without);
      to[std::string("error") + ending] = numberOrNull(effect.error);
      if (!effect.why.empty()) to["reason"] = effect.why;
    };
    const engine::AskedRatios& asked = options_.asked;
    for (std::size_t i = 0; i < figures.ratios.size(); ++i) {
      Report one{{"height_mm", asked.at_heights_mm[i]}, {"ratio", numberOrNull(figures.ratios[i])}};
      put(one, noise[i], "");
      report[askedKey("rmr", info)].push_back(std::move(one));
    }
    for (std::size_t i = 0; i < figures.differences.size(); ++i) {
      Report one{{"ratios", Report::array({asked.between[i].first, asked.between[i].second})},
                 {"height_mm", numberOrNull(figures.differences[i])}};
      put(one, noise[figures.ratios.size() + i], "_mm");
      report[askedKey("rdc", info)].push_back(std::move(one));
    }
  }

  const SectionWants& options_;
  engine::SectionNoise noise_;
};

}  // namespace

Report numberOrNull(double value) {
  return std::isnan(value) ? Report() : Report(value);
}

void addEstimate(Report& report, const std::string& key, const std::string& unit, const Estimate& estimate) {
  const std::string ending = unit.empty() ? std::string() : fmt::format("_{}", unit);
  // Lines are inclined by up to 90 degrees either way: such an error leaves all of them.
  constexpr double kMostDegrees = 90.0;
  if (unit == "deg" && estimate.error > kMostDegrees) {
    report[key + ending] = report[key + "_error" + ending] = Report();
    return;
  }
  report[key + ending] = numberOrNull(estimate.value);
  report[key + "_error" + ending] = numberOrNull(estimate.error);
}

engine::Result<std::vector<glm::dvec2>> polylineOf(const std::string& text, const std::string& option) {
  std::vector<glm::dvec2> points;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(':', from), text.size());
    const std::vector<double> xy = lengthsOf(std::string_view(text).substr(from, end - from), 2);
    if (xy.empty())
      return engine::inputError(fmt::format("'{}' is no polyline", text), option,
                                "give X,Y:X,Y with as many points as you like, in mm or with a unit, 12.5mm");
    points.emplace_back(xy[0], xy[1]);
    from = end + 1;
  }
  if (points.size() < 2)
    return engine::inputError(fmt::format("'{}' is one point", text), option, "give two or more, X,Y:X,Y");
  return points;
}

RoughnessKeys keysOf(const engine::RoughnessInfo& info, const engine::ProfileInfo& profile) {
  using Unit = engine::RoughnessInfo::Unit;
  const char* ending = info.unit == Unit::kHeight || info.unit == Unit::kAlong ? "_mm" : "";
  // The same words behind another first letter: "wa".
  const std::string key = fmt::format("{}{}", profile.word.substr(0, 1), info.key.substr(1));
  return {fmt::format("{}{}", key, ending), fmt::format("{}_without{}", key, ending),
          fmt::format("{}_error{}", key, ending), fmt::format("{}{}", profile.letter, info.symbol.substr(1)),
          fmt::format("{}_reason", key)};
}

std::string askedKey(std::string_view key, const engine::ProfileInfo& profile) {
  return fmt::format("{}{}", profile.word.substr(0, 1), key.substr(1));
}

std::span<const std::string_view> sectionFigureKeys() noexcept {
  return kSectionKeys;
}

const engine::ProfileInfo* profileCalled(std::string_view name) noexcept {
  for (const engine::ProfileInfo& profile : engine::profileInfos())
    if (name == profile.word || name == std::string_view(&profile.letter, 1)) return &profile;
  return nullptr;
}

bool wantsFigure(const SectionWants& wants, std::string_view key) noexcept {
  if (key == "cursors") return !wants.cursors.empty();
  if (key == "line") return !wants.line.empty();
  if (key == "step") return !wants.step.empty();
  if (key == "groove") return !wants.groove.empty();
  if (key == "angle") return !wants.angle.empty();
  if (key == "arc") return !wants.arc.empty();
  const engine::ProfileInfo& profile = *profileCalled(key);
  if (profile.by_cutoff && !wants.cutoff) return false;
  if (wants.profiles.empty()) return profile.kind == engine::ProfileKind::kRoughness;
  return std::ranges::find(wants.profiles, &profile, profileCalled) != wants.profiles.end();
}

engine::Result<Report> sectionFigure(std::string_view key, const SectionWants& wants, const Section& section,
                                     const engine::SectionNoise& noise, std::vector<SectionMark>& marks) {
  return SectionMeasurement(wants, noise).of(key, section, marks);
}

Report sectionFigures(const SectionWants& wants, const Section& section, const engine::SectionNoise& noise,
                      std::vector<SectionMark>& marks, std::vector<FailedFigure>& failed) {
  Report report = Report::object();
  for (const std::string_view key : kSectionKeys) {
    if (!wantsFigure(wants, key)) continue;
    auto figure = sectionFigure(key, wants, section, noise, marks);
    if (figure)
      report[std::string(key)] = *std::move(figure);
    else
      failed.push_back({std::string(key), figure.error()});
  }
  return report;
}

}  // namespace fettle::app

#include "app/commands/align_option.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/align_moves.h"
#include "app/work/estimate_text.h"
#include "app/work/read_units.h"
#include "app/work/repeat_text.h"
#include "app/work/streams.h"
#include "engine/nominal/nominal_align.h"

namespace fettle::app {

namespace {

struct AlignFigure {
  const char* key;
  const char* unit;
  const char* title;
};
constexpr AlignFigure kAlignFigures[] = {
    {"shift_x", "mm", "shift x"},        {"shift_y", "mm", "shift y"}, {"shift_z", "mm", "shift z"},
    {"rotation_z", "deg", "rotation z"}, {"tilt_x", "deg", "tilt x"},  {"tilt_y", "deg", "tilt y"},
};

const NamedMoves& movesNamed(const std::string& word) {
  for (const NamedMoves& moves : kNamedMoves)
    if (word == moves.word) return moves;
  return kNamedMoves[0];
}

std::string alignKey(const AlignFigure& figure, const char* between) {
  return fmt::format("{}{}_{}", figure.key, between, figure.unit);
}

// What `align` finds under the options that the arguments mean; errors name the files.
engine::Result<engine::Alignment> namedAlignment(const engine::Imported& a, const std::string& path_a,
                                                 const std::string& path_b, const AlignArguments& arguments,
                                                 engine::JobControl& job, const auto& align) {
  const auto counted = countedOf(a.field, a.original, path_a, arguments, job);
  if (!counted) return tl::unexpected(counted.error());
  engine::Result<engine::Alignment> alignment = align(*counted, alignOptionsOf(arguments));
  if (!alignment && alignment.error().kind == engine::ErrorKind::kInput) {
    const std::string both = shownInput(path_a) + " and " + shownInput(path_b);
    const std::string& where = alignment.error().where;
    return engine::inputError(alignment.error().what,
                              where == "A"   ? shownInput(path_a)
                              : where == "B" ? shownInput(path_b)
                                             : both,
                              alignment.error().remedy);
  }
  if (alignment && alignment->repeat)
    warn(repeatText(*alignment->repeat, readLengthAs(glm::length(*alignment->repeat), 1.0, "mm")) +
         ": align by a --region that occurs once");
  return alignment;
}

}  // namespace

std::vector<Word> alignWords() {
  std::vector<Word> words;
  words.reserve(kNamedMoves.size());
  for (const NamedMoves& moves : kNamedMoves) words.emplace_back(moves.word, moves.text);
  return words;
}

const engine::AlignMoves& movesOf(const std::string& word) {
  return movesNamed(word).moves;
}

engine::AlignOptions alignOptionsOf(const AlignArguments& arguments) {
  engine::AlignOptions options;
  options.moves = movesNamed(arguments.moves).moves;
  options.region = regionOf(arguments.region);
  options.most_rotation_deg = arguments.rotation.value_or(options.most_rotation_deg);
  return options;
}

void addAlignOptions(Command command, AlignArguments& arguments) {
  constexpr const char* kGroup = "Aligning B to A";
  command.add(
      {{.name = "--rotation",
        .to = &arguments.rotation,
        .text = "Rotations about z that the search tries, both ways; any smaller one is found between",
        .range = Range{0.0, 180.0},
        .unit = "degrees",
        .otherwise = "10"}},
      kGroup);
  addRegionOptions(command, arguments, "The samples of A by which B is aligned", kGroup,
                   arguments.region.empty() ? "all" : "");
}

engine::Status checkAlign(const AlignArguments& arguments) {
  if (auto status = checkRegion(arguments); !status) return status;
  if (arguments.rotation && !movesNamed(arguments.moves).moves.rotation)
    return engine::inputError(fmt::format("'{}' does not rotate about z", arguments.moves), "--rotation",
                              "leave it out, or align by all or in-plane");
  return {};
}

engine::Result<engine::Alignment> alignmentOf(const engine::Imported& a, const engine::Version& b,
                                              const std::string& path_a, const std::string& path_b,
                                              const AlignArguments& arguments, engine::JobControl& job) {
  return namedAlignment(a, path_a, path_b, arguments, job,
                        [&](const engine::Version& counted, const engine::AlignOptions& options) {
                          return engine::alignFields(counted, b, options, job);
                        });
}

engine::Result<engine::Alignment> alignmentOf(const engine::Imported& a, const engine::NominalMesh& b,
                                              const std::string& path_a, const std::string& path_b,
                                              const AlignArguments& arguments, engine::JobControl& job) {
  return namedAlignment(a, path_a, path_b, arguments, job,
                        [&](const engine::Version& counted, const engine::AlignOptions& options) {
                          return engine::alignNominal(counted, b, options, job);
                        });
}

Report alignReport(const AlignArguments& arguments, const engine::Alignment& alignment) {
  const engine::AlignMoves& moves = movesNamed(arguments.moves).moves;
  const auto& motion = alignment.motion;
  const std::array<double, 6> values{motion.shift.x,          motion.shift.y,
                                     motion.shift.z,          alignment.angles.rotation_z,
                                     alignment.angles.tilt_x, alignment.angles.tilt_y};
  const std::array<double, 6> errors{alignment.shift_error.x,      alignment.shift_error.y,
                                     alignment.shift_error.z,      alignment.angle_error.rotation_z,
                                     alignment.angle_error.tilt_x, alignment.angle_error.tilt_y};
  const std::array<bool, 6> free{moves.shift, moves.shift, true, moves.rotation, moves.tilt, moves.tilt};
  Report report{{"moves", arguments.moves}, {"region", arguments.region.empty() ? "all" : arguments.region}};
  for (std::size_t k = 0; k < values.size(); ++k) {
    report[alignKey(kAlignFigures[k], "")] = free[k] ? values[k] : 0.0;
    report[alignKey(kAlignFigures[k], "_error")] = free[k] ? Report(errors[k]) : Report();
  }
  report["centre_mm"] = {motion.centre.x, motion.centre.y, motion.centre.z};
  report["matrix"] = motion.matrix();
  report.update({{"rms_mm", alignment.rms_mm},
                 {"overlap", alignment.overlap},
                 {"left_out", alignment.left_out},
                 {"samples", alignment.samples},
                 {"window_mm", alignment.sigma_mm}});
  if (alignment.repeat)
    report["repeat"] = {{"shift_x_mm", alignment.repeat->x}, {"shift_y_mm", alignment.repeat->y}};
  return report;
}

void printAlignment(const Report& report) {
  if (report.contains("text")) return printReport(report);
  const double window = report["window_mm"].get<double>(), rms = report["rms_mm"].get<double>();
  double longest = window;
  for (const char* key : {"shift_x_mm", "shift_y_mm", "shift_z_mm"})
    longest = std::max(longest, std::abs(report[key].get<double>()));
  const ReadAs length = readLengthAs(longest, 1.0, "mm"), height = readLengthAs(rms, 1.0, "mm"),
               degrees{"degrees", 1.0};
  for (const AlignFigure& figure : kAlignFigures) {
    if (report[alignKey(figure, "_error")].is_null()) continue;  // not fitted
    fmt::print(
        "{:<11} {}\n", figure.title,
        shownEstimate(report, figure.key, figure.unit, std::string(figure.unit) == "mm" ? length : degrees));
  }
  fmt::print("by          {} samples, {:.3g} % of A; {:.3g} % of them lie apart and do not count\n",
             report["samples"].get<std::int64_t>(), 100.0 * report["overlap"].get<double>(),
             100.0 * report["left_out"].get<double>());
  fmt::print("rms         {:.4g} {}, through a Gaussian window of {:.4g} {}\n", rms / height.size,
             height.name, window / length.size, length.name);
}

std::string alignCsv(const Report& report) {
  std::string text = "figure,value,standard_error,unit\n";
  for (const AlignFigure& figure : kAlignFigures) {
    const Report& error = report[alignKey(figure, "_error")];
    fmt::format_to(std::back_inserter(text), "{},{:.12g},{},{}\n", figure.key,
                   report[alignKey(figure, "")].get<double>(),
                   error.is_null() ? "" : fmt::format("{:.6g}", error.get<double>()), figure.unit);
  }
  for (std::size_t i = 0; i < report["matrix"].size(); ++i)
    fmt::format_to(std::back_inserter(text), "matrix_{}{},{:.15g},,{}\n", i / 4 + 1, i % 4 + 1,
                   report["matrix"][i].get<double>(), i % 4 == 3 && i < 12 ? "mm" : "");
  return text;
}

}  // namespace fettle::app

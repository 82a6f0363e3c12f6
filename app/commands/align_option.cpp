#include "app/commands/align_option.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/estimate_text.h"
#include "app/work/read_units.h"
#include "app/work/streams.h"
#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "engine/nominal/nominal_align.h"

namespace fettle::app {

namespace {

struct NamedMoves {
  const char* word;
  const char* text;
  engine::AlignMoves moves;
};
constexpr NamedMoves kMoves[] = {
    {"all", "shift, height, rotation about z and tilt", {true, true, true}},
    {"in-plane", "shift, height and rotation about z", {true, true, false}},
    {"shift", "shift and height", {true, false, false}},
    {"level", "height and tilt", {false, false, true}},
};

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
  for (const NamedMoves& moves : kMoves)
    if (word == moves.word) return moves;
  return kMoves[0];
}

std::string alignKey(const AlignFigure& figure, const char* between) {
  return fmt::format("{}{}_{}", figure.key, between, figure.unit);
}

engine::AlignOptions alignOptionsOf(const AlignArguments& arguments) {
  engine::AlignOptions options;
  options.moves = movesNamed(arguments.moves).moves;
  options.region = arguments.region == "marked"     ? engine::Region::kMarked
                   : arguments.region == "unmarked" ? engine::Region::kUnmarked
                                                    : engine::Region::kAll;
  options.most_rotation_deg = arguments.rotation.value_or(options.most_rotation_deg);
  return options;
}

constexpr double kMostAligned = 1 << 20;  // samples to which a scan is reduced

// Every n-th sample, so that a side of A has about as many as a square: what is searched is the whole shape.
engine::Version thinned(const engine::Version& field, std::int32_t step) {
  engine::Grid grid = field.grid();
  grid.width = (grid.width + step - 1) / step;
  grid.height = (grid.height + step - 1) / step;
  grid.spacing_x *= step;
  grid.spacing_y *= step;
  std::vector<float> row(static_cast<std::size_t>(field.grid().width)), heights;
  heights.reserve(static_cast<std::size_t>(grid.samples()));
  for (std::int32_t r = 0; r < field.grid().height; r += step) {
    field.reader().readHeights(0, r, field.grid().width, 1, row.data(), field.grid().width);
    for (std::int32_t c = 0; c < field.grid().width; c += step)
      heights.push_back(row[static_cast<std::size_t>(c)]);
  }
  return engine::makeField(grid, heights);
}

std::int32_t stepFor(const engine::Version& a, const engine::SampleRect& square) {
  const double samples = static_cast<double>(square.columns) * square.rows;
  return std::max(1, static_cast<std::int32_t>(
                         std::lround(std::sqrt(static_cast<double>(a.grid().samples()) / samples))));
}

// `align` of a thinned A: its time is that of so many samples, whatever they show.
PlannedOnPieces plannedFinding(const engine::Version& a, const AlignArguments& arguments, const auto& align) {
  PlannedOnPieces pieces;
  pieces.most_samples = kMostAligned;
  pieces.memory_each = kAligningMemory;
  pieces.side = 256;
  pieces.work = [&a, align, options = alignOptionsOf(arguments)](
                    const engine::SampleRect& r, engine::JobControl& job) -> engine::Result<engine::Version> {
    const std::int32_t step = stepFor(a, r);
    // So few samples may show too little of the shape: it was searched all the same.
    const engine::Result<engine::Alignment> found = align(thinned(a, step), step, options, job);
    if (!found && found.error().kind != engine::ErrorKind::kInput) return tl::unexpected(found.error());
    return engine::pieceOf(a, r.column, r.row, r.columns, r.rows);
  };
  return pieces;
}

// What `align` finds under the options that the arguments mean; errors name the files.
engine::Result<engine::Alignment> namedAlignment(const engine::Version& a, const std::string& path_a,
                                                 const std::string& path_b, const AlignArguments& arguments,
                                                 engine::JobControl& job, const auto& align) {
  const auto counted = withMarks(a, arguments.marks, job);
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
  return alignment;
}

}  // namespace

std::vector<Word> alignWords() {
  std::vector<Word> words;
  words.reserve(std::size(kMoves));
  for (const NamedMoves& moves : kMoves) words.emplace_back(moves.word, moves.text);
  return words;
}

const engine::AlignMoves& movesOf(const std::string& word) {
  return movesNamed(word).moves;
}

void addAlignOptions(Command command, AlignArguments& arguments) {
  constexpr const char* kGroup = "Aligning B to A";
  command.add(
      {{.name = "--rotation",
        .to = &arguments.rotation,
        .text = "Rotations about z that the search tries, both ways; any smaller one is found between",
        .range = Range{0.0, 180.0},
        .unit = "degrees",
        .otherwise = "10"},
       {.name = "--region",
        .to = &arguments.region,
        .text = "The samples of A by which B is aligned",
        .words = {{"all", "every sample that is no hole"},
                  {"marked", "those that are marked"},
                  {"unmarked", "those that are not"}}},
       {.name = "--marks",
        .to = &arguments.marks,
        .text = "Picture of marks of A for --region, instead of the marks of a session",
        .kind = ValueKind::kMarks}},
      kGroup);
}

engine::Status checkAlign(const AlignArguments& arguments) {
  if (!arguments.marks.empty() && arguments.region == "all")
    return engine::inputError("marks choose nothing where all samples count", "--marks",
                              "add --region marked or --region unmarked");
  if (arguments.rotation && !movesNamed(arguments.moves).moves.rotation)
    return engine::inputError(fmt::format("'{}' does not rotate about z", arguments.moves), "--rotation",
                              "leave it out, or align by all or in-plane");
  return {};
}

engine::Result<engine::Alignment> alignmentOf(const engine::Version& a, const engine::Version& b,
                                              const std::string& path_a, const std::string& path_b,
                                              const AlignArguments& arguments, engine::JobControl& job) {
  return namedAlignment(a, path_a, path_b, arguments, job,
                        [&](const engine::Version& counted, const engine::AlignOptions& options) {
                          return engine::alignFields(counted, b, options, job);
                        });
}

engine::Result<engine::Alignment> alignmentOf(const engine::Version& a, const engine::NominalMesh& b,
                                              const std::string& path_a, const std::string& path_b,
                                              const AlignArguments& arguments, engine::JobControl& job) {
  return namedAlignment(a, path_a, path_b, arguments, job,
                        [&](const engine::Version& counted, const engine::AlignOptions& options) {
                          return engine::alignNominal(counted, b, options, job);
                        });
}

PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::Version& b,
                                 const AlignArguments& arguments) {
  return plannedFinding(
      a, arguments,
      [&b](const engine::Version& thin, std::int32_t step, const engine::AlignOptions& options,
           engine::JobControl& job) { return engine::alignFields(thin, thinned(b, step), options, job); });
}

PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::NominalMesh& b,
                                 const AlignArguments& arguments) {
  return plannedFinding(
      a, arguments,
      [&b](const engine::Version& thin, std::int32_t, const engine::AlignOptions& options,
           engine::JobControl& job) { return engine::alignNominal(thin, b, options, job); });
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
  Report report{{"moves", arguments.moves}, {"region", arguments.region}};
  for (std::size_t k = 0; k < values.size(); ++k) {
    report[alignKey(kAlignFigures[k], "")] = values[k];
    report[alignKey(kAlignFigures[k], "_error")] = free[k] ? Report(errors[k]) : Report();
  }
  report["centre_mm"] = {motion.centre.x, motion.centre.y, motion.centre.z};
  report["matrix"] = motion.matrix();
  report.update({{"rms_mm", alignment.rms_mm},
                 {"overlap", alignment.overlap},
                 {"left_out", alignment.left_out},
                 {"samples", alignment.samples},
                 {"window_mm", alignment.sigma_mm}});
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
  for (const AlignFigure& figure : kAlignFigures)
    fmt::print(
        "{:<11} {}\n", figure.title,
        shownEstimate(report, figure.key, figure.unit, std::string(figure.unit) == "mm" ? length : degrees));
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

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/commands/align_estimate.h"
#include "app/commands/align_option.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/nominal_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/read_units.h"
#include "app/work/streams.h"
#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"
#include "engine/inspect/noise_model.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/form_kind.h"
#include "engine/measure/form_onto.h"
#include "engine/measure/moved_onto.h"
#include "engine/nominal/nominal_surface.h"
#include "engine/transform/form_along.h"

namespace fettle::app {

namespace {

struct AlignCommand {
  std::string a, b, out, csv, to;
  AlignArguments how;
  NominalArguments nominal;
  Replacing replacing = Replacing::kNoWork;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

// Where B lies, and B at the samples of A, if that is written.
struct PlacedB {
  engine::Alignment alignment = {};
  std::optional<engine::Version> moved = {};
  std::optional<engine::Version> measured = {};  // of these, where B has filled samples
  std::optional<Report> nominal = {};
  std::optional<Report> only = {};  // an estimate: nothing was done
};

engine::Result<Foreseen> foreseeAlign(const AlignCommand& options, const engine::Version& a,
                                      PlannedOnPieces finding, PlannedOnPieces::Work moving,
                                      engine::JobControl& job) {
  PlannedWork planned{
      .field = a,
      .original = a,
      .steps = {std::move(finding)},
      .out = memoryPlace(options.out) == nullptr ? options.out : std::string(),
      .extension = isStream(options.out) ? withDot(options.to) : engine::extensionOf(options.out),
      .writing = options.writing};
  if (!options.out.empty())
    planned.steps.emplace_back(PlannedOnPieces{.work = std::move(moving), .fields = 2});
  return foresee(planned, shownInput(options.b), options.estimate, job);
}

// Two measurements of one surface differ by their noise. What differs by far more has another shape there, or lies elsewhere:
// the errors of the motion count it as far as the surface says, but know of no other place.
engine::Status warnOfRemainder(const engine::Alignment& alignment, const engine::Version& a,
                               const engine::Version& b, engine::JobControl& job) {
  constexpr double kFar = 10.0;  // both fields' noise is less through the window
  double square = 0.0;
  for (const engine::Version* field : {&a, &b}) {
    const auto noise = engine::measureNoise(*field, job);
    if (!noise) return tl::unexpected(noise.error());
    if (!(noise->sigma > 0.0)) return {};
    square += std::pow(noise->sigma * field->grid().height_unit.mm, 2);
  }
  if (const double times = alignment.rms_mm / std::sqrt(square); times > kFar)
    warn(fmt::format(
        "what remains is {:.2g} times the noise of both scans: their shapes differ, or B lies elsewhere "
        "than was found: look at fettle compare --align, or state its place with --moves level",
        times));
  return {};
}

// Where the form over B is left, and where it is not quite that of B.
void warnOfForm(const engine::NominalForm& form, const std::optional<engine::FormOnto>& along,
                const engine::Version& moved, const std::string& b) {
  const std::string_view word = engine::infoOf(form).word;
  if (!along)
    return warn(fmt::format(
        "{}: the form {} that lies over it has no place over the samples of A: OUT has the heights with it",
        shownInput(b), word));
  // What rounding to float makes of heights anyway.
  const engine::FieldSummary heights = engine::summarize(moved);
  const double rounding =
      0x1p-24 * std::max(std::abs(heights.min), std::abs(heights.max)) * moved.grid().height_unit.mm;
  if (!(along->off_mm > rounding)) return;
  const ReadAs off = readLengthAs(along->off_mm, 1.0, "mm");
  warn(fmt::format("{}: tilted, the form {} that lies over it is one of its degree only to {:.2g} {}",
                   shownInput(b), word, along->off_mm / off.size, off.name));
}

engine::Result<PlacedB> alignedScan(const AlignCommand& options, const engine::Imported& read,
                                    engine::JobControl& job) {
  const engine::Version& a = read.field;
  auto b = options.out.empty() ? loadSamples(options.b, options.reading, job)
                               : loadScan(options.b, options.reading, job);
  if (!b) return tl::unexpected(b.error());
  const engine::FieldForm form = engine::formOfHeights(b->field);
  if (auto status = takeSamples(*b, job); !status) return tl::unexpected(status.error());
  auto foreseen = foreseeAlign(
      options, a, plannedAlignment(a, b->field, options.how),
      [&](const engine::SampleRect& r, engine::JobControl& own) {
        const engine::Version piece = engine::pieceOf(a, r.column, r.row, r.columns, r.rows);
        return engine::movedOnto(piece, engine::RigidMotion{}, piece.grid(), own);
      },
      job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return PlacedB{.only = std::move(foreseen->only)};
  warnOfFilled(a, read.original, options.a);
  const bool filled = b->original && engine::countFilled(b->field, *b->original) > 0;
  if (filled) warnOfFilled(b->field, b->original, options.b);
  const auto alignment = alignmentOf(read, b->field, options.a, options.b, options.how, job);
  if (!alignment) return tl::unexpected(alignment.error());
  if (auto status = warnOfRemainder(*alignment, a, b->field, job); !status)
    return tl::unexpected(status.error());
  PlacedB placed{.alignment = *alignment};
  if (options.out.empty()) return placed;
  auto moved = engine::movedOnto(b->field, alignment->motion, a.grid(), job);
  if (!moved) return tl::unexpected(moved.error());
  const auto along =
      form == nullptr ? std::nullopt : engine::formOnto(*form, b->field.grid(), alignment->motion, a.grid());
  if (form != nullptr) warnOfForm(*form, along, *moved, options.b);
  auto seen = engine::seenUnder(*moved, along ? std::optional(along->form) : std::nullopt, job);
  if (!seen) return tl::unexpected(seen.error());
  placed.moved = *std::move(seen);
  if (!filled) return placed;
  const auto measured = engine::withoutFilled(b->field, *b->original, job);
  if (!measured) return tl::unexpected(measured.error());
  auto known = engine::movedOnto(*measured, alignment->motion, a.grid(), job);
  if (!known) return tl::unexpected(known.error());
  auto known_seen = engine::seenUnder(*known, along ? std::optional(along->form) : std::nullopt, job);
  if (!known_seen) return tl::unexpected(known_seen.error());
  placed.measured = *std::move(known_seen);
  return placed;
}

engine::Result<PlacedB> alignedNominal(const AlignCommand& options, const engine::Imported& read,
                                       engine::JobControl& job) {
  const engine::Version& a = read.field;
  const auto loaded =
      loadNominal(options.b, options.nominal, options.reading.from, a.grid(), Sides::kNotNeeded, job);
  if (!loaded) return tl::unexpected(loaded.error());
  const engine::NominalMesh* const nominal = &loaded->mesh;
  auto foreseen = foreseeAlign(
      options, a, plannedAlignment(a, *nominal, options.how),
      [&](const engine::SampleRect& r, engine::JobControl& own) {
        const engine::Version piece = engine::pieceOf(a, r.column, r.row, r.columns, r.rows);
        return engine::nominalHeights(
            engine::NominalSurface(*nominal, engine::RigidMotion{}, engine::slackOn(piece.grid(), *nominal)),
            piece.grid(), own);
      },
      job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return PlacedB{.only = std::move(foreseen->only)};
  const auto alignment = alignmentOf(read, *nominal, options.a, options.b, options.how, job);
  if (!alignment) return tl::unexpected(alignment.error());
  PlacedB placed{.alignment = *alignment, .nominal = nominalReport(*loaded)};
  if (options.out.empty()) return placed;
  auto heights = engine::nominalHeights(
      engine::NominalSurface(*nominal, alignment->motion, engine::slackOn(a.grid())), a.grid(), job);
  if (!heights) return tl::unexpected(heights.error());
  placed.moved = *std::move(heights);
  return placed;
}

engine::Result<Report> align(const AlignCommand& options, engine::JobControl& job) {
  if (auto status = checkAlign(options.how); !status) return tl::unexpected(status.error());
  if (!options.nominal.unit.empty() && !isNominal(options.b, options.reading, options.nominal))
    return engine::inputError(fmt::format("{} is no nominal mesh", shownInput(options.b)), "--nominal-unit",
                              "give an .stl or .ply as B");
  if (options.out.empty() && (!options.to.empty() || options.writing.tiff_compression))
    return engine::inputError("no scan is written", options.to.empty() ? "--compress" : "--to",
                              "name OUT too");
  if (auto status = checkOutputs(
          {{options.out, OutputKind::kField, options.to}, {options.csv, OutputKind::kText, ".csv"}},
          {options.a, options.b, options.how.marks}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  if (auto status = checkCompress(options.writing, {{options.b, options.out, options.to}}); !status)
    return tl::unexpected(status.error());
  const auto a = loadSamples(options.a, options.reading, job);
  if (!a) return tl::unexpected(a.error());
  const auto placed = isNominal(options.b, options.reading, options.nominal)
                          ? alignedNominal(options, *a, job)
                          : alignedScan(options, *a, job);
  if (!placed) return tl::unexpected(placed.error());
  if (placed->only) return *placed->only;
  Report report = alignReport(options.how, placed->alignment);
  if (placed->nominal) report["nominal"] = *placed->nominal;
  if (placed->moved) {
    engine::ExportOptions writing = options.writing;
    writing.original = placed->measured ? *placed->measured : *placed->moved;
    warnOfFilledLost(*placed->moved, writing.original, options.out, options.to);
    if (auto status = saveField(*placed->moved, options.out, job, writing, options.to); !status)
      return tl::unexpected(status.error());
    report["out"] = options.out;
    report["hash"] = hashOf(*placed->moved);
  }
  if (!options.csv.empty())
    if (auto status = writeTo(
            options.csv, ".csv", job,
            [&](const std::string& path) { return engine::writeFileAtomically(path, alignCsv(report)); });
        !status)
      return tl::unexpected(status.error());
  return report;
}

}  // namespace

void addAlign(Command root, Chosen& chosen) {
  auto options = std::make_shared<AlignCommand>();
  Command command = addCommand(
      root, chosen, "align", "Move scan B onto scan A: shift, rotation, tilt, with standard errors",
      [options](engine::JobControl& job) { return align(*options, job); }, printAlignment);
  command.add(
      {{.name = "A",
        .to = &options->a,
        .text = "The scan that stays; A or B may be -, standard input",
        .kind = ValueKind::kInput,
        .required = true},
       {.name = "B",
        .to = &options->b,
        .text = "The scan that is moved; its spacing and size may be others. Or the nominal shape of A, "
                ".stl, or .ply with --nominal-unit",
        .kind = ValueKind::kInput,
        .required = true},
       {.name = "OUT",
        .to = &options->out,
        .text = "Also write B, moved, at the samples of A, in A's height unit; - for standard output",
        .kind = ValueKind::kOutput},
       {.name = "--moves", .to = &options->how.moves, .text = "How B may be moved", .words = alignWords()},
       {.name = "--csv",
        .to = &options->csv,
        .text = "Write the motion: figures with their standard errors, and the matrix",
        .kind = ValueKind::kNewFile},
       {.name = "--to",
        .to = &options->to,
        .text = "With OUT -, standard output: its format, as extension",
        .kind = ValueKind::kFormat,
        .proposed = extensionWords(&engine::FormatInfo::writes)}});
  addForceOption(command, options->replacing);
  addEstimateOption(command, options->estimate);
  addAlignOptions(command, options->how);
  addNominalOptions(command, options->nominal);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "A point of B, in mm from B's lower left sample, is turned about the middle of A and shifted; the "
      "matrix "
      "takes it to mm from A's lower left sample. Tilt x and tilt y are slopes up to higher x and y.\n"
      "Samples that only one scan has - dust, holes, spikes, a step - do not count, as long as they are "
      "fewer "
      "than half. A motion that the surface does not decide, as a shift along a cylinder, is refused by its "
      "name. "
      "Heights of B between its samples are bilinear; compare both through one filter where that matters. "
      "Both are compared with the forms that lie over them; that of B is moved with it and lies over OUT, a "
      "session.\n"
      "Of a mesh B the matrix takes millimetres from its least x and y; OUT has the heights of its topmost "
      "surface.");
  command.examples(
      {{"fettle align scan.tif clean.tif", "How the second lies against the first"},
       {"fettle align scan.tif clean.tif moved.tif --moves in-plane --csv motion.csv",
        "The second at the samples of the first, without tilting it"},
       {"fettle align scan.tif clean.tif level.tif --moves level --region unmarked --marks marks.png",
        "Height and tilt alone, by what is not marked"},
       {"fettle align scan.tif clean.tif --region \"rectangle 10,10,60,40\"",
        "By what lies between two corners"},
       {"fettle align scan.tif nominal.stl nominal.tif", "The nominal shape at the samples of the part"}});
}

}  // namespace fettle::app

#include "app/commands/levelling.h"

#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/streams.h"
#include "app/work/through_noise.h"
#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/measure/lines_apart.h"
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

}  // namespace

std::vector<Word> lineWords() {
  std::vector<Word> words;
  words.reserve(std::size(kLineWords));
  for (const LineWord& line : kLineWords) words.emplace_back(line.word, line.text);
  return words;
}

engine::LineOptions lineOptionsOf(const LineArguments& lines, const FormArguments& form) {
  engine::LineOptions options;
  for (const LineWord& row : kLineWords)
    if (lines.rows == row.word) {
      options.method = row.method;
      options.degree = row.degree;
    }
  if (lines.keep_form != LineArguments::kNoForm) options.form_degree = lines.keep_form;
  options.axis = lines.scan_axis == "y" ? engine::ScanAxis::kY : engine::ScanAxis::kX;
  const engine::FormChoice counting = formChoiceOf(form);
  options.region = counting.region;
  options.robust = counting.robust;
  return options;
}

engine::Result<engine::Version> Levelling::takenFrom(const engine::Version& field,
                                                     engine::JobControl& job) const {
  return engine::lowered(
      field, "levelling",
      [&](const engine::SampleRect& rect, double* out) {
        fit.form.readHeights(rect, out, engine::kTileSide);
        if (!lines) return;
        double more[engine::kTileSamples];
        lines->readHeights(rect, more);
        for (int r = 0; r < rect.rows; ++r)
          for (int k = r * engine::kTileSide; k < r * engine::kTileSide + rect.columns; ++k)
            out[k] += more[k];
      },
      job);
}

engine::Result<Levelling> levellingOf(const engine::Version& counted, const std::string& scan,
                                      const engine::Imported& imported, const LineArguments& lines,
                                      const FormArguments& form, engine::JobControl& job) {
  Levelling levelling;
  engine::Version level = counted;
  if (!lines.rows.empty()) {
    auto found = engine::findLineOffsets(counted, lineOptionsOf(lines, form), job);
    if (!found && found.error().kind == engine::ErrorKind::kInput)
      return engine::inputError(found.error().what, shownInput(scan), found.error().remedy);
    if (!found) return tl::unexpected(found.error());
    levelling.lines = *std::move(found);
    auto lowered = engine::lowered(
        counted, "levelling lines",
        [&](const engine::SampleRect& rect, double* out) { levelling.lines->readHeights(rect, out); }, job);
    if (!lowered) return tl::unexpected(lowered.error());
    level = *std::move(lowered);
  }
  auto fit = formOf(level, scan, imported, form, job);
  if (!fit) return tl::unexpected(fit.error());
  levelling.fit = *std::move(fit);
  if (auto status = addThroughNoise(levelling.fit, level, formChoiceOf(form), job); !status)
    return tl::unexpected(status.error());
  return levelling;
}

engine::Status warnOfMovedLines(const Levelling& levelling, const engine::Version& counted,
                                const std::string& scan, const LineArguments& lines,
                                engine::JobControl& job) {
  if (!levelling.lines) return {};
  const auto apart = engine::linesApart(counted, *levelling.lines, job);
  if (!apart) return tl::unexpected(apart.error());
  if (!apart->worse()) return {};
  const bool from_line_to_line = lines.rows == "difference" || lines.rows == "matching",
             neighbours = apart->lag == 1;
  warn(fmt::format("{}: {} lie further apart than before the levelling: {}", shownInput(scan),
                   neighbours ? std::string("lines next to each other")
                              : fmt::format("a line and the {}th after it", apart->lag),
                   !from_line_to_line
                       ? "what is on some of them moves them, take --rows matching or --rows difference"
                   : neighbours || !(apart->before > apart->least)
                       ? "they were level already"
                       : "errors add up from line to line, take --rows median or --keep-form"));
  return {};
}

PlannedOnPieces plannedLevel(const engine::Version& field, const engine::Version& counted,
                             const LineArguments& lines, const FormArguments& form, Lowered lowered) {
  PlannedOnPieces pieces;
  pieces.fields = field == counted ? 1 : 2;
  pieces.work = [&field, &counted, lines, form, lowered](
                    const engine::SampleRect& r, engine::JobControl& job) -> engine::Result<engine::Version> {
    const auto pieceAt = [&](const engine::Version& of) {
      return engine::pieceOf(of, r.column, r.row, r.columns, r.rows);
    };
    const engine::Version piece = pieceAt(field);
    engine::Version level = field == counted ? piece : pieceAt(counted);
    // Of a piece of holes there is no form.
    const auto taken = [&](const engine::Error& error) -> engine::Result<engine::Version> {
      if (error.kind == engine::ErrorKind::kInput) return piece;
      return tl::unexpected(error);
    };
    Levelling levelling;
    if (!lines.rows.empty()) {
      auto found = engine::findLineOffsets(level, lineOptionsOf(lines, form), job);
      if (!found) return taken(found.error());
      levelling.lines = *std::move(found);
      auto without = engine::lowered(
          level, "levelling lines",
          [&](const engine::SampleRect& rect, double* out) { levelling.lines->readHeights(rect, out); }, job);
      if (!without) return without;
      level = *std::move(without);
    }
    // How many rounds a robust fit needs depends on the whole field's shape: the time is that of as many samples from all over it,
    // the form that of the piece.
    engine::FormChoice choice = formChoiceOf(form);
    if (choice.robust) {
      const engine::Version spread = engine::spreadOver(counted, r.columns, r.rows);
      if (auto fit = engine::fitNominalForm(spread, choice, job); !fit) return taken(fit.error());
      choice.robust = false;
    }
    // Three points may lie elsewhere, and take no time.
    auto fit = engine::fitNominalForm(choice.through ? counted : level, choice, job);
    if (!fit) return taken(fit.error());
    levelling.fit = *std::move(fit);
    auto result = levelling.takenFrom(piece, job);
    if (!result || lowered == Lowered::kOnce) return result;
    const auto limit = levelling.takenFrom(piece, job);
    return limit ? result : limit;
  };
  return pieces;
}

void addLevelling(Report& report, const LineArguments& lines, const FormArguments& form,
                  const Levelling& levelling, const engine::Grid& grid) {
  if (levelling.lines)
    report.update({{"rows", lines.rows},
                   {"scan_axis", lines.scan_axis},
                   {"rows_rms", levelling.lines->rms},
                   {"rows_empty", levelling.lines->empty}});
  if (levelling.lines && lines.keep_form != LineArguments::kNoForm)
    report.update({{"keep_form", lines.keep_form}, {"rows_form_rms", levelling.lines->form_rms}});
  addForm(report, form, levelling.fit, grid);
}

}  // namespace fettle::app

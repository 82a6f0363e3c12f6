// Text with a row of heights per line, the first one at the top, as programs of microscopes, spreadsheets, MATLAB and
// NumPy write it: separated by tab, semicolon, comma or spaces. Comments in the manner of Gwyddion's "ASCII data matrix" state
// sizes and the unit of heights.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/base/lower_case.h"
#include "engine/io/field_limits.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

// Points have fewer columns: position, colour, normal, intensity, time.
constexpr std::size_t kMoreThanOfPoints = 16;
constexpr std::int64_t kMostTitleLines = 1000;

// Tabs stay: an empty field may lie before the first one.
std::string_view withoutBlanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\r')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

// What programs write where nothing was measured; "nan" is a number to the parser.
bool isNoHeight(std::string_view field) {
  static constexpr std::array<std::string_view, 9> kWords{"",  "na", "n/a", "null", "bad",
                                                          "-", "--", "---", "***"};
  return field.size() <= 4 && std::ranges::find(kWords, lowerCase(field)) != kWords.end();
}

// The fields of a line of heights, in order. A separator at the end of the line ends a field and begins none. Tabs, semicolons and commas end a field each, which may be empty; spaces are one
// separator however many they are.
class MatrixLine {
 public:
  explicit MatrixLine(std::string_view line, std::optional<char> separator = std::nullopt)
      : rest_(withoutBlanks(line)), separator_(separator.value_or(' ')) {
    if (separator) return;
    for (const char each : {'\t', ';', ','})
      if (rest_.find(each) != std::string_view::npos) {
        separator_ = each;
        break;
      }
  }

  [[nodiscard]] char separator() const noexcept { return separator_; }

  // False behind the last one.
  [[nodiscard]] bool next(std::string_view& field) {
    if (rest_.empty()) return false;
    if (separator_ == ' ') {
      const std::size_t end = std::min(rest_.find(' '), rest_.size());
      field = rest_.substr(0, end);
      rest_ = withoutBlanks(rest_.substr(end));
      return true;
    }
    const std::size_t end = std::min(rest_.find(separator_), rest_.size());
    field = withoutBlanks(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }

 private:
  std::string_view rest_;
  char separator_;
};

template <class Float>
bool heightOf(std::string_view field, Float& height) {
  const char* at = field.data();
  if (parseNumber(at, field.data() + field.size(), height) && at == field.data() + field.size()) return true;
  height = std::numeric_limits<Float>::quiet_NaN();
  return isNoHeight(field);
}

// How many heights a line holds; 0 where something else stands in it, or nothing, or a lone word for a hole.
std::size_t heightsIn(std::string_view line, std::optional<char> separator = std::nullopt) {
  MatrixLine fields(line, separator);
  std::size_t count = 0;
  bool any = false, number = false;
  double height = 0.0;
  for (std::string_view field; fields.next(field); ++count) {
    if (!heightOf(field, height)) return 0;
    any = any || !field.empty();
    number = number || !std::isnan(height);
  }
  return number || (any && count > 1) ? count : 0;
}

// Whether a separator is the last of a line: an empty field follows, or none where all lines end so.
bool endsOpen(std::string_view line, char separator) {
  return separator != ' ' && line.ends_with(separator);
}

// What the remarks above the heights state: "Width: 10.0 um", "Height: 8 um", "Value units: m".
struct Remarks {
  struct Length {
    double value = 0.0;
    LengthUnit unit;
  };
  std::optional<Length> width, height;
  std::string height_unit;
  std::optional<LengthUnit> unit;  // named in another manner

  void take(std::string_view remark) {
    if (!unit) unit = lengthUnitFromComment(remark);
    while (!remark.empty() && (remark.front() == '#' || remark.front() == '/' || remark.front() == '%'))
      remark.remove_prefix(1);
    const std::size_t colon = remark.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key = lowerCase(withoutBlanks(remark.substr(0, colon)));
    const std::string_view value = withoutBlanks(remark.substr(colon + 1));
    if (key == "width") width = lengthIn(value);
    if (key == "height") height = lengthIn(value);
    if (key == "value units") height_unit = value;
  }

  [[nodiscard]] bool areOfAMatrix() const { return width && height && !height_unit.empty(); }

 private:
  static std::optional<Length> lengthIn(std::string_view text) {
    Length length;
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    if (!parseNumber(at, end, length.value) || !std::isfinite(length.value) || !(length.value > 0.0))
      return std::nullopt;
    const auto unit =
        lengthUnitFromName(withoutBlanks(text.substr(static_cast<std::size_t>(at - text.data()))));
    if (!unit) return std::nullopt;
    length.unit = *unit;
    return length;
  }
};

std::size_t fieldsIn(std::string_view line) {
  MatrixLine fields(line);
  std::size_t count = 0;
  for (std::string_view field; fields.next(field);) ++count;
  return count;
}

bool looksLikeMatrix(std::string_view head, std::string_view extension) {
  if (extension == ".xyz" || extension == ".pts" || !looksLikeText(head)) return false;
  head = withoutByteOrderMark(head);
  Remarks remarks;
  std::size_t named = 0;  // columns, at most, by a remark above them
  bool cut = false;
  while (!head.empty() && !cut) {
    const std::size_t end = head.find('\n');
    cut = end == std::string_view::npos;
    std::string_view line = withoutBlanks(head.substr(0, std::min(end, head.size())));
    head.remove_prefix(cut ? head.size() : end + 1);
    if (line.empty()) continue;
    if (isRemark(line)) {
      remarks.take(line);
      named = std::max(named, fieldsIn(line));
      continue;
    }
    // The last number of what was read of the file may be cut anywhere, inside "1e-" too.
    if (cut) line = line.substr(0, line.find_last_of("\t;, ") + 1);
    const std::size_t heights = heightsIn(line);
    if (remarks.areOfAMatrix() && heights > 0) return true;
    if (heights >= kMoreThanOfPoints) return named < heights;
    // A line above them of as many words names the columns of points.
    if (heights > 0 || fieldsIn(line) >= kMoreThanOfPoints) return false;
  }
  return false;
}

// What one look through the file finds: where the rows begin, how many there are and how long they are.
struct Outline {
  std::uint64_t rows = 0, columns = 0;
  char separator = ' ';
  Remarks remarks;
};

Result<Outline> outlineOf(const InputFile& file, JobControl& job) {
  const std::string& path = file.path();
  TextReader text(file);
  Outline found;
  bool ends_open = false;  // the first row
  std::int64_t number = 0;
  std::uint64_t reported = 0;
  for (std::string_view line; text.line(line);) {
    if (++number == 1) line = withoutByteOrderMark(line);
    if (number % 256 == 0) {
      if (job.cancelled()) return cancelled();
      job.advance(text.offset() - std::exchange(reported, text.offset()));
    }
    line = withoutBlanks(line);
    if (line.empty()) continue;
    if (isRemark(line)) {
      if (found.rows == 0) found.remarks.take(line);
      continue;
    }
    if (found.rows == 0) {
      const std::size_t heights = heightsIn(line);
      if (heights == 0) {
        if (number > kMostTitleLines)
          return inputError(fmt::format("the first {} lines hold no row of heights", kMostTitleLines), path);
        found.remarks.take(line);
        continue;
      }
      found.columns = heights;
      found.separator = MatrixLine(line).separator();
      ends_open = endsOpen(line, found.separator);
    } else if (found.rows == 1 && ends_open && heightsIn(line, found.separator) == found.columns + 1) {
      ++found.columns;  // the first row's last height is a hole
    }
    ++found.rows;
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  if (found.rows == 0) return inputError("no line holds heights", path, "is this a matrix of heights?");
  return found;
}

tl::unexpected<Error> badRow(std::int64_t number, std::size_t heights, std::size_t columns,
                             const std::string& path) {
  return inputError(fmt::format("line {} holds {} heights, the first row {}", number, heights, columns), path,
                    heights < columns ? "the file is cut short or damaged" : "the file is damaged");
}

tl::unexpected<Error> badField(std::string_view field, std::int64_t number, std::size_t column,
                               const std::string& path) {
  const std::string shown(field.substr(0, 40));
  if (field.find(',') != std::string_view::npos)
    return inputError(fmt::format("\"{}\" in line {}, column {} has a decimal comma", shown, number, column),
                      path, "write decimal points, e.g. with: tr , . <IN >OUT");
  return inputError(fmt::format("\"{}\" in line {}, column {} is not a number", shown, number, column), path,
                    "the file is damaged");
}

// The rows, parsed as Float: directly to float where they are not scaled, so that they are rounded once.
template <class Float>
Status readMatrixRows(const InputFile& file, const Outline& outline, const HeightRule& rule,
                      FieldBuilder& builder, HeightTally& tally, bool& open, JobControl& job) {
  TextReader text(file);
  const auto columns = static_cast<std::size_t>(outline.columns);
  std::vector<Float> numbers(columns);
  std::vector<float> heights(columns);
  const std::int32_t rows = builder.grid().height;
  std::int32_t row = 0;
  std::int64_t number = 0;
  std::uint64_t reported = 0;
  for (std::string_view line; text.line(line);) {
    if (++number == 1) line = withoutByteOrderMark(line);
    line = withoutBlanks(line);
    if (line.empty() || isRemark(line) || (row == 0 && heightsIn(line) == 0)) continue;
    // The file grew since it was looked through.
    if (row == rows) break;
    MatrixLine fields(line, outline.separator);
    std::size_t c = 0;
    for (std::string_view field; fields.next(field); ++c) {
      if (c == columns) return badRow(number, heightsIn(line, outline.separator), columns, file.path());
      if (!heightOf(field, numbers[c])) return badField(field, number, c + 1, file.path());
      // What a float loses is seen by one number of each row, down the diagonal.
      if constexpr (std::is_same_v<Float, float>) {
        double exact = 0.0;
        if (c == static_cast<std::size_t>(row) % columns && std::isfinite(numbers[c]) &&
            !rule.hole(numbers[c]) && heightOf(field, exact))
          tally.rounded(exact, numbers[c]);
      }
    }
    if (c + 1 == columns && endsOpen(line, outline.separator))
      numbers[c++] = std::numeric_limits<Float>::quiet_NaN();
    if (c != columns) return badRow(number, c, columns, file.path());
    if (job.cancelled()) return cancelled();
    rule.convert(numbers.data(), heights.data(), columns, tally);
    builder.writeHeights(0, rows - 1 - row, static_cast<std::int32_t>(columns), 1, heights.data(),
                         static_cast<std::int32_t>(columns));
    ++row;
    job.advance(text.offset() - std::exchange(reported, text.offset()));
  }
  if (!text.status()) return text.status();
  if (row != rows)
    return inputError(fmt::format("the file ended after {} of {} rows", row, rows), file.path(),
                      "another program changed it: open it again");
  open = text.lastLineIsOpen();
  return {};
}

StatedUnits unitsOf(const Outline& outline, const ImportOptions& options,
                    std::vector<std::string>& warnings) {
  StatedUnits units;
  const Remarks& said = outline.remarks;
  if (said.width && said.height) {
    units.lateral = said.width->unit;
    units.spacing = std::pair{said.width->value / static_cast<double>(outline.columns),
                              said.height->value * (said.height->unit.mm / said.width->unit.mm) /
                                  static_cast<double>(outline.rows)};
  } else if (said.unit) {
    units.lateral = said.unit;
  }
  units.height = heightUnitNamed(said.height_unit, options, warnings);
  return units;
}

Result<Imported> readMatrix(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  job.begin("reading", 2 * file.size());
  const Result<Outline> outline = outlineOf(file, job);
  if (!outline) return tl::unexpected(outline.error());
  if (Status s = checkFieldSize(outline->columns, outline->rows, 0, path); !s)
    return tl::unexpected(s.error());
  std::vector<std::string> warnings;
  Grid grid;
  grid.width = static_cast<std::int32_t>(outline->columns);
  grid.height = static_cast<std::int32_t>(outline->rows);
  determineUnits(grid, unitsOf(*outline, options, warnings), options, warnings);
  const HeightRule rule = HeightRule::of(options);
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), path);
  if (!builder) return tl::unexpected(builder.error());
  HeightTally tally;
  bool open = false;
  const Status status = rule.scale == 1.0
                            ? readMatrixRows<float>(file, *outline, rule, *builder, tally, open, job)
                            : readMatrixRows<double>(file, *outline, rule, *builder, tally, open, job);
  if (!status) return tl::unexpected(status.error());
  tally.decimals = true;
  if (open) warnings.emplace_back(kOpenLastLine);
  return finishImport(std::move(*builder), rule, tally, "Matrix", std::move(warnings));
}

}  // namespace

constexpr std::string_view kMatrixExtensions[] = {".txt", ".csv", ".tsv", ".dat"};
constexpr Format kMatrixFormat{
    .info = {"Matrix", "text with a row of heights per line", kMatrixExtensions, true, false, true},
    .recognises = looksLikeMatrix,
    .read = readMatrix,
};

}  // namespace fettle::engine

// Text with one "x y z" per line: separated by space, tab, comma or semicolon; other columns where a header
// names them, further ones ignored.

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"
#include "engine/io/points/gridding.h"
#include "engine/io/points/xyz_columns.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr int kMostHeaderLines = 1000;

bool isBlank(char c) {
  return c == ' ' || c == '\t';
}

bool isComment(std::string_view line) {
  return isRemark(line) || line.starts_with('!') || line.starts_with(';');
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
  while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
  return line;
}

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

enum class Comma : std::uint8_t { kNone, kDecimal, kOther };

// The meaning of a word's comma, if it has one: "3", "1,5", "-1.234,5e3" against "1,", "1,2,3", "1.5,2.5".
// Words that are not numbers are a case of their own.
Comma commaOf(std::string_view word) {
  if (word.ends_with(',')) word.remove_suffix(1);  // "1,5, 2,5, 3,5"
  const std::size_t comma = word.find(',');
  std::string number(word);
  if (comma != std::string_view::npos) {
    const std::size_t first = word.find_first_of("0123456789");
    if (first > comma || comma + 1 >= word.size() || !isDigit(word[comma + 1])) return Comma::kOther;
    // Points before it separate thousands, three digits after each.
    for (std::size_t point = word.find('.'); point != std::string_view::npos;
         point = word.find('.', point + 1)) {
      const std::size_t next = std::min(word.find('.', point + 1), comma);
      if (point > comma || next != point + 4) return Comma::kOther;
    }
    std::erase(number, '.');
    number[number.find(',')] = '.';
  }
  double value = 0.0;
  const char* at = number.data();
  if (!parseNumber(at, number.data() + number.size(), value) || at != number.data() + number.size())
    return Comma::kOther;
  return comma == std::string_view::npos ? Comma::kNone : Comma::kDecimal;
}

// "1,5 2,5 3,5", "0 0 1,5" or "1,5;2,5;3,5": three numbers of which at least one has a comma inside, so that
// commas do not separate them.
bool hasDecimalComma(std::string_view line) {
  int words = 0, commas = 0;
  for (std::size_t i = 0; i < line.size() && words < 3;) {
    const std::size_t end = std::min(line.find_first_of(" \t;", i), line.size());
    if (end > i) {
      const Comma comma = commaOf(line.substr(i, end - i));
      if (comma == Comma::kOther) return false;
      commas += comma == Comma::kDecimal ? 1 : 0;
      ++words;
    }
    i = end + 1;
  }
  return words == 3 && commas > 0;
}

// The separator of a line that begins with three numbers; nothing if the line does not.
std::optional<char> separatorOf(std::string_view line) {
  std::array<double, 3> point{};
  for (const char separator : {';', ',', '\0'})
    if ((separator == 0 || line.find(separator) != std::string_view::npos) &&
        readPoint(line, separator, {}, point))
      return separator;
  return std::nullopt;
}

// 1, 2, 3 ... or 0, 1, 2 ...: row numbers in place of x.
bool countsRows(const std::vector<double>& values) {
  if (values.size() < 3 || (values[0] != 0.0 && values[0] != 1.0)) return false;
  return std::adjacent_find(values.begin(), values.end(), [](double a, double b) { return b != a + 1.0; }) ==
         values.end();
}

bool looksLikeXyz(std::string_view head, std::string_view extension) {
  head = withoutByteOrderMark(head);
  if (!looksLikeText(head)) return false;
  for (const std::string_view known : {".xyz", ".txt", ".csv", ".pts", ".dat", ".asc"})
    if (extension == known) return true;
  // With another extension, some line of the beginning must hold three numbers (the last may be cut).
  while (!head.empty()) {
    const std::size_t end = head.find('\n');
    if (separatorOf(trimmed(head.substr(0, std::min(end, head.size()))))) return true;
    if (end == std::string_view::npos) break;
    head.remove_prefix(end + 1);
  }
  return false;
}

Result<Imported> readXyz(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  TextReader text(file);
  PointCloud cloud;
  XyzHeader header;
  RasterNotesReader notes;
  XyzColumns columns;
  std::optional<char> separator;
  std::string_view line;
  std::array<double, 3> point{};
  std::int64_t number = 0;
  bool points_last = false;
  std::uint64_t reported = 0;
  job.begin("reading", file.size());
  while (text.line(line)) {
    if (++number % 65536 == 0) {
      if (job.cancelled()) return cancelled();
      job.advance(text.offset() - std::exchange(reported, text.offset()));
    }
    points_last = separator && readPoint(line, *separator, columns, point);
    if (points_last) {
      cloud.add(point[0], point[1], point[2]);
      continue;
    }
    const std::string_view whole = number == 1 ? withoutByteOrderMark(line) : line;
    line = trimmed(whole);
    if (line.empty()) continue;
    if (isComment(line)) {
      if (!cloud.unit) cloud.unit = lengthUnitFromComment(line);
      notes.take(remarkText(line));
      if (!separator) header.takeComment(remarkText(line));
      continue;
    }
    if (hasDecimalComma(line))
      return inputError(fmt::format("line {} has decimal commas", number), path,
                        "write decimal points, e.g. with: tr , . <IN >OUT");
    if (separator)
      return inputError(fmt::format("line {} does not hold three numbers", number), path,
                        "the file is cut short or damaged");
    if (char named = 0; const auto found = header.columnsOf(whole, named)) {
      separator = named;
      columns = *found;
    } else if ((separator = separatorOf(line))) {
      const Result<XyzColumns> chosen = header.columnsWithNumbers(line, *separator, path);
      if (!chosen) return tl::unexpected(chosen.error());
      columns = *chosen;
    }
    points_last = separator && readPoint(whole, *separator, columns, point);
    if (points_last) {
      cloud.add(point[0], point[1], point[2]);
    } else {
      if (!cloud.unit) cloud.unit = lengthUnitFromComment(line);
      header.takeLine(whole);
      if (number > kMostHeaderLines)
        return inputError(fmt::format("the first {} lines hold no three numbers", kMostHeaderLines), path,
                          "is this a file of points?");
    }
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  if (!separator) return inputError("no line holds three numbers", path, "is this a file of points?");
  if (columns.one_unnamed && countsRows(cloud.x))
    return inputError("the lines hold one column more than the header names and begin with 1, 2, 3 ...", path,
                      "name the first column too, e.g. row");
  if (points_last && text.lastLineIsOpen()) cloud.warnings.emplace_back(kOpenLastLine);
  if (columns.lateral) cloud.unit = columns.lateral;
  if (columns.height) cloud.height_unit = columns.height;
  cloud.takeRaster(notes.raster());
  return gridPoints(std::move(cloud), options, "XYZ", path, job);
}

}  // namespace

constexpr std::string_view kXyzExtensions[] = {".xyz", ".txt", ".csv", ".pts", ".dat"};
constexpr Format kXyzFormat{
    .info = {"XYZ", "text with x y z per line", kXyzExtensions, true, true, true},
    .recognises = looksLikeXyz,
    .read = readXyz,
    .write = writeXyz,
};

}  // namespace fettle::engine

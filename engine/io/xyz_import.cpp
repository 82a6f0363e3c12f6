// Text with "x y z" a line: space, tab, comma or semicolon between, further columns ignored.

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/io/format.h"
#include "engine/io/gridding.h"
#include "engine/io/text_reader.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr int kMostHeaderLines = 1000;

bool isBlank(char c) {
  return c == ' ' || c == '\t';
}

// Reads the first three numbers of a line. `separator` (comma or semicolon, 0 for white space alone) may
// stand between two numbers once; a field left empty by two of them is NaN. False if there are not three.
bool readPoint(std::string_view line, char separator, std::array<double, 3>& point) {
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skipBlanks = [&] {
    while (at < end && isBlank(*at)) ++at;
  };
  skipBlanks();
  bool separated = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool empty = separator != 0 && ((at < end && *at == separator) || (at == end && separated));
    if (empty) {
      point[k] = std::numeric_limits<double>::quiet_NaN();
    } else {
      if (at == end || !parseNumber(at, end, point[k])) return false;
      if (at < end && !isBlank(*at) && (separator == 0 || *at != separator)) return false;
    }
    skipBlanks();
    separated = separator != 0 && at < end && *at == separator;
    if (separated) {
      ++at;
      skipBlanks();
    }
  }
  return true;
}

bool isComment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//") || line.starts_with('%') || line.starts_with('!') ||
         line.starts_with(';');
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
  while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
  return line;
}

// "1,5 2,5 3,5" or "1,5;2,5;3,5": commas inside the numbers.
bool hasDecimalComma(std::string_view line) {
  const auto digit = [&](std::size_t i) { return i < line.size() && line[i] >= '0' && line[i] <= '9'; };
  int words = 0;
  int commas = 0;
  for (std::size_t i = 0; i < line.size() && words < 3;) {
    const std::size_t end = std::min(line.find_first_of(" \t;", i), line.size());
    if (end > i) {
      ++words;
      const std::size_t comma = line.substr(0, end).find(',', i);
      if (comma != std::string_view::npos && comma > i && digit(comma - 1) && digit(comma + 1) &&
          line.substr(0, end).find(',', comma + 1) == std::string_view::npos)
        ++commas;
    }
    i = end + 1;
  }
  return words == 3 && commas >= 2;
}

// The separator of a line of points; nothing if the line holds none.
std::optional<char> separatorOf(std::string_view line) {
  std::array<double, 3> point{};
  for (const char separator : {';', ',', '\0'})
    if ((separator == 0 || line.find(separator) != std::string_view::npos) &&
        readPoint(line, separator, point))
      return separator;
  return std::nullopt;
}

std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

}  // namespace

bool looksLikeXyz(std::string_view head, std::string_view extension) {
  head = withoutByteOrderMark(head);
  if (!looksLikeText(head)) return false;
  for (const std::string_view known : {".xyz", ".txt", ".csv", ".pts", ".dat", ".asc"})
    if (extension == known) return true;
  // Under another name, some line of the beginning must hold three numbers (the last may be cut).
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
  std::optional<char> separator;
  std::string_view line;
  std::array<double, 3> point{};
  std::int64_t number = 0;
  std::uint64_t reported = 0;
  job.begin("reading", file.size());
  while (text.line(line)) {
    if (++number % 65536 == 0) {
      if (job.cancelled()) return cancelled();
      job.advance(text.offset() - std::exchange(reported, text.offset()));
    }
    if (separator && readPoint(line, *separator, point)) {
      cloud.add(point[0], point[1], point[2]);
      continue;
    }
    line = trimmed(number == 1 ? withoutByteOrderMark(line) : line);
    if (line.empty()) continue;
    if (isComment(line)) {
      if (!cloud.unit) cloud.unit = lengthUnitFromComment(line);
      continue;
    }
    if (hasDecimalComma(line))
      return inputError(fmt::format("line {} has decimal commas", number), path, "write decimal points");
    if (separator)
      return inputError(fmt::format("line {} does not hold three numbers", number), path,
                        "the file is cut short or damaged");
    separator = separatorOf(line);
    if (separator && readPoint(line, *separator, point)) {
      cloud.add(point[0], point[1], point[2]);
    } else {
      if (!cloud.unit) cloud.unit = lengthUnitFromComment(line);
      if (number > kMostHeaderLines)
        return inputError(fmt::format("the first {} lines hold no three numbers", kMostHeaderLines), path,
                          "is this a file of points?");
    }
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  if (!separator) return inputError("no line holds three numbers", path, "is this a file of points?");
  return gridPoints(std::move(cloud), options, "XYZ", path, job);
}

}  // namespace fettle::engine

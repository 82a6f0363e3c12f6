#include "engine/io/points/xyz_columns.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/io/files/text_reader.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

using namespace std::string_view_literals;

constexpr std::array kSeparators{';', ',', '\t', '\0'};
constexpr std::size_t kMostHeader = 4096;  // bytes of a line that may be names
constexpr std::size_t kMostShown = 100;    // bytes of names in an error

// The fields of a line one by one.
class Fields {
 public:
  Fields(std::string_view line, char separator) : separator_(separator), left_(trimmed(line)) {}

  // The next field without blanks and quotes around it; nothing after the last one.
  std::optional<std::string_view> next() {
    if (left_.empty() && !separated_) return std::nullopt;
    separated_ = false;
    std::size_t end = 0;
    std::string_view field;
    if (left_.starts_with('"')) {
      end = std::min(left_.find('"', 1), left_.size());
      field = left_.substr(1, end - 1);
      end = std::min(end + 1, left_.size());
    } else {
      // Where commas separate the fields, a blank is part of one: "X coordinate,Y coordinate".
      while (end < left_.size() && !(separator_ == 0 ? isBlank(left_[end]) : left_[end] == separator_)) ++end;
      field = trimmed(left_.substr(0, end));
    }
    left_ = trimmed(left_.substr(end));
    if (separator_ != 0 && left_.starts_with(separator_)) {
      separated_ = true;
      left_ = trimmed(left_.substr(1));
    }
    return field;
  }

 private:
  [[nodiscard]] bool isBlank(char c) const { return c == ' ' || (c == '\t' && separator_ != '\t'); }
  [[nodiscard]] std::string_view trimmed(std::string_view text) const {
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    return text;
  }

  char separator_;
  std::string_view left_;
  bool separated_ = false;  // a separator came last: another field follows, possibly empty
};

std::vector<std::string_view> fieldsOf(std::string_view line, char separator) {
  std::vector<std::string_view> all;
  for (Fields fields(line, separator); const auto field = fields.next();) all.push_back(*field);
  return all;
}

// Whether a separator can be that of a line.
bool mayPart(char separator, std::string_view line) {
  return separator == 0 || line.find(separator) != std::string_view::npos;
}

// The names in a header above lines with a separator; where the header has none of these, with any separator.
std::vector<std::string_view> namesIn(std::string_view header, char separator) {
  if (separator != 0 && mayPart(separator, header)) return fieldsOf(header, separator);
  for (const char other : kSeparators)
    if (other != '\t' && mayPart(other, header)) return fieldsOf(header, other);
  return {};
}

bool isNumber(std::string_view field) {
  double ignored = 0.0;
  const char* at = field.data();
  return parseNumber(at, field.data() + field.size(), ignored) && at == field.data() + field.size();
}

std::string_view withoutBlanks(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

// A name without its unit, case and punctuation: "POINT_X" and "point x" are equal; "X [mm]", "x(mm)" and
// "x_mm" are x in mm.
struct ColumnName {
  std::string word;
  std::optional<LengthUnit> unit;
};

ColumnName columnNameOf(std::string_view text) {
  ColumnName name;
  if (const std::size_t open = text.find_first_of("[(");
      open != std::string_view::npos && (text.ends_with(']') || text.ends_with(')'))) {
    name.unit = lengthUnitFromName(withoutBlanks(text.substr(open + 1, text.size() - open - 2)));
    text = text.substr(0, open);
  } else if (const std::size_t mark = text.find_last_of("_ /"); mark != std::string_view::npos && mark > 0) {
    name.unit = lengthUnitFromName(text.substr(mark + 1));
    if (name.unit) text = text.substr(0, mark);
  }
  for (const char c : text) {
    if (c >= 'A' && c <= 'Z') name.word += static_cast<char>(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80)
      name.word += c;
  }
  return name;
}

// The names of columns, the plainest first: of several that a header has, the first counts.
constexpr std::array kNames{
    std::array{"x"sv, "xcoord"sv, "xcoordinate"sv, "coordx"sv, "pointx"sv, "posx"sv, "xpos"sv, "positionx"sv,
               "easting"sv, "east"sv, "longitude"sv, "lon"sv, "e"sv},
    std::array{"y"sv, "ycoord"sv, "ycoordinate"sv, "coordy"sv, "pointy"sv, "posy"sv, "ypos"sv, "positiony"sv,
               "northing"sv, "north"sv, "latitude"sv, "lat"sv, "n"sv},
    std::array{"z"sv, "zcoord"sv, "zcoordinate"sv, "coordz"sv, "pointz"sv, "posz"sv, "zpos"sv, "positionz"sv,
               "height"sv, "elevation"sv, "elev"sv, "altitude"sv, "h"sv}};

// Columns of x, y and z by names. `known`: how many of the three are named; a name of two columns counts for
// none.
struct Named {
  XyzColumns columns;
  std::size_t known = 0;
};

Named namedBy(const std::vector<std::string_view>& names) {
  std::vector<ColumnName> columns;
  for (const std::string_view name : names) columns.push_back(columnNameOf(name));
  Named found;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::string_view word : kNames[axis]) {
      const auto is = [&](const ColumnName& column) { return column.word == word; };
      const auto count = std::count_if(columns.begin(), columns.end(), is);
      if (count == 0) continue;
      const auto at = std::find_if(columns.begin(), columns.end(), is);
      found.columns.at[axis] = static_cast<std::size_t>(at - columns.begin());
      (axis < 2 ? found.columns.lateral : found.columns.height) = at->unit;
      found.known += count == 1 ? 1 : 0;
      break;
    }
  return found;
}

// "mm" or "[mm]" by itself.
std::optional<LengthUnit> unitOnly(std::string_view field) {
  if (auto unit = lengthUnitFromName(field)) return unit;
  ColumnName name = columnNameOf(field);
  return name.word.empty() ? name.unit : std::nullopt;
}

// Units of the three columns from a line of only units.
void takeUnits(std::string_view units, char separator, XyzColumns& columns) {
  const std::vector<std::string_view> all = namesIn(units, separator);
  const auto unitAt = [&](std::size_t axis) {
    return columns.at[axis] < all.size() ? unitOnly(all[columns.at[axis]]) : std::nullopt;
  };
  if (!columns.lateral) columns.lateral = unitAt(0);
  if (!columns.height) columns.height = unitAt(2);
}

bool namesAll(const std::string& header) {
  return std::any_of(kSeparators.begin(), kSeparators.end(),
                     [&](char separator) { return namedBy(namesIn(header, separator)).known == 3; });
}

// The first three numbers of a line; blanks may be next to the separator or replace it.
bool readFirstThree(std::string_view line, char separator, std::array<double, 3>& point) {
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto isBlank = [](char c) { return c == ' ' || c == '\t'; };
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

// Names for an error message: one line, of limited length.
std::string shownNames(const std::vector<std::string_view>& names) {
  std::string text = fmt::format("{}", fmt::join(names, ", ")).substr(0, kMostShown);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, '?');
  return text;
}

}  // namespace

bool readPoint(std::string_view line, char separator, const XyzColumns& columns,
               std::array<double, 3>& point) {
  if (columns.at == std::array<std::size_t, 3>{0, 1, 2} && separator != '\t') {
    if (readFirstThree(line, separator, point)) return true;
    if (line.find('"') == std::string_view::npos) return false;
  }
  const std::size_t last = std::max({columns.at[0], columns.at[1], columns.at[2]});
  Fields fields(line, separator);
  for (std::size_t column = 0; column <= last; ++column) {
    const auto field = fields.next();
    if (!field) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (columns.at[axis] != column) continue;
      if (field->empty()) {
        point[axis] = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      const char* at = field->data();
      const char* const end = at + field->size();
      if (!parseNumber(at, end, point[axis]) || at != end) return false;
    }
  }
  return true;
}

void XyzHeader::takeLine(std::string_view line) {
  if (line.size() > kMostHeader) return;
  const std::vector<std::string_view> fields = namesIn(line, ';');
  const auto isWord = [](std::string_view field) { return !field.empty() && !isNumber(field); };
  if (std::none_of(fields.begin(), fields.end(), isWord)) return;  // a number of points, or their extent
  const auto isUnit = [](std::string_view field) { return field.empty() || unitOnly(field).has_value(); };
  if (!names_.empty() && std::all_of(fields.begin(), fields.end(), isUnit)) {
    units_ = line;
    return;
  }
  // A title below the names does not replace them.
  if (names_.empty() || !namesAll(names_)) names_ = line;
}

void XyzHeader::takeComment(std::string_view comment) {
  if (comment.size() > kMostHeader) return;
  const std::string text(comment);
  if (namesAll(text)) comment_ = text;
}

std::optional<XyzColumns> XyzHeader::columnsOf(std::string_view line, char& separator) const {
  if (names_.empty()) return std::nullopt;
  std::array<double, 3> ignored{};
  for (const char one : kSeparators) {
    if (!mayPart(one, line)) continue;
    const std::vector<std::string_view> names = namesIn(names_, one);
    Named named = namedBy(names);
    if (named.known != 3 || !readPoint(line, one, named.columns, ignored)) continue;
    takeUnits(units_, one, named.columns);
    named.columns.one_unnamed = names.size() + 1 == fieldsOf(line, one).size();
    separator = one;
    return named.columns;
  }
  return std::nullopt;
}

Result<XyzColumns> XyzHeader::columnsWithNumbers(std::string_view line, char separator,
                                                 const std::string& path) const {
  const std::size_t fields = fieldsOf(line, separator).size();
  if (!names_.empty()) {
    const std::vector<std::string_view> names = namesIn(names_, separator);
    const std::size_t known = namedBy(names).known;
    // As many words as columns, or two that are names of some: names, not a title.
    if (names.size() == fields || known >= 2)
      return inputError(fmt::format("the header \"{}\" {}", shownNames(names),
                                    known == 3 ? "names other columns than the points have"
                                               : "does not state which columns are x, y and z"),
                        path,
                        "name one column each x, y and z, or put // before a line that is not a header");
  }
  if (!comment_.empty()) {
    const std::vector<std::string_view> names = namesIn(comment_, separator);
    const Named named = namedBy(names);
    if (named.known == 3 && (names.size() == 3 || names.size() == fields)) return named.columns;
  }
  return XyzColumns{};
}

}  // namespace fettle::engine

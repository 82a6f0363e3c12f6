#include "engine/io/lines/line_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/lines/line_frame.h"

namespace fettle::engine {

namespace {

constexpr std::string_view kLineHeader =
    "line,closed,x,y,located,kind,deviation,step,step_deviation,slope_change,slope_deviation";

struct LineRow {
  std::int64_t id = 0;
  bool closed = false;
  EdgePoint point;
};

// The cells of a row from the left; remembers the first one that is not what was asked for.
class LineCells {
 public:
  LineCells(std::string_view row, char separator) : rest_(row), separator_(separator) {}

  [[nodiscard]] std::string_view word() {
    if (ended_) lacking_ = true;
    const std::size_t end = rest_.find(separator_);
    const std::string_view cell = rest_.substr(0, end);
    ended_ = end == std::string_view::npos;
    rest_.remove_prefix(ended_ ? rest_.size() : end + 1);
    return cell;
  }
  template <class Number>
  [[nodiscard]] Number number(const char* column) {
    const std::string_view cell = word();
    Number value{};
    const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || stop != cell.data() + cell.size()) note(column, cell, "a number in range");
    return value;
  }
  [[nodiscard]] bool either(const char* column, std::string_view no, std::string_view yes) {
    const std::string_view cell = word();
    if (cell != no && cell != yes) note(column, cell, fmt::format("{} or {}", no, yes));
    return cell == yes;
  }
  // What is wrong with the row, after all cells were taken.
  [[nodiscard]] const std::optional<std::string>& problem() {
    if (lacking_ || !ended_) problem_ = "a row needs the columns " + std::string(kLineHeader);
    return problem_;
  }

 private:
  void note(const char* column, std::string_view cell, const std::string& wanted) {
    if (!problem_) problem_ = fmt::format("{} = \"{}\" is not {}", column, cell.substr(0, 24), wanted);
  }

  std::string_view rest_;
  char separator_;
  bool ended_ = false, lacking_ = false;
  std::optional<std::string> problem_;
};

std::optional<std::string> parseLineRow(std::string_view text, char separator, const LineFrame& frame,
                                        LineRow& row) {
  using Real = LineFrame::Real;
  LineCells cells(text, separator);
  row.id = cells.number<std::int64_t>("line");
  row.closed = cells.either("closed", "0", "1");
  const Real x = cells.number<Real>("x");
  const Real y = cells.number<Real>("y");
  EdgePoint& p = row.point;
  p.position = frame.position(x, y);
  p.located = cells.either("located", "0", "1");
  p.kind = cells.either("kind", "step", "crease") ? LineKind::kCrease : LineKind::kStep;
  const auto scaled = [&](const char* column, Real unit) {
    return static_cast<double>(cells.number<Real>(column) / unit);
  };
  p.deviation = scaled("deviation", frame.sample_mm);
  p.step = scaled("step", frame.height_mm);
  p.step_deviation = scaled("step_deviation", frame.height_mm);
  p.slope_change = scaled("slope_change", frame.slope());
  p.slope_deviation = scaled("slope_deviation", frame.slope());
  return cells.problem();
}

void appendNumber(std::string& text, LineFrame::Real value, char end) {
  std::array<char, 64> digits;
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  text += end;
}

void appendLineRow(std::string& text, const EdgeLine& line, const EdgePoint& p, const LineFrame& frame) {
  using Real = LineFrame::Real;
  fmt::format_to(std::back_inserter(text), "{},{:d},", line.id, line.closed);
  // Positions are multiples of 2^-20 samples: the digits of a double are enough.
  fmt::format_to(std::back_inserter(text), "{},{},", static_cast<double>(frame.x(p.position.x)),
                 static_cast<double>(frame.y(p.position.y)));
  fmt::format_to(std::back_inserter(text), "{:d},{},", p.located,
                 p.kind == LineKind::kStep ? "step" : "crease");
  appendNumber(text, Real{p.deviation} * frame.sample_mm, ',');
  appendNumber(text, Real{p.step} * frame.height_mm, ',');
  appendNumber(text, Real{p.step_deviation} * frame.height_mm, ',');
  appendNumber(text, Real{p.slope_change} * frame.slope(), ',');
  appendNumber(text, Real{p.slope_deviation} * frame.slope(), '\n');
}

}  // namespace

Result<std::vector<EdgeLine>> readLineCsv(const InputFile& file, const Grid& grid, const JobControl* job) {
  TextReader reader(file);
  std::string_view text;
  const bool has_header = reader.line(text);
  text = withoutByteOrderMark(text);
  // Spreadsheets write semicolons where the comma is the decimal sign; numbers have points here all the same.
  const char separator = text.starts_with("line;") ? ';' : ',';
  std::string header(text);
  std::ranges::replace(header, separator, ',');
  if (!has_header || header != kLineHeader)
    return inputError(fmt::format("line 1 is not the header {}", kLineHeader), file.path(),
                      "give lines as docs/formats.md describes them");
  const LineFrame frame = LineFrame::field(grid);
  LineCollector lines(grid, file.path(), job);
  bool fresh = true;
  for (std::int64_t number = 2; reader.line(text); ++number) {
    if (text.empty()) {
      fresh = true;
      continue;
    }
    const std::string where = fmt::format("line {}", number);
    // A number that is cut reads as another one.
    if (reader.lastLineIsOpen())
      return inputError(where + " has no end", file.path(), "the file is cut short: write it again");
    LineRow row;
    if (const auto problem = parseLineRow(text, separator, frame, row))
      return inputError(fmt::format("{}: {}", where, *problem), file.path(), "correct or remove the line");
    if (fresh || lines.last().id != row.id || lines.last().closed != row.closed)
      lines.begin(row.id, row.closed);
    fresh = false;
    if (Status status = lines.add(row.point, where); !status) return tl::unexpected(status.error());
  }
  if (!reader.status()) return tl::unexpected(reader.status().error());
  return lines.finish();
}

Status writeLineCsv(const std::string& path, std::span<const EdgeLine> lines, const Grid& grid) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const LineFrame frame = LineFrame::field(grid);
  TextWriter out{*file};
  (out.text += kLineHeader) += '\n';
  const EdgeLine* before = nullptr;
  for (const EdgeLine& line : lines) {
    if (before != nullptr && before->id == line.id) out.text += '\n';
    before = &line;
    for (const EdgePoint& point : line.points) {
      appendLineRow(out.text, line, point, frame);
      if (Status status = out.flushIfLarge(); !status) return status;
    }
  }
  if (Status status = out.flush(); !status) return status;
  return file->commit();
}

}  // namespace fettle::engine

#include "app/pages/report_sheets.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace fettle::app {

namespace {

constexpr double kTop = kSheetMargin, kBottom = kSheetHeight - kSheetMargin;
constexpr double kTableSize = 8.0, kCellPad = 4.0, kLine = 1.35;  // lines are that many sizes apart
constexpr double kNoteSize = 8.0, kNoteGrey = 0.33;
constexpr double kPlotTall = kSheetTextWidth * kPlotHeight / kPlotWidth;

// Width over height of a PNG by its header (PNG specification, 11.2.2); 0 where it is none.
double aspectOf(const std::string& png) {
  if (png.size() < 24 || !png.starts_with("\x89PNG")) return 0.0;
  const auto number = [&png](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(png[i]);
    return static_cast<double>(value);
  };
  return number(20) > 0.0 ? number(16) / number(20) : 0.0;
}

// Widths of columns as browsers choose them: each what its texts need, or, where that is too much, between its longest
// word and that.
std::vector<double> columnsOf(const ReportPage::Table& table, const PageText& text) {
  std::vector<double> least, most;
  for (std::size_t c = 0; c < table.heads.size(); ++c) {
    double word = text.longestWordOf(table.heads[c], kTableSize, FaceWeight::kBold);
    double whole = text.widthOf(table.heads[c], kTableSize, FaceWeight::kBold);
    for (const auto& row : table.rows) {
      word = std::max(word, text.longestWordOf(row[c], kTableSize, FaceWeight::kRegular));
      whole = std::max(whole, text.widthOf(row[c], kTableSize, FaceWeight::kRegular));
    }
    least.push_back(word + 2.0 * kCellPad);
    most.push_back(whole + 2.0 * kCellPad);
  }
  double low = 0.0, high = 0.0;
  for (std::size_t c = 0; c < least.size(); ++c) {
    low += least[c];
    high += most[c];
  }
  std::vector<double> widths;
  for (std::size_t c = 0; c < least.size(); ++c)
    if (high <= kSheetTextWidth)
      widths.push_back(most[c] * kSheetTextWidth / high);
    else if (low <= kSheetTextWidth)
      widths.push_back(least[c] + (most[c] - least[c]) * (kSheetTextWidth - low) / (high - low));
    else
      widths.push_back(least[c] * kSheetTextWidth / low);
  return widths;
}

class Layout {
 public:
  explicit Layout(const PageText& text) : text_(text) { sheets_.emplace_back(); }

  void title(const std::string& line) {
    outline(line);
    paragraph(line, 17.0, FaceWeight::kBold, 0.0);
  }
  engine::Status add(const ReportPage::Heading& heading) {
    headed(heading.text, 0.0);
    return {};
  }
  // A heading, and room for the part that follows it.
  void addBefore(const ReportPage::Heading& heading, const ReportPage::Part& next) {
    if (const auto* plot = std::get_if<ReportPage::Plot>(&next))
      headed(heading.text, 4.0 + figureRoom(kPlotTall, plot->caption));
    else
      headed(heading.text, 40.0);
  }
  engine::Status add(const ReportPage::Paragraph& part) {
    paragraph(part.text, kNoteSize, FaceWeight::kRegular, kNoteGrey);
    return {};
  }
  engine::Status add(const ReportPage::Picture& picture) {
    const double aspect = aspectOf(picture.png);
    if (!(aspect > 0.0)) return engine::failure("a picture cannot be read", picture.caption);
    const double height = kSheetTextWidth / aspect;
    figure(height, picture.caption, [&](double y) {
      put(SheetPicture{kSheetMargin, y, kSheetTextWidth, height, &picture});
    });
    return {};
  }
  engine::Status add(const ReportPage::Plot& plot) {
    figure(kPlotTall, plot.caption, [&](double y) {
      put(SheetPlot{kSheetMargin, y, kSheetTextWidth, kPlotTall, &plot});
    });
    return {};
  }
  engine::Status add(const ReportPage::Table& table) {
    const std::vector<double> widths = columnsOf(table, text_);
    const std::vector<Cells> rows = cellsOf(table, widths);
    const Cells head = cellsOf(table.heads, table, widths, FaceWeight::kBold);
    const bool has_head = std::ranges::any_of(table.heads, [](const auto& text) { return !text.empty(); });
    headed(table.title, heightOf(head) + (rows.empty() ? 0.0 : heightOf(rows.front())));
    if (has_head) row(head, 0.0);
    for (const Cells& cells : rows) {
      if (y_ + heightOf(cells) > kBottom && y_ > kTop) {
        next();
        if (has_head) row(head, 0.0);
      }
      row(cells, 1.0);
    }
    y_ += 3.0;
    if (!table.note.empty()) return add(ReportPage::Paragraph{table.note});
    return {};
  }

  std::vector<Sheet> finished(const std::string& foot) {
    for (std::size_t i = 0; i < sheets_.size(); ++i) {
      constexpr double kFootSize = 7.0, kFootY = kSheetHeight - 0.55 * kSheetMargin;
      const std::string number = fmt::format("{} of {}", i + 1, sheets_.size());
      const double wide = text_.widthOf(number, kFootSize, FaceWeight::kRegular);
      const std::string line =
          text_.linesOf(foot, kFootSize, FaceWeight::kRegular, kSheetTextWidth - wide - 20.0).front();
      sheets_[i].items.emplace_back(
          SheetText{kSheetMargin, kFootY, kFootSize, kNoteGrey, FaceWeight::kRegular, line});
      sheets_[i].items.emplace_back(SheetText{kSheetMargin + kSheetTextWidth - wide, kFootY, kFootSize,
                                              kNoteGrey, FaceWeight::kRegular, number});
    }
    return std::move(sheets_);
  }

 private:
  // The cells of a row, each in lines.
  struct Cell {
    double x = 0.0, width = 0.0;
    bool right = false;
    FaceWeight weight = FaceWeight::kRegular;
    std::vector<std::string> lines;
  };
  using Cells = std::vector<Cell>;

  [[nodiscard]] Cells cellsOf(const std::vector<std::string>& texts, const ReportPage::Table& table,
                              const std::vector<double>& widths, FaceWeight weight) const {
    Cells cells;
    double x = kSheetMargin;
    for (std::size_t c = 0; c < texts.size(); ++c) {
      const bool right = weight == FaceWeight::kBold ? hasFigures(table, c) : isFigure(texts[c]);
      cells.push_back({x, widths[c], right, weight,
                       text_.linesOf(texts[c], kTableSize, weight, widths[c] - 2.0 * kCellPad)});
      x += widths[c];
    }
    return cells;
  }
  [[nodiscard]] std::vector<Cells> cellsOf(const ReportPage::Table& table,
                                           const std::vector<double>& widths) const {
    std::vector<Cells> rows;
    rows.reserve(table.rows.size());
    for (const auto& texts : table.rows) rows.push_back(cellsOf(texts, table, widths, FaceWeight::kRegular));
    return rows;
  }
  [[nodiscard]] static double heightOf(const Cells& cells) {
    std::size_t lines = 1;
    for (const Cell& cell : cells) lines = std::max(lines, cell.lines.size());
    return static_cast<double>(lines) * kTableSize * kLine + 3.0;
  }

  // A row longer than a sheet goes on over the next, line by line.
  void row(const Cells& cells, double ground) {
    std::size_t lines = 1;
    for (const Cell& cell : cells) lines = std::max(lines, cell.lines.size());
    for (std::size_t first = 0; first < lines;) {
      const auto fit = static_cast<std::size_t>(std::max(1.0, (kBottom - y_ - 3.0) / (kTableSize * kLine)));
      const std::size_t end = std::min(lines, first + fit);
      const double height = static_cast<double>(end - first) * kTableSize * kLine + 3.0;
      if (ground < 1.0) put(SheetBox{kSheetMargin, y_, kSheetTextWidth, height, 0.95});
      for (const Cell& cell : cells)
        for (std::size_t i = first; i < std::min(end, cell.lines.size()); ++i) {
          const double wide = text_.widthOf(cell.lines[i], kTableSize, cell.weight);
          const double x = cell.right ? cell.x + cell.width - kCellPad - wide : cell.x + kCellPad;
          const double base = y_ + 1.5 + (static_cast<double>(i - first) + 0.92) * kTableSize * kLine;
          put(SheetText{x, base, kTableSize, 0.13, cell.weight, cell.lines[i]});
        }
      y_ += height;
      put(SheetBox{kSheetMargin, y_ - 0.25, kSheetTextWidth, 0.5, 0.88});
      first = end;
      if (first < lines) next();
    }
  }

  void paragraph(const std::string& text, double size, FaceWeight weight, double grey) {
    for (const std::string& line : text_.linesOf(text, size, weight, kSheetTextWidth)) {
      if (y_ + size * kLine > kBottom) next();
      put(SheetText{kSheetMargin, y_ + size, size, grey, weight, line});
      y_ += size * kLine;
    }
    y_ += 3.0;
  }

  // A heading with room for what follows it.
  void headed(const std::string& text, double following) {
    constexpr double kSize = 12.0, kBefore = 12.0;
    if (y_ + kBefore + 2.0 * kSize * kLine + following > kBottom && y_ > kTop) next();
    if (y_ > kTop) {
      y_ += kBefore;
      put(SheetBox{kSheetMargin, y_ - 4.0, kSheetTextWidth, 0.5, 0.75});
    }
    outline(text);
    paragraph(text, kSize, FaceWeight::kBold, 0.13);
  }

  [[nodiscard]] double figureRoom(double height, const std::string& caption) const {
    const std::size_t lines = text_.linesOf(caption, kNoteSize, FaceWeight::kRegular, kSheetTextWidth).size();
    return 4.0 + height + 2.0 + static_cast<double>(lines) * kNoteSize * kLine;
  }
  template <class Put>
  void figure(double height, const std::string& caption, const Put& put_at) {
    if (y_ + figureRoom(height, caption) > kBottom && y_ > kTop) next();
    y_ += 4.0;
    put_at(y_);
    y_ += height + 2.0;
    paragraph(caption, kNoteSize, FaceWeight::kRegular, kNoteGrey);
  }

  void outline(const std::string& text) { sheets_.back().headings.push_back({y_, text}); }
  void put(SheetItem item) { sheets_.back().items.push_back(std::move(item)); }
  void next() {
    sheets_.emplace_back();
    y_ = kTop;
  }

  const PageText& text_;
  std::vector<Sheet> sheets_;
  double y_ = kTop;
};

}  // namespace

engine::Result<std::vector<Sheet>> sheetsOf(const ReportPage& report, const PageText& text) {
  Layout layout(text);
  layout.title(report.title);
  if (auto status = layout.add(ReportPage::Paragraph{report.made_with}); !status)
    return tl::unexpected(status.error());
  for (std::size_t i = 0; i < report.parts.size(); ++i) {
    const ReportPage::Part& part = report.parts[i];
    const auto* heading = std::get_if<ReportPage::Heading>(&part);
    if (heading != nullptr && i + 1 < report.parts.size())
      layout.addBefore(*heading, report.parts[i + 1]);
    else if (auto status = std::visit([&layout](const auto& each) { return layout.add(each); }, part);
             !status)
      return tl::unexpected(status.error());
  }
  return layout.finished(report.title);
}

}  // namespace fettle::app

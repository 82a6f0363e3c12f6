#include <algorithm>
#include <cctype>
#include <cstddef>
#include <variant>

#include <fmt/format.h>

#include "app/pages/html.h"
#include "app/pages/report_page.h"

namespace fettle::app {

namespace {

constexpr const char* kReportStyle = R"(<style>
@page{size:A4;margin:18mm}
body{font:15px/1.45 "DejaVu Sans",system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222;background:#fff}
h1{margin-bottom:.1em;overflow-wrap:anywhere}h2{margin:1.8em 0 .5em;border-top:1px solid #ccc;padding-top:.6em}
p.how{color:#555;font-size:13px;margin:.3em 0}figure{margin:1em 0;break-inside:avoid}img,svg{max-width:100%;height:auto}
figcaption{color:#555;font-size:13px}table{border-collapse:collapse;font-size:13px;width:100%}
th,td{padding:.22em .6em;text-align:left;border-bottom:1px solid #e4e4e4;vertical-align:top;overflow-wrap:anywhere}
th{background:#f5f5f5}td:first-child,td:last-child,th{white-space:nowrap}.n{text-align:right;font-variant-numeric:tabular-nums}tr{break-inside:avoid}h2{break-after:avoid}
</style>)";

// A part of the page each.
struct HtmlOfPart {
  std::string operator()(const ReportPage::Heading& heading) const {
    return fmt::format("<h2>{}</h2>\n", escapedHtml(heading.text));
  }
  std::string operator()(const ReportPage::Paragraph& paragraph) const {
    return fmt::format("<p class=how>{}</p>\n", escapedHtml(paragraph.text));
  }
  std::string operator()(const ReportPage::Picture& picture) const {
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                       embeddedPng(picture.png, picture.caption), escapedHtml(picture.caption));
  }
  std::string operator()(const ReportPage::Plot& plot) const {
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", plot.svg,
                       escapedHtml(plot.caption));
  }
  std::string operator()(const ReportPage::Table& table) const {
    std::string out = (*this)(ReportPage::Heading{table.title}) + "<table><tr>";
    for (std::size_t i = 0; i < table.heads.size(); ++i)
      out +=
          fmt::format("<th{}>{}</th>", hasFigures(table, i) ? " class=n" : "", escapedHtml(table.heads[i]));
    out += "</tr>\n";
    for (const std::vector<std::string>& row : table.rows) {
      out += "<tr>";
      for (const std::string& cell : row)
        out += fmt::format("<td{}>{}</td>", isFigure(cell) ? " class=n" : "", escapedHtml(cell));
      out += "</tr>\n";
    }
    out += "</table>\n";
    return table.note.empty() ? out : out + (*this)(ReportPage::Paragraph{table.note});
  }
};

}  // namespace

bool isFigure(const std::string& cell) noexcept {
  return !cell.empty() && (std::isdigit(static_cast<unsigned char>(cell.back())) != 0) &&
         cell.find_first_not_of("0123456789.+-e ") == std::string::npos;
}

bool hasFigures(const ReportPage::Table& table, std::size_t column) noexcept {
  return std::ranges::any_of(table.rows, [column](const auto& row) { return isFigure(row[column]); });
}

std::string reportHtml(const ReportPage& report) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=en><head><meta "
      "charset=utf-8><title>{0}</title>\n{1}</head><body>\n<h1>{0}</h1>\n"
      "<p class=how>{2}</p>\n",
      escapedHtml(report.title), kReportStyle, escapedHtml(report.made_with));
  for (const ReportPage::Part& part : report.parts) page += std::visit(HtmlOfPart(), part);
  return page + "</body></html>\n";
}

}  // namespace fettle::app

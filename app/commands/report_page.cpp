#include "app/commands/report_page.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/commands/html.h"

namespace fettle::app {

namespace {

constexpr const char* kReportStyle = R"(<style>
@page{size:A4;margin:18mm}
body{font:15px/1.45 "DejaVu Sans",system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222;background:#fff}
h1{margin-bottom:.1em;overflow-wrap:anywhere}h2{margin:1.8em 0 .5em;border-top:1px solid #ccc;padding-top:.6em}
p.how{color:#555;font-size:13px;margin:.3em 0}figure{margin:1em 0;break-inside:avoid}img{max-width:100%;height:auto}
figcaption{color:#555;font-size:13px}table{border-collapse:collapse;font-size:13px;width:100%}
th,td{padding:.22em .6em;text-align:left;border-bottom:1px solid #e4e4e4;vertical-align:top;overflow-wrap:anywhere}
th{background:#f5f5f5}td:first-child,td:last-child,th{white-space:nowrap}.n{text-align:right;font-variant-numeric:tabular-nums}tr{break-inside:avoid}h2{break-after:avoid}
</style>)";

// Figures stand to the right, so that their digits can be compared.
bool figure(const std::string& cell) noexcept {
  return !cell.empty() && (std::isdigit(static_cast<unsigned char>(cell.back())) != 0) &&
         cell.find_first_not_of("0123456789.+-e ") == std::string::npos;
}

std::string tableHtml(const ReportPage::Table& table) {
  std::string out = fmt::format("<h2>{}</h2>\n<table><tr>", escapedHtml(table.title));
  for (std::size_t i = 0; i < table.heads.size(); ++i) {
    const bool figures = std::ranges::any_of(table.rows, [&](const auto& row) { return figure(row[i]); });
    out += fmt::format("<th{}>{}</th>", figures ? " class=n" : "", escapedHtml(table.heads[i]));
  }
  out += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row)
      out += fmt::format("<td{}>{}</td>", figure(cell) ? " class=n" : "", escapedHtml(cell));
    out += "</tr>\n";
  }
  out += "</table>\n";
  if (!table.note.empty()) out += fmt::format("<p class=how>{}</p>\n", escapedHtml(table.note));
  return out;
}

}  // namespace

std::string reportPage(const ReportPage& report) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=en><head><meta "
      "charset=utf-8><title>{0}</title>\n{1}</head><body>\n<h1>{0}</h1>\n"
      "<p class=how>{2}</p>\n",
      escapedHtml(report.title), kReportStyle, escapedHtml(report.made_with));
  for (const ReportPage::Picture& picture : report.pictures)
    page += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                        embeddedPng(picture.png, picture.caption), escapedHtml(picture.caption));
  for (const ReportPage::Table& table : report.tables) page += tableHtml(table);
  return page + "</body></html>\n";
}

ReportPage::Table textureTable(const std::vector<ArealLine>& lines, const std::vector<std::string>& states,
                               std::string note) {
  ReportPage::Table table{"Surface texture", std::move(note), {}, {}};
  table.heads = {"Parameter", "Meaning"};
  table.heads.insert(table.heads.end(), states.begin(), states.end());
  table.heads.emplace_back("Unit");
  for (const ArealLine& line : lines) {
    std::vector<std::string> row = {line.name, line.text};
    row.insert(row.end(), line.values.begin(), line.values.end());
    row.push_back(line.unit);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace fettle::app

#include "app/commands/accuracy_page/page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/commands/accuracy_page/plot.h"

namespace fettle::app {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string number(double value) {
  if (std::isnan(value)) return "";
  if (value == 0.0) return "0";
  return std::abs(value) >= 1e-3 && std::abs(value) < 1e6 ? fmt::format("{:.4g}", value)
                                                          : fmt::format("{:.2e}", value);
}

std::string percent(double share) {
  return std::isnan(share) ? "" : fmt::format("{:.2f} %", 100.0 * share);
}

std::string csvText(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

constexpr const char* kStyle = R"(<style>
body{font:16px/1.5 "DejaVu Sans",system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222;background:#fff}
h1{margin-bottom:.2em}h2{margin-top:2.5em;border-top:1px solid #ccc;padding-top:.8em}
.ask{color:#555;font-style:italic;margin:.2em 0}.answer{background:#eef5fb;border-left:4px solid #0072b2;padding:.7em 1em}
.how{color:#555;font-size:14px}table{border-collapse:collapse;font-size:13px;width:100%}
th,td{padding:.25em .6em;text-align:right;border-bottom:1px solid #e4e4e4;white-space:nowrap}
th{background:#f5f5f5}td.t,th.t{text-align:left}td.n{text-align:left;white-space:normal;color:#555}
code{font-size:12px;color:#777}svg{max-width:100%;height:auto}summary{cursor:pointer;color:#0072b2;margin:.5em 0}
</style>)";

std::string tableOf(const bench::Study& study) {
  std::string headings;
  for (const std::string& column : study.columns) headings += "<th>" + escaped(column) + "</th>";
  std::string out = fmt::format(
      "<table><tr><th class=t>subject</th><th>no.</th><th class=t>method</th><th>{} "
      "[{}]</th><th>worst</th><th>{} "
      "[{}]</th><th>p99</th><th>worst</th>{}{}<th class=t>note</th><th class=t>hash</th></tr>\n",
      escaped(study.cost.name), escaped(study.cost.unit), escaped(study.error.name),
      escaped(study.error.unit), study.wrong_name.empty() ? "" : "<th>" + escaped(study.wrong_name) + "</th>",
      headings);
  for (const bench::AccuracyRow& row : study.rows) {
    std::string more;
    for (const double value : row.more) more += "<td>" + number(value) + "</td>";
    out += fmt::format(
        "<tr><td class=t>{}</td><td>{}</td><td "
        "class=t>{}</td><td>{}</td><td>{}</td><td><b>{}</b></td><td>{}</td><td>{}"
        "</td>{}{}<td class=n>{}</td><td class=t><code>{:016x}</code></td></tr>\n",
        escaped(row.subject), methodNumber(study, row.method), escaped(row.method), number(row.cost),
        number(row.cost_worst), number(row.error), number(row.error_p99), number(row.error_worst),
        study.wrong_name.empty() ? "" : "<td>" + percent(row.wrong) + "</td>", more, escaped(row.note),
        row.hash);
  }
  return out + "</table>\n";
}

// The numbers of the methods, for reading the plot without the table.
std::string legendOf(const bench::Study& study) {
  std::string out;
  int next = 1;
  for (const bench::AccuracyRow& row : study.rows)
    if (methodNumber(study, row.method) == next)
      out += fmt::format("{}<b>{}</b>&nbsp;{}", next == 1 ? "" : " &middot; ", next, escaped(row.method)),
          ++next;
  return out;
}

std::string viewsOf(const PlottedStudy& s) {
  std::string out;
  for (std::size_t i = 0; i < s.view_svgs.size(); ++i)
    out += fmt::format("<h3>{}</h3>\n{}\n<p class=how>{}</p>\n", escaped(s.study.views[i].title),
                       s.view_svgs[i], legendOf(s.study.views[i]));
  return out;
}

}  // namespace

std::string accuracyPage(const std::vector<PlottedStudy>& studies, const std::string& machine,
                         const std::string& made_with) {
  std::string page =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8><title>Fettle: what accuracy costs in "
      "time</title>\n";
  page += kStyle;
  page +=
      fmt::format("</head><body>\n<h1>What accuracy costs in time</h1>\n<p class=how>{}<br>{}</p>\n<ul>\n",
                  escaped(machine), escaped(made_with));
  for (const PlottedStudy& s : studies)
    page += fmt::format("<li><a href=\"#{0}\">{1}</a>: <i>{2}</i></li>\n", s.study.id, escaped(s.study.title),
                        escaped(s.study.question));
  page +=
      "</ul>\n<p class=how>In each plot further down is nearer the truth and further left is faster; a line "
      "joins what is worth choosing, hollow points are beaten in both. Numbers at points name the method. "
      "Errors below 1e-9 are drawn on the lower edge.</p>\n";
  for (const PlottedStudy& s : studies) {
    page += fmt::format(
        "<h2 id=\"{}\">{}</h2>\n<p class=ask>{}</p>\n<p class=answer>{}</p>\n{}\n<p class=how>{}</p>\n{}<p "
        "class=how><b>Measured against:</b> {}</p>\n<details><summary>All figures</summary>\n{}</details>\n",
        s.study.id, escaped(s.study.title), escaped(s.study.question), escaped(s.study.answer), s.svg,
        legendOf(s.study), viewsOf(s), escaped(s.study.reference), tableOf(s.study));
  }
  return page + "</body></html>\n";
}

std::string accuracyCsv(const std::vector<PlottedStudy>& studies) {
  std::vector<std::string> columns;  // of all studies, each once
  for (const PlottedStudy& s : studies)
    for (const std::string& column : s.study.columns)
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
  std::string text =
      "study,subject,number,method,cost,cost_worst,cost_unit,error,error_p99,error_worst,error_unit,wrong,"
      "hash,note";
  for (const std::string& column : columns) text += fmt::format(",{}", csvText(column));
  text += "\n";
  const auto plain = [](double value) {
    return std::isnan(value) ? std::string() : fmt::format("{:.9g}", value);
  };
  for (const PlottedStudy& s : studies)
    for (const bench::AccuracyRow& row : s.study.rows) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{:016x},{}", s.study.id, csvText(row.subject),
                          methodNumber(s.study, row.method), csvText(row.method), plain(row.cost),
                          plain(row.cost_worst), csvText(s.study.cost.unit), plain(row.error),
                          plain(row.error_p99), plain(row.error_worst), csvText(s.study.error.unit),
                          plain(row.wrong), row.hash, csvText(row.note));
      for (const std::string& column : columns) {
        const auto at = std::find(s.study.columns.begin(), s.study.columns.end(), column);
        text += ",";
        if (at != s.study.columns.end())
          text += plain(row.more[static_cast<std::size_t>(at - s.study.columns.begin())]);
      }
      text += "\n";
    }
  return text;
}

}  // namespace fettle::app

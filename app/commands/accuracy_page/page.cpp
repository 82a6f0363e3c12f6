#include "app/commands/accuracy_page/page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/pages/html.h"
#include "app/plots/gnuplot.h"

namespace fettle::app {

namespace {

std::vector<std::string> subjectsOf(const bench::Study& study) {
  std::vector<std::string> names;
  for (const bench::AccuracyRow& row : study.rows)
    if (std::find(names.begin(), names.end(), row.subject) == names.end()) names.push_back(row.subject);
  return names;
}

struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;  // of what is above zero
  void take(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool logarithmic() const { return high > 3.0 * low; }
  // Position of zero.
  [[nodiscard]] double floor() const { return high > 0.0 ? std::max(low, 1e-12 * high) / 4.0 : 1e-3; }
};

struct Point {
  double cost, error;
  int method;
};

// The Pareto front: points for which no other is both faster and more exact, from the fastest on.
std::vector<Point> frontOf(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.error < b.error;
  });
  std::vector<Point> front;
  for (const Point& p : points)
    if (front.empty() || p.error < front.back().error) front.push_back(p);
  return front;
}

std::string scriptOf(const bench::Study& study) {
  Axis cost, error;
  for (const bench::AccuracyRow& row : study.rows) {
    cost.take(row.cost);
    // Rounding errors would take decades of the plot.
    if (row.error > 1e-9) error.take(row.error);
  }
  std::string script = kPlotHead;
  script += fmt::format("set xlabel {}\nset ylabel {}\n",
                        quoted(fmt::format("{} [{}]", study.cost.name, study.cost.unit)),
                        quoted(fmt::format("{} [{}]", study.error.name, study.error.unit)));
  const bool cost_by_factors = cost.logarithmic() && !study.cost_from_zero;
  if (study.cost_from_zero) script += fmt::format("set xrange [{}:{}]\n", -0.03 * cost.high, 1.1 * cost.high);
  if (cost_by_factors)
    script += ticsOf('x', cost.floor() * 2.5, cost.high * 1.7) +
              fmt::format("set logscale x\nset xrange [{}:{}]\n", cost.floor() * 2.5, cost.high * 1.7);
  if (error.logarithmic())
    script += ticsOf('y', error.floor(), error.high * 2.0) +
              fmt::format("set logscale y\nset yrange [{}:{}]\n", error.floor(), error.high * 2.0);
  script += "set format x '%g'\nset format y '%g'\n";
  const std::vector<std::string> subjects = subjectsOf(study);
  std::string plots;
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    std::vector<Point> points;
    for (const bench::AccuracyRow& row : study.rows)
      if (row.subject == subjects[s])
        points.push_back({std::max(row.cost, cost_by_factors ? cost.floor() * 3.0 : 0.0),
                          row.error > 1e-9 ? row.error : (error.logarithmic() ? 1.05 * error.floor() : 0.0),
                          methodNumber(study, row.method)});
    const std::vector<Point> front = frontOf(points);
    std::string rest, best;
    for (const Point& p : points) {
      const bool worth =
          std::any_of(front.begin(), front.end(), [&](const Point& f) { return f.method == p.method; });
      if (!worth) rest += fmt::format("{:.9g} {:.9g} {}\n", p.cost, p.error, p.method);
    }
    for (const Point& p : front) best += fmt::format("{:.9g} {:.9g} {}\n", p.cost, p.error, p.method);
    script += fmt::format("$best{0} << EOD\n{1}EOD\n", s, best);
    const char* colour = kPlotColours[s % std::size(kPlotColours)];
    plots += fmt::format(
        "{0}$best{1} using 1:2 with linespoints lc rgb '{2}' lw 1.5 pt 7 ps 0.7 title {3}, "
        "$best{1} using 1:2:3 with labels offset 0.7,0.5 font ',11' tc rgb '{2}' notitle",
        s == 0 ? "plot " : ", ", s, colour, quoted(subjects[s]));
    if (rest.empty()) continue;
    script += fmt::format("$rest{0} << EOD\n{1}EOD\n", s, rest);
    plots += fmt::format(
        ", $rest{0} using 1:2 with points lc rgb '{1}' pt 6 ps 0.7 notitle, "
        "$rest{0} using 1:2:3 with labels offset 0.7,0.5 font ',11' tc rgb '{1}' notitle",
        s, colour);
  }
  return script + plots + "\n";
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
  for (const std::string& column : study.columns) headings += "<th>" + escapedHtml(column) + "</th>";
  std::string out = fmt::format(
      "<table><tr><th class=t>subject</th><th>no.</th><th class=t>method</th><th>{} "
      "[{}]</th><th>worst</th><th>{} "
      "[{}]</th><th>p99</th><th>worst</th>{}{}<th class=t>note</th><th class=t>hash</th></tr>\n",
      escapedHtml(study.cost.name), escapedHtml(study.cost.unit), escapedHtml(study.error.name),
      escapedHtml(study.error.unit),
      study.wrong_name.empty() ? "" : "<th>" + escapedHtml(study.wrong_name) + "</th>", headings);
  for (const bench::AccuracyRow& row : study.rows) {
    std::string more;
    for (const double value : row.more) more += "<td>" + number(value) + "</td>";
    out += fmt::format(
        "<tr><td class=t>{}</td><td>{}</td><td "
        "class=t>{}</td><td>{}</td><td>{}</td><td><b>{}</b></td><td>{}</td><td>{}"
        "</td>{}{}<td class=n>{}</td><td class=t><code>{:016x}</code></td></tr>\n",
        escapedHtml(row.subject), methodNumber(study, row.method), escapedHtml(row.method), number(row.cost),
        number(row.cost_worst), number(row.error), number(row.error_p99), number(row.error_worst),
        study.wrong_name.empty() ? "" : "<td>" + percent(row.wrong) + "</td>", more, escapedHtml(row.note),
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
      out += fmt::format("{}<b>{}</b>&nbsp;{}", next == 1 ? "" : " &middot; ", next, escapedHtml(row.method)),
          ++next;
  return out;
}

std::string viewsOf(const PlottedStudy& s) {
  std::string out;
  for (std::size_t i = 0; i < s.view_svgs.size(); ++i)
    out += fmt::format("<h3>{}</h3>\n{}\n<p class=how>{}</p>\n", escapedHtml(s.study.views[i].title),
                       s.view_svgs[i], legendOf(s.study.views[i]));
  return out;
}

}  // namespace

int methodNumber(const bench::Study& study, const std::string& method) {
  std::vector<std::string> names;
  for (const bench::AccuracyRow& row : study.rows) {
    if (std::find(names.begin(), names.end(), row.method) == names.end()) names.push_back(row.method);
    if (row.method == method) break;
  }
  return static_cast<int>(std::find(names.begin(), names.end(), method) - names.begin()) + 1;
}

engine::Result<std::string> plotSvg(const bench::Study& study) {
  return drawnByGnuplot(scriptOf(study));
}

std::string accuracyPage(const std::vector<PlottedStudy>& studies, const std::string& machine,
                         const std::string& made_with) {
  std::string page =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8><title>Fettle: what accuracy costs in "
      "time</title>\n";
  page += kStyle;
  page +=
      fmt::format("</head><body>\n<h1>What accuracy costs in time</h1>\n<p class=how>{}<br>{}</p>\n<ul>\n",
                  escapedHtml(machine), escapedHtml(made_with));
  for (const PlottedStudy& s : studies)
    page += fmt::format("<li><a href=\"#{0}\">{1}</a>: <i>{2}</i></li>\n", s.study.id,
                        escapedHtml(s.study.title), escapedHtml(s.study.question));
  page +=
      "</ul>\n<p class=how>In each plot further down is nearer the truth and further left is faster; a line "
      "joins what is worth choosing, hollow points are beaten in both. Numbers at points name the method. "
      "Errors below 1e-9 are drawn on the lower edge.</p>\n";
  for (const PlottedStudy& s : studies) {
    page += fmt::format(
        "<h2 id=\"{}\">{}</h2>\n<p class=ask>{}</p>\n<p class=answer>{}</p>\n{}\n<p class=how>{}</p>\n{}<p "
        "class=how><b>Measured against:</b> {}</p>\n<details><summary>All figures</summary>\n{}</details>\n",
        s.study.id, escapedHtml(s.study.title), escapedHtml(s.study.question), escapedHtml(s.study.answer),
        s.svg, legendOf(s.study), viewsOf(s), escapedHtml(s.study.reference), tableOf(s.study));
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

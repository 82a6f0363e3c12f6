#include "app/commands/accuracy_page/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "app/commands/plots/gnuplot.h"

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

}  // namespace fettle::app

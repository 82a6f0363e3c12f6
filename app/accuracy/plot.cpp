#include "app/accuracy/plot.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>
#include <vector>

#include <fmt/format.h>

namespace fettle::app {
namespace {

std::vector<std::string> subjectsOf(const bench::Study& study) {
  std::vector<std::string> names;
  for (const bench::AccuracyRow& row : study.rows)
    if (std::find(names.begin(), names.end(), row.subject) == names.end()) names.push_back(row.subject);
  return names;
}

// As gnuplot reads it between double quotes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 32) out += c;
  }
  return out + "\"";
}

struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;  // of what is above zero
  void take(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool logarithmic() const { return high > 3.0 * low; }
  // Where zero is drawn.
  [[nodiscard]] double floor() const { return high > 0.0 ? std::max(low, 1e-12 * high) / 4.0 : 1e-3; }
};

struct Point {
  double cost, error;
  int method;
};

// The points that no other is both faster and nearer the truth than, from fast to sure.
std::vector<Point> frontOf(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.error < b.error;
  });
  std::vector<Point> front;
  for (const Point& p : points)
    if (front.empty() || p.error < front.back().error) front.push_back(p);
  return front;
}

// Where an axis over two decades or less has its marks: 1, 2 and 5 of each.
std::string ticsOf(char axis, double low, double high) {
  if (high > 200.0 * low) return {};
  std::string tics;
  for (int e = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, e) <= high; ++e)
    for (const double m : {1.0, 2.0, 5.0})
      if (const double at = m * std::pow(10.0, e); at >= low && at <= high)
        tics += fmt::format("{}{:.3g}", tics.empty() ? "" : ",", at);
  return fmt::format("set {}tics ({})\n", axis, tics);
}

std::string scriptOf(const bench::Study& study) {
  Axis cost, error;
  for (const bench::AccuracyRow& row : study.rows) {
    cost.take(row.cost);
    // Rounding is no error worth a decade of the plot.
    if (row.error > 1e-9) error.take(row.error);
  }
  std::string script =
      "set terminal svg size 860,480 dynamic enhanced font 'DejaVu Sans,13' background '#ffffff'\n"
      "set termoption noenhanced\n"
      "set key outside right top Left reverse samplen 2\n"
      "set grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset tics textcolor rgb '#333333'\n";
  script += fmt::format("set xlabel {}\nset ylabel {}\n",
                        quoted(fmt::format("{} [{}]", study.cost_name, study.cost_unit)),
                        quoted(fmt::format("{} [{}]", study.error_name, study.error_unit)));
  if (cost.logarithmic())
    script += ticsOf('x', cost.floor() * 2.5, cost.high * 1.7) +
              fmt::format("set logscale x\nset xrange [{}:{}]\n", cost.floor() * 2.5, cost.high * 1.7);
  if (error.logarithmic())
    script += ticsOf('y', error.floor(), error.high * 2.0) +
              fmt::format("set logscale y\nset yrange [{}:{}]\n", error.floor(), error.high * 2.0);
  script += "set format x '%g'\nset format y '%g'\n";
  const std::vector<std::string> subjects = subjectsOf(study);
  std::string plots;
  // Colours that stay apart for most eyes: Okabe and Ito, Color universal design (2008).
  const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    std::vector<Point> points;
    for (const bench::AccuracyRow& row : study.rows)
      if (row.subject == subjects[s])
        points.push_back({std::max(row.cost, cost.logarithmic() ? cost.floor() * 3.0 : 0.0),
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
    const char* colour = colours[s % std::size(colours)];
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

// A file of its own that is gone with it.
class ScratchFile {
 public:
  ScratchFile() {
    std::error_code problem;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(problem);
    if (problem) return;
    path_ = (folder / "fettle-plot-XXXXXX").string();
    const int descriptor = mkstemp(path_.data());
    if (descriptor < 0) {
      path_.clear();
      return;
    }
    close(descriptor);
  }
  ~ScratchFile() {
    if (!path_.empty()) std::remove(path_.c_str());
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// All that gnuplot prints, errors included.
engine::Result<std::string> gnuplot(const std::string& arguments) {
  std::FILE* pipe = popen(("gnuplot " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return engine::failure("gnuplot cannot be started", "accuracy report", "free memory");
  std::string said;
  char buffer[4096];
  for (std::size_t got; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) said.append(buffer, got);
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return engine::failure("gnuplot is missing", "plots of the accuracy report", "install gnuplot-nox");
  if (status != 0)
    return engine::failure("gnuplot refuses: " + said.substr(0, 200), "accuracy report",
                           "please report this");
  return said;
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

engine::Status plotsCanBeMade() {
  const auto said = gnuplot("--version");
  if (!said) return tl::unexpected(said.error());
  return {};
}

engine::Result<std::string> plotSvg(const bench::Study& study) {
  const ScratchFile script;
  if (script.path().empty() || !(std::ofstream(script.path()) << scriptOf(study)).flush())
    return engine::failure("no file can be written for a plot", "the folder of temporary files",
                           "free space there, or set TMPDIR to another folder");
  auto said = gnuplot("'" + script.path() + "'");
  if (!said) return said;
  const std::size_t begin = said->find("<svg");
  if (begin == std::string::npos)
    return engine::failure("gnuplot draws nothing: " + said->substr(0, 200), study.id, "please report this");
  return said->substr(begin);
}

}  // namespace fettle::app

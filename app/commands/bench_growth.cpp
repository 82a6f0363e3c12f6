#include "app/commands/bench.h"

#include <filesystem>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "app/plots/gnuplot.h"
#include "bench/growth_bench.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

struct BenchGrowthArguments {
  bench::GrowthOptions bench;
  std::string folder;
};

std::string scriptOf(const bench::Growth& growth) {
  std::string script = kPlotHead;
  script += fmt::format("set logscale xy\nset format '%g'\nset xlabel {}\nset ylabel {}\n",
                        quoted(growth.work), quoted(growth.cost));
  std::string plots;
  for (std::size_t i = 0; i < growth.series.size(); ++i) {
    const bench::GrowthSeries& series = growth.series[i];
    script += fmt::format("$s{} << EOD\n", i);
    for (const bench::GrowthPoint& p : series.points)
      script += fmt::format("{:.9g} {:.9g} {:.9g}\n", p.work, p.median, p.worst);
    script += "EOD\n";
    const char* colour = kPlotColours[i % std::size(kPlotColours)];
    plots += fmt::format(
        "{0}$s{1} using 1:2:2:3 with yerrorbars lc rgb '{2}' pt 0 lw 1 notitle, $s{1} using 1:2 with "
        "linespoints lc rgb '{2}' lw 1.5 pt 7 ps 0.7 title {3}",
        i == 0 ? "plot " : ", ", i, colour, quoted(fmt::format("{}: {:.2f}", series.name, series.slope)));
  }
  // Costs that do not grow must not look as if they did.
  return script +
         "set autoscale yfixmin\nset yrange [*:*] extend\nset key title 'slope' left\nset offsets graph 0, "
         "0, graph 0.2, graph 0.2\n" +
         plots + "\n";
}

engine::Result<Report> measure(const BenchGrowthArguments& options, engine::JobControl& job) {
  if (!options.folder.empty())
    if (auto ready = plotsCanBeMade(); !ready) return tl::unexpected(ready.error());
  const auto measured = bench::benchGrowth(options.bench, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"copy_bytes_per_second", measured->copy_bytes_per_s},
                {"growths", Report::array()}};
  for (const bench::Growth& growth : measured->growths) {
    Report entry{{"id", growth.id},     {"title", growth.title},       {"work", growth.work},
                 {"cost", growth.cost}, {"expected", growth.expected}, {"series", Report::array()}};
    for (const bench::GrowthSeries& series : growth.series) {
      Report points = Report::array();
      for (const bench::GrowthPoint& p : series.points)
        points.push_back({{"work", p.work}, {"median", p.median}, {"worst", p.worst}});
      entry["series"].push_back({{"name", series.name},
                                 {"slope", series.slope},
                                 {"target", series.target > 0.0 ? Report(series.target) : Report()},
                                 {"points", points}});
    }
    if (!options.folder.empty()) {
      const auto svg = drawnByGnuplot(scriptOf(growth));
      if (!svg) return tl::unexpected(svg.error());
      std::error_code error;
      std::filesystem::create_directories(options.folder, error);
      if (error)
        return engine::inputError("the folder cannot be created: " + error.message(), options.folder,
                                  "name a folder with write permission");
      const std::string path =
          (std::filesystem::path(options.folder) / ("growth_" + growth.id + ".svg")).string();
      if (auto ok = engine::writeFileAtomically(path, *svg); !ok) return tl::unexpected(ok.error());
      entry["picture"] = path;
    }
    report["growths"].push_back(std::move(entry));
  }
  return report;
}

void printBenchGrowth(const Report& report) {
  fmt::print("{}\none thread copies {:.1f} GB/s\n", report["machine"].get<std::string>(),
             report["copy_bytes_per_second"].get<double>() * 1e-9);
  for (const Report& growth : report["growths"]) {
    fmt::print("\n{}: {}; expected slope {}\n", growth["title"].get<std::string>(),
               growth["cost"].get<std::string>(), growth["expected"].get<std::string>());
    fmt::print("{:<20}{:>7}{:>8}  at {}: median (worst)\n", "", "slope", "target",
               growth["work"].get<std::string>());
    for (const Report& series : growth["series"]) {
      const Report& target = series["target"];
      fmt::print("{:<20}{:>7.2f}{:>8} ", series["name"].get<std::string>(), series["slope"].get<double>(),
                 target.is_null() ? std::string() : fmt::format("{:g}", target.get<double>()));
      for (const Report& p : series["points"])
        fmt::print(" {:.3g}: {:.3g} ({:.3g})", p["work"].get<double>(), p["median"].get<double>(),
                   p["worst"].get<double>());
      fmt::print("\n");
    }
  }
}

}  // namespace

void addBenchGrowth(Command bench, Chosen& chosen) {
  auto options = std::make_shared<BenchGrowthArguments>();
  Command command = addCommand(
      bench, chosen, "growth", "How costs grow with the field, the window, the brush and what changed",
      [options](engine::JobControl& job) { return measure(*options, job); }, printBenchGrowth);
  command.add({
      {.name = "--largest",
       .to = &options->bench.largest,
       .text = "Length of the sides of the largest field",
       .range = Range{256.0, 32768.0},
       .unit = "samples"},
      {.name = "--effort",
       .to = &options->bench.effort,
       .text = "Share of the full work",
       .range = Range{0.01, 1.0}},
      {.name = "--plots",
       .to = &options->folder,
       .text = "Folder for a picture of each",
       .kind = ValueKind::kFolder},
      {.name = "--no-picture",
       .to = [options] { options->bench.picture = false; },
       .text = "Omit uploads: no Vulkan device is needed"},
  });
}

}  // namespace fettle::app

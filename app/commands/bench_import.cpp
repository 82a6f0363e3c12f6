#include "app/commands/bench.h"

#include <memory>

#include <fmt/format.h>

#include "bench/import_bench.h"

namespace fettle::app {

namespace {

engine::Result<Report> measure(const bench::ImportBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchImport(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine}, {"repeats", options.repeats}, {"rows", Report::array()}};
  for (const bench::ImportBenchRow& row : measured->rows)
    report["rows"].push_back(
        {{"name", row.name},
         {"format", row.format},
         {"bytes", row.bytes},
         {"samples", row.samples},
         {"bytes_per_second", row.median},
         {"slowest", row.slowest},
         {"fastest", row.fastest},
         {"plain_bytes_per_second", row.plain},
         {"share_of_plain", row.median / row.plain},
         {"gdal_bytes_per_second", row.gdal > 0.0 ? Report(row.gdal) : Report()},
         {"share_of_gdal", row.gdal > 0.0 ? Report(row.median / row.gdal) : Report()},
         {"gdal_into_new_memory_bytes_per_second", row.gdal_new > 0.0 ? Report(row.gdal_new) : Report()},
         {"share_of_gdal_into_new_memory", row.gdal_new > 0.0 ? Report(row.median / row.gdal_new) : Report()},
         {"memory_bytes_per_second", row.memory},
         {"samples_per_second",
          row.median * static_cast<double>(row.samples) / static_cast<double>(row.bytes)},
         {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

void printBenchImport(const Report& report) {
  fmt::print(
      "{}\nmedian of {} imports; plain: the same file read into a buffer; GDAL: its samples read into a "
      "buffer\nby GDAL alone, the faster of two ways; new: into memory never used; memory: that of the "
      "field's "
      "tiles\nprovided alone; all in the same run\n\n",
      report["machine"].get<std::string>(), report["repeats"].get<int>());
  fmt::print("{:<26}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>12}  hash\n", "", "MB", "MB/s",
             "slowest", "fastest", "plain", "share", "GDAL", "share", "new", "share", "memory", "Msamples/s");
  const auto or_none = [](const Report& value, double factor, int digits) {
    return value.is_null() ? std::string("-") : fmt::format("{:.{}f}", value.get<double>() * factor, digits);
  };
  for (const Report& row : report["rows"])
    fmt::print(
        "{:<26}{:>9.2f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.0f}{:>9.4f}{:>9}{:>9}{:>9}{:>9}{:>9.0f}{:>12.2f}  {}\n",
        row["name"].get<std::string>(), row["bytes"].get<double>() * 1e-6,
        row["bytes_per_second"].get<double>() * 1e-6, row["slowest"].get<double>() * 1e-6,
        row["fastest"].get<double>() * 1e-6, row["plain_bytes_per_second"].get<double>() * 1e-6,
        row["share_of_plain"].get<double>(), or_none(row["gdal_bytes_per_second"], 1e-6, 1),
        or_none(row["share_of_gdal"], 1.0, 2), or_none(row["gdal_into_new_memory_bytes_per_second"], 1e-6, 1),
        or_none(row["share_of_gdal_into_new_memory"], 1.0, 2),
        row["memory_bytes_per_second"].get<double>() * 1e-6, row["samples_per_second"].get<double>() * 1e-6,
        row["hash"].get<std::string>());
}

}  // namespace

void addBenchImport(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::ImportBenchOptions>();
  Command command = addCommand(
      bench, chosen, "import", "Import time of each format, and of plain reading of the same file",
      [options](engine::JobControl& job) { return measure(*options, job); }, printBenchImport);
  command.add({
      {.name = "SCANS",
       .to = &options->files,
       .text = "Files to read",
       .kind = ValueKind::kInput,
       .otherwise = "one field written in every format"},
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side of that field; above 2048 GeoTIFF alone",
       .range = Range{16.0, 16384.0},
       .unit = "samples"},
      {.name = "--repeats",
       .to = &options->repeats,
       .text = "Imports of each file",
       .range = Range{1.0, 100.0}},
  });
}

}  // namespace fettle::app

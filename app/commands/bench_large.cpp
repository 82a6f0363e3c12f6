#include "app/commands/bench.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/scan_options.h"
#include "bench/large_bench.h"

namespace fettle::app {

namespace {

Report reportOf(const bench::LargeReport& measured) {
  Report report{{"machine", measured.machine},
                {"side", measured.side},
                {"samples", static_cast<std::int64_t>(measured.side) * measured.side},
                {"file_bytes", measured.file_bytes},
                {"saved_bytes", measured.saved_bytes},
                {"stored_bytes", measured.stored_bytes},
                {"copy_bytes_per_second", measured.copy_bytes_per_s},
                {"peak_bytes", measured.peak},
                {"stroke_tiles", measured.stroke_tiles},
                {"hash", fmt::format("{:016x}", measured.hash)},
                {"stages", Report::array()},
                {"ticks", Report::array()}};
  for (const bench::LargeStage& s : measured.stages)
    report["stages"].push_back(
        {{"name", s.name},
         {"seconds", s.seconds},
         {"samples_per_second", s.samples > 0.0 ? Report(s.samples / s.seconds) : Report()},
         {"plain", s.plain.empty() ? Report() : Report(s.plain)},
         {"plain_seconds", s.plain.empty() ? Report() : Report(s.plain_seconds)},
         {"resident_bytes", s.resident},
         {"peak_bytes", s.peak},
         {"own_bytes", s.own},
         {"disk_reads", s.disk_reads},
         {"note", s.note}});
  for (const bench::LargeTicks& t : measured.ticks)
    report["ticks"].push_back({{"name", t.name},
                               {"ticks", t.ticks},
                               {"tick_ns", t.ns},
                               {"small_tick_ns", t.small_ns},
                               {"of_small", t.ns / t.small_ns},
                               {"tick_p999_ns", t.p999_ns},
                               {"tick_worst_ns", t.worst_ns},
                               {"ticks_that_waited", t.waited}});
  const bench::LargeLoop& loop = measured.loop;
  report["live_loop"] = {{"ticks", loop.ticks},
                         {"contact_ticks", loop.contact_ticks},
                         {"ticks_not_near", loop.not_prefetched},
                         {"disk_waits", loop.disk_waits},
                         {"tiles_brought", loop.prefetched},
                         {"tiles_not_locked", loop.not_locked},
                         {"compute_p50_us", loop.compute_p50_us},
                         {"compute_p999_us", loop.compute_p999_us},
                         {"compute_worst_us", loop.compute_worst_us}};
  return report;
}

std::string shortTime(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.2f} us", 1e6 * seconds);
  if (seconds < 1.0) return fmt::format("{:.2f} ms", 1e3 * seconds);
  return fmt::format("{:.2f} s", seconds);
}

void printBenchLarge(const Report& report) {
  constexpr double kMb = 1e-6;
  fmt::print("{}\n{} x {} samples ({:.0f} million), a file of {:.0f} MB; one thread copies {:.1f} GB/s\n",
             report["machine"].get<std::string>(), report["side"].get<int>(), report["side"].get<int>(),
             1e-6 * report["samples"].get<double>(), kMb * report["file_bytes"].get<double>(),
             1e-9 * report["copy_bytes_per_second"].get<double>());
  if (report["stored_bytes"].get<std::uint64_t>() > 0)
    fmt::print("tiles in a store of {:.0f} MB on the disk\n", kMb * report["stored_bytes"].get<double>());
  fmt::print("\n{:<32}{:>12}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}  yardstick\n", "", "time", "Msample/s",
             "yardstick", "MB now", "peak", "no file", "faults");
  for (const Report& s : report["stages"]) {
    const Report& rate = s["samples_per_second"];
    fmt::print("{:<32}{:>12}{:>12}{:>12}{:>10.0f}{:>10.0f}{:>10.0f}{:>10}  {}{}{}\n",
               s["name"].get<std::string>(), shortTime(s["seconds"].get<double>()),
               rate.is_null() ? std::string("-") : fmt::format("{:.1f}", 1e-6 * rate.get<double>()),
               s["plain"].is_null() ? std::string("-") : shortTime(s["plain_seconds"].get<double>()),
               kMb * s["resident_bytes"].get<double>(), kMb * s["peak_bytes"].get<double>(),
               kMb * s["own_bytes"].get<double>(), s["disk_reads"].get<std::uint64_t>(),
               s["plain"].is_null() ? std::string() : s["plain"].get<std::string>(),
               s["plain"].is_null() || s["note"].get<std::string>().empty() ? "" : "; ",
               s["note"].get<std::string>());
  }
  fmt::print("\n{:<20}{:>10}{:>12}{:>14}{:>8}{:>12}{:>12}{:>10}\n", "", "ticks", "ns/tick", "on 1024^2",
             "ratio", "p99.9 ns", "worst us", "waited");
  for (const Report& t : report["ticks"])
    fmt::print("{:<20}{:>10}{:>12.1f}{:>14.1f}{:>8.2f}{:>12.0f}{:>12.1f}{:>10}\n",
               t["name"].get<std::string>(), t["ticks"].get<std::int64_t>(), t["tick_ns"].get<double>(),
               t["small_tick_ns"].get<double>(), t["of_small"].get<double>(), t["tick_p999_ns"].get<double>(),
               1e-3 * t["tick_worst_ns"].get<double>(), t["ticks_that_waited"].get<std::int64_t>());
  const Report& loop = report["live_loop"];
  fmt::print(
      "\nlive loop at 1 kHz: {} ticks, {} in contact, {} without contact because samples were on the disk;  "
      "waited for the disk {} times; {} tiles read, {} not locked; compute p50 {:.1f} us, p99.9 {:.1f} us, "
      "worst {:.1f} us\n",
      loop["ticks"].get<std::uint64_t>(), loop["contact_ticks"].get<std::uint64_t>(),
      loop["ticks_not_near"].get<std::uint64_t>(), loop["disk_waits"].get<std::uint64_t>(),
      loop["tiles_brought"].get<std::uint64_t>(), loop["tiles_not_locked"].get<std::uint64_t>(),
      loop["compute_p50_us"].get<double>(), loop["compute_p999_us"].get<double>(),
      loop["compute_worst_us"].get<double>());
  fmt::print("\nthe stroke changed {} tiles; saved {}; most memory {:.0f} MB\n",
             report["stroke_tiles"].get<std::int64_t>(), report["hash"].get<std::string>(),
             kMb * report["peak_bytes"].get<double>());
}

}  // namespace

void addBenchLarge(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::LargeOptions>();
  Command command = addCommand(
      bench, chosen, "large",
      "The whole work on a very large scan: open, feel, edit, filter, undo, draw, save",
      [options](engine::JobControl& job) -> engine::Result<Report> {
        const auto measured = bench::benchLarge(*options, job);
        if (!measured) return tl::unexpected(measured.error());
        return reportOf(*measured);
      },
      printBenchLarge);
  command.add({
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side of the scan",
       .range = Range{256.0, 131072.0},
       .unit = "samples"},
      {.name = "--folder",
       .to = &options->folder,
       .text = "Folder for its files",
       .kind = ValueKind::kFolder,
       .otherwise = "the temporary folder"},
      {.name = "--effort", .to = &options->effort, .text = "Share of the ticks", .range = Range{0.01, 1.0}},
      {.name = "--no-picture",
       .to = [options] { options->picture = false; },
       .text = "Omit drawing: no Vulkan device is needed"},
  });
  addStoreOption(command);
}

}  // namespace fettle::app

#include "app/commands/bench.h"

#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "app/commands/typed_values.h"
#include "bench/effects_bench.h"
#include "bench/haptic_bench.h"
#include "bench/machine.h"
#include "bench/render_bench.h"
#include "bench/stiffness_sweep.h"
#include "haptic/loop/loop_bench.h"

namespace fettle::app {

namespace {

// Of a picture: what a device may be asked to draw as one.
constexpr SideRange kBenchSides{64, 16384};

engine::Result<Report> haptic(const bench::HapticBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchHaptic(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"copy_bytes_per_second", measured->copy_bytes_per_s},
                {"side", options.side},
                {"repeats", options.repeats},
                {"rows", Report::array()}};
  for (const bench::HapticBenchRow& row : measured->rows)
    report["rows"].push_back({{"ground", row.ground},
                              {"name", row.name},
                              {"speed_mm_s", row.speed_mm_s},
                              {"ticks", row.ticks},
                              {"contact_ticks", row.contact_ticks},
                              {"ticks_per_second", row.median},
                              {"slowest", row.slowest},
                              {"fastest", row.fastest},
                              {"tick_p50_ns", row.p50_ns},
                              {"tick_p99_ns", row.p99_ns},
                              {"tick_p999_ns", row.p999_ns},
                              {"tick_p9999_ns", row.p9999_ns},
                              {"tick_worst_ns", row.worst_ns},
                              {"cells_per_contact", row.cells},
                              {"newton_cells_per_contact", row.newton_cells},
                              {"bytes_per_contact", row.bytes},
                              {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

void printHaptic(const Report& report) {
  fmt::print("{}\n{} x {} samples, median of {} runs; one thread copies {:.1f} GB/s\n\n",
             report["machine"].get<std::string>(), report["side"].get<int>(), report["side"].get<int>(),
             report["repeats"].get<int>(), report["copy_bytes_per_second"].get<double>() * 1e-9);
  fmt::print("{:<34}{:>6}{:>9}{:>11}{:>9}{:>9}{:>8}{:>8}{:>9}{:>10}{:>10}  hash\n", "", "mm/s", "ticks",
             "M ticks/s", "slowest", "fastest", "p50 ns", "p99 ns", "p99.9 ns", "p99.99 ns", "worst ns");
  std::string ground;
  for (const Report& row : report["rows"]) {
    if (ground != row["ground"]) fmt::print("{}\n", ground = row["ground"]);
    fmt::print("  {:<32}{:>6.0f}{:>9}{:>11.3f}{:>9.3f}{:>9.3f}", row["name"].get<std::string>(),
               row["speed_mm_s"].get<double>(), row["ticks"].get<std::int64_t>(),
               row["ticks_per_second"].get<double>() * 1e-6, row["slowest"].get<double>() * 1e-6,
               row["fastest"].get<double>() * 1e-6);
    if (row["tick_worst_ns"] > 0.0)
      fmt::print("{:>8.0f}{:>8.0f}{:>9.0f}{:>10.0f}{:>10.0f}", row["tick_p50_ns"].get<double>(),
                 row["tick_p99_ns"].get<double>(), row["tick_p999_ns"].get<double>(),
                 row["tick_p9999_ns"].get<double>(), row["tick_worst_ns"].get<double>());
    else
      fmt::print("{:45}", "");
    fmt::print("  {}\n", row["hash"].get<std::string>());
    if (row["cells_per_contact"] > 0.0)
      fmt::print("    of a contact: {:.2f} cells, {:.2f} of them by Newton's method, {:.0f} bytes\n",
                 row["cells_per_contact"].get<double>(), row["newton_cells_per_contact"].get<double>(),
                 row["bytes_per_contact"].get<double>());
  }
}

engine::Result<Report> effects(const bench::EffectsBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchEffects(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"side", options.side},
                {"ticks", options.ticks},
                {"repeats", options.repeats},
                {"instructions_counted_by", bench::countedByName(measured->counted_by)},
                {"rows", Report::array()}};
  for (const bench::EffectsBenchRow& row : measured->rows)
    report["rows"].push_back(
        {{"name", row.name},
         {"ns_per_tick", row.median_ns},
         {"fastest_ns", row.fastest_ns},
         {"worst_ns", row.worst_ns},
         {"instructions_per_tick", row.instructions ? Report(*row.instructions) : Report()},
         {"bytes", row.bytes},
         {"contact_ticks", row.contact_ticks},
         {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

void printEffects(const Report& report) {
  fmt::print("{}\n{} x {} samples, {} ticks, median of {} runs, along the rows; instructions: {}\n\n",
             report["machine"].get<std::string>(), report["side"].get<int>(), report["side"].get<int>(),
             report["ticks"].get<std::int64_t>(), report["repeats"].get<int>(),
             report["instructions_counted_by"].get<std::string>());
  fmt::print("{:<22}{:>11}{:>11}{:>11}{:>15}{:>12}{:>11}  hash\n", "", "ns/tick", "fastest", "worst",
             "instructions", "bytes", "contact");
  for (const Report& row : report["rows"]) {
    const Report& instructions = row["instructions_per_tick"];
    fmt::print("{:<22}{:>11.1f}{:>11.1f}{:>11.1f}{:>15}{:>12}{:>11}  {}\n", row["name"].get<std::string>(),
               row["ns_per_tick"].get<double>(), row["fastest_ns"].get<double>(),
               row["worst_ns"].get<double>(),
               instructions.is_null() ? std::string("not available")
                                      : fmt::format("{:.0f}", instructions.get<double>()),
               row["bytes"].get<std::int64_t>(), row["contact_ticks"].get<std::int64_t>(),
               row["hash"].get<std::string>());
  }
}

Report rowOf(const haptic::LoopBenchRow& row) {
  return {{"name", row.name},
          {"lateness_p50_us", haptic::microseconds(row.lateness.p50_ns)},
          {"lateness_p99_us", haptic::microseconds(row.lateness.p99_ns)},
          {"lateness_p999_us", haptic::microseconds(row.lateness.p999_ns)},
          {"lateness_p9999_us", haptic::microseconds(row.lateness.p9999_ns)},
          {"lateness_worst_us", haptic::microseconds(row.lateness.worst_ns)},
          {"compute_p50_us", haptic::microseconds(row.compute.p50_ns)},
          {"compute_p999_us", haptic::microseconds(row.compute.p999_ns)},
          {"compute_worst_us", haptic::microseconds(row.compute.worst_ns)},
          {"missed", row.missed},
          {"over_1_ms", row.over_1_ms},
          {"latency_held", row.latency_held},
          {"not_granted", row.missing}};
}

engine::Result<Report> loop(const haptic::LoopBenchOptions& options, engine::JobControl& job) {
  const auto measured = haptic::benchLoop(options, job);
  if (!measured) return tl::unexpected(measured.error());
  const bool has_cyclictest = measured->no_cyclictest.empty();
  const std::optional<haptic::RatioIntervals>& within = measured->within;
  Report reference = rowOf(measured->reference);
  if (has_cyclictest) reference["missed"] = nullptr;  // it does not count them
  return Report{{"machine", measured->machine},
                {"seconds", measured->seconds},
                {"rate_hz", measured->rate_hz},
                {"load", measured->load == haptic::BenchLoad::kBusy ? "busy" : "idle"},
                {"reference", measured->reference.name},
                {"p99_ratio", measured->p99_ratio},
                {"p99_ratio_low", within ? Report(within->p99.low) : Report()},
                {"p99_ratio_high", within ? Report(within->p99.high) : Report()},
                {"p999_ratio", measured->p999_ratio},
                {"p999_ratio_low", within ? Report(within->p999.low) : Report()},
                {"p999_ratio_high", within ? Report(within->p999.high) : Report()},
                {"refused_edits", measured->refused_edits},
                {"device", options.device.empty() ? Report() : Report(options.device)},
                {"device_inputs", measured->device_inputs},
                {"cyclictest", has_cyclictest ? reference : Report()},
                {"no_cyclictest", has_cyclictest ? Report() : Report(measured->no_cyclictest)},
                {"rows", {rowOf(measured->loop), reference}}};
}

void printLoop(const Report& report) {
  fmt::print("{}\n{:.0f} s at {:.0f} Hz, {}\n\n", report["machine"].get<std::string>(),
             report["seconds"].get<double>(), report["rate_hz"].get<double>(),
             report["load"].get<std::string>());
  fmt::print("{:<28}{:>10}{:>10}{:>10}{:>10}{:>10}{:>9}{:>11}\n", "lateness, us", "p50", "p99", "p99.9",
             "p99.99", "worst", "missed", "over 1 ms");
  for (const Report& row : report["rows"])
    fmt::print("{:<28}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>9}{:>11}\n",
               row["name"].get<std::string>(), row["lateness_p50_us"].get<double>(),
               row["lateness_p99_us"].get<double>(), row["lateness_p999_us"].get<double>(),
               row["lateness_p9999_us"].get<double>(), row["lateness_worst_us"].get<double>(),
               row["missed"].is_null() ? "-" : row["missed"].dump(), row["over_1_ms"].get<std::uint64_t>());
  for (const Report& row : report["rows"])
    for (const Report& missing : row["not_granted"])
      fmt::print("{}: {}\n", row["name"].get<std::string>(), missing.get<std::string>());
  for (const Report& row : report["rows"])
    fmt::print("{}: processor {} (/dev/cpu_dma_latency)\n", row["name"].get<std::string>(),
               row["latency_held"].get<bool>() ? "kept from deep sleep" : "free to sleep deeply");
  if (!report["no_cyclictest"].is_null()) fmt::print("{}\n", report["no_cyclictest"].get<std::string>());
  const auto ratio = [&](const std::string& of) {
    std::string value = fmt::format("{:.2f}", report[of].get<double>());
    if (report[of + "_low"].is_null()) return value;
    return fmt::format("{} ({:.2f} to {:.2f})", value, report[of + "_low"].get<double>(),
                       report[of + "_high"].get<double>());
  };
  fmt::print("\nhaptic loop over {}: p99 {}, p99.9 {}; target 1.20\n", report["reference"].get<std::string>(),
             ratio("p99_ratio"), ratio("p999_ratio"));
  if (!report["p99_ratio_low"].is_null())
    fmt::print("in brackets: the 95 % confidence interval (block bootstrap)\n");
}

engine::Result<Report> stability(const bench::StiffnessSweepOptions& options, engine::JobControl& job) {
  const auto rows = bench::stiffnessSweep(options, job);
  if (!rows) return tl::unexpected(rows.error());
  Report report{{"mass_kg", options.mass_kg}, {"press_n", options.press_n}, {"rows", Report::array()}};
  for (const bench::StiffnessRow& row : *rows)
    report["rows"].push_back({{"rate_hz", row.rate_hz},
                              {"damping_n_s_per_mm", row.damping_n_s_per_mm},
                              {"theory_n_per_mm", row.theory_n_per_mm},
                              {"exact_n_per_mm", row.exact_n_per_mm},
                              {"measured_n_per_mm", row.measured_n_per_mm},
                              {"ratio", row.ratio}});
  return report;
}

void printStability(const Report& report) {
  fmt::print("largest stiffness [N/mm] that is stable: {} kg pressed with {} N\n\n",
             report["mass_kg"].get<double>(), report["press_n"].get<double>());
  fmt::print("{:>8}{:>12}{:>12}{:>12}{:>12}{:>18}\n", "Hz", "b, N s/mm", "2 b / T", "simulated", "measured",
             "measured/theory");
  for (const Report& row : report["rows"])
    fmt::print("{:>8.0f}{:>12.4f}{:>12.3f}{:>12.3f}{:>12.3f}{:>18.3f}\n", row["rate_hz"].get<double>(),
               row["damping_n_s_per_mm"].get<double>(), row["theory_n_per_mm"].get<double>(),
               row["exact_n_per_mm"].get<double>(), row["measured_n_per_mm"].get<double>(),
               row["ratio"].get<double>());
}

engine::Result<Report> picture(const bench::RenderBenchOptions& options, engine::JobControl& job) {
  const auto result = bench::benchRender(options, job);
  if (!result) return tl::unexpected(result.error());
  Report report{{"machine", result->machine},       {"device", result->device},
                {"width", options.width},           {"height", options.height},
                {"first_ms", result->first_ms},     {"rest_ms", result->rest_ms},
                {"peak_bytes", result->peak_bytes}, {"rows", Report::array()}};
  for (const bench::RenderBenchRow& row : result->rows)
    report["rows"].push_back({{"name", row.name},
                              {"samples", row.samples},
                              {"p50_ms", row.p50_ms},
                              {"p99_ms", row.p99_ms},
                              {"worst_ms", row.worst_ms},
                              {"cpu_ms", row.cpu_ms},
                              {"vertices", row.vertices},
                              {"triangles", row.triangles},
                              {"bound_px", row.bound_px},
                              {"of_plain", row.of_plain},
                              {"redrawn", row.redrawn},
                              {"edit_p50_ms", row.edit_p50_ms},
                              {"edit_p99_ms", row.edit_p99_ms},
                              {"tiles", row.tiles},
                              {"bytes", row.bytes},
                              {"upload_ms", row.upload_ms},
                              {"upload_ratio", row.upload_ratio},
                              {"off_mean", row.off_mean},
                              {"off_max", row.off_max},
                              {"off_share", row.off_share},
                              {"stalls", row.stalls},
                              {"hash", fmt::format("{:016x}", row.hash)}});
  if (result->loop.ran)
    report["with_loop"] = {{"frame_p50_ms", result->loop.frame_p50_ms},
                           {"frame_p99_ms", result->loop.frame_p99_ms},
                           {"late_p50_us", result->loop.late_p50_us},
                           {"late_p99_us", result->loop.late_p99_us},
                           {"late_p999_us", result->loop.late_p999_us}};
  report["targets"] = Report::array();
  for (const bench::RenderTarget& t : result->targets)
    report["targets"].push_back(
        {{"name", t.name}, {"value", t.value}, {"limit", t.limit}, {"met", t.value <= t.limit}});
  return report;
}

void printPicture(const Report& report) {
  fmt::print("{}\n{}\n\n{:<14}{:>8}{:>8}{:>8}{:>8}{:>8}{:>7}{:>9}{:>7}{:>8}{:>9}{:>9}{:>7}{:>9}{:>7}  {}\n",
             report["machine"].get<std::string>(), report["device"].get<std::string>(), "", "Msample",
             "p50 ms", "p99 ms", "worst", "cpu ms", "plain", "vertices", "bound", "redrawn", "edit p50",
             "edit p99", "tiles", "bytes", "ratio", "hash");
  for (const Report& row : report["rows"])
    fmt::print(
        "{:<14}{:>8.1f}{:>8.2f}{:>8.2f}{:>8.2f}{:>8.2f}{:>7.2f}{:>9}{:>7.2f}{:>8.3f}{:>9.2f}{:>9.2f}{:>7}{:>"
        "9}{:>7.3f}  "
        "{}\n",
        row["name"].get<std::string>(), row["samples"].get<double>() / 1e6, row["p50_ms"].get<double>(),
        row["p99_ms"].get<double>(), row["worst_ms"].get<double>(), row["cpu_ms"].get<double>(),
        row["of_plain"].get<double>(), row["vertices"].get<std::int64_t>(), row["bound_px"].get<double>(),
        row["redrawn"].get<double>(), row["edit_p50_ms"].get<double>(), row["edit_p99_ms"].get<double>(),
        row["tiles"].get<std::int64_t>(), row["bytes"].get<std::int64_t>(), row["upload_ratio"].get<double>(),
        row["hash"].get<std::string>());
  for (std::size_t i = 0; i < report["first_ms"].size(); ++i)
    fmt::print("field {}: first picture {:.0f} ms, at rest {:.0f} ms\n", i + 1,
               report["first_ms"][i].get<double>(), report["rest_ms"][i].get<double>());
  fmt::print("peak resident memory {} MiB\n", report["peak_bytes"].get<std::int64_t>() >> 20);
  for (const Report& row : report["rows"])
    if (row["off_max"].get<double>() > 0.0)
      fmt::print(
          "\n{}, {:.1f}M: off the sharp picture by {:.2f} codes in the mean, {:.0f} at most; {:.2f} % of the "
          "pixels by more than 16",
          row["name"].get<std::string>(), row["samples"].get<double>() / 1e6, row["off_mean"].get<double>(),
          row["off_max"].get<double>(), 1e2 * row["off_share"].get<double>());
  fmt::print("\n");
  if (report.contains("with_loop")) {
    const Report& loop = report["with_loop"];
    fmt::print(
        "\nwith a loop at 1 kHz: frames p50 {:.2f} ms, p99 {:.2f} ms; the loop late p50 {:.0f} us, p99 "
        "{:.0f} us, p99.9 {:.0f} us\n",
        loop["frame_p50_ms"].get<double>(), loop["frame_p99_ms"].get<double>(),
        loop["late_p50_us"].get<double>(), loop["late_p99_us"].get<double>(),
        loop["late_p999_us"].get<double>());
  }
  fmt::print("\n");
  for (const Report& t : report["targets"])
    fmt::print("{:<42}{:>9.2f}  target {:>6.2f}  {}\n", t["name"].get<std::string>(),
               t["value"].get<double>(), t["limit"].get<double>(), t["met"].get<bool>() ? "met" : "MISSED");
}

}  // namespace

void addBench(Command root, Chosen& chosen) {
  Command bench = root.subcommand("bench", "Benchmarks: median, spread, worst, machine, hash of the result");
  bench.requireSubcommand();

  constexpr Range kSides{64.0, 32768.0};
  constexpr Range kRepeats{1.0, 100.0};
  auto haptic_options = std::make_shared<bench::HapticBenchOptions>();
  Command ticks = addCommand(
      bench, chosen, "haptic", "Ticks per second of contact, force and local smoothing",
      [haptic_options](engine::JobControl& job) { return haptic(*haptic_options, job); }, printHaptic);
  ticks.add({
      {.name = "--side",
       .to = &haptic_options->side,
       .text = "Length of each side of the field",
       .range = kSides,
       .unit = "samples"},
      {.name = "--ticks",
       .to = &haptic_options->ticks,
       .text = "Ticks of each run",
       .range = Range{10.0, 1e8}},
      {.name = "--repeats", .to = &haptic_options->repeats, .text = "Runs of each row", .range = kRepeats},
      {.name = "--speed",
       .to = &haptic_options->speeds_mm_s,
       .text = "Speeds of the hand",
       .unit = "mm/s",
       .between = ','},
  });

  auto effects_options = std::make_shared<bench::EffectsBenchOptions>();
  Command prices = addCommand(
      bench, chosen, "effects", "What each effect of a scene costs per tick, and the memory that it takes",
      [effects_options](engine::JobControl& job) { return effects(*effects_options, job); }, printEffects);
  prices.add({
      {.name = "--side",
       .to = &effects_options->side,
       .text = "Length of each side of the field",
       .range = kSides,
       .unit = "samples"},
      {.name = "--ticks",
       .to = &effects_options->ticks,
       .text = "Ticks of each run",
       .range = Range{1000.0, 1e8}},
      {.name = "--repeats", .to = &effects_options->repeats, .text = "Runs of each row", .range = kRepeats},
  });

  auto loop_options = std::make_shared<haptic::LoopBenchOptions>();
  auto busy = std::make_shared<bool>(false);
  Command lateness = addCommand(
      bench, chosen, "loop", "Lateness of the live loop and of cyclictest in the same run",
      [loop_options, busy](engine::JobControl& job) {
        haptic::LoopBenchOptions options = *loop_options;
        options.load = *busy ? haptic::BenchLoad::kBusy : haptic::BenchLoad::kIdle;
        return loop(options, job);
      },
      printLoop);
  lateness.add({
      {.name = "--seconds",
       .to = &loop_options->seconds,
       .text = "Time of measuring",
       .range = Range{0.0, 3600.0},
       .unit = "seconds"},
      {.name = "--rate",
       .to = &loop_options->rate_hz,
       .text = "Rate of the loop",
       .range = Range{1000.0, 10000.0},
       .unit = "ticks per second"},
      {.name = "--device",
       .to = &loop_options->device,
       .text = "Drive this device instead of a simulated hand, unarmed: its forces stay zero"},
      {.name = "--busy", .to = busy.get(), .text = "Keep every core busy with other processes"},
  });

  auto sweep_options = std::make_shared<bench::StiffnessSweepOptions>();
  Command sweep = addCommand(
      bench, chosen, "stability", "Stiffness at which a wall becomes unstable, against b > K T / 2",
      [sweep_options](engine::JobControl& job) { return stability(*sweep_options, job); }, printStability);
  sweep.add({
      {.name = "--damping",
       .to = &sweep_options->damping_n_s_per_mm,
       .text = "Damping of the device",
       .unit = "N s/mm"},
      {.name = "--mass", .to = &sweep_options->mass_kg, .text = "Moving mass", .unit = "kg"},
      {.name = "--press", .to = &sweep_options->press_n, .text = "Constant press", .unit = "newtons"},
      {.name = "--rates",
       .to = &sweep_options->rates_hz,
       .text = "Rates, one row each",
       .unit = "ticks per second"},
  });

  addBenchGrowth(bench, chosen);
  addBenchLarge(bench, chosen);
  addBenchImport(bench, chosen);
  addBenchFilters(bench, chosen);
  addBenchEstimate(bench, chosen);
  addBenchFill(bench, chosen);
  addBenchMeasure(bench, chosen);
  addBenchPreviews(bench, chosen);

  auto render_options = std::make_shared<bench::RenderBenchOptions>();
  auto size =
      std::make_shared<std::string>(fmt::format("{}x{}", render_options->width, render_options->height));
  Command drawing = addCommand(
      bench, chosen, "render", "Frames of a field that changes: time, vertices, screen error, uploads",
      [render_options, size](engine::JobControl& job) -> engine::Result<Report> {
        const auto sides = parseSize(*size, "--size", kBenchSides);
        if (!sides) return tl::unexpected(sides.error());
        std::tie(render_options->width, render_options->height) = *sides;
        return picture(*render_options, job);
      },
      printPicture);
  drawing.add({
      {.name = "--side",
       .to = &render_options->sides,
       .text = "Lengths of each side, one field each; 10240: 100M, 31623: 1G",
       .range = kSides,
       .unit = "samples"},
      {.name = "--size",
       .to = size.get(),
       .text = "Size of the picture, each side 64 to 16384",
       .kind = ValueKind::kSize,
       .unit = "pixels"},
      {.name = "--loop",
       .to = &render_options->loop_seconds,
       .text = "Time of drawing with a haptic loop; 0: none",
       .range = Range{0.0, 600.0},
       .unit = "seconds"},
      {.name = "--scene",
       .to = &render_options->scenes,
       .text = "Rows to measure, by name",
       .otherwise = "all"},
      {.name = "--sharp",
       .to = [render_options] { render_options->in_motion = render::Sharpness::kFull; },
       .text = "Draw every pixel while the camera moves, too"},
      {.name = "--frames",
       .to = &render_options->frames,
       .text = "Frames of each row",
       .range = Range{10.0, 100000.0}},
      {.name = "--error",
       .to = &render_options->error_px,
       .text = "Requested screen error",
       .unit = "pixels"},
      {.name = "--vertices", .to = &render_options->vertex_budget, .text = "Most vertices per frame"},
      {.name = "--device-memory",
       .to = &render_options->memory_budget_bytes,
       .text = "Memory that samples may take on the device, the rest is loaded on demand",
       .unit = "bytes",
       .otherwise = "half of its memory"},
  });
}

}  // namespace fettle::app

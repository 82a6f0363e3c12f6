// session_figures [SIDE] [SCAN...]: what a session costs, in numbers. Not a test; ninja session_figures.
// For a simulated scan of SIDE x SIDE samples (4096) and for each SCAN: save, open, size against the TIFF;
// for the first also the commit of strokes of 20 tiles and of a filter of the whole field, with both
// durabilities.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"

using namespace fettle::engine;

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Waves, steps and noise of 1e-3 of their height: what a laser scanner gives of a machined part, roughly.
Version simulatedScan(int side) {
  Grid grid;
  grid.width = grid.height = side;
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0F, 0.005F);
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "figures");
  std::vector<float> row(static_cast<std::size_t>(side));
  for (int r = 0; r < side; ++r) {
    for (int c = 0; c < side; ++c)
      row[static_cast<std::size_t>(c)] =
          5.0F * std::sin(static_cast<float>(c) * 0.004F) + (r / 500 % 2 == 0 ? 0.0F : 4.0F) + noise(random);
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return std::move(*builder).build();
}

std::string spread(std::vector<double> seconds) {
  std::ranges::sort(seconds);
  return fmt::format("median {:.1f} ms, p90 {:.1f} ms, worst {:.1f} ms", seconds[seconds.size() / 2] * 1e3,
                     seconds[seconds.size() * 9 / 10] * 1e3, seconds.back() * 1e3);
}

[[noreturn]] void fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.line());
  std::exit(1);
}

Session sessionOf(const Version& field) {
  Session session;
  session.original = field;
  session.history = History(field);
  return session;
}

void sizes(const std::string& name, const Version& field, const fs::path& folder) {
  JobControl job;
  const double mb = static_cast<double>(field.grid().samples()) * 4e-6;
  const std::string path = (folder / "sizes.fettle").string();
  const std::string tiff = (folder / "sizes.tif").string();
  auto start = Clock::now();
  const auto saved = saveSession(sessionOf(field), path, job);
  if (!saved) fail(saved.error());
  const double save_s = since(start);
  ExportOptions packed;
  packed.tiff_compression = TiffCompression::kDeflate;
  if (const auto exported = exportField(field, tiff, packed, job); !exported) fail(exported.error());
  std::vector<double> opens;
  for (int k = 0; k < 5; ++k) {
    start = Clock::now();
    const auto session = openSession(path, {}, importField, job);
    if (!session) fail(session.error());
    opens.push_back(since(start));
  }
  std::ranges::sort(opens);
  start = Clock::now();
  if (const auto imported = importField(tiff, {}, job); !imported) fail(imported.error());
  const double import_s = since(start);
  const auto tiff_bytes = static_cast<double>(fs::file_size(tiff));
  fmt::print("{}: {} x {}, {:.1f} MB of samples\n", name, field.grid().width, field.grid().height, mb);
  fmt::print(
      "  save {:.0f} ms = {:.0f} MB/s; open median {:.0f} ms = {:.0f} MB/s (import of the TIFF {:.0f} ms)\n",
      save_s * 1e3, mb / save_s, opens[2] * 1e3, mb / opens[2], import_s * 1e3);
  fmt::print("  session {:.2f} MB = {:.2f} of the samples, {:.2f} of the TIFF ({:.2f} MB)\n",
             static_cast<double>(saved->file_bytes) * 1e-6,
             static_cast<double>(saved->file_bytes) * 1e-6 / mb,
             static_cast<double>(saved->file_bytes) / tiff_bytes, tiff_bytes * 1e-6);
}

void commits(const Version& field, Durability durability, const fs::path& folder) {
  JobControl job;
  const std::string path = (folder / "commits.fettle").string();
  Session session = sessionOf(field);
  SessionWriterOptions options;
  options.durability = durability;
  auto writer = SessionWriter::create(session, path, options, job);
  if (!writer) fail(writer.error());
  const int tiles = field.reader().tileColumns();
  std::vector<double> seconds;
  std::vector<double> calls;
  std::vector<double> bytes;
  for (int k = 0; k < 60; ++k) {
    LiveField live(session.history.current(), Growth::kAllowed);
    std::vector<float> z(64 * 9);
    const int row = k % tiles * kTileSide + 20;
    for (int t = 0; t < std::min(20, tiles); ++t) {  // a band of 9 rows through 20 tiles
      live.reader().readHeights(t * kTileSide, row, 64, 9, z.data(), 64);
      for (float& value : z) value = value * 0.5F + 0.1F;
      if (!live.writeHeights(t * kTileSide, row, 64, 9, z.data(), 64)) std::abort();
    }
    session.history.push({"stroke", StepKind::kStroke, stepTimeNow(), {}, 0}, live.snapshot());
    Step step = session.history.step(session.history.number());
    const auto start = Clock::now();
    (*writer)->commit(session.history.number(), std::move(step), {});
    calls.push_back(since(start));
    if (Status status = (*writer)->flush(job); !status) fail(status.error());
    seconds.push_back((*writer)->status().last_commit_s);
    bytes.push_back(static_cast<double>((*writer)->status().last_commit_bytes));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::ranges::sort(calls);
  fmt::print("  stroke of 20 tiles, {}: {}; {:.0f} kB of tiles; the call itself worst {:.0f} us\n",
             durability == Durability::kPowerFailure ? "synchronous=FULL" : "synchronous=NORMAL",
             spread(seconds), bytes[30] * 1e-3, calls.back() * 1e6);

  LiveField live(session.history.current(), Growth::kAllowed);
  const int side = field.grid().width;
  std::vector<float> z(static_cast<std::size_t>(side));
  for (int r = 0; r < side; ++r) {
    live.reader().readHeights(0, r, side, 1, z.data(), side);
    for (float& value : z) value *= 0.999F;
    if (!live.writeHeights(0, r, side, 1, z.data(), side)) std::abort();
  }
  session.history.push({"filter", StepKind::kFilter, stepTimeNow(), {}, 0}, live.snapshot());
  (*writer)->commit(session.history.number(), session.history.step(session.history.number()), {});
  if (Status status = (*writer)->flush(job); !status) fail(status.error());
  const double s = (*writer)->status().last_commit_s;
  fmt::print("  filter of every sample: {:.0f} ms = {:.0f} MB/s of samples\n", s * 1e3,
             static_cast<double>(field.grid().samples()) * 4e-6 / s);
  if (Status status = (*writer)->close(job); !status) fail(status.error());
  const auto start = Clock::now();
  const auto back = openSession(path, {}, importField, job);
  if (!back) fail(back.error());
  fmt::print("  open with 61 steps of history ({:.1f} MB file): {:.0f} ms\n",
             static_cast<double>(fs::file_size(path)) * 1e-6, since(start) * 1e3);
}

}  // namespace

int main(int count, char** arguments) {
  const int side = count > 1 ? std::atoi(arguments[1]) : 4096;
  std::string name = (fs::temp_directory_path() / "fettle-figures-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) return 1;
  const Version field = simulatedScan(side);
  sizes("simulated scan", field, name);
  commits(field, Durability::kPowerFailure, name);
  commits(field, Durability::kProgramDeath, name);
  for (int k = 2; k < count; ++k) {
    JobControl job;
    const auto scan = importField(arguments[k], {}, job);
    if (!scan) fail(scan.error());
    sizes(fs::path(arguments[k]).filename().string(), scan->field, name);
  }
  fs::remove_all(name);
}

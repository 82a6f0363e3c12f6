#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "engine/base/statistics.h"
#include "engine/field/tile.h"

namespace fettle::bench {
namespace {

// A height rounded to 16 bits of the range [low, high].
double sixteen(double z, double low, double high) {
  if (!(high > low)) return low;
  return low + std::round((z - low) / (high - low) * 65535.0) / 65535.0 * (high - low);
}

// Nearest IEEE half-precision number, of the normal ones and zero.
double half(double z) {
  if (z == 0.0) return 0.0;
  int exponent = 0;
  (void)std::frexp(z, &exponent);
  const double unit = std::ldexp(1.0, std::max(exponent, -13) - 11);
  return std::round(z / unit) * unit;
}

}  // namespace

engine::Result<Study> uploadStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"upload",
              "Upload: bits per sample for the picture",
              "Would 16 bits per sample be enough?",
              {"bytes per sample", "B"},
              {"mean height error", "um"}};
  const auto scans = partAndScan("milled part", options, job);
  if (!scans) return tl::unexpected(scans.error());
  job.begin("bits per sample", scans->size());
  constexpr double kTileBytes = engine::kTileSide * engine::kTileSide;
  for (const StudiedScan& subject : *scans) {
    if (job.cancelled()) return engine::cancelled();
    const engine::FieldReader reader = subject.field.reader();
    const double um = 1000.0 * reader.grid().height_unit.mm;
    const engine::HeightBounds all = reader.bounds();
    std::vector<double> whole, tiled, halves, floats;
    std::vector<float> line(engine::kTileSide * engine::kTileSide);
    for (std::int32_t r = 0; r < reader.height(); r += engine::kTileSide)
      for (std::int32_t c = 0; c < reader.width(); c += engine::kTileSide) {
        const std::int32_t w = std::min(engine::kTileSide, reader.width() - c);
        const std::int32_t h = std::min(engine::kTileSide, reader.height() - r);
        reader.readHeights(c, r, w, h, line.data(), w);
        double low = std::numeric_limits<double>::infinity(), high = -low;
        const auto count = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
        for (std::size_t i = 0; i < count; ++i)
          if (!std::isnan(line[i])) {
            low = std::min<double>(low, line[i]);
            high = std::max<double>(high, line[i]);
          }
        for (std::size_t i = 0; i < count; ++i) {
          if (std::isnan(line[i])) continue;
          const double z = line[i];
          floats.push_back(0.0);
          whole.push_back(um * std::abs(sixteen(z, all.min, all.max) - z));
          tiled.push_back(um * std::abs(sixteen(z, low, high) - z));
          halves.push_back(um * std::abs(half(z - all.min) - (z - all.min)));
        }
      }
    const auto add = [&](const char* method, double bytes, std::vector<double>& errors) {
      AccuracyRow row{subject.name, method};
      row.cost = row.cost_worst = bytes;
      row.hash = engine::hashOf(errors);
      row.wrong = std::numeric_limits<double>::quiet_NaN();
      summarise(std::move(errors), row);
      study.rows.push_back(std::move(row));
    };
    add("32-bit float (used)", 4.0, floats);
    add("16 bits over the whole field's range", 2.0, whole);
    add("16 bits over each tile's range", 2.0 + 8.0 / kTileBytes, tiled);
    add("half float from the lowest sample", 2.0, halves);
    job.advance();
  }
  study.reference = "The field's own 32-bit floats. Nothing is timed: bytes moved are the cost.";
  const AccuracyRow& tiled = rowOf(study, "milled part", "16 bits over each tile's range");
  const AccuracyRow& whole = rowOf(study, "milled part", "16 bits over the whole field's range");
  study.answer = fmt::format(
      "16 bits over each tile's range would move half the bytes and be off by {:.3f} um at worst, over the "
      "whole field's range {:.3f} um. Fettle uploads floats, so that what is seen is what is stored; where "
      "memory is short this is what 16 bits would cost.",
      tiled.error_worst, whole.error_worst);
  return study;
}

}  // namespace fettle::bench

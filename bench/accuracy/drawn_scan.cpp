#include "bench/accuracy/drawn_scan.h"

#include <utility>

#include <glm/geometric.hpp>

#include "haptic/operator/hand_lines.h"

namespace fettle::bench {

ScanSizes scanSizes(double effort) {
  if (effort >= 0.5) return {5, 3, 1024};
  if (effort >= 0.05) return {2, 1, 1024};
  return {1, 1, 512};
}

engine::Result<engine::SimulatedScan> scanOf(const PartSubject& subject, std::int32_t side, int seed) {
  engine::ScannerSpec scanner;
  scanner.part = subject.part;
  scanner.width = scanner.height = side;
  scanner.noise = subject.noise;
  scanner.outliers = subject.outliers;
  scanner.spot = subject.spot;
  scanner.seed = static_cast<std::uint64_t>(seed);
  // Not the caller's job: its progress counts runs, not samples.
  engine::JobControl quiet;
  return engine::simulateScan(scanner, quiet);
}

engine::Result<std::vector<StudiedScan>> partAndScan(const char* name, const AccuracyOptions& options,
                                                     engine::JobControl& job) {
  engine::ScannerSpec spec;
  spec.width = spec.height = 1024;
  const auto part = engine::simulateScan(spec, job);
  if (!part) return tl::unexpected(part.error());
  std::vector<StudiedScan> scans{{name, part->scan}};
  if (options.scan) scans.push_back(*options.scan);
  return scans;
}

DrawnEdges drawnEdges(const engine::SimulatedScan& scan, int seed, double roughness) {
  constexpr double kUsualSide = 1024.0;
  const engine::Grid& grid = scan.scan.grid();
  haptic::OperatorSpec person;
  person.seed = static_cast<std::uint64_t>(seed);
  person.wander_mm *= roughness * kUsualSide / grid.width;
  person.tremor_mm *= roughness * kUsualSide / grid.width;
  DrawnEdges drawn;
  for (haptic::HandLine& line : haptic::handLines(scan.edge_lines, grid, person)) {
    for (std::size_t i = 1; i < line.points.size(); ++i)
      drawn.seconds +=
          glm::distance(line.points[i], line.points[i - 1]) * grid.spacingXMm() / person.speed_mm_s;
    drawn.strokes.push_back(
        {static_cast<std::int64_t>(drawn.strokes.size()), std::move(line.points), line.closed});
  }
  return drawn;
}

}  // namespace fettle::bench

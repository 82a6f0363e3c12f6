#pragma once

#include <cstdint>
#include <vector>

#include "bench/accuracy/studies.h"
#include "engine/edges/locate.h"
#include "engine/scanner/scanner.h"

namespace fettle::bench {

/// A part to be scanned, as a row of a study.
struct PartSubject {
  const char* name;  ///< of the row
  const char* part;
  double noise;           ///< ScannerSpec::noise
  double outliers = 0.0;  ///< ScannerSpec::outliers
  double spot = 0.0;      ///< ScannerSpec::spot
};

/// How often and how large a study scans each part.
struct ScanSizes {
  int seeds = 1;  ///< of the noise, from 1
  int hands = 1;  ///< seeds of the person, from 1
  std::int32_t side = 512;
};
[[nodiscard]] ScanSizes scanSizes(double effort);

/// A simulated scan of side x side samples.
[[nodiscard]] engine::Result<engine::SimulatedScan> scanOf(const PartSubject& subject, std::int32_t side,
                                                           int seed);

/// A scan of the milled part, 1024 x 1024 samples, as `name`, and the user's, if there is one.
[[nodiscard]] engine::Result<std::vector<StudiedScan>> partAndScan(const char* name,
                                                                   const AccuracyOptions& options,
                                                                   engine::JobControl& job);

/// What a person draws along all edges of a scan.
struct DrawnEdges {
  std::vector<engine::EdgeStroke> strokes;  ///< one for each edge, in their order
  double seconds = 0.0;                     ///< of drawing
};
/// `roughness` multiplies drift and tremor of OperatorSpec. In samples they are the same at every size of the
/// scan: those of OperatorSpec at 1024 samples per side. Deterministic by seed.
[[nodiscard]] DrawnEdges drawnEdges(const engine::SimulatedScan& scan, int seed, double roughness = 1.0);

}  // namespace fettle::bench

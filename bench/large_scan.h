#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

/// Writes a scan of side x side samples as an uncompressed float32 BigTIFF with a GeoTIFF's spacing and
/// corner, strip by strip, so that it may be larger than memory: the milled part of workpiece() with other
/// noise, 0.05 mm per sample. Needs memory for one strip. Not atomic: for a private folder. Errors: kInput
/// for a path that cannot be written or a full disk; kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Status writeLargeScan(const std::string& path, std::int32_t side,
                                            engine::JobControl& job);

/// Bytes of the samples of such a file.
[[nodiscard]] constexpr std::uint64_t largeScanBytes(std::int32_t side) noexcept {
  return static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side) * sizeof(float);
}

}  // namespace fettle::bench

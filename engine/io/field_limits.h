#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/field/builder.h"
#include "engine/io/height_rule.h"

namespace fettle::engine {

/// Refuses sides of 0 or above Grid::kMaxSide.
[[nodiscard]] Status checkFieldSides(std::uint64_t width, std::uint64_t height, const std::string& path);

/// Refuses a field whose size in the header is impossible: sides of 0 or above Grid::kMaxSide, more than fits
/// in memory next to `extra_bytes` and on the disk of a store (tile_store.h). Call before anything is
/// allocated.
[[nodiscard]] Status checkFieldSize(std::uint64_t width, std::uint64_t height, std::uint64_t extra_bytes,
                                    const std::string& path);

/// Refuses a header with more samples than its file can hold: `raw_bytes` of samples when decompressed, from
/// `stored_bytes` in the file by a compression of at most `ratio`. Up to 64 MB are accepted: a sparse or very
/// flat file may be small, and reading it detects a false header.
[[nodiscard]] Status checkPromise(std::uint64_t raw_bytes, std::uint64_t stored_bytes, double ratio,
                                  const std::string& path);

/// Refuses a file of `stored_bytes` with so many `raw_bytes` of heights that it must be made to fill memory:
/// over 240 MB and 200 to 1. Deflate compresses zeros 1032 to 1; heights of a scan, including holes, are far
/// below.
[[nodiscard]] Status checkPacking(std::uint64_t raw_bytes, std::uint64_t stored_bytes,
                                  const std::string& path);

/// Builds the field and adds the warning where it has no height, the warnings of the tally, and one for each
/// value that looks like an undeclared hole (lone_value.h). `rule` is the one that the heights were computed
/// by.
[[nodiscard]] Result<Imported> finishImport(FieldBuilder&& builder, const HeightRule& rule,
                                            const HeightTally& tally, std::string format,
                                            std::vector<std::string> warnings);

}  // namespace fettle::engine

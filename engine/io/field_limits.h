#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/field/builder.h"
#include "engine/io/height_rule.h"

namespace fettle::engine {

/// Refuses a field that a header promises but that cannot be: sides of 0 or past Grid::kMaxSide, more than
/// neither memory, beside `extra_bytes`, nor the disk of a store holds (tile_store.h). Call before anything
/// is allocated.
[[nodiscard]] Status checkFieldSize(std::uint64_t width, std::uint64_t height, std::uint64_t extra_bytes,
                                    const std::string& path);

/// Refuses a header that promises more samples than its file can hold: `raw_bytes` of samples when unpacked,
/// from `stored_bytes` in the file by a compression that shrinks at most `ratio` times. Up to 64 MB pass: a
/// sparse or very flat file may be small, and the reader will find out.
[[nodiscard]] Status checkPromise(std::uint64_t raw_bytes, std::uint64_t stored_bytes, double ratio,
                                  const std::string& path);

/// Refuses a file of `stored_bytes` that promises so many `raw_bytes` of heights that it must be made to fill
/// memory: over 240 MB and 200 to 1. Deflate packs zeros 1032 to 1; heights of a scan, holes and all, never
/// come near.
[[nodiscard]] Status checkPacking(std::uint64_t raw_bytes, std::uint64_t stored_bytes,
                                  const std::string& path);

/// Builds the field, refuses one without any height, and puts the tally's warnings in place, and one for
/// each value that looks like an undeclared hole (lone_value.h). `rule` is the one that the heights were made
/// by.
[[nodiscard]] Result<Imported> finishImport(FieldBuilder&& builder, const HeightRule& rule,
                                            const HeightTally& tally, std::string format,
                                            std::vector<std::string> warnings, const std::string& path);

}  // namespace fettle::engine

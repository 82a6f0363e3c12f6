#pragma once

#include <cstdint>

namespace fettle::engine {

// SDF, surface data files: ISO 25178-71 and the BCR format before it. A header of keys, the profiles, and a trailer of any
// text, all of it as text ("aISO-1.0") or, without a trailer, in binary ("bISO-1.0"), little-endian. Lengths in metres.
// Version 2.0 counts points with 32 bits instead of 16 and has floats. Layout as read by Gwyddion's sdfile and surfalize,
// which agree; profiles are shown from the top by both.

/// Numbers in the key DataType.
enum class SdfType : std::uint8_t {
  kUint8,
  kUint16,
  kUint32,
  kFloat,
  kInt8,
  kInt16,
  kInt32,
  kDouble,
};
inline constexpr int kSdfTypes = 8;

inline constexpr std::uint64_t kSdfMostShort = 65535;  ///< points and profiles of version 1.0
inline constexpr std::uint64_t kSdfHeader = 81;        ///< bytes of a binary header of version 1.0; 85 of 2.0

}  // namespace fettle::engine

// Included by C++ and by the shaders of generalised variation, so that the two sides always agree.
#ifndef FETTLE_SHADERS_TGV_LAYOUT_H
#define FETTLE_SHADERS_TGV_LAYOUT_H

#ifdef __cplusplus
#include <glm/vec4.hpp>

namespace fettle::render::gpu {
using glm::ivec4;
using glm::vec4;
#define FETTLE_TGV_CONST inline constexpr int
#else
#define FETTLE_TGV_CONST const int
#endif

// Room for a square: samples along one side, those around it included.
FETTLE_TGV_CONST kTgvSlot = 352;
// Squares of a batch, at most.
FETTLE_TGV_CONST kTgvSquares = 8;

// A workgroup takes a region of kTgvRegion x kTgvRegion samples through kTgvTogether steps without leaving its own
// memory: each step makes one sample more along the region's rim wrong, and the kTgvInner x kTgvInner samples that are
// right at the end are written. One step at a time would move 124 bytes per sample and step, this moves 38, and
// works each sample out 1.8 times.
FETTLE_TGV_CONST kTgvRegion = 32;
FETTLE_TGV_CONST kTgvTogether = 4;
FETTLE_TGV_CONST kTgvInner = kTgvRegion - 2 * kTgvTogether;
// Threads of the group: one for each column, and of each column one for this many rows.
FETTLE_TGV_CONST kTgvRowsPerThread = 4;
FETTLE_TGV_CONST kTgvThreadRows = kTgvRegion / kTgvRowsPerThread;
// Threads along one side of a group that lowers weights.
FETTLE_TGV_CONST kTgvWeightsGroup = 16;

// Bindings of descriptor set 0: buffers of floats. Each array has kTgvSquares squares, each of these kTgvSlot rows of
// kTgvSlot samples.
FETTLE_TGV_CONST kTgvBindKept = 0;  // what steps read
FETTLE_TGV_CONST kTgvBindFrom = 1;  // what steps change: before
FETTLE_TGV_CONST kTgvBindTo = 2;    // and after

// Arrays of kTgvBindKept; names as in engine/filter/tgv_rows.h.
FETTLE_TGV_CONST kTgvF = 0;
FETTLE_TGV_CONST kTgvWp = 1;
FETTLE_TGV_CONST kTgvWq = 2;
FETTLE_TGV_CONST kTgvWv = 3;
FETTLE_TGV_CONST kTgvKept = 4;

// Arrays of the other two.
FETTLE_TGV_CONST kTgvU = 0;
FETTLE_TGV_CONST kTgvX = 1;
FETTLE_TGV_CONST kTgvY = 2;
FETTLE_TGV_CONST kTgvU2 = 3;
FETTLE_TGV_CONST kTgvX2 = 4;
FETTLE_TGV_CONST kTgvY2 = 5;
FETTLE_TGV_CONST kTgvP = 6;
FETTLE_TGV_CONST kTgvQ = 7;
FETTLE_TGV_CONST kTgvXx = 8;
FETTLE_TGV_CONST kTgvYy = 9;
FETTLE_TGV_CONST kTgvXy = 10;
FETTLE_TGV_CONST kTgvChanged = 11;

struct TgvPush {
  vec4 lengths;  // of a step: primal, dual, primal / (1 + primal)
  vec4 weights;  // jump . half_jump, half_jump, crease . half_crease, half_crease
  vec4 cut;      // x: kCut
  // Columns and rows of squares 0 and 1, 2 and 3, and so on.
  ivec4 sizes[kTgvSquares / 2];
};

#ifdef __cplusplus
// What every device takes.
static_assert(sizeof(TgvPush) <= 128);
static_assert(kTgvInner > 0 && kTgvRegion % kTgvRowsPerThread == 0 && kTgvSquares % 2 == 0);
}  // namespace fettle::render::gpu
#endif

#endif  // FETTLE_SHADERS_TGV_LAYOUT_H

#pragma once

#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::bench {

/// What a filter works out for a sample, in registers or from the nearest cache.
struct Operations {
  double products = 0.0;  ///< fused, of doubles
  double extrema = 0.0;   ///< minima and maxima of floats
  double chords = 0.0;    ///< two loads and two minima of floats; of doubles two
  double sums = 0.0;      ///< a load, a sum and a minimum of doubles
  double tests = 0.0;     ///< of samples or groups of them, as BowlTest of engine/filter/bowls.h
  // Of medians by ranks and sets (engine/filter/median_rank.cpp); more sets in which a sample is than the first one, whose move counts
  // it, have `flips`.
  double moves = 0.0;       ///< a rank's bit of a set, and the rank held against the pivots of 16 windows
  double flips = 0.0;       ///< a rank's bit of a set alone
  double selections = 0.0;  ///< of five sets the word that holds a median, its bit and its height
  double sorts =
      0.0;  ///< of a sample: three digits of 11 bits are counted, and three times it is moved by one
};

/// What a filter of one thread cannot do without, measured alone, beside the filter in the same run. Seconds per sample of processor
/// time, medians of the repeats.
struct FilterBound {
  double filter = 0.0;  ///< all of applyFilter
  double tiles =
      0.0;  ///< every tile read, and a new one written with its marks, bounds and report: results lie ready
  double operations = 0.0;  ///< `counted` alone
  Operations counted;
  bool whole =
      false;  ///< whether that is all it cannot do without; false: nothing was counted for this filter
};

/// Of a Gaussian's two passes, a median's shared networks or shared sets, both erosions of an opening or closing by a disk or ball: of
/// each way in which the results can be had; of a box nothing, since a sample takes part in four sums whatever its window. Shared sets
/// are those of 16 windows, from a window of 17 on, in a block without edges: each sample is sorted once and enters a window's sets once
/// a group of 16; where a median's word is, is known. Empty: not counted. Throws std::bad_alloc.
[[nodiscard]] std::vector<Operations> operationsOf(const engine::Version& field,
                                                   const engine::FilterSpec& spec);

/// Of a spec with one thread, by the way that takes least. Error kFailed: out of memory. Thread: any; blocks.
[[nodiscard]] engine::Result<FilterBound> filterBound(const engine::Version& field,
                                                      const engine::FilterSpec& spec, int repeats,
                                                      engine::JobControl& job);

}  // namespace fettle::bench

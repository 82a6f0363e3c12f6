#pragma once

#include <vector>

#include "engine/field/line_cuts.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {

/// The schedule of generalised variation; how the filter cuts the field.
struct TgvTwin {
  double balance = 0.15;
  int first_steps = 60, rounds = 4, round_steps = 40;
  int side = 256, halo = 48;  ///< 0: the whole field in one
  bool lone = true;           ///< lone samples are set aside
  /// Links that lines cut, of a field of one square; no sample changes its side.
  const LineCuts* cuts = nullptr;
};

/// What kGeneralisedVariation makes of a field, in double, sample by sample as its formulas read.
[[nodiscard]] std::vector<double> tgvTwin(const PlainField& field, double noise, const TgvTwin& twin = {});

}  // namespace fettle::engine::tests

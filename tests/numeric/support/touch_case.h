#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/scene/scene.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::tests {

/// A field, a hand and a way to touch as small whole numbers, so that a failure shrinks to the fewest samples
/// and ticks and to the smallest numbers.
struct TouchCase {
  int columns = 2;
  std::vector<int>
      heights;  ///< [1/16 mm], row-major, `columns` a row, the last row filled up with 0; kGap: hole
  struct Move {
    int x = 0, y = 0, z = 0;  ///< endpoint of the next tick [1/32 mm]
  };
  std::vector<Move> moves;
  Choice choice = Choice::kPaper;

  static constexpr int kGap = 40;  ///< heights are -32 .. 31

  [[nodiscard]] engine::Version field() const;                      ///< cells of 1 mm, at least 2 x 2 samples
  [[nodiscard]] std::vector<haptic::StrokeSample> strokes() const;  ///< 1 kHz
  [[nodiscard]] haptic::Scene scene() const;
};

void showValue(const TouchCase& touch, std::ostream& out);
[[nodiscard]] rc::Gen<TouchCase> touchCases(Choice choice);

/// What is wrong with a case, as one sentence; nothing when the property holds.
using TouchProperty = std::function<std::optional<std::string>(const TouchCase&)>;

/// The smallest case that a property does not hold for, and where it was written.
struct SmallestCase {
  TouchCase touch;
  std::string problem;
  std::string command;  ///< the fettle command line that plays it
};

/// Looks for a case that breaks a property among 500, shrinks it and writes it to `folder`, which is made:
/// scan.tif, strokes.csv and scene.toml, for the command to replay. Nothing when the property holds.
[[nodiscard]] std::optional<SmallestCase> findBroken(const std::string& name, Choice choice,
                                                     const TouchProperty& property,
                                                     const std::string& folder);

}  // namespace fettle::tests

#pragma once

#include <optional>
#include <string>

#include "render/plan/number_text.h"

namespace fettle::app {

/// A unit in which a length is read at ease: its name in ASCII, and its size in the unit that the length is kept in.
struct ReadAs {
  std::string name;
  double size = 1.0;
  friend bool operator==(const ReadAs&, const ReadAs&) = default;
};

/// The unit for lengths up to `length`, kept in a unit of `unit_mm` millimetres called `unit`: of metric ones m, mm, um or
/// nm, so that 0.0000113 mm are 11.3 nm; of others the same. 0 is read in the unit that it is kept in.
[[nodiscard]] ReadAs readLengthAs(double length, double unit_mm, const std::string& unit);

/// The unit for lengths along a surface whose samples are `spacing` apart: of metric ones mm, as drawings state them, m where
/// samples are 10 mm apart and more, um where they are less than 100 nm apart.
[[nodiscard]] ReadAs readAcrossAs(double spacing, double unit_mm, const std::string& unit);

/// A unit of render::fieldUnits(), its name in ASCII.
[[nodiscard]] ReadAs unitRead(const render::ShownUnit& shown);

/// As readLengthAs() for the window, whose lengths read "\u00b5m".
[[nodiscard]] ReadAs readOnScreenAs(double length, double unit_mm, const std::string& unit);
[[nodiscard]] ReadAs onScreen(ReadAs as);

/// How many of `unit` make one of `typed`, both names of length units (engine::lengthUnitFromName); nothing where one of them is
/// none and they differ.
[[nodiscard]] std::optional<double> ratioOfUnits(const std::string& typed, const std::string& unit);

}  // namespace fettle::app

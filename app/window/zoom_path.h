#pragma once

namespace fettle::app {

/// The way of a camera between two places at two scales along which the picture seems to move evenly: it zooms out
/// where both are not seen together, pans there and zooms in again (van Wijk and Nuij 2003, "Smooth and efficient
/// zooming and panning", equations 8 and 9, with the ratio of their trials).
class ZoomPath {
 public:
  ZoomPath() = default;
  /// `far`: distance of the places, >= 0; `from`, `to`: what is seen across the picture there, > 0; all in one unit.
  ZoomPath(double far, double from, double to) noexcept;

  struct Place {
    double share = 0.0;   ///< of the distance, 0 .. 1
    double across = 1.0;  ///< what is seen across the picture
  };
  /// `way`: share of the path, 0 .. 1; at the ends exact except for rounding.
  [[nodiscard]] Place at(double way) const noexcept;

 private:
  double far_ = 0.0, from_ = 1.0;
  double begin_ = 0.0;   // r0 of the paper; of a path without distance unused
  double length_ = 0.0;  // S of the paper
};

}  // namespace fettle::app

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/scanner/part.h"

namespace fettle::engine {

namespace {

Outline box(glm::dvec2 centre, double half_length, double half_width, double radius = 0.0) {
  return {centre, half_length, half_width, radius, {1.0, 0.0}};
}

Outline slot(glm::dvec2 centre, double half_length, double half_width) {
  return {centre, half_length, half_width, half_width, {1.0, 0.0}};
}

Feature raised(Outline outline, double level, Rim rim = Rim::kSharp, double rim_mm = 0.0,
               double foot_mm = 0.0) {
  Feature f;
  f.outline = outline;
  f.level = level;
  f.rim = rim;
  f.rim_mm = rim_mm;
  f.foot_mm = foot_mm;
  return f;
}

Feature sunk(Outline outline, double level, double chamfer_mm = 0.0) {
  Feature f;
  f.outline = outline;
  f.level = level;
  f.sunk = true;
  f.rim = chamfer_mm > 0.0 ? Rim::kChamfer : Rim::kSharp;
  f.rim_mm = chamfer_mm;
  return f;
}

Feature drilled(glm::dvec2 centre, double radius, double countersink_mm = 0.0) {
  Feature f;
  f.kind = FeatureKind::kThrough;
  f.outline = Outline::circle(centre, radius + countersink_mm);
  f.rim_mm = countersink_mm;
  return f;
}

Feature roof(Outline outline, double slope_v) {
  Feature f;
  f.kind = FeatureKind::kRoof;
  f.outline = outline;
  f.slope_v = slope_v;
  return f;
}

Feature bump(glm::dvec2 centre, double radius, double level) {
  Feature f;
  f.kind = FeatureKind::kBump;
  f.outline = Outline::circle(centre, radius);
  f.level = level;
  return f;
}

Feature freeform(Outline outline, double level, double waviness, double wavelength) {
  Feature f;
  f.outline = outline;
  f.level = level;
  f.waviness = waviness;
  f.wavelength = wavelength;
  return f;
}

Feature tilted(Outline outline, double level, glm::dvec2 slope) {
  Feature f;
  f.outline = outline;
  f.level = level;
  f.slope = slope;
  return f;
}

Part bracket() {
  Part part{
      {"bracket",
       "machined bracket: wall with fillets, bored boss, pocket with island, thin ribs, ledges, freeform pad",
       100.0, 100.0},
      {}};
  part.features = {
      raised(box({0, 0}, 46, 44, 6), 8.0, Rim::kChamfer, 1.0),
      // The ribs run under the wall and out of it; the thinnest is 0.2 mm.
      raised(box({-12, 30}, 14, 1.0), 13.0),
      raised(box({-12, 23}, 14, 0.5).rotated(2), 13.0),
      raised(box({-12, 16}, 14, 0.25).rotated(-3), 12.0),
      raised(box({-12, 9}, 14, 0.1).rotated(1), 12.0),
      raised(box({-32, 2}, 9, 35, 2), 18.0, Rim::kFillet, 1.5, 3.0),
      roof(box({-32, 2}, 22, 2.0).rotated(90), -0.8),
      raised(Outline::circle({22, 22}, 11), 14.0, Rim::kChamfer, 0.8, 2.0),
      sunk(Outline::circle({22, 22}, 6), 7.0, 0.5),
      sunk(box({12, -12}, 17, 11, 4).rotated(12), 4.0, 0.6),
      raised(slot({12, -12}, 7, 3).rotated(12), 7.0),
      sunk(box({12, -12}, 4, 0.6).rotated(12), 5.5),
      // Low ledges: heights comparable with the noise.
      raised(box({-8, -34}, 12, 5, 0.5).rotated(-4), 8.3),
      raised(box({-8, -34}, 8, 3, 0.5).rotated(-4), 8.8),
      raised(box({-8, -34}, 4, 1.2).rotated(-4), 10.0),
      freeform(Outline::circle({34, -32}, 8.5), 10.5, 0.8, 9.0),
      bump({-12, -20}, 9, 1.2),
      drilled({38, 38}, 2.2, 1.0),
      drilled({38, -8}, 2.2, 1.0),
      drilled({-36, -40}, 1.6),
      drilled({22, 22}, 3.0),
  };
  return part;
}

Part housing() {
  Part part{{"housing", "turned bearing housing: concentric steps, chamfered bore, bolt circle, radial ribs",
             120.0, 120.0},
            {}};
  part.features = {raised(Outline::circle({0, 0}, 55), 10.0, Rim::kChamfer, 1.5)};
  for (int k = 0; k < 8; ++k)
    part.features.push_back(raised(box({0, 0}, 46, 0.3 + 0.1 * k).rotated(22.5 * k + 5.0), 15.0));
  part.features.push_back(raised(Outline::circle({0, 0}, 30), 22.0, Rim::kFillet, 2.0, 2.5));
  part.features.push_back(sunk(Outline::circle({0, 0}, 22), 17.0, 1.0));
  part.features.push_back(sunk(Outline::circle({0, 0}, 16), 16.4));
  part.features.push_back(sunk(Outline::circle({0, 0}, 12), 12.0, 0.5));
  for (int k = 0; k < 6; ++k) {
    const double a = 1.0471975511965976 * k + 0.2;
    part.features.push_back(sunk(Outline::circle({48 * std::cos(a), 48 * std::sin(a)}, 4.0), 8.5));
    part.features.push_back(drilled({48 * std::cos(a), 48 * std::sin(a)}, 2.0));
  }
  part.features.push_back(drilled({0, 0}, 8, 1.0));
  return part;
}

Part ribs() {
  Part part{{"ribs", "heat sink: ribs and grooves from 3.2 to 0.05 mm wide, straight and turned", 80.0, 80.0},
            {}};
  part.features = {raised(box({0, 0}, 38, 38, 1), 4.0)};
  double width = 3.2;
  for (int k = 0; k < 7; ++k, width /= 2.0) {
    const double y = 32.0 - 5.0 * k;
    part.features.push_back(raised(box({-18, y}, 15, width / 2), 10.0));
    part.features.push_back(raised(box({18, y}, 14, width / 2).rotated(4.0), 7.0));
    part.features.push_back(sunk(box({-18, y - 37.0}, 15, width / 2).rotated(1.5), 2.0));
    part.features.push_back(raised(box({4.0 + 4.5 * k, -20}, width / 2, 14), 8.0));
  }
  return part;
}

Part steps() {
  Part part{
      {"steps", "gauge block: steps of 0.05 to 6.4 mm, terraces at 0, 11 and 45 degrees, round terraces",
       90.0, 90.0},
      {}};
  part.features = {raised(box({0, 0}, 43, 43, 1), 2.0)};
  double height = 2.0;
  for (int k = 0; k < 8; ++k) {
    height += 0.05 * static_cast<double>(1 << k);
    const double h = 18.0 - 2.2 * k;
    part.features.push_back(raised(box({-21, 21}, h, h), height));
    part.features.push_back(raised(box({21, 21}, 0.7 * h, 0.7 * h).rotated(45), height));
    part.features.push_back(raised(box({-21, -21}, 0.85 * h, 0.85 * h).rotated(11), height));
    part.features.push_back(raised(Outline::circle({21, -21}, h), height));
  }
  return part;
}

Part wedges() {
  Part part{{"wedges", "creases only: roofs, grooves, bevelled and tilted lands, cone frustums", 80.0, 80.0},
            {}};
  part.features = {
      roof(box({-20, 24}, 16, 5), 0.3),
      roof(box({20, 24}, 16, 5).rotated(17), 0.8),
      roof(box({-20, 4}, 16, 3).rotated(-8), -0.5),
      roof(box({20, 2}, 16, 4).rotated(30), -1.0),
      raised(Outline::circle({-22, -22}, 12), 6.0, Rim::kChamfer, 6.0),
      raised(box({18, -24}, 16, 9, 4), 3.0, Rim::kChamfer, 3.0),
  };
  return part;
}

Part die() {
  Part part{
      {"die", "freeform forging die: waved cavity and core, smooth bumps, tilted parting face", 100.0, 100.0},
      {}};
  part.features = {
      freeform(box({0, 0}, 47, 47, 3), 20.0, 1.5, 40.0),
      tilted(box({0, 0}, 38, 38, 8), 16.0, {0.04, -0.03}),
      freeform(box({-4, 3}, 28, 22, 10).rotated(15), 9.0, 2.5, 25.0),
      freeform(slot({-4, 3}, 14, 5).rotated(35), 14.0, 1.0, 12.0),
      bump({26, -24}, 9, 3.0),
      bump({-26, -24}, 8, -3.0),
  };
  return part;
}

Part plate() {
  Part part{
      {"plate", "flat plate at height 0 without any feature: nothing but the scanner's noise", 100.0, 100.0},
      {}};
  return part;
}

const std::array<Part, 7>& catalogue() {
  static const std::array<Part, 7> all{bracket(), housing(), ribs(), steps(), wedges(), die(), plate()};
  return all;
}

}  // namespace

const Part* findPart(std::string_view name) noexcept {
  const auto& all = catalogue();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Part& p) { return p.info.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::span<const PartInfo> parts() noexcept {
  static const std::array<PartInfo, 7> infos = [] {
    std::array<PartInfo, 7> list;
    std::transform(catalogue().begin(), catalogue().end(), list.begin(),
                   [](const Part& p) { return p.info; });
    return list;
  }();
  return infos;
}

}  // namespace fettle::engine

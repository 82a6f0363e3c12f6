#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"
#include "engine/measure/section_noise.h"

namespace fettle::app {

/// What is measured in a section: lengths along it in millimetres from its first point. Empty: not.
struct SectionWants {
  std::vector<double> within;      ///< A,B: of step, groove and roughness; empty: the whole line
  std::vector<double> cursors;     ///< A,B
  std::vector<double> line;        ///< A,B
  std::vector<double> angle;       ///< A,B,C,D
  std::vector<double> arc;         ///< A,B
  std::string step;                ///< the edge's length, or "auto"
  std::string groove;              ///< both edges' lengths A,B, or "auto"
  std::optional<double> cutoff;    ///< of roughness and waviness
  std::optional<double> lambda_s;  ///< of their S-filter and that of the primary profile
  /// Words or letters of engine::profileInfos(), whose parameters are measured; empty: those of roughness where there is a cut-off.
  std::vector<std::string> profiles;
  engine::AskedRatios asked = {};  ///< of their material ratio curves
};

/// A place along a section that a picture shows.
struct SectionMark {
  double along_mm = 0.0;
  std::string name;  ///< "edge"
};

/// Keys of the figures, in the order in which they are reported: cursors, line, step, groove, angle, arc, and
/// the words of engine::profileInfos().
[[nodiscard]] std::span<const std::string_view> sectionFigureKeys() noexcept;
/// The profile of a word or a letter, "waviness" or "W"; null for another text.
[[nodiscard]] const engine::ProfileInfo* profileCalled(std::string_view name) noexcept;
[[nodiscard]] bool wantsFigure(const SectionWants& wants, std::string_view key) noexcept;

/// One figure as `fettle section` reports it, and the window with it. `noise`: sectionNoiseOf() the scan. `marks`: places of it
/// are added. Errors (kInput): what the heights do not determine, with the option to blame and a remedy.
[[nodiscard]] engine::Result<Report> sectionFigure(std::string_view key, const SectionWants& wants,
                                                   const engine::Section& section,
                                                   const engine::SectionNoise& noise,
                                                   std::vector<SectionMark>& marks);

/// All that is wanted, a key each, but for what the heights do not determine: that is in `failed`.
struct FailedFigure {
  std::string key;
  engine::Error error;
};
[[nodiscard]] Report sectionFigures(const SectionWants& wants, const engine::Section& section,
                                    const engine::SectionNoise& noise, std::vector<SectionMark>& marks,
                                    std::vector<FailedFigure>& failed);

/// The points of "X,Y:X,Y" [mm], as lengthsOf() reads them, two or more. Errors (kInput): another text, naming the option.
[[nodiscard]] engine::Result<std::vector<glm::dvec2>> polylineOf(const std::string& text,
                                                                 const std::string& option);

/// Of a figure in a section's "roughness", "primary" or "waviness": what it is, without noise, and the standard error of that; its symbol, "Wa"; and why it is
/// not stated without noise.
struct RoughnessKeys {
  std::string value, without, error, symbol, reason;
};
[[nodiscard]] RoughnessKeys keysOf(const engine::RoughnessInfo& info, const engine::ProfileInfo& profile);
/// "rmr" and "rdc" with the first letter of a profile: what was asked for of its material ratio curve.
[[nodiscard]] std::string askedKey(std::string_view key, const engine::ProfileInfo& profile);

/// A number of a report; null for NaN.
[[nodiscard]] Report numberOrNull(double value);
/// KEY_UNIT and KEY_error_UNIT.
void addEstimate(Report& report, const std::string& key, const std::string& unit,
                 const engine::Estimate& estimate);

}  // namespace fettle::app

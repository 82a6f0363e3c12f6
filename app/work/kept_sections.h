#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "app/work/section_report.h"
#include "engine/base/error.h"

namespace fettle::app {

/// A section that is kept with the work on a scan: its line, and what is measured between its cursors. Lengths in millimetres, positions in
/// field coordinates.
struct KeptSection {
  glm::dvec2 from{0.0}, to{0.0};
  double width_mm = 0.0;                        ///< heights are means across it; 0: of the line alone
  std::pair<double, double> cursors{0.0, 0.0};  ///< lengths along the line
  std::pair<double, double> others{0.0, 0.0};   ///< the second stretch, of the angle; the same for none
  // Between the cursors, besides what lies between them.
  bool line = false, step = false, groove = false, arc = false, roughness = false;
  bool angle = false;      ///< between the lines of both stretches
  double cutoff_mm = 0.0;  ///< of the roughness; above 0

  [[nodiscard]] double lengthMm() const noexcept;
  /// Puts both stretches where they stay until somebody moves them: the first over the middle half, or before the second where the angle
  /// between both is measured.
  void placeStretches() noexcept;
  /// Both stretches as many times as far along a line that became longer or shorter.
  void scaleStretches(double times) noexcept;
  /// The second stretch over the longer part of the line beside the first, where it is none and the angle is measured.
  void placeSecond() noexcept;
  friend bool operator==(const KeptSection&, const KeptSection&) = default;
};

/// What `fettle section` is to measure of it: --cursors A,B, and as asked --fit-line A,B, --arc A,B, --angle A,B,C,D, and --step auto,
/// --groove auto and --cutoff --within A,B, A the nearer cursor.
[[nodiscard]] SectionWants wantsOf(const KeptSection& section);

/// They as the note engine::kSectionsNote of a session, and read from it. Numbers come back to the same bits. Errors (kInput): another text.
[[nodiscard]] std::string sectionsText(const std::vector<KeptSection>& sections);
[[nodiscard]] engine::Result<std::vector<KeptSection>> sectionsOf(std::string_view text);

}  // namespace fettle::app

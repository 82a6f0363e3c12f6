#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/field/version.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"

namespace fettle::app {

/// A section of the field that is worked on, over that of the scan it began with, along a straight line between two points; taken again in the
/// background whenever line or field change. Two cursors measure in it. Threading: main.
class SectionTool {
 public:
  /// A line's ends, field coordinates [mm].
  struct Line {
    glm::dvec2 from{0.0}, to{0.0};
    friend bool operator==(const Line&, const Line&) = default;
  };
  struct Profiles {
    engine::Section now;
    engine::Section before;  ///< of the scan; no places where the field does not differ from it
    double noise_mm = 0.0;   ///< of a sample of the scan; NaN where it is not known
  };

  /// Sets an end; the other one stays, or is the same point where there was none.
  void setFrom(const glm::dvec2& mm);
  void setTo(const glm::dvec2& mm);
  void setLine(const Line& line);
  void setWidth(double mm);
  /// Removes line and profiles.
  void clear();
  /// The same, of a document that is closed.
  void reset();

  /// Takes over results, and begins again after a change. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] const std::optional<Line>& line() const noexcept { return line_; }
  [[nodiscard]] double widthMm() const noexcept { return width_mm_; }
  /// Empty without a line, or where the line has no height.
  [[nodiscard]] const std::optional<Profiles>& profiles() const noexcept { return profiles_; }
  /// Whether a section is being taken or due.
  [[nodiscard]] bool busy() const noexcept { return working_.busy() || due_; }
  /// Differs whenever the line does.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

  /// Lengths along the line [mm], within it.
  [[nodiscard]] const std::pair<double, double>& cursors() const noexcept { return cursors_; }
  /// Moves the nearer cursor to a length along the line.
  void moveCursor(double along_mm);
  /// Between the cursors, of the field and of the scan; empty where a cursor has no height.
  [[nodiscard]] std::optional<engine::CursorFigures> between() const;
  [[nodiscard]] std::optional<engine::CursorFigures> betweenBefore() const;

 private:
  struct Work {
    Profiles profiles;
    engine::Version scan;  // that the noise is of
  };
  void lineChanged();
  void start(const LoopClient& client);

  std::optional<Line> line_;
  double width_mm_ = 0.0;
  std::pair<double, double> cursors_{0.0, 0.0};
  std::uint64_t revision_ = 0;
  bool due_ = false;
  engine::Version taken_;  // that the profiles are of, or that is being worked on
  std::optional<Profiles> profiles_;
  engine::Version noise_of_;
  std::optional<double> noise_mm_;  // of noise_of_
  Background<Work> working_;
};

}  // namespace fettle::app

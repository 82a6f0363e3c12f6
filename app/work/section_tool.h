#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "app/work/background.h"
#include "app/work/kept_sections.h"
#include "app/work/loop_client.h"
#include "app/work/section_lines.h"
#include "engine/field/version.h"
#include "engine/measure/section.h"
#include "engine/measure/section_noise.h"

namespace fettle::app {

/// Sections of the field that is worked on, over those of the scan it began with, along straight lines; one of them is chosen, whose profiles and
/// figures are taken again in the background whenever it or the field changes. All are kept with the session, as a note. Threading: main.
class SectionTool {
 public:
  /// Of the chosen section.
  struct Profiles {
    engine::Section now;
    engine::Section before;      ///< of the scan; no places where the field does not differ from it
    engine::SectionNoise noise;  ///< of the scan
  };
  /// A figure with its text as `fettle section` writes it, or why there is none.
  struct Figures {
    std::vector<SectionLine> now, before;
    Report report;  ///< of sectionFigures() of the field, those that there are
  };

  /// What of them is written to a file.
  struct Exporting {
    bool chosen_alone = false;
    bool with_scan = false;  ///< profiles of the scan it began with, too, where the field differs from it
  };
  Exporting exporting;  ///< edited by the dialog

  /// Sets an end of the chosen section; the other one stays, or is the same point where there was none.
  void setFrom(const glm::dvec2& mm);
  void setTo(const glm::dvec2& mm);
  /// Changes the chosen one; its stretches keep their shares of the line where that changes, the second is placed where there is none.
  void set(const KeptSection& section);
  /// The next end that is set begins another section, which is chosen then.
  void beginNew();
  /// Chooses the next one, or one by its number.
  void next();
  void choose(std::size_t section);
  /// Removes the chosen one.
  void remove();
  /// Takes over those that a session has kept.
  void restore(std::vector<KeptSection> sections);
  /// Forgets all of a document that is closed.
  void reset();

  /// Takes over results, and begins again after a change. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] const std::vector<KeptSection>& sections() const noexcept { return sections_; }
  /// None while there is none, or a new one is to begin.
  [[nodiscard]] std::optional<std::size_t> chosen() const noexcept;
  [[nodiscard]] const KeptSection* section() const noexcept;
  /// Empty without a section, or where it has no height.
  [[nodiscard]] const std::optional<Profiles>& profiles() const noexcept { return profiles_; }
  /// Of the present profiles, or those before while they are measured again.
  [[nodiscard]] const Figures& figures() const noexcept { return figures_; }
  /// sectionsText() of all, where they are others than at the last call.
  [[nodiscard]] std::optional<std::string> takeKept();
  /// Whether a section is being taken or measured, or due.
  [[nodiscard]] bool busy() const noexcept {
    return working_.busy() || measuring_.busy() || due_ || figures_due_;
  }
  /// Differs whenever a line does, or the choice.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

  /// Figures are written in these units from now on.
  void writeIn(const SectionUnits& units);

  /// Moves the nearest cursor of the chosen section to a length along it.
  void moveCursor(double along_mm);

 private:
  struct Work {
    Profiles profiles;
    engine::Version scan;  // that the noise is of
  };
  void lineChanged();
  void start(const LoopClient& client);
  void startFigures();

  std::vector<KeptSection> sections_;
  std::vector<KeptSection> taken_sections_;  // by takeKept()
  std::size_t chosen_ = 0;                   // sections_.size(): a new one
  std::uint64_t revision_ = 0;
  bool due_ = false, figures_due_ = false;
  engine::Version taken_;  // that the profiles are of, or that is being worked on
  std::optional<Profiles> profiles_;
  SectionUnits units_;
  Figures figures_;
  engine::Version noise_of_;
  std::optional<engine::SectionNoise> noise_;  // of noise_of_
  Background<Work> working_;
  Background<Figures> measuring_;
};

}  // namespace fettle::app

#pragma once

#include <span>
#include <vector>

#include "app/work/background.h"
#include "engine/field/version.h"
#include "haptic/trials/contact_trial.h"
#include "render/plan/picture.h"
#include "render/trials/detail_trial.h"

namespace fettle::app {

/// Vertex budgets of a frame, from the fastest to the finest.
[[nodiscard]] std::span<const trials::DetailChoice> detailChoices();

/// Error and time of each level of contact and each level of detail on the scan in the window: measured in
/// the background when they are about to be chosen, not before, and kept until another scan is opened. Later
/// edits are ignored. Threading: main.
class ChoiceCosts {
 public:
  /// Over a field as felt: each of trials::contactChoices(), about 2000 ticks of a hand that moves over it, a
  /// tenth of that for balls. Takes one or two seconds.
  void measureContact(const engine::Version& field);
  /// From the present camera, with a separate device and 2^21 vertices as the truth: takes seconds on a
  /// machine without a GPU. Only the first version's surface, without marks.
  void measureDetail(const engine::Version& field, const render::View& view);
  void cancelContact() noexcept { contact_run_.cancel(); }
  void cancelDetail() noexcept { detail_run_.cancel(); }
  /// Discards the results, which belong to another scan.
  void reset() noexcept;

  /// Takes results over; returns errors other than a cancel.
  [[nodiscard]] std::vector<engine::Error> poll();

  [[nodiscard]] bool busy() const noexcept { return contact_run_.busy() || detail_run_.busy(); }
  [[nodiscard]] const Background<std::vector<trials::ContactFigures>>& contactRun() const noexcept {
    return contact_run_;
  }
  [[nodiscard]] const Background<std::vector<trials::DetailFigures>>& detailRun() const noexcept {
    return detail_run_;
  }
  /// In the order of the choices; empty: not measured. An entry without ticks could not be tried: no square
  /// without holes that is large enough for a ball.
  [[nodiscard]] const std::vector<trials::ContactFigures>& contact() const noexcept { return contact_; }
  [[nodiscard]] const std::vector<trials::DetailFigures>& detail() const noexcept { return detail_; }

 private:
  std::vector<trials::ContactFigures> contact_;
  std::vector<trials::DetailFigures> detail_;
  Background<std::vector<trials::ContactFigures>> contact_run_;
  Background<std::vector<trials::DetailFigures>> detail_run_;
};

}  // namespace fettle::app

#pragma once

#include <optional>

#include "app/work/background.h"
#include "engine/field/version.h"
#include "engine/inspect/noise.h"

namespace fettle::app {

/// The noise of the scan as it was opened (engine::estimateNoise), measured once in the background when it is first wanted: ranges from
/// the noise are those of the scan, also when filters have taken most of it away. Threading: main.
class ScanNoise {
 public:
  /// Until the next call of poll(): a panel says so in each frame in which it shows the number.
  void want() noexcept { wanted_ = true; }
  /// `original`: the scan; under another form another version, which is measured again. True when there is another number.
  [[nodiscard]] bool poll(const engine::Version& original);
  /// Of this version, whatever its sign; null while it is not known.
  [[nodiscard]] const engine::NoiseEstimate* of(const engine::Version& original) const noexcept;
  [[nodiscard]] bool busy() const noexcept { return measuring_.busy(); }
  /// Forgets all of a document that is closed.
  void clear();

 private:
  bool wanted_ = false;
  engine::Version of_;  // that is measured, or was
  std::optional<engine::NoiseEstimate> noise_;
  Background<engine::NoiseEstimate> measuring_;
};

}  // namespace fettle::app

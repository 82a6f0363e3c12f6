#pragma once

#include <optional>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/remove/remove.h"

namespace fettle::app {

/// How many samples of the newest field would be removed, counted in the background while it is wanted, so that they are seen before
/// anything is done. Threading: main.
class RemovalCount {
 public:
  /// Of these, until the next call of poll(): a panel says so in each frame in which it shows the number.
  void want(const engine::RemoveOptions& options) { wanted_ = options; }
  /// Takes a result, and counts again where field or options are others. True when there is another number.
  [[nodiscard]] bool poll(const LoopClient& client);
  /// Of what was wanted last; nothing while it is counted.
  [[nodiscard]] const std::optional<engine::RemoveCounts>& counts() const noexcept { return counts_; }
  [[nodiscard]] bool busy() const noexcept { return counting_.busy(); }
  /// Forgets all of a document that is closed.
  void clear();

 private:
  struct Counted {
    engine::Version field;
    engine::RemoveOptions options;
    friend bool operator==(const Counted&, const Counted&) = default;
  };

  std::optional<engine::RemoveOptions> wanted_;
  std::optional<Counted> of_;  // that is counted, or was
  std::optional<engine::RemoveCounts> counts_;
  Background<engine::RemoveCounts> counting_;
};

}  // namespace fettle::app

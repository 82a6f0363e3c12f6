#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// What is worked out of the field in the background while the hand goes on, and stays beside it: no step. `Work` has the field that it
/// is of as `engine::Version field`. Threading: main.
template <class Work>
class BesideTheField {
 public:
  /// Starts this work in place of the one that is running, whose result is not taken.
  void begin(typename Background<Work>::Work work) { working_.replace(std::move(work)); }
  void cancel() noexcept { working_.cancel(); }

  struct Polled {
    bool changed = false;  ///< something visible
    bool taken = false;    ///< there is a new result
    bool failed = false;   ///< what ran has ended without one
  };
  /// Takes over a result; an error becomes a notice.
  [[nodiscard]] Polled poll(const LoopClient& client, std::vector<Notice>& notices) {
    Polled polled;
    const bool dropped = working_.cancelling();
    if (auto done = working_.take()) {
      polled.changed = true;
      if (!dropped && *done) {
        work_ = **std::move(done);
        polled.taken = true;
      } else {
        polled.failed = true;
        if (!dropped && done->error().kind != engine::ErrorKind::kCancelled)
          notices.push_back(noticeOf(done->error()));
      }
    }
    if (!work_) return polled;
    const bool outdated = !(client.newest() == work_->field);
    if (std::exchange(outdated_, outdated) != outdated) polled.changed = true;
    return polled;
  }

  [[nodiscard]] bool busy() const noexcept { return working_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  /// What the work is at, as its JobControl says.
  [[nodiscard]] const char* stage() const noexcept { return working_.stage(); }
  /// The last result; null before, and of another document.
  [[nodiscard]] const Work* get() const noexcept { return work_ ? &*work_ : nullptr; }
  [[nodiscard]] Work* get() noexcept { return work_ ? &*work_ : nullptr; }
  /// The last result if the field has the form over it that it had then: null where they cannot be seen together.
  [[nodiscard]] const Work* under(const engine::Version& field) const noexcept {
    return work_ && work_->field.formOver() == field.formOver() ? &*work_ : nullptr;
  }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return outdated_; }
  /// Forgets the result.
  void clear() {
    working_.cancel();
    work_.reset();
    outdated_ = false;
  }

 private:
  std::optional<Work> work_;
  bool outdated_ = false;
  Background<Work> working_;
};

}  // namespace fettle::app

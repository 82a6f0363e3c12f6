#pragma once

#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/history/history.h"

namespace fettle::app {

/// The original scan, also as it is seen under each form that lies over a state of the work: what changes and limits of
/// change are measured against. Versions are upright. Threading: one thread at a time; versions may be read by any.
class FormOriginals {
 public:
  /// `scan`: the original, any form over it ignored.
  FormOriginals(const engine::Version& scan)  // NOLINT(google-explicit-constructor): a scan without forms
      : scan_(scan.form() == nullptr ? scan : scan.withForm(nullptr)) {}

  /// Empty; may only be assigned to.
  FormOriginals() = default;

  /// Without a form.
  [[nodiscard]] const engine::Version& scan() const noexcept { return scan_; }
  /// Under the form over `state`; null: add() it first.
  [[nodiscard]] const engine::Version* of(const engine::Version& state) const noexcept;
  /// The same for a state whose original was added.
  [[nodiscard]] const engine::Version& at(const engine::Version& state) const noexcept;

  /// As it is seen under the form over `state`, sharing with the state what both have in common. Errors: memory, cancelled.
  /// A long job under a form, also on another thread.
  [[nodiscard]] static engine::Result<engine::Version> make(const engine::Version& scan,
                                                            const engine::Version& state,
                                                            engine::JobControl& job);
  /// What make() has made.
  void add(const engine::Version& seen);
  /// make() and add() for every form over a state of the history.
  [[nodiscard]] engine::Status makeAll(const engine::History& history, engine::JobControl& job);
  /// Drops those under forms over no state of the history and not over `shown`.
  void keepFor(const engine::History& history, const engine::Version& shown);

 private:
  engine::Version scan_;
  std::vector<engine::Version> seen_;
};

}  // namespace fettle::app

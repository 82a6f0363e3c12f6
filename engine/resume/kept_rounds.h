#pragma once

#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/filter/filter_work.h"

namespace fettle::engine {

/// The rounds of one pass in a file of their own, beside that of kept work: each time whole or not at all, as what the last
/// round left is all that the next one begins with. docs/formats.md describes the file.
///
/// Threading: one thread at a time.
class KeptRounds {
 public:
  /// `identity`: of the work (WorkIdentity::text).
  KeptRounds(std::string path, std::string identity)
      : path_(std::move(path)), identity_(std::move(identity)) {}

  /// Those of this pass, from 0. Nothing: no file, one that is damaged, or of other work.
  [[nodiscard]] std::optional<FilterWork::Rounds> read(int pass) const;
  /// Replaces what is there, whole or not at all. Errors: kFailed where it cannot be written.
  [[nodiscard]] Status keep(int pass, const FilterWork::Rounds& rounds) const;
  /// What is kept is of no more use.
  void remove() const noexcept;

 private:
  std::string path_, identity_;
};

}  // namespace fettle::engine

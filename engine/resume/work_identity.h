#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// What kept work belongs to: every input that a bit of a filter's result depends on, as words and values in a fixed
/// order. Two runs with equal identities have the same result.
struct WorkIdentity {
  std::vector<std::pair<std::string, std::string>> parts;

  /// One line "word value" per part.
  [[nodiscard]] std::string text() const;
  /// Of the first part in which a text differs from this one, its word; empty where none does.
  [[nodiscard]] std::string differsIn(const std::string& other_text) const;
};

/// Raised when a filter makes other bits than before of anything: kept work of another revision is not used. A test
/// holds the bits of every filter against it.
inline constexpr int kFilterRevision = 2;

/// Parts, in this order: `revision`; `filter` (spec without its threads, reals as binary64); `compute`, the device or
/// "cpu"; `size`; `scan` (contentHash of samples with the sign, and marks); `lines` (XXH64 of their points); `original`
/// (contentHash), only where the change is limited. The spec has its range sigma. Reads the field once; any thread.
[[nodiscard]] WorkIdentity identityOf(const Version& input, const Version& original, const FilterSpec& spec,
                                      const std::string& device);

}  // namespace fettle::engine

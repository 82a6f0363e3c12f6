#pragma once

#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace fettle::tests {

/// Path of a real scan by file name. The scans lie outside the project, in ../shared/data next to the
/// checkout or in the folder that FETTLE_SCANS names; nothing when neither is there.
[[nodiscard]] std::optional<std::string> scan(const std::string& name);

}  // namespace fettle::tests

/// Declares `var`, the path of a real scan, or skips the test, saying what is missing.
#define FETTLE_SCAN_OR_SKIP(var, name)                                                                 \
  const std::optional<std::string> var##_found = ::fettle::tests::scan(name);                          \
  if (!var##_found) GTEST_SKIP() << "no folder of real scans with " << (name) << ", set FETTLE_SCANS"; \
  const std::string& var = *var##_found

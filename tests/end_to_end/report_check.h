#pragma once

#include <set>
#include <string>

#include <nlohmann/json.hpp>

namespace fettle::tests {

/// What is wrong with an object of --json by the schema that it names, as `fettle reference` writes it; empty when
/// nothing is.
[[nodiscard]] std::string problemOf(const nlohmann::json& report);

/// The names of all schemas: "fettle.info/1".
[[nodiscard]] std::set<std::string> schemaNames();

}  // namespace fettle::tests

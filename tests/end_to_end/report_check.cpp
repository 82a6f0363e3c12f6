#include "tests/end_to_end/report_check.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "tests/support/process.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {

namespace {

using Adapter = valijson::adapters::NlohmannJsonAdapter;

// The schemas that this program writes, by name.
const std::map<std::string, valijson::Schema>& schemas() {
  static const std::map<std::string, valijson::Schema> all = [] {
    const TempFolder folder;
    if (runProcess({FETTLE_PROGRAM, "reference", folder.path().string(), "-q"}).status != 0)
      throw std::runtime_error("fettle reference failed");
    std::map<std::string, valijson::Schema> read;
    for (const auto& file : std::filesystem::directory_iterator(folder.path() / "schema")) {
      const nlohmann::json text = nlohmann::json::parse(std::ifstream(file.path()));
      valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
      parser.populateSchema(Adapter(text), read[text.at("$id").get<std::string>()]);
    }
    return read;
  }();
  return all;
}

}  // namespace

std::string problemOf(const nlohmann::json& report) {
  const auto name = report.find("schema");
  if (name == report.end() || !name->is_string()) return "it names no schema";
  const auto schema = schemas().find(name->get<std::string>());
  if (schema == schemas().end()) return "there is no schema " + name->get<std::string>();
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  valijson::ValidationResults results;
  if (validator.validate(schema->second, Adapter(report), &results)) return {};
  std::string text = name->get<std::string>() + ":";
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    for (const std::string& part : error.context) text += part;
    text += ' ' + error.description + '\n';
  }
  return text + report.dump(1).substr(0, 4000);
}

std::set<std::string> schemaNames() {
  std::set<std::string> names;
  for (const auto& [name, schema] : schemas()) names.insert(name);
  return names;
}

}  // namespace fettle::tests

#include "app/reference/report_schema.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

namespace fettle::app {

namespace {

Report objectOf(const std::vector<ReportKey>& keys);

// {"type": ...} of a type as the table writes it.
Report typeOf(std::string type, const ReportKey& key) {
  const bool optional = type.ends_with('?');
  if (optional) type.pop_back();
  if (type.starts_with('[')) {
    type.pop_back();
    type.erase(0, 1);
    Report list{{"type", "array"}, {"items", typeOf(type, key)}};
    if (optional) list["type"] = {"array", "null"};
    return list;
  }
  if (type == "any") return Report::object();
  Report value = type == "object" ? objectOf(key.keys) : Report{{"type", type}};
  if (optional || type == "number") value["type"] = {type, "null"};
  return value;
}

Report objectOf(const std::vector<ReportKey>& keys) {
  Report object{{"type", "object"}, {"properties", Report::object()}, {"required", Report::array()}};
  object["additionalProperties"] = false;
  for (const ReportKey& key : keys) {
    Report value = typeOf(std::string(key.type), key);
    if (!key.text.empty()) value["description"] = key.text;
    if (key.name == "*") {
      object["additionalProperties"] = std::move(value);
      continue;
    }
    std::string name(key.name);
    const bool always = !name.ends_with('?');
    if (!always) name.pop_back();
    object["properties"][name] = std::move(value);
    if (always) object["required"].push_back(name);
  }
  return object;
}

ReportKey warnings() {
  return {"warnings?", "[string]", "what had to be guessed, or was lost"};
}
ReportKey scanIn() {
  return {"in", "string", "the scan that was read"};
}

std::vector<ReportKey> with(std::vector<ReportKey> keys, std::initializer_list<ReportKey> more) {
  keys.insert(keys.end(), more);
  return keys;
}

}  // namespace

std::string schemaName(const ReportSchema& schema) {
  std::string name = fmt::format("fettle.{}/{}", schema.command, schema.version);
  std::ranges::replace(name, ' ', '.');
  return name;
}

std::string schemaName(std::string_view path) {
  const std::size_t blank = path.find(' ');
  if (blank == std::string_view::npos) return {};
  for (const ReportSchema& schema : reportSchemas())
    if (schema.command == path.substr(blank + 1)) return schemaName(schema);
  return {};
}

std::string schemaFile(const ReportSchema& schema) {
  std::string name = schemaName(schema);
  std::ranges::replace(name, '/', '.');
  return name + ".json";
}

Report schemaReport(const ReportSchema& schema) {
  const ReportKey own{"schema", "string", "the name of this schema"};
  Report forms = Report::array();
  const auto add = [&](std::string_view when, Report form) {
    form["properties"]["schema"] = {{"const", schemaName(schema)}};
    if (!when.empty()) form["title"] = when;
    forms.push_back(std::move(form));
  };
  for (const ReportForm& form : schema.forms) add(form.when, objectOf(with(form.keys, {own, warnings()})));
  if (schema.batch) {
    Report each = Report::array();
    for (const ReportForm& form : schema.forms)
      each.push_back(
          objectOf(with(form.keys, {scanIn(), {"out?", "string", "the file that was written"}, warnings()})));
    each.push_back(objectOf({scanIn(), {"error", "string", "why it failed"}, warnings()}));
    Report batch = objectOf({own,
                             {"done", "integer", "scans that succeeded"},
                             {"failed", "integer", "scans that failed"},
                             {"files", "[object]", "one for each scan, in the order given"},
                             warnings()});
    batch["properties"]["files"]["items"] = {{"anyOf", std::move(each)}};
    add("several scans", std::move(batch));
  }
  Report report{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"$id", schemaName(schema)}};
  if (forms.size() == 1)
    report.update(forms.front());
  else
    report["anyOf"] = std::move(forms);
  return report;
}

}  // namespace fettle::app

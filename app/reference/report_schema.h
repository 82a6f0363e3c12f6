#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/report.h"

namespace fettle::app {

// What the objects of --json hold, as one table: JSON Schemas (draft 7) are made of it, which state every key, and
// refuse others. A report names its schema in the key "schema".

/// A key of an object.
struct ReportKey {
  std::string name;  ///< with "?" at the end: not always there; "*": every other key
  /// "string", "integer", "number", "boolean", "object", or a list of one of these, "[number]", "any"; with "?" at the end
  /// null as well. A number may always be null: where it cannot be measured.
  std::string_view type;
  std::string_view text;             ///< what it is, with its unit
  std::vector<ReportKey> keys = {};  ///< of an object
};

/// One form of a command's report: which one depends on its arguments.
struct ReportForm {
  std::string_view when;
  std::vector<ReportKey> keys;
};

/// The reports of a command.
struct ReportSchema {
  std::string_view command;  ///< "bench haptic"
  /// Raised when a key is removed, renamed, or gets another type or meaning. A new key does not raise it.
  int version;
  std::vector<ReportForm> forms;
  bool batch = false;  ///< takes several scans: a list of such reports as well
};

/// All commands that print a report, and the error of any: "error".
[[nodiscard]] std::span<const ReportSchema> reportSchemas();

/// "fettle.bench.haptic/1" for the path of a command, "fettle bench haptic"; empty for one that has no report.
[[nodiscard]] std::string schemaName(std::string_view path);
[[nodiscard]] std::string schemaName(const ReportSchema& schema);

/// The schema as JSON, and the name of its file: "fettle.bench.haptic.1.json".
[[nodiscard]] Report schemaReport(const ReportSchema& schema);
[[nodiscard]] std::string schemaFile(const ReportSchema& schema);

}  // namespace fettle::app

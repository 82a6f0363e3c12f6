// The keys of every report: a key that a command prints and these tables lack fails the tests.

#include "app/reference/report_keys.h"

namespace fettle::app {

namespace {

std::vector<ReportSchema> all() {
  std::vector<ReportSchema> schemas;
  for (std::vector<ReportSchema>& part :
       std::vector{reports::inspecting(), reports::sectioning(), reports::comparing(), reports::changing(),
                   reports::sharing(), reports::showing(), reports::measuring()})
    schemas.insert(schemas.end(), part.begin(), part.end());
  schemas.push_back({"error",
                     1,
                     {{"",
                       {{"error", "string", "the line that is printed without --json"},
                        {"kind", "string", "input, failed or cancelled"},
                        {"what", "string", ""},
                        {"where", "string", "file or parameter"},
                        {"remedy", "string", "what to do"},
                        {"status", "integer", "exit status"}}}}});
  return schemas;
}

}  // namespace

std::span<const ReportSchema> reportSchemas() {
  static const std::vector<ReportSchema> schemas = all();
  return schemas;
}

}  // namespace fettle::app

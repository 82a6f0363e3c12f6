#include "app/commands/filter_warnings.h"

#include "app/terminal.h"

namespace fettle::app {

void addWeightless(Report& report, const engine::Filter& filter, const engine::FilterReport& done,
                   const std::string& of) {
  if (!filter.robust) return;
  report["weightless"] = done.weightless;
  if (const std::string warning = engine::warningOf(done); !warning.empty()) warn(of + ": " + warning);
}

void warnOfCutoff(const engine::FilterSpec& spec, const engine::Grid& grid, const std::string& of) {
  if (const std::string warning = engine::warningOf(spec, grid); !warning.empty()) warn(of + ": " + warning);
}

}  // namespace fettle::app

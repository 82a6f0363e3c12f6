#include "app/commands/noise_text.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/work/read_units.h"

namespace fettle::app {

void printNoise(const Report& report) {
  if (report["noise_mm"].is_null()) return;
  const double noise_mm = report["noise_mm"].get<double>();
  const ReadAs as = readLengthAs(noise_mm, 1.0, "mm");
  std::string shared;
  for (const auto& [key, name] : {std::pair("noise_rows_mm", "rows"), {"noise_columns_mm", "columns"}})
    if (const double mm = report[key].get<double>(); mm > 0.0) {
      const ReadAs of = readLengthAs(mm, 1.0, "mm");
      shared += fmt::format(", of whole {} {:.4g} {}", name, mm / of.size, of.name);
    }
  fmt::print("noise of a sample {:.4g} {}{}; +- standard error\n", noise_mm / as.size, as.name, shared);
}

}  // namespace fettle::app

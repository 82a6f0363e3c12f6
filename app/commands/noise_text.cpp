#include "app/commands/noise_text.h"

#include <string>

#include <fmt/format.h>

#include "app/work/fit_files.h"

namespace fettle::app {

void printNoise(const Report& report) {
  if (const std::string noise = errorNoiseText(report); !noise.empty())
    fmt::print("{}; +- standard error\n", noise);
}

}  // namespace fettle::app

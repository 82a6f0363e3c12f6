#pragma once

#include "app/command.h"

namespace fettle::app {

/// `fettle bench filters`.
void addBenchFilters(CLI::App& bench, Chosen& chosen);

}  // namespace fettle::app

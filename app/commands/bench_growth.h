#pragma once

#include "app/command.h"

namespace fettle::app {

/// `fettle bench growth`, added to `fettle bench`.
void addBenchGrowth(CLI::App& bench, Chosen& chosen);

}  // namespace fettle::app

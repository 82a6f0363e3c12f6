#pragma once

#include "app/command.h"

namespace fettle::app {

/// `fettle bench import`, added to `fettle bench`.
void addBenchImport(CLI::App& bench, Chosen& chosen);

}  // namespace fettle::app

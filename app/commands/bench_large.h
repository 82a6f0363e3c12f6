#pragma once

#include "app/command.h"

namespace fettle::app {

/// `fettle bench large`, added to `fettle bench`.
void addBenchLarge(CLI::App& bench, Chosen& chosen);

}  // namespace fettle::app

#pragma once

#include "app/commands/command.h"

namespace fettle::app {

/// `fettle bench growth`, added to `fettle bench`.
void addBenchGrowth(Command bench, Chosen& chosen);

}  // namespace fettle::app

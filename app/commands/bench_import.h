#pragma once

#include "app/commands/command.h"

namespace fettle::app {

/// `fettle bench import`, added to `fettle bench`.
void addBenchImport(Command bench, Chosen& chosen);

}  // namespace fettle::app

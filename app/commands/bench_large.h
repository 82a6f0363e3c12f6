#pragma once

#include "app/commands/command.h"

namespace fettle::app {

/// `fettle bench large`, added to `fettle bench`.
void addBenchLarge(Command bench, Chosen& chosen);

}  // namespace fettle::app

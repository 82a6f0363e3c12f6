#pragma once

#include "app/commands/command.h"

namespace fettle::app {

/// `fettle bench filters`.
void addBenchFilters(Command bench, Chosen& chosen);

}  // namespace fettle::app

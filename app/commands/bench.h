#pragma once

#include "app/commands/command.h"

namespace fettle::app {

/// `fettle bench filters`, `estimate`, `fill`, `growth`, `import`, `large`, `measure` and `previews`, added to `fettle bench`.
void addBenchFilters(Command bench, Chosen& chosen);
void addBenchEstimate(Command bench, Chosen& chosen);
void addBenchFill(Command bench, Chosen& chosen);
void addBenchGrowth(Command bench, Chosen& chosen);
void addBenchImport(Command bench, Chosen& chosen);
void addBenchLarge(Command bench, Chosen& chosen);
void addBenchMeasure(Command bench, Chosen& chosen);
void addBenchPreviews(Command bench, Chosen& chosen);

}  // namespace fettle::app

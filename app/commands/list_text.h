#pragma once

#include "app/report.h"

namespace fettle::app {

// What commands print of a list of scans, and of one; `fettle gather` prints the report of a list's shards with them.
void printFilter(const Report& report);
void printMeasured(const Report& report);
void printCompared(const Report& report);

}  // namespace fettle::app

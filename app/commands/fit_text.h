#pragma once

#include "app/report.h"

namespace fettle::app {

/// Prints the report of `fettle fit` as text.
void printFits(const Report& report);

}  // namespace fettle::app

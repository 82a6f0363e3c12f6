#pragma once

#include "app/report.h"

namespace fettle::app {

/// Prints the report of `fettle section` as text: a line for each figure, values to two digits of their standard errors.
void printSections(const Report& report);

}  // namespace fettle::app

#pragma once

#include "app/report.h"

namespace fettle::app {

/// Prints the noise that standard errors are by: between samples, of whole rows and of whole columns (`noise_mm`, `noise_rows_mm`,
/// `noise_columns_mm`); nothing where that of a sample is not known.
void printNoise(const Report& report);

}  // namespace fettle::app

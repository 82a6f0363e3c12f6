#pragma once

#include "app/commands/command.h"
#include "app/work/scan_reading.h"

namespace fettle::app {

/// The options of ScanOptions.
void addScanOptions(Command command, ScanOptions& options);

/// --store FOLDER: every field of this process is stored there (engine/field/tile_store.h). Part of
/// addScanOptions.
void addStoreOption(Command command);

}  // namespace fettle::app

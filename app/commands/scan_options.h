#pragma once

#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/work/scan_reading.h"
#include "engine/base/error.h"
#include "engine/io/export.h"

namespace fettle::app {

/// The heading of options about what a command writes.
inline constexpr const char* kWriting = "Writing";

/// The options of ScanOptions.
void addScanOptions(Command command, ScanOptions& options);

/// --store FOLDER: every field of this process is stored there (engine/field/tile_store.h). Part of
/// addScanOptions.
void addStoreOption(Command command);

/// --compress: compression of the TIFFs that a command writes.
void addCompressOption(Command command, engine::ExportOptions& writing);

/// Refuses, before anything is read or computed, --compress for an output that is not a TIFF.
[[nodiscard]] engine::Status checkCompress(const engine::ExportOptions& writing,
                                           const std::vector<BatchTask>& tasks);

}  // namespace fettle::app

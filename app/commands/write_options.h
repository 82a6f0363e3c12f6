#pragma once

#include <vector>

#include "app/commands/batch.h"
#include "engine/base/error.h"
#include "engine/io/export.h"

namespace fettle::app {

/// --compress: compression of the TIFFs that a command writes.
void addCompressOption(Command command, engine::ExportOptions& writing);

/// Refuses, before anything is read or computed, --compress for an output that is not a TIFF.
[[nodiscard]] engine::Status checkCompress(const engine::ExportOptions& writing,
                                           const std::vector<BatchTask>& tasks);

}  // namespace fettle::app

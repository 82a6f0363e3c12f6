#pragma once

#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "engine/base/error.h"
#include "engine/io/export.h"

namespace fettle::app {

/// --compress: how TIFFs that a command writes are packed.
void addCompressOption(Command command, engine::ExportOptions& writing);

/// Refuses, before anything is read or computed, --compress for an output that is no TIFF.
[[nodiscard]] engine::Status checkCompress(const engine::ExportOptions& writing,
                                           const std::vector<BatchTask>& tasks);

}  // namespace fettle::app

#pragma once

#include <string>

#include "engine/io/export.h"

namespace fettle::engine {

/// PLY with faces, for ExportOptions::mesh; contract: exportField.
[[nodiscard]] Result<Exported> writePlyMesh(const Version& field, const std::string& path,
                                            const ExportOptions& options, JobControl& job);

}  // namespace fettle::engine

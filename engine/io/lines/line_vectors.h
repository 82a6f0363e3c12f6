#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/edge_line.h"
#include "engine/field/grid.h"
#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// The forms of lines.h that GDAL reads and writes, by extension. May throw std::bad_alloc.
[[nodiscard]] Result<std::vector<EdgeLine>> readLineVectors(const InputFile& file, const Grid& grid);
[[nodiscard]] Status writeLineVectors(const std::string& path, std::span<const EdgeLine> lines,
                                      const Grid& grid);

}  // namespace fettle::engine

#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/grid.h"
#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// The CSV form of lines.h. An empty row begins another line where two in succession have the same number.
[[nodiscard]] Result<std::vector<EdgeLine>> readLineCsv(const InputFile& file, const Grid& grid,
                                                        const JobControl* job);
[[nodiscard]] Status writeLineCsv(const std::string& path, std::span<const EdgeLine> lines, const Grid& grid);

/// The forms of lines.h that GDAL reads and writes, by extension. May throw std::bad_alloc.
[[nodiscard]] Result<std::vector<EdgeLine>> readLineVectors(const InputFile& file, const Grid& grid,
                                                            const JobControl* job);
[[nodiscard]] Status writeLineVectors(const std::string& path, std::span<const EdgeLine> lines,
                                      const Grid& grid);

}  // namespace fettle::engine

#include "engine/io/lines/lines.h"

#include <algorithm>
#include <iterator>
#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/io/files/input_file.h"
#include "engine/io/lines/line_csv.h"

namespace fettle::engine {

namespace {

constexpr std::uint64_t kLargestLineFile = std::uint64_t{1} << 30;

Status checkLineExtension(const std::string& path) {
  const std::string extension = extensionOf(path);
  if (std::ranges::find(kLineExtensions, extension) != std::end(kLineExtensions)) return {};
  return inputError(extension.empty() ? "there is no extension that names the format of the lines"
                                      : fmt::format("{} is not a format of lines", extension),
                    path, fmt::format("take one of {}", fmt::join(kLineExtensions, " ")));
}

}  // namespace

Result<std::vector<EdgeLine>> importLines(const std::string& path, const Version& field) {
  if (Status status = checkLineExtension(path); !status) return tl::unexpected(status.error());
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  if (file->size() > kLargestLineFile)
    return inputError("a file of lines has at most 1 GiB", path, "divide the file, or leave lines out");
  try {
    return file->extension() == ".csv" ? readLineCsv(*file, field.grid())
                                       : readLineVectors(*file, field.grid());
  } catch (const std::bad_alloc&) {
    return failure("there is not enough memory for the lines", path);
  }
}

Status exportLines(const std::string& path, std::span<const EdgeLine> lines, const Grid& grid) {
  if (Status status = checkLineExtension(path); !status) return status;
  if (const std::int64_t points = countPoints(lines); points > kMostLinePoints)
    return inputError(fmt::format("the lines have {} points, files at most {}", points, kMostLinePoints),
                      path, "write fewer lines");
  try {
    return extensionOf(path) == ".csv" ? writeLineCsv(path, lines, grid)
                                       : writeLineVectors(path, lines, grid);
  } catch (const std::bad_alloc&) {
    return failure("there is not enough memory for the lines", path);
  }
}

}  // namespace fettle::engine

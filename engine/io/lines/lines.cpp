#include "engine/io/lines/lines.h"

#include <algorithm>
#include <iterator>
#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/io/files/input_file.h"
#include "engine/io/files/text_reader.h"
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

std::string_view lineExtensionOf(std::string_view head) noexcept {
  if (head.starts_with("SQLite format 3")) return ".gpkg";
  head = withoutByteOrderMark(head);
  if (head.starts_with("line,") || head.starts_with("line;")) return ".csv";
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  head.remove_prefix(first);
  if (head.front() == '{') return ".geojson";
  // A DXF begins with a group code, 0 or the 999 of a comment, on a line of its own.
  const std::string_view code = head.substr(0, head.find_first_of("\r\n"));
  return code == "0" || code == "999" ? ".dxf" : std::string_view();
}

Result<std::vector<EdgeLine>> importLines(const std::string& path, const Version& field,
                                          const JobControl* job) {
  if (Status status = checkLineExtension(path); !status) return tl::unexpected(status.error());
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  if (file->size() > kLargestLineFile)
    return inputError("a file of lines has at most 1 GiB", path, "divide the file, or leave lines out");
  try {
    return file->extension() == ".csv" ? readLineCsv(*file, field.grid(), job)
                                       : readLineVectors(*file, field.grid(), job);
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

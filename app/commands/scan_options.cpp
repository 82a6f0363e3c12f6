#include "app/commands/scan_options.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/work/outputs.h"
#include "app/work/spelling.h"
#include "engine/field/tile_store.h"
#include "engine/io/import.h"

namespace fettle::app {

namespace {

constexpr const char* kReading = "Reading the scan";

std::string unreadableFormat(const std::string& typed) {
  const auto known = extensionsOf(&engine::FormatInfo::reads);
  if (std::find(known.begin(), known.end(), withDot(typed)) != known.end()) return "";
  const std::string meant = didYouMean(withDot(typed), known);
  return fmt::format("{} is not a format that can be read{}{}", typed, meant.empty() ? "" : "; ", meant);
}

}  // namespace

void addStoreOption(Command command) {
  const auto store_in = [](const std::string& folder) {
    engine::StorePolicy policy;
    policy.folder = folder;
    policy.always = true;
    engine::setStorePolicy(policy);
  };
  command.add({{.name = "--store",
                .to = std::function<void(const std::string&)>(store_in),
                .text = "Folder on a disk for samples, for fields larger than memory",
                .kind = ValueKind::kFolder}},
              kReading);
}

void addScanOptions(Command command, ScanOptions& options) {
  addStoreOption(command);
  command.add(
      {
          {.name = "--no-data",
           .to = &options.no_data,
           .text = "Height that means a hole, in addition to the one that the file declares"},
          {.name = "--spacing",
           .to = &options.spacing,
           .text = "Sample spacing X[,Y] in the scan's unit, where the file has none",
           .shown = "X[,Y]",
           .between = ',',
           .one_word = true},  // "--spacing 0.5 SCAN": the next word is the scan
          {.name = "--z-scale", .to = &options.z_scale, .text = "Height of one count of the file"},
          {.name = "--unit",
           .to = &options.unit,
           .text = fmt::format("Unit of the file's lengths, where it has none: {}",
                               fmt::join(engine::lengthUnitNames(), ", ")),
           .proposed = engine::lengthUnitNames()},
          {.name = "--cell-size",
           .to = &options.cell_size,
           .text = "Point clouds: side of a grid cell in the scan's unit"},
          {.name = "--cell-rule",
           .to = &options.cell_rule,
           .text = "Point clouds: height of a cell with several points",
           .words = {"median", "mean", "highest"}},
          {.name = "--depth-camera",
           .to = &options.depth_camera,
           .text = "PNG, TIFF: distances from a camera of this focal length in pixels, kept in its "
                   "perspective; its axis "
                   "goes through the middle of the picture, unless that is given",
           .shown = "FX[,FY[,CX,CY]]",
           .between = ',',
           .one_word = true},
          {.name = "--from",
           .to = &options.from,
           .text = "Format of standard input (-), as extension, where its content is ambiguous",
           .kind = ValueKind::kFormat,
           .proposed = extensionWords(&engine::FormatInfo::reads),
           .problem = unreadableFormat},
      },
      kReading);
}

void addCompressOption(Command command, engine::ExportOptions& writing) {
  const auto take = [&writing](const std::string& name) {
    writing.tiff_compression = engine::tiffCompressionFromName(name);
  };
  command.add({{.name = "--compress",
                .to = std::function<void(const std::string&)>(take),
                .text = "TIFF: compression; the page File formats says which programs read it",
                .words = {{"none", "every program reads it"}, "lzw", "deflate", "zstd"},
                .otherwise = "none"}},
              kWriting);
}

engine::Status checkCompress(const engine::ExportOptions& writing, const std::vector<BatchTask>& tasks) {
  if (!writing.tiff_compression) return {};
  for (const BatchTask& task : tasks)
    if (const std::string extension = engine::extensionOf(task.out);
        !extension.empty() && extension != ".tif" && extension != ".tiff")
      return engine::inputError("only .tif supports the requested compression", task.out,
                                "write that or omit --compress");
  return {};
}

}  // namespace fettle::app

#include "app/commands/scan_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/work/outputs.h"
#include "app/work/spelling.h"
#include "engine/field/tile_store.h"

namespace fettle::app {

constexpr const char* kReading = "Reading the scan";

void addStoreOption(Command command) {
  command
      .onOption(
          "--store",
          [](const std::string& folder) {
            engine::StorePolicy policy;
            policy.folder = folder;
            policy.always = true;
            engine::setStorePolicy(policy);
          },
          "Folder on a disk for samples, for fields larger than memory")
      .check(folderName())
      .group(kReading);
}

void addScanOptions(Command command, ScanOptions& options) {
  const std::string group = kReading;
  addStoreOption(command);
  command
      .option("--no-data", options.no_data,
              "Height that means a hole, in addition to the one that the file declares")
      .group(group);
  command
      .option("--spacing", options.spacing,
              "Sample spacing X[,Y] in the scan's unit, where the file has none")
      .delimiter(',')
      .oneValueEach()  // "--spacing 0.5 SCAN": the next word is the scan
      .group(group);
  command.option("--z-scale", options.z_scale, "Height of one count of the file").group(group);
  command
      .option("--unit", options.unit, "Unit of the file's lengths, where it has none (nm, um, mm, m, in, ft)")
      .group(group);
  command.option("--cell-size", options.cell_size, "Point clouds: side of a grid cell in the scan's unit")
      .group(group);
  command.option("--cell-rule", options.cell_rule, "Point clouds: height of a cell with several points")
      .check(oneOf({"median", "mean", "highest"}))
      .group(group);
  command
      .option("--depth-camera", options.depth_camera,
              "PNG, TIFF: distances from a camera with FX,FY,CX,CY in pixels, kept in its perspective")
      .delimiter(',')
      .expected(4)
      .group(group);
  command
      .option("--from", options.from,
              "Format of standard input (-), as extension, where its content is ambiguous")
      .check({[](const std::string& typed) {
        const auto known = extensionsOf(&engine::FormatInfo::reads);
        if (std::find(known.begin(), known.end(), withDot(typed)) != known.end()) return std::string();
        const std::string meant = didYouMean(withDot(typed), known);
        return fmt::format("{} is not a format that can be read{}{}", typed, meant.empty() ? "" : "; ",
                           meant);
      }})
      .group(group);
}

void addCompressOption(Command command, engine::ExportOptions& writing) {
  command
      .onOption(
          "--compress",
          [&writing](const std::string& name) {
            writing.tiff_compression = engine::tiffCompressionFromName(name);
          },
          "TIFF: none (every program reads it; the default), lzw, deflate or zstd; support by programs is in "
          "docs/formats.md")
      .check(memberOf({"none", "lzw", "deflate", "zstd"}))
      .group("Writing");
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

#include "app/commands/write_options.h"

namespace fettle::app {

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

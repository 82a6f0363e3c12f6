#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/list_text.h"
#include "app/commands/shards/gathering.h"
#include "app/commands/shards/list_shard.h"

namespace fettle::app {

namespace {

struct GatherArguments {
  std::string out;
  GatherOptions options;
};

engine::Result<Report> gather(const GatherArguments& options, engine::JobControl& job) {
  return isListFolder(options.out) ? gatherList(options.out) : gatherBands(options.out, options.options, job);
}

// As the command of the list prints it: by a key that is in its reports alone.
void printGathered(const Report& report) {
  constexpr std::pair<const char*, void (*)(const Report&)> kPrinters[] = {
      {"commands", printFilter}, {"places", printFilter}, {"form", printMeasured}, {"rms", printCompared}};
  if (report.contains("files"))
    for (const auto& [key, print] : kPrinters)
      if (std::ranges::any_of(report["files"], [key = key](const Report& file) {
            return file.contains(key) && !file.contains("out");
          }))
        return print(report);
  printBatch(report);
}

}  // namespace

void addGather(Command root, Chosen& chosen) {
  auto options = std::make_shared<GatherArguments>();
  Command command = addCommand(
      root, chosen, "gather", "Check the shards of a plan, and put their result together",
      [options](engine::JobControl& job) { return gather(*options, job); }, printGathered, Progress::kLine,
      batchStatus);
  command.add(
      {{.name = "OUT",
        .to = &options->out,
        .text = "The file that was planned, or the folder (--out-dir, --shard-dir) of a list's shards",
        .kind = ValueKind::kFile,
        .required = true},
       {.name = "--vrt",
        .to = &options->options.vrt,
        .text = "Write no OUT but this virtual raster of GDAL over the files of the shards, which stay "
                "(fettle plan --result files)",
        .kind = ValueKind::kNewFile},
       {.name = "--keep-shards", .to = &options->options.keep, .text = "Leave the folder OUT.shards"}});
}

}  // namespace fettle::app

#pragma once

#include <optional>
#include <string>

#include "app/commands/batch.h"
#include "app/commands/resume_option.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/shard_option.h"
#include "engine/io/export.h"

namespace fettle::app {

// What `fettle filter` and `fettle plan filter` are given, as typed; the rows of its table say what each is.
struct FilterArguments {
  BatchOptions files;
  std::string filter;
  int window = 3;
  double sigma = 0.0;
  std::string range_sigma;
  std::string cutoff, radius;  // nesting indices
  std::string element = "ball";
  std::string residual;
  int passes = 1;
  std::string keep;
  std::string only;
  std::string lines;
  std::string max_change;
  std::string original;
  int threads = 0;
  std::string compute = "auto";
  bool suggest = false;
  std::string tolerance;
  std::optional<double> budget;
  int places = 0;
  ResumeOptions resume;
  bool estimate = false;
  ShardOptions shards;
  ScanOptions reading;
  engine::ExportOptions writing;

  // Where a shard of a list keeps its report; of an estimate none is kept.
  [[nodiscard]] std::string reportFolder() const { return estimate ? std::string() : files.out_dir; }
};

}  // namespace fettle::app

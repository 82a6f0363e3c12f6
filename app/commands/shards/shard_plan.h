#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/tiff/plain_tiff.h"

namespace fettle::app {

/// What all shards of one field know, from the file plan.json: what is global is found once, so that every shard has the
/// same.
struct ShardPlan {
  std::string command;                 ///< filter or convert
  std::vector<std::string> arguments;  ///< of a shard, without --shard
  std::string folder;                  ///< that these were typed in
  Report settings;                     ///< words and values that every shard must have as well
  std::string in, out;
  std::uint64_t in_bytes = 0;
  std::string in_print;  ///< printOf() the file
  std::int32_t width = 0, height = 0;
  int shards = 1;
  std::int32_t halo = 0;                          ///< rows around a band that its samples depend on
  bool lines = false;                             ///< the field has edge lines
  std::optional<double> range_sigma, max_change;  ///< [height_unit]
  std::string unit;
  std::optional<engine::PlainLayout>
      one_file;                    ///< of ShardFolder::whole(); else every shard has a file of its own
  double seconds = 0.0;            ///< of the largest shard, as foreseen
  std::uint64_t memory_bytes = 0;  ///< of the largest shard at its most
  int threads = 1;                 ///< of a shard, for which time and memory are foreseen
  int revision = 0;                ///< engine::kFilterRevision

  /// Hash of all but what is foreseen: what a shard's report names its plan by.
  [[nodiscard]] std::string id() const;
  /// Whether one process made it for itself (--shards-in-turn).
  [[nodiscard]] bool inTurn() const;
};

/// 64 bits of a text, as 16 digits.
[[nodiscard]] std::string hashOfText(const std::string& text);

/// The schema of a plan's file and report: "fettle.plan.filter/1".
[[nodiscard]] std::string planSchema(const std::string& command);

/// As a report, `id` among its keys.
[[nodiscard]] Report reportOf(const ShardPlan& plan);

/// Errors (kInput): no plan of a version that this program knows.
[[nodiscard]] engine::Result<ShardPlan> readPlan(const std::string& path);

/// Whether a result is a TIFF whose rows lie one after another: no compression, not laid out for a cloud. `settings`: of a plan.
[[nodiscard]] bool writesPlainTiff(const std::string& out, const Report& settings);

/// A file by its size and some of its bytes: the first and the last 64 KB and 62 pieces of 4 KB between. The same file copied to
/// another machine has the same. Errors as engine::InputFile.
[[nodiscard]] engine::Result<std::string> printOf(const std::string& path);

}  // namespace fettle::app

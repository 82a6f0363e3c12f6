#pragma once

#include <string>

namespace fettle::app {

/// The files of work that is divided into shards, all in the folder OUT.shards.
class ShardFolder {
 public:
  explicit ShardFolder(const std::string& out) : path_(out + ".shards") {}

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string plan() const { return path_ + "/plan.json"; }
  /// The result, whose rows all shards write.
  [[nodiscard]] std::string whole() const { return path_ + "/whole.tif"; }
  [[nodiscard]] std::string rows(int number) const {
    return path_ + "/rows-" + std::to_string(number) + ".tif";
  }
  /// What a shard did: its report, there once its rows are safe on the disk.
  [[nodiscard]] std::string done(int number) const {
    return path_ + "/shard-" + std::to_string(number) + ".json";
  }
  /// Of a shard that runs: how far it is. Its age says whether it still does.
  [[nodiscard]] std::string note(int number) const {
    return path_ + "/running-" + std::to_string(number) + ".json";
  }

 private:
  std::string path_;
};

}  // namespace fettle::app

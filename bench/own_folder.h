#pragma once

#include <filesystem>
#include <utility>

#include "engine/base/error.h"

namespace fettle::bench {

/// A new folder that goes, with all that is in it, when the run ends. Threading: one thread.
class OwnFolder {
 public:
  /// In the system's temporary folder. Errors: kInput when none can be made.
  [[nodiscard]] static engine::Result<OwnFolder> create();
  /// In `parent`.
  [[nodiscard]] static engine::Result<OwnFolder> create(const std::filesystem::path& parent);
  OwnFolder(OwnFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  OwnFolder& operator=(OwnFolder&&) = delete;
  ~OwnFolder();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  explicit OwnFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace fettle::bench

#pragma once

#include <filesystem>
#include <utility>

#include "engine/base/error.h"

namespace fettle::bench {

/// A new folder that is removed, with its content, by the destructor. Threading: one thread.
class TemporaryFolder {
 public:
  /// In the system's temporary folder. Errors: kInput when none can be created.
  [[nodiscard]] static engine::Result<TemporaryFolder> create();
  /// In `parent`.
  [[nodiscard]] static engine::Result<TemporaryFolder> create(const std::filesystem::path& parent);
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace fettle::bench

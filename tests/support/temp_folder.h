#pragma once

#include <filesystem>
#include <string>

namespace fettle::tests {

/// A folder of one test's own, removed with everything in it at the end of the scope.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// The bytes of a file; none where it cannot be read.
[[nodiscard]] std::string bytesOf(const std::string& path);

}  // namespace fettle::tests

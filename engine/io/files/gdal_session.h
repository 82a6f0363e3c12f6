#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/io/files/gdal_calls.h"

namespace fettle::engine {

/// During its lifetime, GDAL's messages on this thread are collected here instead of going to stderr.
/// Creating the first one initialises GDAL: only the drivers that Fettle needs, no plugins, no .aux.xml
/// files, a bounded block cache. Threading: one thread; scopes nest.
class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession& operator=(GdalSession&&) = delete;

  /// Whether GDAL reported a failure since the last clear().
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  void clear() noexcept { failed_ = false; }
  /// GDAL's first failure (later ones are its consequences) as plain text: no paths, no full stop;
  /// `otherwise` if there was none.
  [[nodiscard]] std::string reason(const std::string& otherwise) const;
  /// The system's error number of the first failure caused by the disk (isDiskError), else 0.
  [[nodiscard]] int diskError() const noexcept { return disk_error_; }

 private:
  static void hear(CPLErr severity, CPLErrorNum number, const char* message);

  bool failed_ = false;
  int disk_error_ = 0;
  std::string first_;
};

/// A file in memory, removed by the destructor. Drivers replace and rename files as they like, and what is written
/// whole is copied once. Threading: one thread.
class MemoryFile {
 public:
  /// `content`: of a file to read; without it there is none yet.
  explicit MemoryFile(const std::string& extension, std::string content = {});
  ~MemoryFile();
  MemoryFile& operator=(MemoryFile&&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// What was written.
  [[nodiscard]] std::string_view bytes() const;

 private:
  std::string content_, path_;
};

struct CloseDataset {
  void operator()(GDALDatasetH dataset) const noexcept { gdal().GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<void, CloseDataset>;

struct ReleaseCrs {
  void operator()(OGRSpatialReferenceH crs) const noexcept { gdal().OSRRelease(crs); }
};
using CrsPtr = std::unique_ptr<void, ReleaseCrs>;

}  // namespace fettle::engine

#pragma once

#include <memory>
#include <string>

#include "engine/base/error.h"
#include "render/plan/picture.h"

namespace fettle::render {

/// Writes 8-bit RGBA PNG with an sRGB chunk, some rows at a time; the file appears completely or not at all
/// (temporary file, fsync, rename). Holds a few rows, however large the picture is.
///
/// Threading: one thread at a time.
class PngWriter {
 public:
  /// Errors: kInput when the path cannot be written or the size is not positive.
  [[nodiscard]] static engine::Result<PngWriter> create(const std::string& path, int width, int height);
  PngWriter(PngWriter&&) noexcept;
  PngWriter& operator=(PngWriter&&) noexcept;
  ~PngWriter();

  /// The next rows, from the top on, as wide as the picture. Errors: kInput for rows of another width or more
  /// of them than the picture has; kFailed when the disk is full.
  [[nodiscard]] engine::Status write(const Image& rows);
  /// After the last row: the file appears. Errors as write(), and kInput when rows are missing.
  [[nodiscard]] engine::Status finish();

 private:
  struct Impl;
  explicit PngWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A whole picture at once. Errors as PngWriter.
[[nodiscard]] engine::Status writePng(const Image& image, const std::string& path);

/// Reads any PNG as 8-bit RGBA. Errors: kInput for a file that cannot be read, is no PNG, is cut short, or
/// has more than 2^28 pixels.
[[nodiscard]] engine::Result<Image> readPng(const std::string& path);

}  // namespace fettle::render

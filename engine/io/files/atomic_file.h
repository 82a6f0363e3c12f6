#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace fettle::engine {

/// A file that appears whole or not at all: written under a temporary name in the folder of the final one,
/// flushed to the disk, then renamed over it. Dropped without commit() - an error, a cancel, an early return
/// - the temporary file is removed and what stood at the final path stands there still.
///
///   Result<AtomicFile> file = AtomicFile::create("out.tif");
///   if (!file) return tl::unexpected(file.error());
///   ... write to file->temporaryPath() by any library, and close it, or call file->write() ...
///   return file->commit();
///
/// A final path that is a symbolic link is followed; one that exists and is no ordinary file (a folder, a
/// device, a pipe) is refused, so /dev/full and the like are never replaced. A file that is replaced passes
/// its permissions on.
///
/// Threading: one thread at a time. All errors name the final path: ErrorKind::kInput where it cannot be
/// written, kFailed where the disk is full or broken (writeError).
class AtomicFile {
 public:
  /// Creates the empty temporary file. It keeps the extension of the final path, for libraries that look at
  /// it. Errors: the folder does not exist or cannot be written, the path is no ordinary file.
  [[nodiscard]] static Result<AtomicFile> create(const std::string& final_path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  [[nodiscard]] const std::string& temporaryPath() const noexcept { return temporary_; }
  [[nodiscard]] const std::string& finalPath() const noexcept { return final_; }

  /// Appends bytes through the file's own descriptor; unbuffered, so hand over large pieces. Not to be mixed
  /// with a library that writes to temporaryPath(). Errors: full disk, file size limit; after one, drop.
  [[nodiscard]] Status write(std::string_view bytes);

  /// The error of a library that failed to write to temporaryPath(), or the disk's own where it takes no
  /// more: few libraries report that. Writes to the temporary file, so call it before the file is dropped.
  [[nodiscard]] Error explained(Error error) const;

  /// Flushes file and folder and renames; at most once, with no other writer open on the file. On error the
  /// temporary file is gone and the final path is untouched.
  [[nodiscard]] Status commit();

 private:
  AtomicFile(std::string final_path, std::string target, std::string temporary, int descriptor);
  void discard() noexcept;

  std::string final_;      // as the caller named it, for messages
  std::string target_;     // links followed
  std::string temporary_;  // empty once committed or moved from
  int descriptor_ = -1;    // open on temporary_
};

/// Why a file could not be written, from the system's error number: kFailed for a full disk, a used-up quota,
/// a limit on file sizes and a broken disk, kInput for a path that cannot be written.
[[nodiscard]] tl::unexpected<Error> writeError(const std::string& path, int error);

/// Whether a system's error number means that a disk takes no more (writeError: kFailed).
[[nodiscard]] bool isDiskError(int error) noexcept;

/// The whole of a small file at once: report, table, JSON, picture already encoded.
[[nodiscard]] Status writeFileAtomically(const std::string& path, std::string_view content);

}  // namespace fettle::engine

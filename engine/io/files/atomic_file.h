#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace fettle::engine {

/// A file that appears completely or not at all: written under a temporary name in the folder of the final
/// one, flushed to the disk, then renamed over it. Without commit() - an error, a cancel, an early return -
/// the temporary file is removed and the final path is unchanged.
///
///   Result<AtomicFile> file = AtomicFile::create("out.tif");
///   if (!file) return tl::unexpected(file.error());
///   ... write to file->temporaryPath() by any library, and close it, or call file->write() ...
///   return file->commit();
///
/// A final path that is a symbolic link is followed; one that exists and is not a regular file (a folder, a
/// device, a pipe) is refused, so /dev/full and the like are never replaced. The new file gets the
/// permissions of the one it replaces.
///
/// Threading: one thread at a time. All errors name the final path: ErrorKind::kInput where it cannot be
/// written, kFailed where the disk is full or broken (writeError).
class AtomicFile {
 public:
  /// Creates the empty temporary file. It has the extension of the final path, for libraries that use it.
  /// Errors: the folder does not exist or cannot be written, the path is not a regular file.
  [[nodiscard]] static Result<AtomicFile> create(const std::string& final_path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  [[nodiscard]] const std::string& temporaryPath() const noexcept { return temporary_; }
  [[nodiscard]] const std::string& finalPath() const noexcept { return final_; }

  /// Appends bytes through the file's own descriptor; unbuffered, so pass large pieces. Not together with a
  /// library that writes to temporaryPath(). Errors: full disk, file size limit; destroy the file after one.
  [[nodiscard]] Status write(std::string_view bytes);

  /// The error of a library that failed to write to temporaryPath(), or the disk's own error where it is
  /// full: few libraries report that. Writes to the temporary file, so call it before the file is destroyed.
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

/// Gives a finished file, whose samples are on the disk, the name of another, as AtomicFile does: links are followed, the one that is
/// replaced leaves its permissions. Where a link leads to another disk the bytes are copied. On an error `finished` stays and the
/// final path is untouched. Errors and thread as AtomicFile.
[[nodiscard]] Status replaceFile(const std::string& finished, const std::string& final_path);

/// Why a file could not be written, from the system's error number: kFailed for a full disk, a used-up quota,
/// a limit on file sizes and a broken disk, kInput for a path that cannot be written.
[[nodiscard]] tl::unexpected<Error> writeError(const std::string& path, int error);

/// Whether a system's error number means that the disk is full or failed (writeError: kFailed).
[[nodiscard]] bool isDiskError(int error) noexcept;

/// Writes all of a small file: report, table, JSON, encoded picture.
[[nodiscard]] Status writeFileAtomically(const std::string& path, std::string_view content);

/// Collects text for an AtomicFile and writes it in large pieces. The caller appends to text, calls
/// flushIfLarge() regularly (each row), and flush() at the end.
struct TextWriter {
  AtomicFile& file;
  std::string text{};

  [[nodiscard]] Status flushIfLarge() { return text.size() < kPiece ? Status{} : flush(); }
  [[nodiscard]] Status flush() {
    Status status = file.write(text);
    text.clear();
    return status;
  }

  static constexpr std::size_t kPiece = std::size_t{4} << 20;
};

}  // namespace fettle::engine

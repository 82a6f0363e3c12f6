#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/filter/block_pass.h"

namespace fettle::engine {

/// Blocks of one pass and those of their tiles that changed.
struct DoneBlocks {
  std::vector<TileRect> blocks;
  std::vector<NewTile> tiles;
};

/// The file of kept work (docs/formats.md): a head with the identity and the passes that are complete, the tiles that
/// these changed, and a journal of blocks of the next pass. Every part has a checksum; a part counts once it and all
/// before it are whole.
///
/// Threading: one thread at a time. Errors as writeError(); of a file that cannot be used kInput.
class WorkFile {
 public:
  /// A new file with this head and these tiles, flushed to the disk and then renamed to `path`; what was there is gone.
  [[nodiscard]] static Result<WorkFile> create(const std::string& path, const std::string& identity,
                                               int passes, std::span<const NewTile> tiles);

  /// What a file holds.
  struct Content {
    bool there = false;       ///< there is a file whose head and tiles are whole
    std::string identity;     ///< as given to create()
    int passes = 0;           ///< complete ones
    std::uint64_t whole = 0;  ///< bytes up to the first part that is not whole
    std::uint64_t bytes = 0;  ///< of the file, 0: none
  };
  /// Reads the head alone. Errors (kInput): a file that is no kept work, or cannot be read.
  [[nodiscard]] static Result<Content> look(const std::string& path);

  /// Samples of a tile as they are taken back: a new tile for this place, or none where it does not fit.
  using Restore = std::function<TileRef(std::int32_t column, std::int32_t row, const float* samples)>;
  struct Taken;
  /// Opens a file for more, having read all of it: what is not whole is cut off. content.there is false where the tiles
  /// are not whole: only create() may follow. Errors (kInput): the file is in use by another process, or read-only.
  [[nodiscard]] static Result<Taken> open(const std::string& path, const Restore& restore);

  WorkFile() = default;
  WorkFile(WorkFile&& other) noexcept;
  WorkFile& operator=(WorkFile&& other) noexcept;
  ~WorkFile();

  /// Appends to the journal and flushes to the disk. After an error the file is as before.
  [[nodiscard]] Status append(const DoneBlocks& done);

  /// Removes the file, which is of no more use.
  void remove();

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] bool isOpen() const noexcept { return descriptor_ >= 0; }

 private:
  WorkFile(std::string path, int descriptor, std::uint64_t bytes)
      : path_(std::move(path)), descriptor_(descriptor), bytes_(bytes) {}

  std::string path_;
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;  // that are whole
};

struct WorkFile::Taken {
  WorkFile file;
  Content content;
  std::vector<NewTile> tiles;  ///< after the complete passes
  DoneBlocks pass;             ///< of the next one
};

}  // namespace fettle::engine

#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"

struct archive;
struct archive_entry;

namespace fettle::engine {

/// Reads a zip file entry by entry. Nothing is written to the disk, and names are only compared: ".." has no
/// effect. Threading: one thread.
class ZipReader {
 public:
  /// `file` must outlive the reader.
  explicit ZipReader(const InputFile& file);

  /// Moves to the next entry; false at the end or after an error, see status(). Costs reading the archive's
  /// directory, not decompressing the previous entry.
  [[nodiscard]] bool next();
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Status& status() const noexcept { return status_; }

  /// Moves to the entry of that name after the current one; false if there is none.
  [[nodiscard]] bool find(std::string_view name);

  /// The next bytes of the entry, decompressed; 0 at its end. An error when the compression is damaged,
  /// encrypted or of an unknown kind.
  [[nodiscard]] Result<std::size_t> read(char* out, std::size_t bytes);

 private:
  struct Free {
    void operator()(archive* a) const noexcept;
  };
  struct Source;
  struct FreeSource {
    void operator()(Source* source) const noexcept;
  };
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& otherwise) const;

  const InputFile& file_;
  std::unique_ptr<Source, FreeSource> source_;
  std::unique_ptr<archive, Free> archive_;
  std::string name_;
  Status status_;
};

/// Writes a zip into an AtomicFile, entry after entry, Deflate. No times: the same content gives the same
/// bytes. Threading: one thread.
class ZipWriter {
 public:
  /// `file` must outlive the writer; it is committed by the caller after finish().
  explicit ZipWriter(AtomicFile& file);

  /// Begins an entry of exactly `bytes` bytes, which write() then gets in pieces of any size.
  [[nodiscard]] Status begin(const std::string& name, std::uint64_t bytes);
  [[nodiscard]] Status write(const char* bytes, std::size_t count);
  [[nodiscard]] Status finish();

 private:
  struct Free {
    void operator()(archive* a) const noexcept;
  };
  struct Sink {
    AtomicFile* file;
    Status status;
  };
  [[nodiscard]] Status refuse() const;

  std::unique_ptr<Sink> sink_;
  std::unique_ptr<archive, Free> archive_;
};

}  // namespace fettle::engine

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"

namespace fettle::engine {

// PNG through libpng, row by row. Not through GDAL: version 3.6 swaps the bytes of interlaced 16-bit
// pictures.

struct PngHeader {
  std::int32_t width = 0;
  std::int32_t height = 0;
  int bits = 8;             ///< 1, 2, 4, 8 or 16; below 8 a sample still takes one byte in the rows
  bool alpha = false;       ///< a second channel, left out of the rows
  bool interlaced = false;  ///< the whole picture is held while it is read
  std::optional<std::uint16_t> transparent;  ///< the one value that the file declares transparent
  std::optional<std::pair<std::uint32_t, std::uint32_t>> per_metre;  ///< pixels across, down
  std::string description;  ///< of a file that is read: its text "Description", empty if none; one line
};

/// Reads a grey PNG. Threading: one thread at a time.
class PngReader {
 public:
  /// Reads the header. Errors (kInput): no PNG, damaged, colour or palette, a side past Grid::kMaxSide, more
  /// samples than the file can hold. `file` must outlive the reader.
  [[nodiscard]] static Result<PngReader> open(const InputFile& file);
  PngReader(PngReader&&) noexcept;
  PngReader& operator=(PngReader&&) noexcept;
  ~PngReader();

  [[nodiscard]] const PngHeader& header() const noexcept { return header_; }

  /// The next row from the top: header().width samples of 2 bytes (native order) at 16 bits, else of 1 byte.
  [[nodiscard]] Status readRow(unsigned char* row);
  /// After the last row: checks that the end of the file is valid.
  [[nodiscard]] Status finish();

 private:
  struct State;
  explicit PngReader(std::unique_ptr<State> state);
  [[nodiscard]] Status readHeader();
  [[nodiscard]] Status readInterlaced();

  std::unique_ptr<State> state_;
  PngHeader header_;
  std::vector<unsigned char> picture_;  // of an interlaced file
  std::size_t next_row_ = 0;
};

/// Writes a grey PNG of 8 or 16 bits into an AtomicFile, which it does not commit.
class PngWriter {
 public:
  /// `text`: a comment under the keyword "Description", empty for none; header.description is not used.
  /// per_metre: see PngHeader.
  [[nodiscard]] static Result<PngWriter> create(AtomicFile& file, const PngHeader& header,
                                                const std::string& text);
  PngWriter(PngWriter&&) noexcept;
  PngWriter& operator=(PngWriter&&) noexcept;
  ~PngWriter();

  [[nodiscard]] Status writeRow(const unsigned char* row);
  [[nodiscard]] Status finish();

 private:
  struct State;
  explicit PngWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace fettle::engine

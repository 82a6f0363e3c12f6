#include "engine/io/raster/png_stream.h"

#include <bit>
#include <csetjmp>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <png.h>

#include "engine/field/grid.h"
#include "engine/io/field_limits.h"

// libpng reports errors by longjmp. Every function here that calls setjmp has only trivial locals, and every
// callback has destroyed its objects before it calls png_error.

namespace fettle::engine {

namespace {

void keepQuiet(png_structp, png_const_charp) {}

}  // namespace

struct PngReader::State {
  const InputFile* file = nullptr;
  std::uint64_t offset = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string message;

  ~State() { png_destroy_read_struct(&png, &info, nullptr); }

  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    auto* state = static_cast<State*>(png_get_error_ptr(png));
    state->message = message;
    std::longjmp(*png_set_longjmp_fn(png, std::longjmp, sizeof(std::jmp_buf)), 1);
  }
  static bool pull(State* state, png_bytep out, std::size_t bytes) {
    const Result<std::size_t> got = state->file->read(state->offset, reinterpret_cast<char*>(out), bytes);
    state->offset += bytes;
    return got && *got == bytes;
  }
  static void read(png_structp png, png_bytep out, std::size_t bytes) {
    if (!pull(static_cast<State*>(png_get_io_ptr(png)), out, bytes))
      png_error(png, "the file ends too early");
  }
  // libpng only warns of a chunk longer than its limit, and still allocates its buffer. Rows take at most 4
  // bytes per sample, and nothing else that is read is held completely.
  static constexpr png_alloc_size_t kMostBytes = 16U << 20;
  static_assert(kMostBytes > 4ULL * Grid::kMaxSide + 4096);
  static png_voidp allocate(png_structp, png_alloc_size_t bytes) {
    return bytes > kMostBytes ? nullptr : std::malloc(bytes);
  }
  static void release(png_structp, png_voidp memory) { std::free(memory); }
  [[nodiscard]] tl::unexpected<Error> damaged() const {
    return inputError("the PNG cannot be read: " + message, file->path(), "the file is cut short or damaged");
  }

  // Texts before the samples only: later ones come too late for reading these.
  [[nodiscard]] std::string description() const {
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(png, info, &texts, &count);
    for (int i = 0; i < count; ++i) {
      if (texts[i].key == nullptr || texts[i].text == nullptr ||
          std::strcmp(texts[i].key, "Description") != 0)
        continue;
      const std::string_view text = texts[i].text;
      return std::string(text.substr(0, text.find_first_of("\r\n")));
    }
    return {};
  }

  // Each returns false after a longjmp.
  bool header() {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_user_limits(png, Grid::kMaxSide, Grid::kMaxSide);
    png_set_chunk_malloc_max(png, 8U << 20);
    png_read_info(png, info);
    return true;
  }
  bool prepare(bool strip_alpha) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_packing(png);  // samples below 8 bits unpacked to a byte, values as stored
    if (strip_alpha) png_set_strip_alpha(png);
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
  }
  bool row(png_bytep out) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_read_row(png, out, nullptr);
    return true;
  }
  bool picture(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_read_image(png, rows);
    return true;
  }
  bool end() {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_read_end(png, nullptr);
    return true;
  }
};

PngReader::PngReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
PngReader::PngReader(PngReader&&) noexcept = default;
PngReader& PngReader::operator=(PngReader&&) noexcept = default;
PngReader::~PngReader() = default;

Result<PngReader> PngReader::open(const InputFile& file) {
  auto state = std::make_unique<State>();
  state->file = &file;
  state->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, state.get(), State::fail, keepQuiet, nullptr,
                                        State::allocate, State::release);
  if (state->png != nullptr) state->info = png_create_info_struct(state->png);
  if (state->info == nullptr) return failure("there is not enough memory to read the PNG", file.path());
  png_set_read_fn(state->png, state.get(), State::read);
  PngReader reader(std::move(state));
  if (Status status = reader.readHeader(); !status) return tl::unexpected(status.error());
  return reader;
}

Status PngReader::readHeader() {
  State& s = *state_;
  if (!s.header()) return s.damaged();
  const int color = png_get_color_type(s.png, s.info);
  if (color != PNG_COLOR_TYPE_GRAY && color != PNG_COLOR_TYPE_GRAY_ALPHA)
    return inputError(color == PNG_COLOR_TYPE_PALETTE
                          ? "the PNG is a picture with a palette, not one grey band"
                          : "the PNG is a colour picture, not one grey band",
                      s.file->path(), "export one grey band");
  const std::uint64_t width = png_get_image_width(s.png, s.info);
  const std::uint64_t height = png_get_image_height(s.png, s.info);
  header_.bits = png_get_bit_depth(s.png, s.info);
  header_.alpha = color == PNG_COLOR_TYPE_GRAY_ALPHA;
  header_.interlaced = png_get_interlace_type(s.png, s.info) != PNG_INTERLACE_NONE;
  const std::uint64_t channels = header_.alpha ? 2 : 1;
  const std::uint64_t row = (width * channels * static_cast<std::uint64_t>(header_.bits) + 7) / 8 + 1;
  if (Status status = checkPromise(row * height, s.file->size(), 1032.0, s.file->path()); !status)
    return status;
  const std::uint64_t held = header_.interlaced ? width * height * 2 * channels : 0;
  if (Status status = checkFieldSize(width, height, held, s.file->path()); !status) return status;
  header_.width = static_cast<std::int32_t>(width);
  header_.height = static_cast<std::int32_t>(height);
  png_color_16p transparent = nullptr;
  if (png_get_tRNS(s.png, s.info, nullptr, nullptr, &transparent) != 0 && transparent != nullptr)
    header_.transparent = transparent->gray;
  png_uint_32 across = 0;
  png_uint_32 down = 0;
  int unit = 0;
  if (png_get_pHYs(s.png, s.info, &across, &down, &unit) != 0 && unit == PNG_RESOLUTION_METER && across > 0 &&
      down > 0)
    header_.per_metre = std::pair{std::uint32_t{across}, std::uint32_t{down}};
  header_.description = s.description();
  return s.prepare(header_.alpha) ? Status{} : s.damaged();
}

Status PngReader::readInterlaced() {
  const std::size_t row = png_get_rowbytes(state_->png, state_->info);
  picture_.resize(row * header_.height);
  std::vector<png_bytep> rows(static_cast<std::size_t>(header_.height));
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = picture_.data() + r * row;
  return state_->picture(rows.data()) ? Status{} : state_->damaged();
}

Status PngReader::readRow(unsigned char* row) {
  if (!header_.interlaced) return state_->row(row) ? Status{} : state_->damaged();
  if (picture_.empty())
    if (Status status = readInterlaced(); !status) return status;
  const std::size_t bytes = picture_.size() / static_cast<std::size_t>(header_.height);
  std::memcpy(row, picture_.data() + bytes * next_row_++, bytes);
  return {};
}

Status PngReader::finish() {
  return state_->end() ? Status{} : state_->damaged();
}

struct PngWriter::State {
  AtomicFile* file = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string pending;
  std::string message;
  Status status;

  static constexpr std::size_t kPiece = 1U << 20;

  ~State() { png_destroy_write_struct(&png, &info); }

  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<State*>(png_get_error_ptr(png))->message = message;
    std::longjmp(*png_set_longjmp_fn(png, std::longjmp, sizeof(std::jmp_buf)), 1);
  }
  bool flush() {
    status = file->write(pending);
    pending.clear();
    return status.has_value();
  }
  static void write(png_structp png, png_bytep bytes, std::size_t count) {
    auto* state = static_cast<State*>(png_get_io_ptr(png));
    state->pending.append(reinterpret_cast<const char*>(bytes), count);
    if (state->pending.size() >= kPiece && !state->flush()) png_error(png, "write");
  }
  static void flushNothing(png_structp) {}

  [[nodiscard]] tl::unexpected<Error> error() const {
    if (!status) return tl::unexpected(status.error());
    return failure("the PNG cannot be written: " + message, file->finalPath());
  }
  bool begin(const PngHeader& header, png_textp text, int texts) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_user_limits(png, Grid::kMaxSide, Grid::kMaxSide);
    png_set_IHDR(png, info, static_cast<png_uint_32>(header.width), static_cast<png_uint_32>(header.height),
                 header.bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (header.per_metre)
      png_set_pHYs(png, info, header.per_metre->first, header.per_metre->second, PNG_RESOLUTION_METER);
    if (texts > 0) png_set_text(png, info, text, texts);
    png_write_info(png, info);
    if constexpr (std::endian::native == std::endian::little)
      if (header.bits == 16) png_set_swap(png);
    return true;
  }
  bool row(const unsigned char* bytes) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_write_row(png, bytes);
    return true;
  }
  bool end() {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_write_end(png, nullptr);
    return true;
  }
};

PngWriter::PngWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PngWriter::PngWriter(PngWriter&&) noexcept = default;
PngWriter& PngWriter::operator=(PngWriter&&) noexcept = default;
PngWriter::~PngWriter() = default;

Result<PngWriter> PngWriter::create(AtomicFile& file, const PngHeader& header, const std::string& text) {
  auto state = std::make_unique<State>();
  state->file = &file;
  state->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, state.get(), State::fail, keepQuiet);
  if (state->png != nullptr) state->info = png_create_info_struct(state->png);
  if (state->info == nullptr) return failure("there is not enough memory to write the PNG", file.finalPath());
  png_set_write_fn(state->png, state.get(), State::write, State::flushNothing);
  std::string key = "Description";
  std::string value = text;
  png_text entry{};
  entry.compression = PNG_TEXT_COMPRESSION_NONE;
  entry.key = key.data();
  entry.text = value.data();
  entry.text_length = value.size();
  if (!state->begin(header, &entry, text.empty() ? 0 : 1)) return state->error();
  return PngWriter(std::move(state));
}

Status PngWriter::writeRow(const unsigned char* row) {
  return state_->row(row) ? Status{} : state_->error();
}

Status PngWriter::finish() {
  if (!state_->end() || !state_->flush()) return state_->error();
  return {};
}

}  // namespace fettle::engine

#include "render/png/png.h"

#include <cstring>
#include <new>

#include <png.h>

#include "engine/io/files/atomic_file.h"

namespace fettle::render {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

void append(png_structp png, png_bytep bytes, png_size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
}
void flush(png_structp /*png*/) {}
[[noreturn]] void leave(png_structp png, png_const_charp message) {
  if (auto* text = static_cast<char*>(png_get_error_ptr(png)); text != nullptr) {
    std::strncpy(text, message, 127);
    text[127] = '\0';
  }
  png_longjmp(png, 1);
}
void ignore(png_structp /*png*/, png_const_charp /*message*/) {}

// No object with a destructor is created between setjmp and longjmp: all of them belong to the caller.
bool writeHeader(png_structp png, png_infop info, int width, int height) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 6);
  png_write_info(png, info);
  return true;
}

bool writeRow(png_structp png, const Image& rows, int y) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_write_row(png, rows.rgba.data() +
                         std::size_t{4} * static_cast<std::size_t>(rows.width) * static_cast<std::size_t>(y));
  return true;
}

bool writeEnd(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_write_end(png, info);
  return true;
}

// Bytes that are written to the file together.
constexpr std::size_t kBytesPerWrite = std::size_t{1} << 20;

}  // namespace

struct PngWriter::Impl {
  engine::AtomicFile file;
  int width, height, row = 0;
  std::string bytes{};  // encoded, not written yet
  char message[128] = "";
  png_structp png = nullptr;
  png_infop info = nullptr;

  Impl(engine::AtomicFile f, int w, int h) : file(std::move(f)), width(w), height(h) {}
  Impl& operator=(Impl&&) = delete;
  ~Impl() { png_destroy_write_struct(&png, &info); }

  [[nodiscard]] engine::Status refused() const {
    return engine::failure(std::string("the picture cannot be encoded: ") + message, file.finalPath());
  }
  [[nodiscard]] engine::Status flush() {
    const engine::Status status = file.write(bytes);
    bytes.clear();
    return status;
  }
};

PngWriter::PngWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PngWriter::PngWriter(PngWriter&&) noexcept = default;
PngWriter& PngWriter::operator=(PngWriter&&) noexcept = default;
PngWriter::~PngWriter() = default;

engine::Result<PngWriter> PngWriter::create(const std::string& path, int width, int height) {
  if (width <= 0 || height <= 0) return engine::inputError("there is no picture to write", path);
  engine::Result<engine::AtomicFile> file = engine::AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  auto impl = std::make_unique<Impl>(*std::move(file), width, height);
  impl->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, impl->message, leave, ignore);
  impl->info = impl->png != nullptr ? png_create_info_struct(impl->png) : nullptr;
  if (impl->info != nullptr) png_set_write_fn(impl->png, &impl->bytes, append, flush);
  if (impl->info == nullptr || !writeHeader(impl->png, impl->info, width, height))
    return tl::unexpected(impl->refused().error());
  return PngWriter(std::move(impl));
}

engine::Status PngWriter::write(const Image& rows) {
  Impl& w = *impl_;
  if (rows.width != w.width || rows.height <= 0 || rows.height > w.height - w.row ||
      rows.rgba.size() !=
          std::size_t{4} * static_cast<std::size_t>(rows.width) * static_cast<std::size_t>(rows.height))
    return engine::inputError("these are not the rows of the picture", w.file.finalPath());
  for (int y = 0; y < rows.height; ++y) {
    if (!writeRow(w.png, rows, y)) return w.refused();
    if (w.bytes.size() < kBytesPerWrite) continue;
    if (engine::Status status = w.flush(); !status) return status;
  }
  w.row += rows.height;
  return {};
}

engine::Status PngWriter::finish() {
  Impl& w = *impl_;
  if (w.row != w.height) return engine::inputError("rows of the picture are missing", w.file.finalPath());
  if (!writeEnd(w.png, w.info)) return w.refused();
  if (engine::Status status = w.flush(); !status) return status;
  return w.file.commit();
}

engine::Status writePng(const Image& image, const std::string& path) {
  engine::Result<PngWriter> writer = PngWriter::create(path, image.width, image.height);
  if (!writer) return tl::unexpected(writer.error());
  if (engine::Status status = writer->write(image); !status) return status;
  return writer->finish();
}

engine::Result<Image> readPng(const std::string& path) {
  png_image reader;
  std::memset(&reader, 0, sizeof(reader));
  reader.version = PNG_IMAGE_VERSION;
  const auto refuse = [&]() {
    const std::string what = reader.message;
    png_image_free(&reader);
    return engine::inputError("cannot read the picture: " + what, path, "give a whole PNG file");
  };
  if (png_image_begin_read_from_file(&reader, path.c_str()) == 0) return refuse();
  if (std::int64_t{reader.width} * reader.height > kMostPixels) {
    png_image_free(&reader);
    return engine::inputError("the picture has more than 2^28 pixels", path, "give a smaller one");
  }
  reader.format = PNG_FORMAT_RGBA;
  Image image;
  image.width = static_cast<int>(reader.width);
  image.height = static_cast<int>(reader.height);
  try {
    image.rgba.resize(PNG_IMAGE_SIZE(reader));
  } catch (const std::bad_alloc&) {
    png_image_free(&reader);
    return engine::failure("not enough memory for the picture", path);
  }
  if (png_image_finish_read(&reader, nullptr, image.rgba.data(), 0, nullptr) == 0) return refuse();
  return image;
}

}  // namespace fettle::render

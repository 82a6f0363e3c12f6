#include <cstring>
#include <new>

#include <png.h>

#include "engine/io/files/atomic_file.h"
#include "render/plan/picture.h"

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

// No object with a destructor lives between setjmp and longjmp: everything that has one comes from outside.
bool encode(png_structp png, png_infop info, const Image& image) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 6);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, image.rgba.data() + std::size_t{4} * static_cast<std::size_t>(image.width) *
                                               static_cast<std::size_t>(y));
  png_write_end(png, info);
  return true;
}

}  // namespace

engine::Status writePng(const Image& image, const std::string& path) {
  if (image.width <= 0 || image.height <= 0 ||
      image.rgba.size() !=
          std::size_t{4} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    return engine::inputError("there is no picture to write", path);
  std::string bytes;
  char message[128] = "";
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, message, leave, ignore);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  bool ok = info != nullptr;
  if (ok) {
    png_set_write_fn(png, &bytes, append, flush);
    ok = encode(png, info, image);
  }
  png_destroy_write_struct(&png, &info);
  if (!ok) return engine::failure(std::string("the picture cannot be encoded: ") + message, path);
  return engine::writeFileAtomically(path, bytes);
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

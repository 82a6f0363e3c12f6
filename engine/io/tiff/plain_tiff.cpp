#include "engine/io/tiff/plain_tiff.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <memory>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <fmt/format.h>
#include <tiffio.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/write_at.h"
#include "engine/io/tiff/tiff_header.h"

namespace fettle::engine {

namespace {

static_assert(std::endian::native == std::endian::little);

// A file that libtiff writes blocks to of which only the place is kept: their bytes are left out.
struct OutlineFile {
  int descriptor = -1;
  bool leaves_out = false;
  off_t at = 0, end = 0;
  int error = 0;
};

OutlineFile& outlineOf(thandle_t handle) {
  return *static_cast<OutlineFile*>(handle);
}

tmsize_t readOutline(thandle_t handle, void* bytes, tmsize_t size) {
  OutlineFile& file = outlineOf(handle);
  const ssize_t got = pread(file.descriptor, bytes, static_cast<std::size_t>(size), file.at);
  if (got > 0) file.at += got;
  return got;
}

tmsize_t writeOutline(thandle_t handle, void* bytes, tmsize_t size) {
  OutlineFile& file = outlineOf(handle);
  if (!file.leaves_out) {
    const std::string_view all(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
    if (const int error = writeAt(file.descriptor, all, static_cast<std::uint64_t>(file.at)); error != 0) {
      file.error = error;
      return 0;
    }
  }
  file.at += size;
  file.end = std::max(file.end, file.at);
  return size;
}

toff_t seekOutline(thandle_t handle, toff_t offset, int whence) {
  OutlineFile& file = outlineOf(handle);
  const off_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? file.at : file.end;
  file.at = from + static_cast<off_t>(offset);
  return static_cast<toff_t>(file.at);
}

int closeOutline(thandle_t) {
  return 0;
}

toff_t sizeOfOutline(thandle_t handle) {
  return static_cast<toff_t>(outlineOf(handle).end);
}

struct CloseOutline {
  void operator()(TIFF* file) const noexcept { TIFFClose(file); }
};

// Gives every block its place behind the header, as writing them one after another would.
Result<PlainLayout> placeBlocks(const Grid& grid, OutlineFile& outline, const std::string& path) {
  const GdalSession session;
  const auto refused = [&]() -> tl::unexpected<Error> {
    if (outline.error != 0) return writeError(path, outline.error);
    return cannotWriteTiff(session, path);
  };
  const std::unique_ptr<TIFF, CloseOutline> file(TIFFClientOpen(path.c_str(), "r+m", &outline, readOutline,
                                                                writeOutline, seekOutline, closeOutline,
                                                                sizeOfOutline, nullptr, nullptr));
  if (!file) return refused();
  const TiffBlocks blocks(grid, TiffCompression::kNone);
  const auto row_bytes = static_cast<std::size_t>(grid.width) * sizeof(float);
  std::vector<std::uint8_t> nothing(row_bytes * static_cast<std::size_t>(blocks.rows));
  PlainLayout layout{grid.width, grid.height, 0, 0};
  outline.leaves_out = true;
  for (std::int32_t block = 0; block < blocks.down; ++block) {
    const std::int32_t rows = std::min(blocks.rows, grid.height - block * blocks.rows);
    const auto size = static_cast<tmsize_t>(row_bytes * static_cast<std::size_t>(rows));
    const auto number = static_cast<std::uint32_t>(block);
    if (TIFFWriteRawStrip(file.get(), number, nothing.data(), size) != size) return refused();
    const auto offset = static_cast<std::uint64_t>(TIFFGetStrileOffset(file.get(), number));
    if (block == 0) layout.first_byte = offset;
    const std::uint64_t expected = layout.first_byte + static_cast<std::uint64_t>(block) *
                                                           static_cast<std::uint64_t>(blocks.rows) *
                                                           layout.rowBytes();
    if (offset != expected) return failure("the samples have no place in one piece", path);
  }
  outline.leaves_out = false;
  if (TIFFFlush(file.get()) != 1 || session.failed()) return refused();
  layout.bytes = static_cast<std::uint64_t>(outline.end);
  return layout;
}

class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor& operator=(Descriptor&&) = delete;
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

// Why open(2) failed: a file that is missing is to be made again, others are there, whatever refuses them.
tl::unexpected<Error> cannotOpen(const std::string& path, const char* remedy_where_missing) {
  const int error = errno;
  if (error == ENOENT || error == ENOTDIR)
    return inputError("the file is missing", path, remedy_where_missing);
  return failure(fmt::format("the file cannot be opened: {}", std::generic_category().message(error)), path);
}

}  // namespace

Result<PlainLayout> createPlainTiff(const Grid& grid, const std::string& path) {
  Result<AtomicFile> whole = AtomicFile::create(path);
  if (!whole) return tl::unexpected(whole.error());
  if (Status status = writeTiffHeader(grid, TiffCompression::kNone, whole->temporaryPath(), path); !status)
    return tl::unexpected(whole->explained(status.error()));
  const Descriptor file(::open(whole->temporaryPath().c_str(), O_RDWR | O_CLOEXEC));
  if (file.number() < 0) return writeError(path, errno);
  struct stat header {};
  if (fstat(file.number(), &header) != 0) return writeError(path, errno);
  OutlineFile outline{file.number(), false, 0, header.st_size, 0};
  Result<PlainLayout> layout = placeBlocks(grid, outline, path);
  if (!layout) return layout;
  const auto bytes = static_cast<off_t>(layout->bytes);
  // Not every file system can take blocks before they are written; posix_fallocate would then write all of them.
  if (fallocate(file.number(), 0, 0, bytes) != 0) {
    if (errno != EOPNOTSUPP && errno != ENOSYS) return writeError(path, errno);
    if (ftruncate(file.number(), bytes) != 0) return writeError(path, errno);
  }
  if (Status status = whole->commit(); !status) return tl::unexpected(status.error());
  return layout;
}

Result<PlainLayout> layoutOfPlainTiff(const std::string& path, std::int32_t width, std::int32_t height) {
  const GdalSession session;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return cannotOpen(path, "do the shard again");
  // libtiff closes what it has taken.
  const std::unique_ptr<TIFF, CloseOutline> file(TIFFFdOpen(descriptor, path.c_str(), "rm"));
  if (!file) ::close(descriptor);
  struct stat found {};
  std::uint32_t columns = 0, rows = 0;
  if (!file || fstat(TIFFFileno(file.get()), &found) != 0 ||
      TIFFGetField(file.get(), TIFFTAG_IMAGEWIDTH, &columns) != 1 ||
      TIFFGetField(file.get(), TIFFTAG_IMAGELENGTH, &rows) != 1 ||
      columns != static_cast<std::uint32_t>(width) || rows != static_cast<std::uint32_t>(height))
    return inputError("this is not the file of a shard", path, "do the shard again");
  const PlainLayout layout{width, height, TIFFGetStrileOffset(file.get(), 0),
                           static_cast<std::uint64_t>(found.st_size)};
  return layout;
}

Result<PlainRows> PlainRows::open(const std::string& path, const PlainLayout& layout) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return cannotOpen(path, "plan the work again: fettle plan");
  PlainRows rows(path, layout, descriptor);
  struct stat found {};
  if (fstat(descriptor, &found) != 0 || static_cast<std::uint64_t>(found.st_size) != layout.bytes)
    return inputError("the file that was made for all shards is not as long as planned", path,
                      "plan the work again: fettle plan");
  return rows;
}

PlainRows::~PlainRows() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status PlainRows::write(std::int32_t row, std::int32_t rows, const float* heights) {
  std::vector<float> turned(static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(rows));
  const auto width = static_cast<std::size_t>(layout_.width);
  for (std::int32_t r = 0; r < rows; ++r)
    std::copy_n(heights + static_cast<std::size_t>(rows - 1 - r) * width, width,
                turned.data() + static_cast<std::size_t>(r) * width);
  const std::string_view bytes(reinterpret_cast<const char*>(turned.data()), turned.size() * sizeof(float));
  const int error = writeAt(descriptor_, bytes, layout_.offsetOf(row + rows - 1));
  return error != 0 ? Status(writeError(path_, error)) : Status();
}

Status PlainRows::read(std::int32_t row, std::int32_t rows, float* heights) const {
  const std::size_t row_bytes = layout_.rowBytes();
  for (std::int32_t r = 0; r < rows; ++r) {
    char* const to = reinterpret_cast<char*>(heights) + static_cast<std::size_t>(r) * row_bytes;
    for (std::size_t done = 0; done < row_bytes;) {
      const ssize_t got = pread(descriptor_, to + done, row_bytes - done,
                                static_cast<off_t>(layout_.offsetOf(row + r) + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        return failure(fmt::format("the samples cannot be read: {}", std::generic_category().message(errno)),
                       path_);
      if (got == 0)
        return inputError("the samples cannot be read", path_, "the file is cut short or damaged");
      done += static_cast<std::size_t>(got);
    }
  }
  return {};
}

Status PlainRows::flush() {
  if (fdatasync(descriptor_) != 0) return writeError(path_, errno);
  return {};
}

bool keepsBytesApart(const std::string& folder) {
  // Numbers of statfs(2): ext, XFS, Btrfs, tmpfs, ramfs, overlay, F2FS, ZFS, bcachefs; Lustre, GPFS, BeeGFS, Ceph, OrangeFS, OCFS2, GFS2.
  constexpr std::array<std::uint32_t, 16> kKnown{
      0xEF53,     0x58465342, 0x9123683E, 0x01021994, 0x858458F6, 0x794C7630, 0xF2F52010, 0x2FC12FC1,
      0xCA451A4E, 0x0BD00BD0, 0x47504653, 0x19830326, 0x00C36400, 0x20030528, 0x7461636F, 0x01161970};
  struct statfs system {};
  if (statfs(folder.empty() ? "." : folder.c_str(), &system) != 0) return false;
  return std::ranges::find(kKnown, static_cast<std::uint32_t>(system.f_type)) != kKnown.end();
}

}  // namespace fettle::engine

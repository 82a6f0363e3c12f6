#include "engine/resume/work_file.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <xxhash.h>

#include "engine/field/tile.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/write_at.h"

namespace fettle::engine {

namespace {

static_assert(std::endian::native == std::endian::little, "parts are written as they lie in memory");

constexpr std::string_view kSignature{"FETTLEKW", 8};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kPart = 0x54524150;  // "PART"
constexpr std::uint32_t kMostIdentity = 1U << 20;
constexpr std::size_t kTilesOfAPart = 1024;  // of the complete passes

// The fixed beginning of a file; the identity and a checksum of both follow.
struct Head {
  char signature[8];
  std::uint32_t version, identity_bytes, passes, tiles;
};
static_assert(sizeof(Head) == 24);

// Of a part; its blocks, tiles and a checksum of all of it follow.
struct PartHead {
  std::uint32_t signature, blocks, tiles, reserved;
};
struct BlockRecord {
  std::int32_t column0, row0, column1, row1;
};
struct TileRecord {
  std::int32_t column, row;
  std::int64_t changed;
  double max_change, squares;
};
static_assert(sizeof(PartHead) == 16 && sizeof(BlockRecord) == 16 && sizeof(TileRecord) == 32);

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] int release() noexcept { return std::exchange(number_, -1); }

 private:
  int number_;
};

class Checksum {
 public:
  // `seed`: the place in the file, so that a part counts in no other.
  explicit Checksum(std::uint64_t seed) : state_(XXH64_createState(), XXH64_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH64_reset(state_.get(), seed);
  }
  void add(const void* bytes, std::size_t count) { XXH64_update(state_.get(), bytes, count); }
  [[nodiscard]] std::uint64_t value() const { return XXH64_digest(state_.get()); }

 private:
  std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state_;
};

// Writes from an offset on, in large pieces.
class Writer {
 public:
  Writer(int descriptor, std::uint64_t at, std::uint64_t seed)
      : descriptor_(descriptor), at_(at), sum_(seed) {
    buffer_.reserve(kPiece + 2 * kTileSamples * sizeof(float));
  }
  void put(const void* bytes, std::size_t count) {
    sum_.add(bytes, count);
    buffer_.append(static_cast<const char*>(bytes), count);
    if (buffer_.size() >= kPiece) flush();
  }
  // Ends with the checksum; the error number of the first failure, 0 for none.
  int finish() {
    const std::uint64_t sum = sum_.value();
    put(&sum, sizeof sum);
    flush();
    return error_;
  }
  // Where that ended, without an error.
  [[nodiscard]] std::uint64_t end() const noexcept { return at_; }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 20;

  void flush() {
    if (error_ == 0) error_ = writeAt(descriptor_, buffer_, at_);
    at_ += buffer_.size();
    buffer_.clear();
  }

  int descriptor_;
  std::uint64_t at_;
  Checksum sum_;
  std::string buffer_;
  int error_ = 0;
};

// Reads from an offset on; at the end of the file every take() is false.
class Reader {
 public:
  Reader(int descriptor, std::uint64_t at, std::uint64_t seed)
      : descriptor_(descriptor), at_(at), sum_(seed), buffer_(kPiece) {}
  bool take(void* out, std::size_t count) {
    if (!takeRaw(out, count)) return false;
    sum_.add(out, count);
    return true;
  }
  // The checksum of all that was taken, which follows.
  bool endsWhole() {
    const std::uint64_t is = sum_.value();
    std::uint64_t written = 0;
    return takeRaw(&written, sizeof written) && written == is;
  }
  [[nodiscard]] std::uint64_t at() const noexcept { return at_; }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 20;

  bool takeRaw(void* out, std::size_t count) {
    auto* to = static_cast<char*>(out);
    while (count > 0) {
      if (begin_ == end_ && !fill()) return false;
      const std::size_t now = std::min(count, end_ - begin_);
      std::memcpy(to, buffer_.data() + begin_, now);
      begin_ += now;
      at_ += now;
      to += now;
      count -= now;
    }
    return true;
  }
  bool fill() {
    ssize_t got = 0;
    do got = pread(descriptor_, buffer_.data(), buffer_.size(), static_cast<off_t>(at_));
    while (got < 0 && errno == EINTR);
    begin_ = 0;
    end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
    return got > 0;
  }

  int descriptor_;
  std::uint64_t at_;
  Checksum sum_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

tl::unexpected<Error> inUse(const std::string& path) {
  return inputError("another process works on this output", path, "wait for it, or name another output");
}

bool lock(int descriptor) {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

int writePart(int descriptor, std::uint64_t at, const DoneBlocks& part, std::span<const NewTile> tiles,
              std::uint64_t* end) {
  Writer out(descriptor, at, at);
  const PartHead head{kPart, static_cast<std::uint32_t>(part.blocks.size()),
                      static_cast<std::uint32_t>(tiles.size()), 0};
  out.put(&head, sizeof head);
  for (const TileRect& b : part.blocks) {
    const BlockRecord record{b.column0, b.row0, b.column1, b.row1};
    out.put(&record, sizeof record);
  }
  for (const NewTile& t : tiles) {
    const TileRecord record{t.column, t.row, t.report.changed, t.report.max_change, t.report.squares};
    out.put(&record, sizeof record);
    out.put(t.tile->samples.data(), sizeof t.tile->samples);
  }
  const int error = out.finish();
  *end = out.end();
  return error;
}

// One part at `at`; false where it is not whole.
bool readPart(int descriptor, std::uint64_t at, std::uint64_t file_bytes, const WorkFile::Restore& restore,
              DoneBlocks& part, std::uint64_t* end) {
  Reader in(descriptor, at, at);
  PartHead head{};
  if (!in.take(&head, sizeof head) || head.signature != kPart) return false;
  constexpr std::uint64_t kTileBytes = sizeof(TileRecord) + sizeof(Tile::samples);
  const std::uint64_t rest = file_bytes - in.at();
  // Before memory is taken for what a damaged head claims.
  if (head.blocks * sizeof(BlockRecord) + head.tiles * kTileBytes + sizeof(std::uint64_t) > rest)
    return false;
  part.blocks.reserve(head.blocks);
  part.tiles.reserve(head.tiles);
  for (std::uint32_t i = 0; i < head.blocks; ++i) {
    BlockRecord b{};
    if (!in.take(&b, sizeof b)) return false;
    part.blocks.push_back({b.column0, b.row0, b.column1, b.row1});
  }
  std::vector<float> samples(kTileSamples);
  for (std::uint32_t i = 0; i < head.tiles; ++i) {
    TileRecord t{};
    if (!in.take(&t, sizeof t) || !in.take(samples.data(), kTileSamples * sizeof(float))) return false;
    TileRef tile = restore(t.column, t.row, samples.data());
    if (!tile) return false;
    part.tiles.push_back({t.column, t.row, std::move(tile), {t.changed, t.max_change, t.squares}});
  }
  if (!in.endsWhole()) return false;
  *end = in.at();
  return true;
}

// The head of an open file into `content`; the number of tiles that follow. Errors: not a file of kept work.
Result<std::uint32_t> readHead(int descriptor, const std::string& path, WorkFile::Content& content) {
  struct stat file {};
  if (fstat(descriptor, &file) != 0)
    return inputError("the kept work cannot be read", path, "delete it to begin from the beginning");
  content.bytes = static_cast<std::uint64_t>(file.st_size);
  Reader in(descriptor, 0, 0);
  Head head{};
  char begin[kSignature.size()] = {};
  const std::size_t known = std::min<std::size_t>(content.bytes, kSignature.size());
  if (!S_ISREG(file.st_mode) || !in.take(begin, known) ||
      std::string_view(begin, known) != kSignature.substr(0, known))
    return inputError("this file is no kept work, and its name is that of the kept work of the output", path,
                      "move it, or name another output");
  if (known < kSignature.size()) return 0;
  std::memcpy(head.signature, begin, sizeof begin);
  if (!in.take(&head.version, sizeof head - sizeof head.signature) || head.version != kVersion ||
      head.identity_bytes > kMostIdentity)
    return 0;
  content.identity.resize(head.identity_bytes);
  if (!in.take(content.identity.data(), head.identity_bytes) || !in.endsWhole()) return 0;
  content.there = true;
  content.passes = static_cast<int>(head.passes);
  content.whole = in.at();
  return head.tiles;
}

int flushFolderOf(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const Descriptor folder(open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.number() < 0 || fsync(folder.number()) == 0 || errno == EINVAL) return 0;
  return errno;
}

std::string unfinished(const std::string& path) {
  return path + ".new";
}

}  // namespace

WorkFile::WorkFile(WorkFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(std::exchange(other.bytes_, 0)) {}

WorkFile& WorkFile::operator=(WorkFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

WorkFile::~WorkFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<WorkFile> WorkFile::create(const std::string& path, const std::string& identity, int passes,
                                  std::span<const NewTile> tiles) {
  const std::string temporary = unfinished(path);
  Descriptor file(::open(temporary.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666));
  if (file.number() < 0) return writeError(path, errno);
  if (!lock(file.number())) return inUse(path);
  const auto refuse = [&](int error) {
    unlink(temporary.c_str());
    return writeError(path, error);
  };
  if (ftruncate(file.number(), 0) != 0) return refuse(errno);
  Writer out(file.number(), 0, 0);
  Head head{{},
            kVersion,
            static_cast<std::uint32_t>(identity.size()),
            static_cast<std::uint32_t>(passes),
            static_cast<std::uint32_t>(tiles.size())};
  std::memcpy(head.signature, kSignature.data(), kSignature.size());
  out.put(&head, sizeof head);
  out.put(identity.data(), identity.size());
  if (const int error = out.finish(); error != 0) return refuse(error);
  std::uint64_t end = out.end();
  for (std::size_t i = 0; i < tiles.size(); i += kTilesOfAPart)
    if (const int error = writePart(file.number(), end, {},
                                    tiles.subspan(i, std::min(kTilesOfAPart, tiles.size() - i)), &end);
        error != 0)
      return refuse(error);
  if (fsync(file.number()) != 0) return refuse(errno);
  if (rename(temporary.c_str(), path.c_str()) != 0) return refuse(errno);
  if (const int error = flushFolderOf(path); error != 0) return writeError(path, error);
  return WorkFile(path, file.release(), end);
}

Result<WorkFile::Content> WorkFile::look(const std::string& path) {
  Content content;
  // Not to wait for what a pipe of that name may hold.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.number() < 0 && errno == ENOENT) return content;
  if (file.number() < 0)
    return inputError(fmt::format("the kept work cannot be read: {}", std::generic_category().message(errno)),
                      path, "change its rights, or delete it to begin from the beginning");
  const auto tiles = readHead(file.number(), path, content);
  if (!tiles) return tl::unexpected(tiles.error());
  return content;
}

Result<WorkFile::Taken> WorkFile::open(const std::string& path, const Restore& restore) {
  Descriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (file.number() < 0)
    return inputError(
        fmt::format("the kept work cannot be written: {}", std::generic_category().message(errno)), path,
        "change its rights, or delete it to begin from the beginning");
  struct stat opened {
  }, named{};
  if (!lock(file.number()) || fstat(file.number(), &opened) != 0 || stat(path.c_str(), &named) != 0 ||
      opened.st_ino != named.st_ino)
    return inUse(path);
  Taken taken;
  const auto tiles = readHead(file.number(), path, taken.content);
  if (!tiles) return tl::unexpected(tiles.error());
  Content& content = taken.content;
  if (!content.there) return taken;
  while (taken.tiles.size() < *tiles) {
    DoneBlocks part;
    if (!readPart(file.number(), content.whole, content.bytes, restore, part, &content.whole) ||
        !part.blocks.empty() || part.tiles.empty()) {
      content.there = false;
      taken.tiles.clear();
      return taken;
    }
    std::move(part.tiles.begin(), part.tiles.end(), std::back_inserter(taken.tiles));
  }
  for (;;) {
    DoneBlocks part;
    if (content.whole == content.bytes ||
        !readPart(file.number(), content.whole, content.bytes, restore, part, &content.whole))
      break;
    taken.pass.blocks.insert(taken.pass.blocks.end(), part.blocks.begin(), part.blocks.end());
    std::move(part.tiles.begin(), part.tiles.end(), std::back_inserter(taken.pass.tiles));
  }
  if (content.whole < content.bytes && ftruncate(file.number(), static_cast<off_t>(content.whole)) != 0)
    return writeError(path, errno);
  taken.file = WorkFile(path, file.release(), content.whole);
  return taken;
}

Status WorkFile::append(const DoneBlocks& done) {
  std::uint64_t end = bytes_;
  int error = writePart(descriptor_, bytes_, done, done.tiles, &end);
  if (error == 0 && fdatasync(descriptor_) != 0) error = errno;
  if (error != 0) {
    // Gives the space back; what remains beyond is no whole part.
    if (ftruncate(descriptor_, static_cast<off_t>(bytes_)) != 0) return writeError(path_, errno);
    return writeError(path_, error);
  }
  bytes_ = end;
  return {};
}

void WorkFile::remove() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());
  // Of a run that was ended while it wrote one.
  unlink(unfinished(path_).c_str());
  close(std::exchange(descriptor_, -1));
}

}  // namespace fettle::engine

#include "engine/io/files/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

namespace {

std::string remedyFor(int error) {
  switch (error) {
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder with write permission";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    default:
      return {};
  }
}

// The error number of appending to the file; 0 when that succeeds.
int refusalOf(int descriptor) {
  // More than a library is likely to have left free when its own write failed.
  constexpr std::size_t kMost = std::size_t{1} << 20;
  const std::string zeros(std::size_t{1} << 16, '\0');
  if (lseek(descriptor, 0, SEEK_END) < 0) return 0;
  for (std::size_t done = 0; done < kMost;) {
    const ssize_t now = ::write(descriptor, zeros.data(), zeros.size());
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return now < 0 ? errno : ENOSPC;
    done += static_cast<std::size_t>(now);
  }
  return fsync(descriptor) != 0 ? errno : 0;
}

// Follows symbolic links step by step, so that a link to a file that does not exist yet is followed too.
Result<std::string> followLinks(const std::string& path) {
  std::filesystem::path target = path;
  for (int links = 0; links < 40; ++links) {
    std::error_code error;
    if (!std::filesystem::is_symlink(std::filesystem::symlink_status(target, error))) return target.string();
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) return writeError(path, error.value());
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return writeError(path, ELOOP);
}

// What a final path leads to; refuses one that is no place for a file.
Result<std::string> targetOf(const std::string& final_path) {
  if (final_path.empty()) return inputError("no output file was named", {});
  Result<std::string> target = followLinks(final_path);
  if (!target) return target;
  struct stat existing {};
  if (stat(target->c_str(), &existing) == 0) {
    if (S_ISDIR(existing.st_mode))
      return inputError("the output is a folder", final_path, "name a file in it");
    if (!S_ISREG(existing.st_mode))
      return inputError("the output is not a regular file", final_path, "name a file");
    // A rename would replace even a file that its owner has write-protected.
    if (access(target->c_str(), W_OK) != 0) return writeError(final_path, errno);
  } else if (errno != ENOENT) {
    return writeError(final_path, errno);
  }
  if (!std::filesystem::path(*target).has_filename())
    return inputError("the output is a folder", final_path, "name a file in it");
  return target;
}

// Flushes a file, with the permissions of what it replaces, and renames it; the error number, 0 where it went well.
int putInPlace(const std::string& file, const std::string& target) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return errno;
  struct stat existing {
  }, own{};
  // Only the owner of a file may set permissions, those that it has too.
  const bool differs = stat(target.c_str(), &existing) == 0 &&
                       (fstat(descriptor, &own) != 0 || ((own.st_mode ^ existing.st_mode) & 07777) != 0);
  if ((differs && fchmod(descriptor, existing.st_mode & 07777) != 0) || fsync(descriptor) != 0) {
    const int error = errno;
    close(descriptor);
    return error;
  }
  if (close(descriptor) != 0) return errno;
  return rename(file.c_str(), target.c_str()) != 0 ? errno : 0;
}

// The directory entry must be flushed too, otherwise a power failure may remove the file. Some file systems
// cannot flush a folder (EINVAL); there nothing safer is possible.
Status flushFolderOf(const std::string& target, const std::string& final_path) {
  const std::filesystem::path parent = std::filesystem::path(target).parent_path();
  const int folder = open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return {};
  const int error = fsync(folder) != 0 ? errno : 0;
  close(folder);
  if (error != 0 && error != EINVAL) return writeError(final_path, error);
  return {};
}

}  // namespace

bool isDiskError(int error) noexcept {
  return error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO;
}

tl::unexpected<Error> writeError(const std::string& path, int error) {
  constexpr const char* kRoom = "free space on the disk or choose another folder";
  switch (error) {
    case ENOSPC:
      return failure("the disk is full, the file was not written", path, kRoom);
    case EDQUOT:
      return failure("the disk quota is used up, the file was not written", path, kRoom);
    case EFBIG:
      return failure("the file is larger than the limit on file sizes and was not written", path,
                     "raise the limit on file sizes (ulimit -f) or choose another disk");
    case EIO:
      return failure("the disk failed, the file was not written", path, "choose another disk");
    default:
      return inputError(fmt::format("the file cannot be written: {}", std::generic_category().message(error)),
                        path, remedyFor(error));
  }
}

AtomicFile::AtomicFile(std::string final_path, std::string target, std::string temporary, int descriptor)
    : final_(std::move(final_path)),
      target_(std::move(target)),
      temporary_(std::move(temporary)),
      descriptor_(descriptor) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : final_(std::move(other.final_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  std::swap(final_, other.final_);
  std::swap(target_, other.target_);
  std::swap(temporary_, other.temporary_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) unlink(temporary_.c_str());
  temporary_.clear();
}

Result<AtomicFile> AtomicFile::create(const std::string& final_path) {
  Result<std::string> target = targetOf(final_path);
  if (!target) return tl::unexpected(target.error());
  const std::filesystem::path as_path = *target;
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string name =
        fmt::format(".fettle-{:08x}{:08x}{}", random(), random(), as_path.extension().string());
    std::string temporary = (as_path.parent_path() / name).string();
    const int descriptor = open(temporary.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor >= 0) return AtomicFile(final_path, *target, std::move(temporary), descriptor);
    if (errno != EEXIST) return writeError(final_path, errno);
  }
  return writeError(final_path, EEXIST);
}

Status AtomicFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return writeError(final_, written < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Error AtomicFile::explained(Error error) const {
  if (error.kind == ErrorKind::kCancelled) return error;
  // By its name: a library may have replaced the file, and size limits apply to files.
  const int named = open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
  const int refusal = refusalOf(named >= 0 ? named : descriptor_);
  if (named >= 0) close(named);
  return isDiskError(refusal) ? writeError(final_, refusal).value() : error;
}

Status AtomicFile::commit() {
  // By its name: a library may have replaced the empty file by its own.
  if (const int error = putInPlace(temporary_, target_); error != 0) {
    discard();
    return writeError(final_, error);
  }
  temporary_.clear();
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  return flushFolderOf(target_, final_);
}

Status replaceFile(const std::string& finished, const std::string& final_path) {
  const Result<std::string> target = targetOf(final_path);
  if (!target) return tl::unexpected(target.error());
  const int error = putInPlace(finished, *target);
  if (error == 0) return flushFolderOf(*target, final_path);
  // A copy can be made on another disk, and with permissions that another's file cannot be given.
  if (error != EXDEV && error != EPERM) return writeError(final_path, error);
  Result<InputFile> from = InputFile::open(finished);
  if (!from) return tl::unexpected(from.error());
  Result<AtomicFile> copy = AtomicFile::create(final_path);
  if (!copy) return tl::unexpected(copy.error());
  std::string bytes(TextWriter::kPiece, '\0');
  for (std::uint64_t done = 0; done < from->size();) {
    const auto got = from->read(done, bytes.data(), bytes.size());
    if (!got) return tl::unexpected(got.error());
    if (*got == 0) return inputError("the file ends before its size", finished);
    if (Status status = copy->write({bytes.data(), *got}); !status) return status;
    done += *got;
  }
  if (Status status = copy->commit(); !status) return status;
  unlink(finished.c_str());
  return {};
}

Status writeFileAtomically(const std::string& path, std::string_view content) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (Status status = file->write(content); !status) return status;
  return file->commit();
}

}  // namespace fettle::engine

#include "engine/io/files/input_file.h"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "engine/base/lower_case.h"

namespace fettle::engine {

std::string extensionOf(const std::string& path) {
  return lowerCase(std::filesystem::path(path).extension().string());
}

InputFile::InputFile(std::string path, std::uint64_t size, int descriptor)
    : path_(std::move(path)), size_(size), descriptor_(descriptor) {}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), size_(other.size_), descriptor_(std::exchange(other.descriptor_, -1)) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<InputFile> InputFile::open(const std::string& path) {
  // Non-blocking, otherwise a pipe without a writer would block here; no effect on regular files.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const int error = errno;
    return inputError(fmt::format("the file cannot be read: {}", std::generic_category().message(error)),
                      path, error == ENOENT ? "check the path" : "check its permissions");
  }
  struct stat status {};
  const bool known = fstat(descriptor, &status) == 0;
  InputFile file(path, known ? static_cast<std::uint64_t>(status.st_size) : 0, descriptor);
  if (known && S_ISDIR(status.st_mode))
    return inputError("this is a folder, not a file", path, "name a file in it");
  if (!known || !S_ISREG(status.st_mode))
    return inputError("this is not a regular file", path, "copy the data to a file first");
  if (status.st_size == 0) return inputError("the file is empty", path, "give a scan with samples in it");
  return file;
}

std::string InputFile::extension() const {
  return extensionOf(path_);
}

std::string InputFile::pathForGdal() const {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path_, error);
  return "/." + (error ? path_ : absolute.string());
}

Result<std::size_t> InputFile::read(std::uint64_t offset, char* out, std::size_t bytes) const {
  std::size_t got = 0;
  while (got < bytes) {
    const ssize_t now = pread(descriptor_, out + got, bytes - got, static_cast<off_t>(offset + got));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0)
      return inputError(fmt::format("the file cannot be read: {}", std::generic_category().message(errno)),
                        path_);
    if (now == 0) break;
    got += static_cast<std::size_t>(now);
  }
  return got;
}

}  // namespace fettle::engine

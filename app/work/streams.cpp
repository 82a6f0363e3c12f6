#include "app/work/streams.h"

#include <cerrno>
#include <cstdio>

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "app/terminal.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

constexpr const char* kInput = "standard input";
constexpr const char* kOutput = "standard output";
constexpr std::size_t kPiece = std::size_t{1} << 18;

// Destination of data written to "-". Set once, on the main thread.
std::optional<int> data_output;

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Descriptor& operator=(Descriptor&&) = delete;
  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

// Writes all of it; the system's error number, or 0.
int writeAll(int to, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t now = write(to, bytes, count);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return now < 0 ? errno : ENOSPC;
    bytes += now;
    count -= static_cast<std::size_t>(now);
  }
  return 0;
}

// Waits for the descriptor to be ready or the job to be cancelled: a read or a write alone would continue to
// wait after Ctrl-C, because it is restarted after signals.
engine::Status await(int descriptor, short event, const engine::JobControl& job) {
  pollfd wait{descriptor, event, 0};
  do {
    if (job.cancelled()) return engine::cancelled();
  } while (poll(&wait, 1, 100) <= 0);
  return {};
}

engine::Status copyInput(int to, const std::string& scratch, engine::JobControl& job) {
  std::vector<char> buffer(kPiece);
  for (;;) {
    if (auto ready = await(STDIN_FILENO, POLLIN, job); !ready) return ready;
    const ssize_t got = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got < 0)
      return engine::inputError(fmt::format("it cannot be read: {}", std::generic_category().message(errno)),
                                kInput, "is it closed, or a folder?");
    if (got == 0) return {};
    if (const int error = writeAll(to, buffer.data(), static_cast<std::size_t>(got)); error != 0)
      return engine::failure(fmt::format("standard input cannot be kept while it is read: {}",
                                         std::generic_category().message(error)),
                             scratch, "free space there, or set TMPDIR to another folder");
  }
}

engine::Status copyOutput(const std::string& from, engine::JobControl& job) {
  const Descriptor in(open(from.c_str(), O_RDONLY | O_CLOEXEC));
  std::vector<char> buffer(kPiece);
  for (;;) {
    const ssize_t got = in.get() < 0 ? -1 : ::read(in.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return engine::failure(
          fmt::format("the finished file cannot be read: {}", std::generic_category().message(errno)), from);
    if (got == 0) return {};
    for (ssize_t at = 0; at < got;) {
      if (auto ready = await(*data_output, POLLOUT, job); !ready) return ready;
      const ssize_t now = write(*data_output, buffer.data() + at, static_cast<std::size_t>(got - at));
      if (now < 0 && errno == EINTR) continue;
      if (now < 0 && errno == EPIPE)
        return engine::failure("the reader closed it before all data was written", kOutput);
      if (now <= 0) return engine::writeError(kOutput, now < 0 ? errno : ENOSPC);
      at += now;
    }
  }
}

}  // namespace

bool isStream(const std::string& path) noexcept {
  return path == "-";
}

std::string shownInput(const std::string& path) {
  return isStream(path) ? kInput : path;
}

std::string shownOutput(const std::string& path) {
  return isStream(path) ? kOutput : path;
}

ScratchFolder::ScratchFolder(std::string path)
    : path_(new std::string(std::move(path)), [](const std::string* folder) {
        std::error_code ignored;
        std::filesystem::remove_all(*folder, ignored);
        delete folder;
      }) {}

engine::Result<ScratchFolder> ScratchFolder::create(const std::string& in) {
  std::error_code error;
  const auto folder = in.empty() ? std::filesystem::temp_directory_path(error) : std::filesystem::path(in);
  std::string name = (folder / (in.empty() ? "fettle-XXXXXX" : ".fettle-XXXXXX")).string();
  if (error || mkdtemp(name.data()) == nullptr)
    return engine::failure("there is no folder for temporary files that can be written", folder.string(),
                           "set TMPDIR to a folder you may write to");
  return ScratchFolder(std::move(name));
}

StandardInput::StandardInput(ScratchFolder folder, std::string path)
    : folder_(std::move(folder)), path_(std::move(path)) {}

engine::Result<StandardInput> StandardInput::read(const std::string& extension, engine::JobControl& job) {
  static bool taken = false;
  if (std::exchange(taken, true))
    return engine::inputError("standard input can only be read once", "-", "give one - alone");
  auto folder = ScratchFolder::create();
  if (!folder) return tl::unexpected(folder.error());
  std::string path = folder->path() + "/stdin" + extension;
  const Descriptor to(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (to.get() < 0)
    return engine::failure(fmt::format("standard input cannot be kept while it is read: {}",
                                       std::generic_category().message(errno)),
                           folder->path(), "set TMPDIR to a folder you may write to");
  if (auto copied = copyInput(to.get(), folder->path(), job); !copied) return tl::unexpected(copied.error());
  return StandardInput(*std::move(folder), std::move(path));
}

engine::Status StandardInput::nameAs(const std::string& extension) {
  std::error_code error;
  std::filesystem::rename(path_, path_ + extension, error);
  if (error)
    return engine::failure("standard input cannot be kept while it is read: " + error.message(), path_,
                           "set TMPDIR to another folder");
  path_ += extension;
  return {};
}

engine::Error StandardInput::renamed(engine::Error error) const {
  for (std::string* text : {&error.what, &error.where, &error.remedy})
    for (std::size_t at; (at = text->find(path_)) != std::string::npos;)
      text->replace(at, path_.size(), kInput);
  return error;
}

void keepStandardOutputForData() {
  if (data_output) return;
  std::fflush(stdout);
  data_output = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  dup2(STDERR_FILENO, STDOUT_FILENO);
}

engine::Status writeTo(const std::string& path, const std::string& extension, engine::JobControl& job,
                       const std::function<engine::Status(const std::string&)>& write) {
  if (!isStream(path)) return write(path);
  keepStandardOutputForData();
  const auto folder = ScratchFolder::create();
  if (!folder) return tl::unexpected(folder.error());
  const std::string file = folder->path() + "/stdout" + extension;
  if (auto written = write(file); !written) {
    engine::Error error = written.error();
    if (error.where == file) error.where = kOutput;
    return tl::unexpected(std::move(error));
  }
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder->path(), error))
    if (entry.path() != file)
      warn(fmt::format("{}: the {} file that accompanies the scan is left out", kOutput,
                       entry.path().extension().string()));
  return copyOutput(file, job);
}

}  // namespace fettle::app

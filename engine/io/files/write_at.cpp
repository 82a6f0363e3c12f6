#include "engine/io/files/write_at.h"

#include <cerrno>

#include <unistd.h>

namespace fettle::engine {

int writeAt(int descriptor, std::string_view bytes, std::uint64_t at) noexcept {
  while (!bytes.empty()) {
    errno = ENOSPC;  // the reason where nothing is written and no error is given
    const ssize_t written = pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
      at += static_cast<std::uint64_t>(written);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

}  // namespace fettle::engine

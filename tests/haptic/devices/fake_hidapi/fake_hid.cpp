#include "tests/haptic/devices/fake_hidapi/fake_hid.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "tests/haptic/devices/fake_hidapi/wire.h"

namespace fettle::fake {

namespace {

int listenAt(const std::string& path) {
  ::unlink(path.c_str());
  const int file = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const sockaddr_un address = addressOf(path);
  if (::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(file, 8) != 0)
    throw std::runtime_error("cannot listen at " + path);
  return file;
}

void closeAll(std::vector<int>& files) {
  for (const int f : files) ::close(f);
  files.clear();
}

}  // namespace

FakeHid::FakeHid(std::string folder, std::string name, Description description)
    : path_(std::move(folder) + "/" + std::move(name)), description_(std::move(description)) {}

FakeHid::~FakeHid() {
  unplug();
}

void FakeHid::plug() {
  if (plugged()) return;
  listen_in_ = listenAt(path_ + ".in");
  listen_out_ = listenAt(path_ + ".out");
  ::unlink(path_.c_str());
  if (::mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("cannot make " + path_);
  pipe_ = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  // Whole at once: a host may look at any moment.
  const std::string temporary = path_ + ".tmp";
  std::FILE* file = std::fopen(temporary.c_str(), "w");
  if (file == nullptr) throw std::runtime_error("cannot write " + temporary);
  std::fprintf(file, "%x %x\n%x %x\n%d\n%s\n%s\n%s\n", description_.vendor, description_.product,
               description_.usage_page, description_.usage, description_.interface_number,
               description_.manufacturer.c_str(), description_.product_name.c_str(),
               description_.serial.c_str());
  std::fclose(file);
  std::rename(temporary.c_str(), (path_ + ".hid").c_str());
}

void FakeHid::unplug() {
  if (!plugged()) return;
  ::unlink((path_ + ".hid").c_str());
  ::unlink((path_ + ".in").c_str());
  ::unlink((path_ + ".out").c_str());
  ::unlink(path_.c_str());
  closeAll(hosts_in_);
  closeAll(hosts_out_);
  for (int* f : {&listen_in_, &listen_out_, &pipe_}) {
    ::close(*f);
    *f = -1;
  }
}

void FakeHid::serve(int ms, Out out, const Output& on_output) {
  if (!plugged()) {
    ::poll(nullptr, 0, ms);
    return;
  }
  std::vector<pollfd> files{{listen_in_, POLLIN, 0}, {listen_out_, POLLIN, 0}};
  if (out == Out::kTaken)
    for (const int f : hosts_out_) files.push_back({f, POLLIN, 0});
  if (::poll(files.data(), files.size(), ms) <= 0) return;
  for (std::size_t i = 2; i < files.size(); ++i) {
    if (files[i].revents == 0) continue;
    std::array<std::uint8_t, 300> packet;
    const ssize_t n = ::recv(files[i].fd, packet.data(), packet.size(), MSG_DONTWAIT);
    if (n >= 5) {
      on_output({packet.data() + 5, static_cast<std::size_t>(n) - 5});  // past the number and the id byte
      static_cast<void>(::send(files[i].fd, packet.data(), 4, MSG_NOSIGNAL | MSG_DONTWAIT));
    } else if (n == 0) {
      ::close(files[i].fd);
      std::erase(hosts_out_, files[i].fd);
    }
  }
  if (files[0].revents != 0)
    if (const int f = ::accept4(listen_in_, nullptr, nullptr, SOCK_CLOEXEC); f >= 0) hosts_in_.push_back(f);
  if (files[1].revents != 0)
    if (const int f = ::accept4(listen_out_, nullptr, nullptr, SOCK_CLOEXEC); f >= 0) hosts_out_.push_back(f);
}

void FakeHid::send(std::span<const std::uint8_t> report) {
  for (std::size_t i = 0; i < hosts_in_.size();) {
    const ssize_t n = ::send(hosts_in_[i], report.data(), report.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno != EAGAIN && errno != ENOBUFS) {
      ::close(hosts_in_[i]);
      hosts_in_.erase(hosts_in_.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
}

std::vector<std::vector<std::uint8_t>> FakeHid::directWrites(std::size_t size) {
  std::vector<std::vector<std::uint8_t>> writes;
  std::vector<std::uint8_t> bytes(size);
  while (plugged() && ::read(pipe_, bytes.data(), size) == static_cast<ssize_t>(size))
    writes.push_back(bytes);
  return writes;
}

}  // namespace fettle::fake

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace fettle::fake {

/// A socket that hands out one frame of the WebSocket protocol (RFC 6455, 5.2) at a time. Beast reads ahead otherwise, and what a program
/// says too early would be out of sight. One thread.
class FrameByFrame {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using Error = boost::system::error_code;
  using executor_type = Socket::executor_type;

  explicit FrameByFrame(Socket socket) : socket_(std::move(socket)) {}

  executor_type get_executor() { return socket_.get_executor(); }
  [[nodiscard]] Socket& socket() { return socket_; }

  template <class Buffers>
  std::size_t read_some(const Buffers& into, Error& error) {
    std::array<unsigned char, 4096> part;
    const std::size_t most = std::min({left_, boost::asio::buffer_size(into), part.size()});
    const std::size_t n = socket_.read_some(boost::asio::buffer(part.data(), most), error);
    for (std::size_t i = 0; i < n; ++i) take(part[i]);
    return boost::asio::buffer_copy(into, boost::asio::buffer(part.data(), n));
  }
  template <class Buffers>
  std::size_t read_some(const Buffers& into) {
    return thrown([&](Error& error) { return read_some(into, error); });
  }
  template <class Buffers>
  std::size_t write_some(const Buffers& from, Error& error) {
    return socket_.write_some(from, error);
  }
  template <class Buffers>
  std::size_t write_some(const Buffers& from) {
    return thrown([&](Error& error) { return write_some(from, error); });
  }

  friend void teardown(boost::beast::role_type role, FrameByFrame& stream, Error& error) {
    boost::beast::websocket::teardown(role, stream.socket_, error);
  }

 private:
  template <class Call>
  static std::size_t thrown(const Call& call) {
    Error error;
    const std::size_t n = call(error);
    if (error) throw boost::system::system_error(error);
    return n;
  }

  // Follows the frame byte by byte: two bytes, then the longer length and the mask, then the payload.
  void take(unsigned char byte) {
    if (!in_payload_) header_[known_++] = byte;
    if (--left_ > 0) return;
    if (!in_payload_ && known_ == 2) {
      const int length = header_[1] & 0x7F;
      left_ = (length == 127 ? 8U : length == 126 ? 2U : 0U) + ((header_[1] & 0x80) != 0 ? 4U : 0U);
      if (left_ > 0) return;
    }
    left_ = in_payload_ ? 0 : payload();
    in_payload_ = left_ > 0;
    if (in_payload_) return;
    known_ = 0;
    left_ = 2;
  }
  [[nodiscard]] std::size_t payload() const {
    const std::size_t length = header_[1] & 0x7F;
    const std::size_t bytes = length == 127 ? 8 : length == 126 ? 2 : 0;
    if (bytes == 0) return length;
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < bytes; ++i) n = n << 8 | header_[2 + i];
    return n;
  }

  Socket socket_;
  std::array<unsigned char, 14> header_{};
  std::size_t known_ = 0;  // bytes of header_
  std::size_t left_ = 2;   // until the next part of a frame
  bool in_payload_ = false;
};

}  // namespace fettle::fake

// The one file that includes Boost.Beast, for the sake of build times.
#include "haptic/devices/vendor/web_socket.h"

#include <chrono>
#include <exception>
#include <optional>
#include <utility>

// One thread uses a socket: no fences are needed between threads of Asio, which the thread sanitizer does not know.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace fettle::haptic {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using tcp = asio::ip::tcp;

constexpr std::size_t kLongestMessage = 65536;
// A service that is behind reads the last message, and the close after it, later: what is dropped before it answers is lost.
constexpr std::int64_t kCloseNs = 1'000'000'000;

}  // namespace

struct WebSocket::Impl {
  asio::io_context io;
  std::optional<beast::websocket::stream<tcp::socket>> stream;
  beast::flat_buffer buffer;
  std::string sending;
  // Of the running call; one of each kind at most.
  bool reading = false;
  bool writing = false;
  beast::error_code read_error;
  beast::error_code write_error;

  // Runs handlers until `busy` is false or the time is over.
  void runWhile(const bool& busy, std::int64_t for_ns) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(for_ns);
    io.restart();
    while (busy && io.run_one_until(until) != 0) {
    }
  }

  // Beast allows a close beside a read that has not ended.
  void sayClosed() {
    if (!stream || !stream->is_open() || writing) return;
    bool busy = true;
    stream->async_close(beast::websocket::close_code::normal, [&busy](beast::error_code) { busy = false; });
    runWhile(busy, kCloseNs);
    if (busy) drop();  // its handler uses this frame
  }

  void startReading() {
    if (reading) return;
    buffer.clear();
    reading = true;
    stream->async_read(buffer, [this](beast::error_code e, std::size_t) {
      read_error = e;
      reading = false;
    });
  }

  // Of the read that was started.
  [[nodiscard]] Outcome received(std::string& message) const {
    if (reading) return Outcome::kTimeout;
    if (read_error) return Outcome::kGone;
    message = beast::buffers_to_string(buffer.data());
    return Outcome::kDone;
  }

  // Cancels what runs and waits for its handler, which uses members of this.
  void drop() {
    if (!stream) return;
    beast::error_code ignored;
    stream->next_layer().close(ignored);
    io.restart();
    io.poll();
    stream.reset();
    buffer.clear();
    reading = writing = false;
  }
};

WebSocket::WebSocket() : impl_(std::make_unique<Impl>()) {}

WebSocket::~WebSocket() {
  close();
}

void WebSocket::close() noexcept try {
  impl_->sayClosed();
  impl_->drop();
} catch (const std::exception&) {
}

WebSocket::Outcome WebSocket::connect(const std::string& address, std::int64_t for_ns) noexcept try {
  Impl& s = *impl_;
  s.drop();
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return Outcome::kGone;
  beast::error_code error;
  tcp::resolver resolver(s.io);
  const auto ends = resolver.resolve(address.substr(0, colon), address.substr(colon + 1), error);
  if (error) return Outcome::kGone;
  s.stream.emplace(s.io);
  bool busy = true;
  beast::error_code outcome;
  asio::async_connect(s.stream->next_layer(), ends, [&](beast::error_code e, const tcp::endpoint&) {
    if (e) {
      outcome = e;
      busy = false;
      return;
    }
    beast::error_code ignored;
    s.stream->next_layer().set_option(tcp::no_delay(true), ignored);  // small messages, one by one
    s.stream->read_message_max(kLongestMessage);
    s.stream->async_handshake(address, "/", [&](beast::error_code f) {
      outcome = f;
      busy = false;
    });
  });
  s.runWhile(busy, for_ns);
  if (busy) {
    s.drop();  // runs the handlers above, which use this frame
    return Outcome::kTimeout;
  }
  if (!outcome) return Outcome::kDone;
  s.drop();
  return Outcome::kGone;
} catch (const std::exception&) {
  return Outcome::kGone;
}

WebSocket::Outcome WebSocket::send(const std::string& message, std::int64_t for_ns) noexcept try {
  Impl& s = *impl_;
  if (!s.stream) return Outcome::kGone;
  if (!s.writing) {
    s.sending = message;
    s.stream->text(true);
    s.writing = true;
    s.stream->async_write(asio::buffer(s.sending), [&s](beast::error_code e, std::size_t) {
      s.write_error = e;
      s.writing = false;
    });
  }
  s.runWhile(s.writing, for_ns);
  if (s.writing) return Outcome::kTimeout;
  return s.write_error ? Outcome::kGone : Outcome::kDone;
} catch (const std::exception&) {
  return Outcome::kGone;
}

WebSocket::Outcome WebSocket::receive(std::string& message, std::int64_t for_ns) noexcept try {
  Impl& s = *impl_;
  if (!s.stream) return Outcome::kGone;
  s.startReading();
  s.runWhile(s.reading, for_ns);
  return s.received(message);
} catch (const std::exception&) {
  return Outcome::kGone;
}

WebSocket::Outcome WebSocket::receiveIfThere(std::string& message) noexcept try {
  Impl& s = *impl_;
  if (!s.stream) return Outcome::kGone;
  s.startReading();
  s.io.restart();
  while (s.reading && s.io.poll_one() != 0) {
  }
  return s.received(message);
} catch (const std::exception&) {
  return Outcome::kGone;
}

}  // namespace fettle::haptic

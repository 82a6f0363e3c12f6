#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace fettle::haptic {

/// A WebSocket client for text messages, with a limit of time on each call. One thread. Allocates.
class WebSocket {
 public:
  WebSocket();
  ~WebSocket();
  WebSocket& operator=(WebSocket&&) = delete;

  enum class Outcome : std::uint8_t {
    kDone,
    kTimeout,  ///< not yet: call again with the same arguments; a part that has arrived is kept
    kGone,     ///< refused, closed by the other side, a message too long (64 KiB), or not WebSocket
  };

  /// `address`: "host:port". After kTimeout the connection has been given up.
  [[nodiscard]] Outcome connect(const std::string& address, std::int64_t for_ns) noexcept;
  [[nodiscard]] Outcome send(const std::string& message, std::int64_t for_ns) noexcept;
  [[nodiscard]] Outcome receive(std::string& message, std::int64_t for_ns) noexcept;
  /// A message that is there already; kTimeout where none is.
  [[nodiscard]] Outcome receiveIfThere(std::string& message) noexcept;
  /// By the closing handshake, for which the other side has 100 ms; then the connection is cut.
  void close() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::haptic

#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/haptic/devices/fake_vendor/fake_inverse_messages.h"
#include "tests/haptic/devices/fake_vendor/rules.h"

namespace fettle::fake {

/// How the service answers.
enum class InverseAnswer {
  kState,        ///< as documented
  kNothing,      ///< the service stands: the answer comes when this ends
  kNotJson,      ///< text that is no JSON
  kCutShort,     ///< the first half of an answer
  kNoState,      ///< the device without its state
  kNoPosition,   ///< a position that lacks z
  kHuge,         ///< a position of 1e30 m
  kNull,         ///< a position of nulls, which is how JSON writes what is not finite
  kWords,        ///< a position of strings
  kOtherDevice,  ///< the state of a device that nobody asked for, in place of the one
  kBinary,       ///< a binary message
  kLong,         ///< a right answer with 8 MiB of spaces before it
  kHugeFrame,    ///< a frame that states a length of 1 TiB, and no more
  kTwice,        ///< two messages for one
  kInPieces,     ///< a ping, then the answer in two frames: allowed by the protocol
  kCloses,       ///< the service closes the connection
  kDrops,        ///< the connection breaks
};

/// Haply's Inverse Service: WebSocket on the loopback, written from what is published of it. It checks each message of a program: text,
/// one at a time (the next only after the answer), for a device that is there, of a force within the limit, the last one zero, and a
/// connection that ends by the closing handshake.
/// Threading: any.
class FakeInverseService {
 public:
  /// What a test sets.
  struct Wishes {
    InverseForm form = InverseForm::k35;
    std::vector<InverseUnit> units{InverseUnit{}};
    InverseAnswer answer = InverseAnswer::kState;
    std::chrono::microseconds slowness{0};  ///< of each answer
    bool refuses = false;                   ///< programs are answered 503 where they ask for a WebSocket
    bool is_silent = false;                 ///< the connection is taken, and nothing is said until this ends
    double limit_n = 3.0;                   ///< of the first force that is against the rules
  };
  /// What arrived.
  struct Received {
    int connections = 0;  ///< now
    int ever_connected = 0;
    unsigned long messages = 0;
    std::array<double, 3> force_n{};        ///< of the first device, the last one
    std::array<double, 3> other_force_n{};  ///< of the second
    double strongest_n = 0.0;
    std::vector<float> forces_n;  ///< strengths of the first device's forces, as they came
  };

  FakeInverseService();
  ~FakeInverseService();
  FakeInverseService(const FakeInverseService&) = delete;
  FakeInverseService& operator=(const FakeInverseService&) = delete;

  /// HOST:PORT for FETTLE_INVERSE3; the same after stop() and start().
  [[nodiscard]] std::string address() const;
  void change(const std::function<void(Wishes&)>& how);
  [[nodiscard]] Received received() const;
  void forgetReceived();
  /// All connections break and no more are taken.
  void stop();
  void start();

  Rules rules;

 private:
  class Connection;
  struct Listener;

  void listen();
  [[nodiscard]] bool isStopping() const;
  // Waits while `holds`; false when the service was stopped meanwhile.
  bool waitWhile(const std::function<bool(const Wishes&)>& holds);
  // Waits so long; false likewise.
  bool waitFor(std::chrono::microseconds length);
  void note(const InverseCommand& command, const std::vector<InverseUnit>& units, double limit_n);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Wishes wishes_;
  Received received_;
  bool stopping_ = false;
  unsigned short port_ = 0;
  std::unique_ptr<Listener> listener_;
  std::thread listening_;
};

}  // namespace fettle::fake

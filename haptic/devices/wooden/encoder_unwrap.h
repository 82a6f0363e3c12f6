#pragma once

#include <cstdint>

namespace fettle::haptic {

/// Follows an encoder whose count wraps at 16 bits. Right as long as it turns less than 32768 counts between
/// two reports (at 1 kHz and 2000 counts per turn: 16,000 turns per second).
class EncoderUnwrap {
 public:
  /// The next count is taken as it is.
  void reset() noexcept { known_ = false; }

  std::int32_t next(std::int16_t raw) noexcept {
    // Differences modulo 2^16, read as signed: the short way round.
    if (known_)
      count_ +=
          static_cast<std::int16_t>(static_cast<std::uint16_t>(raw) - static_cast<std::uint16_t>(last_));
    else
      count_ = raw;
    known_ = true;
    last_ = raw;
    return count_;
  }

 private:
  std::int32_t count_ = 0;
  std::int16_t last_ = 0;
  bool known_ = false;
};

}  // namespace fettle::haptic

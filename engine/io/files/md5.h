#pragma once

#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nettle/md5.h>

namespace fettle::engine {

/// MD5 of bytes given in pieces, as x3p requires: against accidents, not against forgery.
class Md5 {
 public:
  Md5() { md5_init(&context_); }
  void add(std::string_view bytes) {
    md5_update(&context_, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  }
  /// 32 hexadecimal digits, lower case; starts again.
  [[nodiscard]] std::string hex() {
    std::array<std::uint8_t, MD5_DIGEST_SIZE> digest{};
    md5_digest(&context_, digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) text += fmt::format("{:02x}", byte);
    return text;
  }

 private:
  md5_ctx context_{};
};

}  // namespace fettle::engine

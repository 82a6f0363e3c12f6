#include "app/pages/html.h"

#include <cstdint>

#include <fmt/format.h>
#include <nettle/base64.h>

namespace fettle::app {

std::string escapedHtml(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string embeddedPng(const std::string& png, const std::string& description) {
  std::string code(BASE64_ENCODE_RAW_LENGTH(png.size()), '\0');
  // Bytes of any kind, as which char may be read.
  base64_encode_raw(code.data(), png.size(), reinterpret_cast<const std::uint8_t*>(png.data()));
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escapedHtml(description), code);
}

}  // namespace fettle::app

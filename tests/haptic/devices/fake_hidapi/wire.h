#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>
#include <cstring>
#include <string>

/// How the drop-in libhidapi-hidraw.so.0 and a fake device speak. In the folder that FETTLE_FAKE_HID names, a
/// device NAME is four files:
///   NAME.hid  its description, one line a field: vendor and product (hex), usage page and usage (hex),
///             interface, manufacturer, product, serial; the last three may be empty
///   NAME      a pipe: what is written straight to the device file (the zero of a dying program)
///   NAME.in   SOCK_SEQPACKET, device to host: one packet a report
///   NAME.out  SOCK_SEQPACKET, host to device: a number (4 bytes) and the report with its id byte; the device
///             sends the number back when it has taken the report. No answer: a stalled OUT endpoint.
namespace fettle::fake {

inline constexpr const char* kFolderVariable = "FETTLE_FAKE_HID";

inline sockaddr_un addressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  return address;
}

}  // namespace fettle::fake

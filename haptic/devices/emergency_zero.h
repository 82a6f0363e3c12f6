#pragma once

#include <cstdint>
#include <span>

namespace fettle::haptic {

/// A final report of zero force to every force device, for the handler of a fatal signal: written directly to
/// the device file. The drivers arm and disarm it for the devices they hold; the program's signal handler
/// calls zeroAllDevices() and then lets the signal end the program.
///
/// Without it a force lasts until the firmware's watchdog detects that no reports arrive (100 to 500 ms).
/// After SIGKILL only the watchdog acts.

/// Opens `path` for writing and keeps `report` (at most 96 bytes) for it. Returns a number for
/// disarmEmergencyZero, or -1 when the file cannot be opened or 8 are armed already: then only the watchdog
/// acts. Any thread.
[[nodiscard]] int armEmergencyZero(const char* path, std::span<const std::uint8_t> report) noexcept;

/// No effect for -1. Any thread.
void disarmEmergencyZero(int number) noexcept;

/// Writes each armed report once. Async-signal-safe: write(2) on open files, no lock, no allocation; keeps
/// errno. Returns how many were accepted. A device that has stopped accepting reports can block it for 5 s.
int zeroAllDevices() noexcept;

/// From now on every port sends zero force instead of its argument (kYes), or its argument again (kNo): a
/// writer thread that runs for some milliseconds after the zeros must not undo them. Async-signal-safe.
enum class HeldAtZero : bool { kNo, kYes };
void holdDevicesAtZero(HeldAtZero held) noexcept;
/// For the ports. Any thread, wait-free.
[[nodiscard]] bool devicesHeldAtZero() noexcept;

/// A device that is reached only through calls of a library or a service, which no signal handler may make:
/// its link thread sends the zero itself, once it sees devicesHeldAtZero(), and reports that here. Link thread,
/// wait-free. At most 8 at a time; beyond that only the device's own watchdog acts.
class ZeroWhenHeld {
 public:
  ZeroWhenHeld() = default;
  ~ZeroWhenHeld() { disarm(); }
  ZeroWhenHeld& operator=(ZeroWhenHeld&&) = delete;

  /// The device may hold a force from now on.
  void arm() noexcept;
  void disarm() noexcept;
  /// A zero has reached the device.
  void zeroSent() noexcept;

 private:
  int number_ = -1;
};

/// Waits until the links of all armed ZeroWhenHeld have sent a zero since holdDevicesAtZero(), 20 ms at most: a
/// link that crashed itself never will. Returns how many have not. Async-signal-safe; keeps errno.
int waitForHeldZeros() noexcept;

}  // namespace fettle::haptic

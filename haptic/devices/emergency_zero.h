#pragma once

#include <cstdint>
#include <span>

namespace fettle::haptic {

/// The last words to every device that gives force, for the handler of a fatal signal: a report of zero
/// force, written straight to the device file. The drivers arm and disarm it for the devices they hold; the
/// program's signal handler calls zeroAllDevices() and then dies as it would have.
///
/// Without it a force stays on until the firmware's watchdog sees that nobody writes (100 to 500 ms). SIGKILL
/// leaves only the watchdog.

/// Opens `path` for writing and keeps `report` (at most 96 bytes) for it. Returns a number for
/// disarmEmergencyZero, or -1 when the file cannot be opened or 8 are armed already: then the watchdog is
/// what is left. Any thread.
[[nodiscard]] int armEmergencyZero(const char* path, std::span<const std::uint8_t> report) noexcept;

/// No effect for -1. Any thread.
void disarmEmergencyZero(int number) noexcept;

/// Writes each armed report once. Async-signal-safe: write(2) on open files, no lock, no allocation; keeps
/// errno. Returns how many were taken. A device that has stopped taking reports can hold it for 5 s.
int zeroAllDevices() noexcept;

/// From now on every port sends zero force whatever it is handed (kYes), or what it is handed again (kNo): a
/// writer thread that lives on for some milliseconds after the zeros must not undo them. Async-signal-safe.
enum class HeldAtZero : bool { kNo, kYes };
void holdDevicesAtZero(HeldAtZero held) noexcept;
/// For the ports. Any thread, wait-free.
[[nodiscard]] bool devicesHeldAtZero() noexcept;

}  // namespace fettle::haptic

#pragma once

#include "engine/base/error.h"

namespace fettle::haptic {

/// The functions of Force Dimension's SDK (omega, delta, sigma, lambda; the Novint Falcon, too) that Fettle calls, in declarations of
/// its own: no file of the maker is part of Fettle. Names and values as several independent bindings agree; lengths in m, forces in N;
/// axes: x towards the user, y to the right, z up. Calls that return int: negative is an error. They may block for about a millisecond.
struct Dhd {
  int (*dhdGetDeviceCount)() = nullptr;
  int (*dhdOpenID)(char index) = nullptr;  // the device's number, for the other calls
  int (*dhdClose)(char id) = nullptr;
  const char* (*dhdGetSystemName)(char id) = nullptr;
  int (*dhdGetPosition)(double* x, double* y, double* z, char id) = nullptr;
  int (*dhdGetButton)(int button, char id) = nullptr;
  int (*dhdEnableForce)(unsigned char on, char id) = nullptr;
  int (*dhdSetForce)(double x, double y, double z,
                     char id) = nullptr;  // 1: skipped, the last one was too short ago
  const char* (*dhdErrorGetLastStr)() = nullptr;
};

/// The library, loaded at the first call: libdhd.so, by FETTLE_LIBDHD where that is set. Errors (kFailed): where it was looked for, and
/// what to install. Threading: any; not the loop thread.
[[nodiscard]] engine::Result<const Dhd*> dhd();

}  // namespace fettle::haptic

#pragma once

#include "engine/base/error.h"

namespace fettle::haptic {

/// The functions of OpenHaptics' HDAPI (3D Systems Touch and Phantom devices) that Fettle calls, in declarations of its own: no file of
/// the maker is part of Fettle. Names and values as several independent bindings agree; lengths in mm, forces in N; axes: x to the
/// right, y up, z towards the user.
struct Hdapi {
  struct Error {
    unsigned code;  // the high byte tells the kind: kForceErrors ...
    int internal;
    unsigned device;
  };
  using Callback =
      unsigned (*)(void* data);  // on the library's servo thread; 1: again in the next tick, 0: done

  static constexpr unsigned kInvalidDevice = 0xFFFFFFFF;
  static constexpr unsigned kButtons = 0x2000, kPosition = 0x2050, kModel = 0x2501, kSerial = 0x2504,
                            kUsableWorkspace = 0x2551, kNominalMaxForce = 0x2603, kForce = 0x2700,
                            kForceOutput = 0x4000;
  static constexpr unsigned kForceErrors = 0x0200, kKind = 0xFF00;
  static constexpr unsigned short kHighestPriority = 65535;

  unsigned (*hdInitDevice)(const char* name) = nullptr;  // null: the default device
  void (*hdDisableDevice)(unsigned device) = nullptr;
  void (*hdStartScheduler)() = nullptr;
  void (*hdStopScheduler)() = nullptr;
  unsigned long (*hdScheduleAsynchronous)(Callback callback, void* data, unsigned short priority) = nullptr;
  void (*hdUnschedule)(unsigned long handle) = nullptr;
  void (*hdBeginFrame)(unsigned device) = nullptr;
  void (*hdEndFrame)(unsigned device) = nullptr;
  void (*hdMakeCurrentDevice)(unsigned device) = nullptr;
  void (*hdEnable)(unsigned capability) = nullptr;
  void (*hdDisable)(unsigned capability) = nullptr;
  void (*hdGetDoublev)(unsigned parameter, double* values) = nullptr;
  void (*hdGetIntegerv)(unsigned parameter, int* values) = nullptr;
  void (*hdSetDoublev)(unsigned parameter, const double* values) = nullptr;
  const char* (*hdGetString)(unsigned parameter) = nullptr;
  Error (*hdGetError)() = nullptr;  // the oldest that was not taken yet
};

/// The library, loaded at the first call: libHD.so, by FETTLE_LIBHD where that is set. Errors (kFailed): where it was looked for, and what
/// to install. Threading: any; not the loop thread.
[[nodiscard]] engine::Result<const Hdapi*> hdapi();

}  // namespace fettle::haptic

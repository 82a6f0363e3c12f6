#pragma once

#include <memory>

#include "haptic/devices/vendor/vendor_library.h"

namespace fettle::haptic {

/// The calls of OpenHaptics' HDAPI (libHD.so) that are used here, by their documented C types.
namespace hd {

using Handle = unsigned int;
using Callback = unsigned int (*)(void*);

struct ErrorInfo {
  unsigned int code;
  int internal_code;
  Handle device;
};

inline constexpr Handle kNoDevice = 0xFFFFFFFFU;
inline constexpr unsigned int kDone = 0;
inline constexpr unsigned int kContinue = 1;
inline constexpr unsigned short kHighestPriority = 65535;

// Parameters.
inline constexpr unsigned int kButtons = 0x2000;
inline constexpr unsigned int kPosition = 0x2050;   // mm
inline constexpr unsigned int kTransform = 0x2052;  // 16, by columns; mm
inline constexpr unsigned int kModel = 0x2501;
inline constexpr unsigned int kVendor = 0x2503;
inline constexpr unsigned int kSerial = 0x2504;
inline constexpr unsigned int kUsableWorkspace = 0x2551;  // 6: low corner, high corner, mm
inline constexpr unsigned int kCalibrationStyle = 0x2555;
inline constexpr unsigned int kUpdateRate = 0x2600;  // Hz
inline constexpr unsigned int kMaxForce = 0x2603;    // N
inline constexpr unsigned int kForce = 0x2700;       // N
// Capabilities.
inline constexpr unsigned int kForceOutput = 0x4000;
inline constexpr unsigned int kForceClamping = 0x4001;
// States of the calibration.
inline constexpr unsigned int kCalibrated = 0x5000;
inline constexpr unsigned int kNeedsUpdate = 0x5001;
// Classes of error codes: the upper byte.
inline constexpr unsigned int kForceErrors = 0x0200;
inline constexpr unsigned int kDeviceErrors = 0x0300;
inline constexpr unsigned int kFrameErrors = 0x0400;
inline constexpr unsigned int kSchedulerErrors = 0x0500;

}  // namespace hd

struct OpenHapticsCalls {
  hd::Handle (*init_device)(const char*) = nullptr;
  void (*disable_device)(hd::Handle) = nullptr;
  void (*start_scheduler)() = nullptr;
  void (*stop_scheduler)() = nullptr;
  unsigned long (*schedule_asynchronous)(hd::Callback, void*, unsigned short) = nullptr;
  void (*unschedule)(unsigned long) = nullptr;
  void (*begin_frame)(hd::Handle) = nullptr;
  void (*end_frame)(hd::Handle) = nullptr;
  void (*enable)(unsigned int) = nullptr;
  void (*disable)(unsigned int) = nullptr;
  void (*get_doublev)(unsigned int, double*) = nullptr;
  void (*get_integerv)(unsigned int, int*) = nullptr;
  void (*set_doublev)(unsigned int, const double*) = nullptr;
  const char* (*get_string)(unsigned int) = nullptr;
  hd::ErrorInfo (*get_error)() = nullptr;
  // Null in a library that lacks them: then the device counts as calibrated, and codes have no words.
  unsigned int (*check_calibration)() = nullptr;
  void (*update_calibration)(unsigned int) = nullptr;
  const char* (*get_error_string)(unsigned int) = nullptr;
  void (*make_current_device)(hd::Handle) = nullptr;
};

struct OpenHaptics {
  VendorLibrary library;
  OpenHapticsCalls calls;  ///< complete when library.problem() is empty
};
/// The library, looked for again at each call until it is found. Never null. Not for the loop's thread.
[[nodiscard]] std::shared_ptr<const OpenHaptics> openHaptics();

}  // namespace fettle::haptic

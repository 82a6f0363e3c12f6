#include "haptic/devices/vendor/hdapi.h"

#include <array>

#include "engine/base/loaded_library.h"
#include "haptic/devices/vendor/library_places.h"

namespace fettle::haptic {

namespace {

constexpr std::array kHdPlaces{
    "/opt/OpenHaptics/*/libHD/lib/libHD.so*", "/opt/OpenHaptics/*/*/libHD/lib/libHD.so*",
    "/opt/OpenHaptics/*/*/lib/*/libHD.so*", "/usr/lib64/libHD.so*", "/usr/local/lib*/libHD.so*"};

engine::Result<Hdapi> loadedHdapi() {
  engine::LoadedLibrary library(
      libraryPlaces("FETTLE_LIBHD", "libHD.so", kHdPlaces),
      "install OpenHaptics and the Touch device driver of 3D Systems, or name the file in FETTLE_LIBHD; "
      "/opt/OpenHaptics, /usr/lib64 and /usr/local were searched, too");
  Hdapi hd;
#define FETTLE_CALL(name) library.find(#name, hd.name);
  FETTLE_CALL(hdInitDevice)
  FETTLE_CALL(hdDisableDevice)
  FETTLE_CALL(hdStartScheduler)
  FETTLE_CALL(hdStopScheduler)
  FETTLE_CALL(hdScheduleAsynchronous)
  FETTLE_CALL(hdUnschedule)
  FETTLE_CALL(hdBeginFrame)
  FETTLE_CALL(hdEndFrame)
  FETTLE_CALL(hdMakeCurrentDevice)
  FETTLE_CALL(hdEnable)
  FETTLE_CALL(hdDisable)
  FETTLE_CALL(hdGetDoublev)
  FETTLE_CALL(hdGetIntegerv)
  FETTLE_CALL(hdSetDoublev)
  FETTLE_CALL(hdGetString)
  FETTLE_CALL(hdGetError)
#undef FETTLE_CALL
  if (auto status = library.status("the library of OpenHaptics cannot be used", "libHD", ""); !status)
    return tl::unexpected(status.error());
  return hd;
}

}  // namespace

engine::Result<const Hdapi*> hdapi() {
  static const engine::Result<Hdapi> calls = loadedHdapi();
  if (!calls) return tl::unexpected(calls.error());
  return &*calls;
}

}  // namespace fettle::haptic

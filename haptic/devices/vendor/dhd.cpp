#include "haptic/devices/vendor/dhd.h"

#include <array>

#include "engine/base/loaded_library.h"
#include "haptic/devices/vendor/library_places.h"

namespace fettle::haptic {

namespace {

constexpr std::array kDhdPlaces{
    "/opt/*orce*imension*/lib/libdhd.so*", "/opt/*orce*imension*/lib/release/lin-x86_64-gcc/libdhd.so*",
    "/opt/sdk-3*/lib/release/lin-x86_64-gcc/libdhd.so*", "/usr/local/lib*/libdhd.so*"};

engine::Result<Dhd> loadedDhd() {
  engine::LoadedLibrary library(libraryPlaces("FETTLE_LIBDHD", "libdhd.so", kDhdPlaces),
                                "install the Force Dimension SDK, or name its file in FETTLE_LIBDHD; /opt "
                                "and /usr/local were searched, too");
  Dhd calls;
#define FETTLE_CALL(name) library.find(#name, calls.name);
  FETTLE_CALL(dhdGetDeviceCount)
  FETTLE_CALL(dhdOpenID)
  FETTLE_CALL(dhdClose)
  FETTLE_CALL(dhdGetSystemName)
  FETTLE_CALL(dhdGetPosition)
  FETTLE_CALL(dhdGetButton)
  FETTLE_CALL(dhdEnableForce)
  FETTLE_CALL(dhdSetForce)
  FETTLE_CALL(dhdErrorGetLastStr)
#undef FETTLE_CALL
  if (auto status = library.status("the library of Force Dimension cannot be used", "libdhd", ""); !status)
    return tl::unexpected(status.error());
  return calls;
}

}  // namespace

engine::Result<const Dhd*> dhd() {
  static const engine::Result<Dhd> calls = loadedDhd();
  if (!calls) return tl::unexpected(calls.error());
  return &*calls;
}

}  // namespace fettle::haptic

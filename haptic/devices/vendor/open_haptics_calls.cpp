#include "haptic/devices/vendor/open_haptics_calls.h"

#include <mutex>

namespace fettle::haptic {

namespace {

constexpr LibraryPlaces kHdPlaces{
    "libHD.so", "FETTLE_LIBHD", "/opt/OpenHaptics",
    "3D Systems' OpenHaptics and the driver of the device (support.3dsystems.com)"};

std::shared_ptr<const OpenHaptics> loadOpenHaptics() {
  auto loaded = std::make_shared<OpenHaptics>(OpenHaptics{VendorLibrary(kHdPlaces), {}});
  VendorLibrary& l = loaded->library;
  OpenHapticsCalls& c = loaded->calls;
  if (!l.loaded()) return loaded;
  l.find("hdInitDevice", c.init_device);
  l.find("hdDisableDevice", c.disable_device);
  l.find("hdStartScheduler", c.start_scheduler);
  l.find("hdStopScheduler", c.stop_scheduler);
  l.find("hdScheduleAsynchronous", c.schedule_asynchronous);
  l.find("hdUnschedule", c.unschedule);
  l.find("hdBeginFrame", c.begin_frame);
  l.find("hdEndFrame", c.end_frame);
  l.find("hdEnable", c.enable);
  l.find("hdDisable", c.disable);
  l.find("hdGetDoublev", c.get_doublev);
  l.find("hdGetIntegerv", c.get_integerv);
  l.find("hdSetDoublev", c.set_doublev);
  l.find("hdGetString", c.get_string);
  l.find("hdGetError", c.get_error);
  l.findOptional("hdCheckCalibration", c.check_calibration);
  l.findOptional("hdUpdateCalibration", c.update_calibration);
  l.findOptional("hdGetErrorString", c.get_error_string);
  l.findOptional("hdMakeCurrentDevice", c.make_current_device);
  return loaded;
}

}  // namespace

std::shared_ptr<const OpenHaptics> openHaptics() {
  static std::mutex mutex;
  static std::shared_ptr<const OpenHaptics> found;
  const std::lock_guard lock(mutex);
  if (!found || !found->library.loaded()) found = loadOpenHaptics();
  return found;
}

}  // namespace fettle::haptic

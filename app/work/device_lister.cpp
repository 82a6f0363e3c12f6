#include "app/work/device_lister.h"

#include <utility>

#include "haptic/devices/enumerate.h"

namespace fettle::app {
namespace {

using haptic::DeviceKind;

DeviceChoice choiceOf(const haptic::DeviceInfo& device) {
  const haptic::DeviceProblem problem = device.open_error != 0
                                            ? haptic::deviceProblem(device.open_error)
                                            : haptic::DeviceProblem{device.answer, device.advice};
  return {device.path, device.name, problem.what, problem.remedy};
}

bool isOfMaker(const haptic::KnownDriver* driver) {
  return driver != nullptr &&
         (driver->kind == DeviceKind::kOpenHaptics || driver->kind == DeviceKind::kForceDimension ||
          driver->kind == DeviceKind::kInverse3);
}

}  // namespace

std::vector<DeviceChoice> listDeviceChoices(const std::string& in_use) {
  std::vector<DeviceChoice> choices;
  // What needs an argument, as a file of strokes, is for the command line.
  for (const haptic::KnownDriver& driver : haptic::knownDrivers())
    if (driver.needs_window) choices.push_back({std::string(driver.word), std::string(driver.title), {}, {}});
  for (const haptic::DeviceInfo& device : haptic::listDevices())
    if (device.kind != DeviceKind::kOther) choices.push_back(choiceOf(device));
  if (isOfMaker(haptic::driverNamed(in_use).driver)) return choices;
  for (const haptic::MakerInfo& maker : haptic::listMakers())
    for (const haptic::DeviceInfo& device : maker.devices) choices.push_back(choiceOf(device));
  return choices;
}

void DeviceLister::list(const std::string& in_use) {
  if (busy()) return;
  listing_.start([in_use](engine::JobControl&) -> engine::Result<std::vector<DeviceChoice>> {
    return listDeviceChoices(in_use);
  });
}

bool DeviceLister::poll() {
  auto done = listing_.take();
  if (!done || !*done) return false;
  all_ = std::move(**done);
  return true;
}

}  // namespace fettle::app

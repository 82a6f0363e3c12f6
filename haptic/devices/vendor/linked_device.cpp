#include "haptic/devices/vendor/linked_device.h"

#include <system_error>
#include <utility>

#include "haptic/devices/link_thread.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kLinkPlugWaitNs = 200'000'000;

}  // namespace

LinkedDevice::LinkedDevice(DeviceProfile profile, std::unique_ptr<Counterpart> counterpart,
                           std::int64_t hang_ns)
    : profile_(std::move(profile)), hang_ns_(hang_ns), shared_(std::make_shared<Shared>()) {
  shared_->counterpart = std::move(counterpart);
}

LinkedDevice::~LinkedDevice() {
  stop();
}

void LinkedDevice::run(Shared& shared) noexcept {
  becomeLinkThread("fettle-device");
  do {
    shared.counterpart->serve(shared.slots);
    shared.slots.lost();
  } while (shared.slots.waitWhileRunning(kLinkPlugWaitNs));
  shared.slots.ended();
}

engine::Status LinkedDevice::start() {
  if (link_.joinable()) return {};
  if (!shared_->slots.waitEnded(0))
    return engine::failure("the device's library has not returned from its last call", profile_.name,
                           "end the program and plug the device in again");
  shared_->slots.start();
  try {
    link_ = std::thread([shared = shared_] { run(*shared); });
  } catch (const std::system_error&) {
    shared_->slots.ended();
    return engine::failure("no thread can be started for the device", "", "free memory or raise ulimit -u");
  }
  return {};
}

void LinkedDevice::stop() noexcept {
  if (!link_.joinable()) return;
  shared_->slots.requestStop();
  if (shared_->slots.waitEnded(hang_ns_))
    link_.join();
  else
    link_.detach();
}

}  // namespace fettle::haptic

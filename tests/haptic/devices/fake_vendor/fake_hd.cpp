// A replacement of OpenHaptics' libHD.so: the calls that programs make by its documentation, a servo thread, and a check of each call.
#include "tests/haptic/devices/fake_vendor/fake_hd.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <limits>
#include <mutex>
#include <thread>

namespace {

using fettle::fake::FakeHd;
using fettle::fake::SharedPage;
using fettle::fake::writeLog;

constexpr unsigned kSuccess = 0x0000, kInvalidEnum = 0x0100, kBadHandle = 0x0104, kWarm = 0x0200,
                   kAlreadyOpen = 0x0301, kCommunication = 0x0302;
constexpr unsigned kInvalidDevice = 0xFFFFFFFF;
struct HdError {
  unsigned code;
  int internal;
  unsigned device;
};
using Callback = unsigned (*)(void*);

thread_local bool is_servo = false;

struct Library {
  FakeHd control;
  std::mutex mutex;
  std::condition_variable changed;
  bool open[2] = {false, false};
  bool force_enabled[2] = {false, false};
  unsigned current = kInvalidDevice;
  Callback callback = nullptr;
  void* data = nullptr;
  unsigned long handle = 0;
  bool running = false;
  SharedPage* const page =
      SharedPage::map(std::getenv("FAKE_VENDOR_PAGE"));  // null: the test is in this process
  std::thread servo;
  std::deque<HdError> errors;
  // Servo thread's own.
  bool in_frame = false;
  std::atomic<bool> in_callback{false};
  int frames_in_callback = 0;
  double pending[3] = {0.0, 0.0, 0.0};

  // As the test in another process wants it.
  void follow() {
    if (page == nullptr) return;
    control.plugged = page->plugged.load();
    control.stalled = page->stalled.load();
    control.garbage = page->garbage.load();
    control.position.set(page->right_mm, page->up_mm, -page->away_mm);
    control.buttons = page->buttons.load();
    const double c = std::cos(page->turn_rad), s = std::sin(page->turn_rad);
    control.turned.set({{c, 0.0, s}, {0.0, 1.0, 0.0}, {-s, 0.0, c}});
  }
  ~Library() {
    control.rules.check(!servo.joinable(), "the scheduler is stopped before the program ends");
    if (servo.joinable()) {
      {
        const std::lock_guard lock(mutex);
        running = false;
      }
      changed.notify_all();
      servo.join();
    }
    control.rules.check(!open[0] && !open[1], "devices are closed before the program ends");
    writeLog(control.rules);
  }
  void fail(unsigned code) {
    const std::lock_guard lock(mutex);
    errors.push_back({code, 0, current});
  }
  [[nodiscard]] bool onServo() const { return is_servo && in_callback; }
  [[nodiscard]] bool isOpen(unsigned device) const { return device < 2 && open[device]; }

  void serve() {
    is_servo = true;
    auto next = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex);
    while (running) {
      next += std::chrono::milliseconds(1);
      changed.wait_until(lock, next, [this] { return !running; });
      follow();
      if (!running || callback == nullptr || control.stalled) continue;
      const Callback call = callback;
      lock.unlock();
      in_callback = true;
      frames_in_callback = 0;
      const unsigned again = call(data);
      control.rules.check(!in_frame, "a frame that is begun is ended in the same callback");
      control.rules.check(frames_in_callback == 1, "one frame in a callback");
      control.rules.check(again <= 1, "a callback returns 0 or 1");
      in_callback = false;
      lock.lock();
      if (again == 0) callback = nullptr;
    }
  }
};

Library& library() {
  static Library one;
  return one;
}

}  // namespace

extern "C" {

FakeHd* fake_hd() {
  return &library().control;
}

unsigned hdInitDevice(const char* name) {
  Library& l = library();
  const unsigned device = name == nullptr || std::strcmp(name, "Default Device") == 0 ? 0
                          : std::strcmp(name, "right") == 0                           ? 1
                                                                                      : 2;
  l.follow();
  if (device > 1 || !l.control.plugged) {
    l.fail(device > 1 ? kBadHandle : kCommunication);
    return kInvalidDevice;
  }
  if (l.open[device]) {
    l.fail(kAlreadyOpen);
    l.control.rules.check(false, "a device is opened once");
    return kInvalidDevice;
  }
  l.open[device] = true;
  ++l.control.open_devices;
  l.current = device;
  return device;
}

void hdDisableDevice(unsigned device) {
  Library& l = library();
  l.control.rules.check(l.isOpen(device), "what is closed is open");
  l.control.rules.check(!l.servo.joinable(), "the scheduler is stopped before a device is closed");
  l.control.rules.check(!l.control.plugged || l.control.force.length() == 0.0 || l.control.stalled,
                        "the last force before a device is closed is zero");
  if (!l.isOpen(device)) return;
  l.open[device] = l.force_enabled[device] = false;
  --l.control.open_devices;
}

void hdStartScheduler() {
  Library& l = library();
  l.control.rules.check(!l.servo.joinable(), "the scheduler is started once");
  l.control.rules.check(l.open[0] || l.open[1], "a device is open before the scheduler starts");
  if (l.servo.joinable()) return;
  l.running = true;
  l.control.scheduler_runs = true;
  l.servo = std::thread([&l] { l.serve(); });
}

void hdStopScheduler() {
  Library& l = library();
  l.control.rules.check(l.servo.joinable(), "the scheduler that is stopped runs");
  l.control.rules.check(!l.onServo(), "the scheduler is not stopped from a callback");
  if (!l.servo.joinable()) return;
  {
    const std::lock_guard lock(l.mutex);
    l.running = false;
  }
  l.changed.notify_all();
  l.servo.join();
  l.servo = std::thread();
  l.control.scheduler_runs = false;
}

unsigned long hdScheduleAsynchronous(Callback callback, void* data, unsigned short) {
  Library& l = library();
  l.control.rules.check(l.open[0] || l.open[1], "a device is open before a callback is scheduled");
  const std::lock_guard lock(l.mutex);
  l.control.rules.check(l.callback == nullptr, "one callback is scheduled");
  l.callback = callback;
  l.data = data;
  return ++l.handle;
}

void hdUnschedule(unsigned long handle) {
  Library& l = library();
  const std::lock_guard lock(l.mutex);
  l.control.rules.check(handle != 0 && handle == l.handle,
                        "a callback is taken off by the number it was given");
  l.callback = nullptr;
}

void hdMakeCurrentDevice(unsigned device) {
  Library& l = library();
  l.control.rules.check(l.isOpen(device), "the current device is open");
  l.current = device;
}

void hdBeginFrame(unsigned device) {
  Library& l = library();
  l.control.rules.check(l.onServo(), "frames are begun on the servo thread");
  l.control.rules.check(l.isOpen(device), "the device of a frame is open");
  l.control.rules.check(!l.in_frame, "frames are not begun within frames");
  l.in_frame = true;
  ++l.frames_in_callback;
  l.current = device;
  for (double& f : l.pending) f = 0.0;
}

void hdEndFrame(unsigned device) {
  Library& l = library();
  l.control.rules.check(l.in_frame && device == l.current, "the frame that is ended was begun");
  l.in_frame = false;
  ++l.control.frames;
  if (!l.control.plugged) {
    l.fail(kCommunication);
    return;
  }
  const double strength = std::hypot(l.pending[0], l.pending[1], l.pending[2]);
  if (l.control.warm && strength > 0.0) l.fail(kWarm);
  l.control.force.set(l.pending[0], l.pending[1], l.pending[2]);
  if (l.page != nullptr) l.page->push(strength);
  if (strength > l.control.strongest_n) l.control.strongest_n = strength;
}

void hdEnable(unsigned capability) {
  Library& l = library();
  l.control.rules.check(l.isOpen(l.current), "a device is open before force is switched on");
  if (capability == 0x4001) return;  // clamps forces: the rules are about what arrives
  if (capability != 0x4000) return l.fail(kInvalidEnum);
  if (l.isOpen(l.current)) l.force_enabled[l.current] = true;
}

void hdDisable(unsigned capability) {
  Library& l = library();
  if (capability != 0x4000) return l.fail(kInvalidEnum);
  if (l.isOpen(l.current)) l.force_enabled[l.current] = false;
}

void hdGetDoublev(unsigned parameter, double* values) {
  Library& l = library();
  l.control.rules.check(l.isOpen(l.current), "a device is open before it is asked");
  const fettle::fake::Triple& p = l.current == 1 ? l.control.other_position : l.control.position;
  switch (parameter) {
    case 0x2050:
      l.control.rules.check(l.in_frame && l.onServo(), "a position is read within a frame");
      values[0] = p.x;
      values[1] = p.y;
      values[2] = p.z;
      if (l.control.garbage)
        values[l.control.frames % 3] =
            l.control.frames % 2 == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e30;
      return;
    case 0x2052:
      l.control.rules.check(l.in_frame && l.onServo(), "a transform is read within a frame");
      if (!l.control.has_gimbal) return l.fail(kInvalidEnum);
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) values[4 * c + r] = l.control.turned.row[r][c];
        values[4 * r + 3] = 0.0;
      }
      values[12] = p.x;
      values[13] = p.y;
      values[14] = p.z;
      values[15] = 1.0;
      return;
    case 0x2551:
      for (int i = 0; i < 3; ++i) {
        values[i] = l.control.low[i];
        values[3 + i] = l.control.high[i];
      }
      return;
    case 0x2603:
      values[0] = l.control.nominal_n;
      return;
    default:
      l.fail(kInvalidEnum);
  }
}

void hdGetIntegerv(unsigned parameter, int* values) {
  Library& l = library();
  if (parameter != 0x2000) return l.fail(kInvalidEnum);
  l.control.rules.check(l.in_frame && l.onServo(), "buttons are read within a frame");
  values[0] = l.control.buttons;
}

void hdSetDoublev(unsigned parameter, const double* values) {
  Library& l = library();
  l.control.rules.check(parameter == 0x2700, "a force is all that is set: torques stay zero");
  if (parameter != 0x2700) return l.fail(kInvalidEnum);
  l.control.rules.check(l.in_frame && l.onServo(), "a force is set within a frame");
  l.control.rules.check(l.isOpen(l.current) && l.force_enabled[l.current],
                        "force is switched on before one is set");
  const double strength = std::hypot(values[0], values[1], values[2]);
  l.control.rules.check(std::isfinite(strength), "a force is finite");
  l.control.rules.check(!(strength > l.control.nominal_n * 1.001),
                        "a force is within what the device states");
  for (int i = 0; i < 3; ++i) l.pending[i] = values[i];
}

const char* hdGetString(unsigned parameter) {
  Library& l = library();
  l.control.rules.check(l.isOpen(l.current), "a device is open before it is asked");
  return parameter == 0x2501   ? "Touch"
         : parameter == 0x2503 ? "3D Systems, Inc."
         : parameter == 0x2504 ? "20251126001"
                               : "";
}

HdError hdGetError() {
  Library& l = library();
  const std::lock_guard lock(l.mutex);
  if (l.errors.empty()) return {kSuccess, 0, 0};
  const HdError oldest = l.errors.front();
  l.errors.pop_front();
  return oldest;
}

const char* hdGetErrorString(unsigned code) {
  return code == kCommunication ? "communication error" : "another error";
}

}  // extern "C"

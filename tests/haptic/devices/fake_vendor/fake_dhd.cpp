// A replacement of Force Dimension's libdhd.so: the calls that programs make by its documentation, and a check of each call.
#include "tests/haptic/devices/fake_vendor/fake_dhd.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

#include <chrono>
#include <limits>
#include <mutex>
#include <thread>

namespace {

using fettle::fake::FakeDhd;
using fettle::fake::SharedPage;
using fettle::fake::writeLog;
using Unit = FakeDhd::Unit;

struct Library {
  FakeDhd control;
  bool force_on[2] = {false, false};
  SharedPage* const page =
      SharedPage::map(std::getenv("FAKE_VENDOR_PAGE"));  // null: the test is in this process
  std::mutex in_call;  // of one device's calls: two at once would be against the rules

  // As the test in another process wants it.
  void follow() {
    if (page == nullptr) return;
    control.count = page->plugged ? 1 : 0;
    control.stalled = page->stalled.load();
    control.garbage = page->garbage.load();
    control.units[0].position.set(-0.001 * page->away_mm, 0.001 * page->right_mm, 0.001 * page->up_mm);
    control.units[0].buttons = page->buttons.load();
    const double c = std::cos(page->turn_rad), s = std::sin(page->turn_rad);
    control.units[0].turned.set({{c, -s, 0.0}, {s, c, 0.0}, {0.0, 0.0, 1.0}});
    control.wrist = page->wrist.load();
  }
  ~Library() {
    for (const Unit& unit : control.units)
      control.rules.check(!unit.open, "devices are closed before the program ends");
    writeLog(control.rules);
  }
  // Of an open device that is plugged in; null is an error.
  Unit* unit(char id) {
    control.rules.check(id >= 0 && id < 2 && control.units[static_cast<int>(id)].open,
                        "a device is open before it is used");
    if (id < 0 || id >= control.count) return nullptr;
    return &control.units[static_cast<int>(id)];
  }
};

Library& library() {
  static Library one;
  return one;
}

// The time that the wire takes.
struct Call {
  std::unique_lock<std::mutex> lock;
  explicit Call(Library& l) : lock(l.in_call, std::try_to_lock) {
    l.control.rules.check(lock.owns_lock(), "a device is used by one thread at a time");
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    l.follow();
    for (; l.control.stalled; l.follow()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

}  // namespace

extern "C" {

FakeDhd* fake_dhd() {
  return &library().control;
}

int dhdGetDeviceCount() {
  library().follow();
  return library().control.count;
}

int dhdOpenID(char index) {
  Library& l = library();
  l.follow();
  if (index < 0 || index >= l.control.count) return -1;
  l.control.rules.check(!l.control.units[static_cast<int>(index)].open, "a device is opened once");
  l.control.units[static_cast<int>(index)].open = true;
  return index;
}

int dhdClose(char id) {
  Library& l = library();
  Unit& unit = l.control.units[id == 1 ? 1 : 0];
  l.control.rules.check(unit.open, "what is closed is open");
  l.control.rules.check(id >= l.control.count || unit.force.length() == 0.0,
                        "the last force before a device is closed is zero");
  unit.open = false;
  l.force_on[id == 1 ? 1 : 0] = false;
  return 0;
}

const char* dhdGetSystemName(char id) {
  Library& l = library();
  return l.unit(id) == nullptr ? nullptr : l.control.name;
}

int dhdGetPosition(double* x, double* y, double* z, char id) {
  Library& l = library();
  const Call call(l);
  const Unit* const unit = l.unit(id);
  if (unit == nullptr) return -1;
  const unsigned long n = ++l.control.exchanges;
  *x = unit->position.x;
  *y = unit->position.y;
  *z = unit->position.z;
  if (l.control.garbage) *y = n % 2 == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e30;
  return 0;
}

bool dhdHasWrist(char id) {
  Library& l = library();
  return l.unit(id) != nullptr && l.control.wrist;
}

int dhdGetOrientationFrame(double (*by_rows)[3], char id) {
  Library& l = library();
  const Call call(l);
  const Unit* const unit = l.unit(id);
  if (unit == nullptr) return -1;
  l.control.rules.check(l.control.wrist, "a device without a wrist is not asked how it is held");
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) by_rows[r][c] = unit->turned.row[r][c];
  return 0;
}

int dhdGetSerialNumber(unsigned short* number, char id) {
  Library& l = library();
  if (l.unit(id) == nullptr) return -1;
  *number = static_cast<unsigned short>(10406 + id);
  return 0;
}

int dhdGetButton(int button, char id) {
  Library& l = library();
  const Unit* const unit = l.unit(id);
  return unit == nullptr ? -1 : (unit->buttons >> button) & 1;
}

int dhdEnableForce(unsigned char on, char id) {
  Library& l = library();
  if (l.unit(id) == nullptr) return -1;
  l.force_on[static_cast<int>(id)] = on != 0;
  return 0;
}

int dhdSetForce(double x, double y, double z, char id) {
  Library& l = library();
  const Call call(l);
  Unit* const unit = l.unit(id);
  if (unit == nullptr) return -1;
  const double strength = std::hypot(x, y, z);
  l.control.rules.check(l.force_on[static_cast<int>(id)], "force is switched on before one is set");
  l.control.rules.check(std::isfinite(strength), "a force is finite");
  l.control.rules.check(!(strength > l.control.limit_n * 1.001), "a force is within what the device gives");
  if (l.control.too_early) return 1;
  unit->force.set(x, y, z);
  if (l.page != nullptr) l.page->push(strength);
  if (strength > unit->strongest_n) unit->strongest_n = strength;
  return 0;
}

const char* dhdErrorGetLastStr() {
  return "no device found";
}

}  // extern "C"

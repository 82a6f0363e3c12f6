#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"

namespace fettle::tests {

/// A loop on a thread of its own, some 1 kHz: reads a device, writes the force that was set, and notes what it saw.
class LoopOfItsOwn {
 public:
  explicit LoopOfItsOwn(haptic::Device& device) : device_(device), thread_([this] { run(); }) {}
  ~LoopOfItsOwn() {
    stop_ = true;
    thread_.join();
  }
  LoopOfItsOwn& operator=(LoopOfItsOwn&&) = delete;

  void setForce(const glm::dvec3& f) {
    const std::lock_guard lock(mutex_);
    force_ = f;
  }
  void setWrites(bool writes) { writes_ = writes; }
  [[nodiscard]] haptic::DeviceInput input() const {
    const std::lock_guard lock(mutex_);
    return input_;
  }

 private:
  void run() {
    while (!stop_) {
      glm::dvec3 force;
      {
        const std::lock_guard lock(mutex_);
        force = force_;
      }
      const haptic::DeviceInput in = device_.read();
      if (writes_) device_.write(force);
      {
        const std::lock_guard lock(mutex_);
        input_ = in;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the loop's period
    }
  }

  haptic::Device& device_;
  mutable std::mutex mutex_;
  glm::dvec3 force_{0.0};
  haptic::DeviceInput input_;
  std::atomic<bool> writes_{true}, stop_{false};
  std::thread thread_;
};

}  // namespace fettle::tests

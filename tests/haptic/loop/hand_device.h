#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include "haptic/devices/device.h"
#include "haptic/loop/loop_tick.h"

namespace fettle::haptic::tests {

/// A device whose inputs a test writes by hand and whose forces it sees. One input for each read.
class HandDevice : public Device {
 public:
  HandDevice() {
    profile_.name = "hand";
    profile_.space = DeviceSpace::kField;
    profile_.max_force_n = 8.0;
    profile_.gives_force = true;
    input.link = LinkState::kConnected;
    input.buttons = kPrimaryButton;
  }

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override {
    if (speaking) {
      ++input.sequence;
      input.arrival_ns = now_ns;
    }
    return input;
  }
  void write(const glm::dvec3& force_n) noexcept override { force = force_n; }
  void show(const Touched& touched) noexcept override { shown = touched; }
  engine::Status start() override { return {}; }
  void stop() noexcept override {}

  DeviceInput input;
  bool speaking = true;     ///< false: no new input
  std::int64_t now_ns = 0;  ///< set by whoever ticks
  glm::dvec3 force{0.0};    ///< the newest written
  Touched shown;            ///< the newest

 protected:
  DeviceProfile profile_;
};

/// One on a desk, whose workspace is placed in the field; no button is pressed.
class DeskDevice : public HandDevice {
 public:
  DeskDevice() {
    profile_.space = DeviceSpace::kDesk;
    input.buttons = 0;
  }
};

/// A LoopTick with its channels, device and a clock that the test turns.
class LoopBench {
 public:
  static constexpr std::int64_t kPeriod_ns = 1'000'000;

  LoopBench(const engine::Version& start, const engine::Version& original, const Scene& scene,
            const LoopOptions& options)
      : channels(options),
        loop(std::make_unique<PreparedScene>(scene, original), start, device, channels, options) {}

  void tick(std::int64_t since_ns = kPeriod_ns) noexcept {
    device.now_ns += since_ns;
    loop.run(device.now_ns, since_ns);
  }
  void tickAt(const glm::dvec3& tip_mm) noexcept {
    device.input.position_mm = tip_mm;
    tick();
  }
  [[nodiscard]] bool send(CommandKind kind, const std::function<void(LoopCommand&)>& fill = {}) {
    LoopCommand command;
    command.kind = kind;
    if (fill) fill(command);
    return channels.commands.push(std::move(command));
  }
  /// All events so far.
  [[nodiscard]] std::vector<LoopEvent> poll() {
    std::vector<LoopEvent> all;
    for (LoopEvent event; channels.events.pop(event);) all.push_back(std::move(event));
    return all;
  }
  /// The newest event of a kind among all so far; the test fails when there is none.
  [[nodiscard]] LoopEvent newest(EventKind kind) {
    LoopEvent found;
    bool any = false;
    for (LoopEvent& event : poll())
      if (event.kind == kind) {
        found = std::move(event);
        any = true;
      }
    EXPECT_TRUE(any) << "no such event";
    return found;
  }
  [[nodiscard]] engine::Version field() { return loop.scene().field.snapshot(); }

  HandDevice device;
  LoopChannels channels;
  LoopTick loop;
};

/// Options for tests: tools act whenever in contact.
inline LoopOptions testOptions(Tool tool) {
  LoopOptions options;
  options.tool = tool;
  options.tool_switch = ToolSwitch::kAlways;
  options.limits.peak_force_n = 8.0;
  options.limits.continuous_force_n = 3.0;
  return options;
}

/// A hand that sweeps over [0, side_mm]^2 around the height z_mm, presses and lifts: the same for the same
/// tick.
inline glm::dvec3 sweep(std::uint64_t tick, double side_mm, double z_mm, double press_mm) {
  const double t = 1e-3 * static_cast<double>(tick);
  const double half = 0.45 * side_mm;
  return {0.5 * side_mm + half * std::sin(1.7 * t), 0.5 * side_mm + half * std::sin(1.3 * t + 1.0),
          z_mm - press_mm * std::sin(11.0 * t)};
}

/// A plain copy of heights and marks that follows events: within each event's rectangle only.
class Mirror {
 public:
  explicit Mirror(const engine::Version& start) : width_(start.grid().width), height_(start.grid().height) {
    heights_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    marks_.resize(heights_.size());
    take(start, {0, 0, width_, height_});
  }
  void take(const engine::Version& version, const engine::SampleRect& rect) {
    if (rect.empty()) return;
    const std::size_t at = static_cast<std::size_t>(rect.row) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(rect.column);
    version.reader().readHeights(rect.column, rect.row, rect.columns, rect.rows, heights_.data() + at,
                                 width_);
    version.reader().readMarks(rect.column, rect.row, rect.columns, rect.rows, marks_.data() + at, width_);
  }
  /// Samples and marks in which the field differs.
  [[nodiscard]] std::size_t differences(const engine::Version& version) const {
    Mirror other(version);
    std::size_t n = 0;
    for (std::size_t i = 0; i < heights_.size(); ++i)
      n +=
          (heights_[i] != other.heights_[i] && !(std::isnan(heights_[i]) && std::isnan(other.heights_[i]))) ||
                  marks_[i] != other.marks_[i]
              ? 1
              : 0;
    return n;
  }
  [[nodiscard]] float height(std::int32_t column, std::int32_t row) const {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(column)];
  }

 private:
  std::int32_t width_, height_;
  std::vector<float> heights_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace fettle::haptic::tests

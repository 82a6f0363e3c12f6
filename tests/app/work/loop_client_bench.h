#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/loop_client.h"

namespace fettle::tests {

/// The live loop with the mouse as stylus on a field, gone round with as the window does: for the parts of
/// the window that work on it in the background.
class LoopClientBench {
 public:
  /// The test fails when there is no loop.
  explicit LoopClientBench(const engine::Version& field, haptic::Scene scene = haptic::defaultScene(),
                           haptic::SessionSink* sink = nullptr) {
    scene.brush_radius_samples = 3.0;
    auto started =
        app::LoopClient::start(engine::History(field, std::size_t{64} << 20), field, scene, {}, sink);
    EXPECT_TRUE(started) << (started ? "" : started.error().line());
    if (started) client_ = std::move(*started);
  }

  [[nodiscard]] app::LoopClient& client() { return *client_; }
  [[nodiscard]] const std::vector<app::Notice>& notices() const { return notices_; }
  [[nodiscard]] std::vector<app::Notice>& noticesToFill() { return notices_; }

  /// Goes round until `is`; false when that never comes.
  bool until(const std::function<bool()>& is) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      client_->poll();
      if (is()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  /// Until the field is the history's newest state.
  bool settled() {
    return until([&] { return client_->upright() == client_->history().current(); });
  }
  /// A stroke of the stylus at a place of the surface [mm, its height included], until it is a step.
  bool stroke(haptic::Tool tool, const glm::dvec3& at) {
    const std::int64_t before = client_->history().number();
    haptic::MouseStylus& mouse = *client_->mouse();
    client_->setTool(tool);
    mouse.setCursor(at);
    mouse.press(tool);
    if (!until([&] { return !(client_->upright() == client_->history().current()); })) return false;
    mouse.release();
    return until([&] { return client_->history().number() == before + 1 && !mouse.busy(); });
  }

 private:
  std::unique_ptr<app::LoopClient> client_;
  std::vector<app::Notice> notices_;
};

/// Whether the marks of two versions are the same.
[[nodiscard]] inline bool sameMarks(const engine::Version& a, const engine::Version& b) {
  const engine::FieldReader x = a.reader(), y = b.reader();
  for (std::int32_t r = 0; r < a.grid().height; ++r)
    for (std::int32_t c = 0; c < a.grid().width; ++c)
      if (x.markedAt(c, r) != y.markedAt(c, r)) return false;
  return true;
}
[[nodiscard]] inline std::int64_t markedSamples(const engine::Version& v) {
  return engine::summarize(v).marked;
}

}  // namespace fettle::tests

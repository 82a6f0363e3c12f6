#pragma once

#include <array>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

/// What a program showed in a frame that is kept.
struct KeptFrame {
  long number = 0;
  double takes_s = 0.0;  ///< before it is written
  std::string layers;    ///< " projection quad ..."
  struct Eye {
    XrPosef pose{};
    XrFovf fov{};
    Pixels own;
  };
  std::array<Eye, 2> eyes;
  struct Quad {
    XrCompositionLayerQuad layer{};
    XrPosef pose{};  ///< in the room
    bool placed = false;
    Pixels picture;
  };
  std::vector<Quad> quads;
};

/// Writes kept frames as files, on a thread of its own: a headset's clock does not wait for files, and a program is not to take a runtime
/// that writes them for one that has stopped to make frames.
class Keeper {
 public:
  ~Keeper() { finish(); }
  void keep(KeptFrame frame);
  /// Waits until all are written. Not with the runtime's lock held.
  void finish();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<KeptFrame> waiting_;  // guarded, as below
  bool ends_ = false;
  std::thread thread_;
};

[[nodiscard]] Keeper& keeper();

}  // namespace fettle::tests::xr

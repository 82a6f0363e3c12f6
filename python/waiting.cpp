#include "python/waiting.h"

#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include <algorithm>

namespace fettle::python {

namespace py = pybind11;

namespace {

// Ctrl-C is a flag that Python's own handler sets; only a call shows it to the main thread.
constexpr auto kLook = std::chrono::milliseconds(20);
constexpr auto kShow = std::chrono::milliseconds(100);

class Finish {
 public:
  void reached() {
    {
      const std::scoped_lock lock(mutex_);
      reached_ = true;
    }
    wake_.notify_one();
  }
  // False when it was not reached within that time.
  bool await(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return wake_.wait_for(lock, time, [this] { return reached_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool reached_ = false;  // guarded by mutex_
};

void show(const engine::JobControl& job, const py::object& progress) {
  const auto total = static_cast<double>(job.total());
  const double share = total > 0.0 ? std::min(1.0, static_cast<double>(job.done()) / total) : 0.0;
  progress(job.stage(), share);
}

}  // namespace

void waitFor(const std::function<void()>& work, engine::JobControl& job, const py::object& progress) {
  Finish finish;
  std::optional<py::error_already_set> stopped_by;
  std::thread worker([&] {
    std::fesetenv(FE_DFL_ENV);
    work();
    finish.reached();
  });
  {
    const py::gil_scoped_release released;
    auto next_show = std::chrono::steady_clock::now() + kShow;
    while (!finish.await(kLook)) {
      if (job.cancelled()) continue;
      const bool shows = !progress.is_none() && std::chrono::steady_clock::now() >= next_show;
      const py::gil_scoped_acquire held;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (shows) {
          show(job, progress);
          next_show = std::chrono::steady_clock::now() + kShow;
        }
      } catch (const py::error_already_set& error) {
        stopped_by.emplace(error);
        job.cancel();
      }
    }
    worker.join();
  }
  if (stopped_by) {
    stopped_by->restore();
    throw py::error_already_set();
  }
}

}  // namespace fettle::python

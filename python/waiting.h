#pragma once

#include <functional>

#include <pybind11/pybind11.h>

#include "engine/base/job.h"

namespace fettle::python {

/// Runs `work` on a thread of its own and waits for it without the GIL, so that other threads of Python continue. While it
/// waits it
///
/// - looks every 20 ms whether Ctrl-C was pressed (only Python's main thread is told) and cancels `job` if so;
/// - calls `progress(stage, share)` about every 100 ms unless it is None: the job's stage as text, and how much of
///   that is done, 0 to 1. An exception in it cancels `job`, too.
///
/// After the work has ended, the exception that cancelled it is raised. `work` must not throw and not use Python; its
/// floating-point environment is the default one, whatever that of the caller is. Several threads may wait at once.
/// Thread: holds the GIL.
void waitFor(const std::function<void()>& work, engine::JobControl& job, const pybind11::object& progress);

}  // namespace fettle::python

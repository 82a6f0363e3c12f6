#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// The path of a scan to try the program on: a simulated one of the bracket, 1024 x 1024 samples with the usual noise, in
/// $XDG_DATA_HOME/fettle, else ~/.local/share/fettle. Made where it is not there yet; what a person wrote over it stays.
/// Errors: kInput where there is no such folder, those of exportField, kCancelled. Thread: any; a second of work.
[[nodiscard]] engine::Result<std::string> sampleScan(engine::JobControl& job);

}  // namespace fettle::app

#pragma once

#include <functional>
#include <string>

#include "app/work/scan_reading.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// A report about the open document, as files say it.
struct ReportRequest {
  std::string file;      ///< the session, or the scan where nothing was done to it
  ScanOptions reading;   ///< of a scan
  std::string name;      ///< of the scan in the page; empty: that of the file
  std::string sections;  ///< sectionsText() of those kept with the work; empty: none
};

/// Writes it to a path that ends with .html or .pdf, as `fettle report` does, whole or not at all. Called on a worker. The window does
/// not know how: pages are made where commands are.
using ReportWriter = std::function<engine::Status(const ReportRequest& request, const std::string& path,
                                                  engine::JobControl& job)>;

}  // namespace fettle::app

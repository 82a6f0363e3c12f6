#include "app/window/event_log.h"

namespace fettle::app {

engine::Result<EventLog> EventLog::open(const std::string& path) {
  EventLog log;
  log.file_.reset(std::fopen(path.c_str(), "we"));
  if (!log.file_)
    return engine::inputError("cannot be written to", path, "name a file or a pipe for --events");
  return log;
}

void EventLog::writeLine(const Report& line) {
  // A path may contain bytes that are not UTF-8.
  const std::string text = line.dump(-1, ' ', false, Report::error_handler_t::replace) + "\n";
  if (std::fputs(text.c_str(), file_.get()) < 0 || std::fflush(file_.get()) != 0) file_.reset();
}

}  // namespace fettle::app

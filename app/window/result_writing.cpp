#include "app/window/result_writing.h"

#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/session_guard.h"

namespace fettle::app {

void ResultWriting::start(std::string path, const char* what, Reads reads, Work work) {
  what_ = what;
  Waiting next{std::move(path), std::move(work)};
  if (reads == Reads::kSession)
    waiting_ = std::move(next);
  else
    begin(std::move(next));
}

void ResultWriting::begin(Waiting next) {
  writing_.start([path = std::move(next.path),
                  work = std::move(next.work)](engine::JobControl& job) -> engine::Result<std::string> {
    ScanGuard guard;  // a file that is replaced may be the scan of a session
    if (auto spared = guard.protectSessions(path, job); !spared) return tl::unexpected(spared.error());
    if (auto written = work(path, job); !written) return tl::unexpected(written.error());
    return path;
  });
}

void ResultWriting::cancel() noexcept {
  waiting_.reset();
  writing_.cancel();
}

std::optional<std::string> ResultWriting::poll(bool stored, Feedback& feedback) {
  if (waiting_ && stored) {
    Waiting next = *std::move(waiting_);
    waiting_.reset();
    begin(std::move(next));
  }
  const bool cancelled = writing_.cancelling();
  auto done = writing_.take();
  if (!done) return std::nullopt;
  if (*done) {
    feedback.status = trFormat("written: {}", **done);
    feedback.take({.what = feedback.status, .remedy = "", .passes = true});
    return std::move(**done);
  }
  if (!cancelled && done->error().kind != engine::ErrorKind::kCancelled)
    feedback.message(done->error().line(), "");
  return std::nullopt;
}

}  // namespace fettle::app

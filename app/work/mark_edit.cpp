#include "app/work/mark_edit.h"

namespace fettle::app {

void MarkEdit::ask(std::string name, Change change, Notice unchanged) {
  waiting_.push_back({std::move(name), std::move(change), std::move(unchanged)});
}

void MarkEdit::cancel() {
  waiting_.clear();
  working_.cancel();
}

bool MarkEdit::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  // A cancelled job may have finished meanwhile.
  const bool dropped = working_.cancelling();
  if (auto done = working_.take()) {
    changed = true;
    if (dropped) {
      // Its result is not needed.
    } else if (!*done) {
      if (done->error().kind != engine::ErrorKind::kCancelled)
        notices.push_back({done->error().what, done->error().remedy});
    } else if ((*done)->base == (*done)->changed) {
      if (!running_.unchanged.what.empty()) notices.push_back(running_.unchanged);
    } else if (!client.change((*done)->base, (*done)->changed, running_.name)) {
      waiting_.push_front(std::move(running_));
    }
  }
  if (!working_.busy() && !waiting_.empty()) {
    running_ = std::move(waiting_.front());
    waiting_.pop_front();
    working_.start(
        [base = client.newest(), change = running_.change](engine::JobControl& job) -> engine::Result<Done> {
          auto result = change(base, job);
          if (!result) return tl::unexpected(result.error());
          return Done{base, std::move(*result)};
        });
  }
  return changed;
}

}  // namespace fettle::app

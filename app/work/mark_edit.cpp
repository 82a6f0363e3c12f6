#include "app/work/mark_edit.h"

namespace fettle::app {

void MarkEdit::ask(std::string name, Change change) {
  waiting_.push_back({std::move(name), std::move(change)});
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
    } else if (!((*done)->base == (*done)->marked)) {
      client.replaceMarks((*done)->base, (*done)->marked, name_);
    }
  }
  if (!working_.busy() && !waiting_.empty()) {
    Request next = std::move(waiting_.front());
    waiting_.pop_front();
    name_ = std::move(next.name);
    working_.start([base = client.newest(),
                    change = std::move(next.change)](engine::JobControl& job) -> engine::Result<Done> {
      auto marked = change(base, job);
      if (!marked) return tl::unexpected(marked.error());
      return Done{base, std::move(*marked)};
    });
  }
  return changed;
}

}  // namespace fettle::app

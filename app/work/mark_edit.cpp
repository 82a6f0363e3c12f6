#include "app/work/mark_edit.h"

namespace fettle::app {

void MarkEdit::ask(std::string name, Change change, Notice unchanged, std::optional<TakenEdges> edges) {
  waiting_.push_back({std::move(name), std::move(change), std::move(unchanged), std::move(edges)});
}

void MarkEdit::cancel() {
  waiting_.clear();
  working_.cancel();
  done_.reset();
}

std::optional<std::string> MarkEdit::cancelNewest() {
  if (!waiting_.empty()) {
    std::string name = std::move(waiting_.back().name);
    waiting_.pop_back();
    return name;
  }
  if (!done_ && (!working_.busy() || working_.cancelling())) return std::nullopt;
  done_.reset();
  working_.cancel();
  return running_.name;
}

bool MarkEdit::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  // A cancelled job may have finished meanwhile.
  const bool dropped = working_.cancelling();
  if (auto result = working_.take()) {
    changed = true;
    if (dropped) {
      // Its result is not needed.
    } else if (!*result) {
      if (result->error().kind != engine::ErrorKind::kCancelled)
        notices.push_back({result->error().what, result->error().remedy});
    } else if ((*result)->base == (*result)->changed) {
      if (!running_.unchanged.what.empty()) addNotice(notices, running_.unchanged);
    } else {
      done_ = std::move(**result);
    }
  }
  // A line that comes while the next edge is drawn would divide that stroke.
  if (done_ && (done_->base.lines() == done_->changed.lines() || !client.strokeIsUnderWay())) {
    if (!client.change(done_->base, done_->changed, running_.name, running_.edges))
      waiting_.push_front(std::move(running_));
    done_.reset();
    changed = true;
  }
  if (!working_.busy() && !done_ && !waiting_.empty()) {
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

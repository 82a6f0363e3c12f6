#include "app/work/adoption_mailbox.h"

#include <chrono>
#include <thread>
#include <utility>

namespace fettle::app {

constexpr std::chrono::milliseconds kPause{20};

engine::Result<AdoptionMailbox::Answer> AdoptionMailbox::ask(Question question, engine::Version given) {
  std::unique_lock lock(mutex_);
  if (closed_) return engine::cancelled();
  question_ = question;
  sent_ = false;
  version_ = std::move(given);
  answer_.reset();
  answered_.wait(lock, [&] { return answer_ || closed_; });
  question_ = Question::kNone;
  if (!answer_) return engine::cancelled();
  return *std::exchange(answer_, std::nullopt);
}

engine::Result<engine::Version> AdoptionMailbox::snapshot() {
  auto answer = ask(Question::kSnapshot, {});
  if (!answer) return tl::unexpected(answer.error());
  return std::move(answer->version);
}

engine::Result<haptic::AdoptionPort::Answer> AdoptionMailbox::adopt(engine::Version version) {
  return ask(Question::kAdopt, std::move(version));
}

void AdoptionMailbox::pause() {
  std::this_thread::sleep_for(kPause);
}

std::optional<haptic::LoopCommand> AdoptionMailbox::takeCommand(std::uint64_t& next_id) {
  const std::scoped_lock lock(mutex_);
  if (question_ == Question::kNone || sent_) return std::nullopt;
  haptic::LoopCommand command;
  if (question_ == Question::kSnapshot) {
    command.kind = haptic::CommandKind::kSnapshot;
    id_ = next_id++;
  } else {
    command.kind = haptic::CommandKind::kAdopt;
    command.version = std::move(version_);
  }
  command.id = id_;
  sent_ = true;
  return command;
}

void AdoptionMailbox::answer(engine::Version live, bool adopted) {
  {
    const std::scoped_lock lock(mutex_);
    if (question_ == Question::kNone) return;
    answer_ = Answer{adopted, std::move(live)};
  }
  answered_.notify_all();
}

void AdoptionMailbox::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  answered_.notify_all();
}

void AdoptionMailbox::open() {
  const std::scoped_lock lock(mutex_);
  closed_ = false;
}

}  // namespace fettle::app

#include "haptic/journal/session_player.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "engine/field/seen_field.h"
#include "engine/field/upright.h"
#include "engine/session/form_codec.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/mark_codec.h"
#include "haptic/journal/tick_codec.h"
#include "haptic/loop/adopt_filtered.h"
#include "haptic/loop/loop_player.h"

namespace fettle::haptic {
namespace {

using engine::Version;
using haptic::CommandKind;
using haptic::EventKind;
using haptic::LoopCommand;

// More rounds than any adoption was allowed (FilterPreview): the journal records where it ended.
constexpr int kMostRounds = 1000;

class Player final : public haptic::AdoptionPort {
 public:
  Player(const engine::Session& session, engine::JobControl& job, TickListener* listener)
      : journal_(session.journal),
        original_(session.original.withForm(nullptr)),
        job_(job),
        listener_(listener) {
    states_[0] = session.original;
    const engine::History& stored = session.history;
    const std::int64_t start = std::min(journalStart(session), stored.last());
    for (std::int64_t k = std::max(stored.first(), std::int64_t{1}); k <= start; ++k)
      states_[k] = engine::upright(stored.state(k));
  }

  engine::Result<PlayedSession> run() {
    if (auto seen = seeAfresh(); !seen) return tl::unexpected(seen.error());
    job_.begin("replaying", journal_.size());
    while (next_ < journal_.size())
      if (auto done = playNext(); !done) return tl::unexpected(done.error());
    auto field = engine::restored(states_.at(played_.state), own_);
    if (!field) return tl::unexpected(field.error());
    played_.field = *std::move(field);
    return std::move(played_);
  }

  // Answers the requests of the adoption at the points that the journal records.
  engine::Result<Version> snapshot() override {
    snapshot_.reset();
    if (auto done = playUntil([&] { return snapshot_.has_value(); }); !done)
      return tl::unexpected(done.error());
    return *snapshot_;
  }
  engine::Result<Answer> adopt(Version version) override {
    offer_ = std::move(version);
    answer_.reset();
    if (auto done = playUntil([&] { return answer_.has_value(); }); !done)
      return tl::unexpected(done.error());
    return *std::exchange(answer_, std::nullopt);
  }
  void pause() override {}

 private:
  // Ends the running adoption: the next filter's begin, a new loop or the journal's end mean that it was
  // cancelled there.
  engine::Status playUntil(const auto& done) {
    while (!done()) {
      if (next_ == journal_.size()) return engine::cancelled();
      auto entry = entryAt(next_);
      if (!entry) return tl::unexpected(entry.error());
      if (std::holds_alternative<journal::FilterBegun>(*entry) ||
          std::holds_alternative<journal::Begin>(*entry))
        return engine::cancelled();
      if (auto status = playNext(); !status) return status;
    }
    return {};
  }

  engine::Result<journal::Entry> entryAt(std::size_t i) const { return journalEntry(journal_[i].action); }

  engine::Status playNext() {
    if (job_.cancelled()) return engine::cancelled();
    auto entry = entryAt(next_);
    if (!entry) return tl::unexpected(entry.error());
    const std::string& data = journal_[next_].data;
    ++next_;
    job_.advance(1);
    return std::visit([&](const auto& what) { return play(what, data); }, *entry);
  }

  tl::unexpected<engine::Error> mismatch(const char* what) const {
    return engine::inputError(fmt::format("the journal does not fit itself: {}", what),
                              fmt::format("journal entry {}", next_),
                              "the session's stored states are not touched by this: open or export them");
  }

  // A state as it is seen when it is read from the file.
  engine::Status seeAfresh(Version& state) {
    if (state.formOver() == nullptr) return {};
    auto stored = engine::restored(state, own_);
    if (stored) stored = engine::seenNear(*stored, state, own_);
    if (!stored) return tl::unexpected(stored.error());
    state = *std::move(stored);
    return {};
  }
  engine::Status seeAfresh() {
    for (auto& each : states_)
      if (auto done = seeAfresh(each.second); !done) return done;
    return {};
  }

  // The original scan under the form over a state, which it is computed near.
  engine::Result<Version> originalOf(const Version& state) {
    const engine::FieldForm& form = state.formOver();
    if (form == nullptr) return original_;
    Version& known = originals_[form];
    if (!known.empty()) return known;
    auto seen = engine::seenNear(original_.withForm(form), state, own_);
    if (seen) known = *seen;
    return seen;
  }

  engine::Status play(const journal::Begin& begin, const std::string&) {
    if (!begin.continues)
      if (auto seen = seeAfresh(); !seen) return seen;
    const auto state = states_.find(begin.state);
    if (state == states_.end()) return mismatch("a loop begins on a state that does not exist");
    auto original = originalOf(state->second);
    if (!original) return tl::unexpected(original.error());
    scene_ = toBePlayed(begin.scene);
    auto loop = haptic::LoopPlayer::create(state->second, *original, scene_);
    if (!loop) return tl::unexpected(loop.error());
    if (listener_ != nullptr) listener_->sceneIs(scene_);
    live_original_ = *std::move(original);
    loop_ = std::move(*loop);
    inverted_ = begin.scene.invert;
    played_.state = begin.state;
    ticks_.clear();
    bases_.clear();
    asked_.clear();
    answered_tick_.reset();
    ++played_.loops;
    return {};
  }

  engine::Status play(const journal::StateRead& read, const std::string&) {
    const auto state = states_.find(read.state);
    if (state == states_.end()) return mismatch("a state is read that does not exist");
    return seeAfresh(state->second);
  }

  engine::Status play(const journal::Ticks& what, const std::string& data) {
    auto ticks = unpackTicks(data);
    if (!ticks) return tl::unexpected(ticks.error());
    if (static_cast<std::int64_t>(ticks->size()) != what.count) return mismatch("a block of ticks is short");
    ticks_.insert(ticks_.end(), ticks->begin(), ticks->end());
    return {};
  }

  engine::Status play(const journal::Lost& lost, const std::string&) {
    return engine::inputError(
        fmt::format("{} ticks were not recorded: the window did not respond for too long", lost.count),
        fmt::format("journal entry {}", next_),
        "what follows cannot be replayed; the session's stored states contain it");
  }

  engine::Status play(const journal::SceneSet& set, const std::string&) {
    LoopCommand command;
    command.kind = CommandKind::kScene;
    scene_ = toBePlayed(set.scene);
    command.scene = std::make_unique<haptic::PreparedScene>(scene_, live_original_);
    if (auto done = advance(set.at.tick); !done) return done;
    if (listener_ != nullptr) listener_->sceneIs(scene_);
    inverted_ = set.scene.invert;
    return give(std::move(command), set.at);
  }

  engine::Status play(const journal::StepMade& step, const std::string& data) {
    Version state;
    if (step.maker) {
      const auto before = states_.find(step.state - 1);
      if (before == states_.end()) return mismatch("heights of a state that does not exist");
      auto computed = computeHeights(before->second, *step.maker, own_);
      if (!computed) return tl::unexpected(computed.error());
      state = std::move(computed->field);
    } else if (step.form || step.heights) {
      const auto before = states_.find(step.state - 1);
      if (before == states_.end()) return mismatch("a form over a state that does not exist");
      auto changed = underOtherForm(before->second, step, data);
      if (!changed) return tl::unexpected(changed.error());
      state = *std::move(changed);
    } else if (step.marks || step.lines) {
      const auto before = states_.find(step.state - 1);
      if (before == states_.end()) return mismatch("marks on a state that does not exist");
      auto changed =
          step.lines ? applyLineChange(before->second, data) : applyMarkChanges(before->second, data);
      if (!changed) return tl::unexpected(changed.error());
      state = *std::move(changed);
    } else {
      auto there = versionAt(step.at);
      if (!there) return tl::unexpected(there.error());
      state = engine::upright(*there);
    }
    states_[step.state] = std::move(state);
    // Steps after it are discarded.
    states_.erase(states_.upper_bound(step.state), states_.end());
    played_.state = step.state;
    ++played_.steps;
    return {};
  }

  engine::Result<Version> underOtherForm(const Version& before, const journal::StepMade& step,
                                         const std::string& data) {
    if (step.heights) return engine::madeHeights(before);
    const auto form = engine::unpackForm(data, before.grid());
    if (!form) return mismatch("a form that cannot be read");
    const auto stored = engine::restored(before, own_);
    if (!stored) return tl::unexpected(stored.error());
    return engine::seenNear(stored->withForm(*form), before, own_);
  }

  engine::Status play(const journal::RestoreRequested& asked, const std::string&) {
    const auto state = states_.find(asked.state);
    if (state == states_.end()) return mismatch("a state is restored that does not exist");
    asked_[asked.id] = state->second;
    played_.state = asked.state;
    return {};
  }

  engine::Status play(const journal::Restored& restored, const std::string&) {
    const auto version = asked_.find(restored.id);
    if (version == asked_.end()) return mismatch("a state is restored without a request");
    LoopCommand command;
    command.kind = CommandKind::kRestore;
    command.version = inverted_ ? version->second.inverted() : version->second;
    // As LoopClient: under another form the original is another in the same tick.
    if (version->second.formOver() != live_original_.formOver()) {
      auto original = originalOf(version->second);
      if (!original) return tl::unexpected(original.error());
      live_original_ = *std::move(original);
      command.scene = std::make_unique<haptic::PreparedScene>(scene_, live_original_);
    }
    asked_.erase(version);
    return give(std::move(command), restored.at);
  }

  engine::Status play(const journal::FilterBase& base, const std::string&) {
    auto version = versionAt(base.at);
    if (!version) return tl::unexpected(version.error());
    bases_[base.id] = *std::move(version);
    return {};
  }

  engine::Status play(const journal::FilterBegun& filter, const std::string&) {
    const auto base = bases_.find(filter.id);
    if (base == bases_.end()) return mismatch("a filter without its input field");
    const Version input = base->second;
    auto upright = originalOf(input);
    if (!upright) return tl::unexpected(upright.error());
    const Version original = input.reader().sign() < 0.0F ? upright->inverted() : *upright;
    engine::JobControl own = engine::JobControl::partOf(job_);  // its stages are not shown
    auto result = engine::applyFilter(input, original, filter.spec, own);
    if (!result) return tl::unexpected(result.error());
    ++played_.filters;
    const auto adopted =
        haptic::adoptFiltered(*this, input, result->field, original, filter.spec, kMostRounds, own);
    if (!adopted && adopted.error().kind != engine::ErrorKind::kCancelled)
      return tl::unexpected(adopted.error());
    if (job_.cancelled()) return engine::cancelled();
    return {};
  }

  engine::Status play(const journal::Snapshot& snapshot, const std::string&) {
    LoopCommand command;
    command.kind = CommandKind::kSnapshot;
    command.id = ++snapshot_id_;
    if (auto done = give(std::move(command), snapshot.at); !done) return done;
    snapshot_ = answered_;
    return {};
  }

  engine::Status play(const journal::Offered& offered, const std::string&) {
    if (!offer_) return mismatch("a filter's result is offered that was not computed");
    LoopCommand command;
    command.kind = CommandKind::kAdopt;
    command.id = snapshot_id_;
    command.version = *std::exchange(offer_, std::nullopt);
    if (auto done = give(std::move(command), offered.at); !done) return done;
    const bool taken = answer_kind_ == EventKind::kAdopted;
    if (taken != offered.taken) return mismatch("a filter's result was taken there and is refused here");
    answer_ = Answer{taken, answered_};
    return {};
  }

  // Runs the ticks up to a place. Places never decrease: entries were written in the order of the loop's
  // answers.
  engine::Status advance(std::uint64_t tick) {
    if (!loop_) return mismatch("an event before a loop began");
    while (loop_->ticks() < tick) {
      if ((loop_->ticks() & 4095U) == 0 && job_.cancelled()) return engine::cancelled();
      if (ticks_.empty()) return mismatch("ticks are missing");
      const haptic::StrokeSample input = takeTick();
      if (auto done = loop_->run(input); !done) return done;
      if (auto done = tell(input); !done) return done;
    }
    return {};
  }

  Scene toBePlayed(Scene scene) const {
    if (listener_ != nullptr && !scene.lists(EffectKind::kSound)) scene.effects.push_back(EffectKind::kSound);
    return scene;
  }

  engine::Status tell(const haptic::StrokeSample& input) {
    return listener_ == nullptr ? engine::Status{} : listener_->tickIs(*loop_->heard(), input);
  }

  haptic::StrokeSample takeTick() {
    const haptic::StrokeSample tick = ticks_.front();
    ticks_.pop_front();
    ++played_.ticks;
    return tick;
  }

  engine::Status give(LoopCommand&& command, const LoopPlace& at) {
    if (auto done = advance(at.tick); !done) return done;
    if (loop_->ticks() != at.tick) return mismatch("a command comes too late");
    if (ticks_.empty()) return mismatch("ticks are missing");
    const haptic::StrokeSample input = takeTick();
    auto answer = loop_->run(input, std::move(command));
    if (!answer) return tl::unexpected(answer.error());
    if (auto done = tell(input); !done) return done;
    answered_ = answer->version;
    answer_kind_ = answer->kind;
    answered_tick_ = at.tick;
    return {};
  }

  engine::Result<Version> versionAt(const LoopPlace& at) {
    if (at.answered) {
      if (answered_tick_ != at.tick) return mismatch("a state after a command that was not given");
      return answered_;
    }
    if (auto done = advance(at.tick); !done) return tl::unexpected(done.error());
    if (loop_->ticks() != at.tick) return mismatch("a state of an earlier tick");
    return loop_->field();
  }

  const std::vector<engine::JournalEntry>& journal_;
  const Version original_;  // without a form
  std::map<engine::FieldForm, Version> originals_;
  Version live_original_;  // of the loop, under the form of its field
  Scene scene_;            // of the loop
  engine::JobControl& job_;
  TickListener* listener_;
  engine::JobControl own_ = engine::JobControl::partOf(job_);  // its stages are not shown
  std::size_t next_ = 0;
  PlayedSession played_;

  std::map<std::int64_t, Version> states_;  // upright
  std::map<std::uint64_t, Version> asked_;  // by id of the restore, upright
  std::map<std::uint64_t, Version> bases_;  // by id, as felt
  std::unique_ptr<haptic::LoopPlayer> loop_;
  bool inverted_ = false;
  std::deque<haptic::StrokeSample> ticks_;  // recorded, not run yet

  Version answered_;  // by the last command, as felt
  EventKind answer_kind_ = EventKind::kSnapshot;
  std::optional<std::uint64_t> answered_tick_;

  std::uint64_t snapshot_id_ = 0;
  std::optional<Version> snapshot_;
  std::optional<Version> offer_;
  std::optional<Answer> answer_;
};

}  // namespace

std::int64_t journalStart(const engine::Session& session) {
  if (session.journal.empty()) return 0;
  const auto first = journalEntry(session.journal.front().action);
  const auto* begin = first ? std::get_if<journal::Begin>(&*first) : nullptr;
  return begin != nullptr ? begin->state : 0;
}

engine::Result<PlayedSession> playSession(const engine::Session& session, engine::JobControl& job,
                                          TickListener* listener) {
  return Player(session, job, listener).run();
}

}  // namespace fettle::haptic

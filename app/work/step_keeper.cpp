#include "app/work/step_keeper.h"

namespace fettle::app {

using haptic::EventKind;

void LoopJournal::begin(std::int64_t state, const haptic::Scene& scene, bool continues) {
  recorder_ = haptic::Recorder();
  recorded_ = lost_ = 0;
  scenes_.clear();
  if (sink_ != nullptr) recorder_.add(haptic::journal::Begin{state, scene, continues});
}

void LoopJournal::stateRead(std::int64_t state) {
  if (sink_ != nullptr) recorder_.add(haptic::journal::StateRead{state});
}

bool LoopJournal::takeTicks(haptic::HapticLoop& loop, StrokePath& path) {
  if (sink_ == nullptr) return false;
  for (haptic::TickRecord record; loop.pollRecord(record); ++recorded_) {
    recorder_.tick(record.input);
    path.add(recorded_, record);
  }
  const std::uint64_t lost = loop.state().lost_records;
  if (lost == lost_) return false;
  recorder_.add(haptic::journal::Lost{static_cast<std::int64_t>(lost - lost_)});
  recorded_ += lost - lost_;
  lost_ = lost;
  return true;
}

bool LoopJournal::reached(const haptic::LoopEvent& event) const noexcept {
  // An event follows all ticks before it and, when it is an answer, the tick that took the command.
  return sink_ == nullptr || recorded_ >= event.tick + (isAnswer(event.kind) ? 1 : 0);
}

void LoopJournal::sceneSent(std::uint64_t id, const haptic::Scene& scene) {
  if (sink_ != nullptr) scenes_.emplace_back(id, scene);
}

void LoopJournal::answered(const haptic::LoopEvent& event) {
  if (sink_ == nullptr) return;
  const haptic::LoopPlace at{event.tick, true};
  switch (event.kind) {
    case EventKind::kSnapshot:
      recorder_.add(haptic::journal::Snapshot{at});
      break;
    case EventKind::kAdopted:
    case EventKind::kAdoptRefused:
      recorder_.offerAnswered({at, event.kind == EventKind::kAdopted});
      break;
    case EventKind::kRestored:
      recorder_.add(haptic::journal::Restored{event.id, at});
      break;
    case EventKind::kSceneChanged:
      while (!scenes_.empty() && scenes_.front().first != event.id) scenes_.pop_front();
      if (!scenes_.empty()) recorder_.add(haptic::journal::SceneSet{at, scenes_.front().second});
      break;
    case EventKind::kEdited:
    case EventKind::kStrokeEnded:
      break;
  }
}

std::uint64_t LoopJournal::filterBase(const haptic::LoopPlace& place) {
  const std::uint64_t id = ++filters_;
  if (sink_ != nullptr) recorder_.add(haptic::journal::FilterBase{id, place});
  return id;
}

void LoopJournal::filterBegun(std::uint64_t base, const engine::FilterSpec& spec) {
  if (sink_ != nullptr) recorder_.beginFilter({base, spec});
}

void LoopJournal::commit(const haptic::journal::StepMade& made, const engine::Step& step, std::string data) {
  if (sink_ == nullptr) return;
  recorder_.add(made, std::move(data));
  sink_->commit(made.state, step, recorder_.take());
}

void LoopJournal::moveTo(std::int64_t state) {
  if (sink_ != nullptr) sink_->moveTo(state, {});
}

void LoopJournal::restoreRequested(std::uint64_t id, std::int64_t state) {
  if (sink_ == nullptr) return;
  recorder_.add(haptic::journal::RestoreRequested{id, state});
  sink_->moveTo(state, recorder_.take());
}

void LoopJournal::flushWhenDue() {
  if (recorder_.due()) flush();
}

void LoopJournal::flush() {
  if (sink_ != nullptr && !recorder_.empty()) sink_->note(recorder_.take());
}

void StepKeeper::begin(const haptic::Scene& scene) {
  committed_ = history_.current();
  adopting_ = false;
  journal_.begin(history_.number(), scene, begun_);
  begun_ = true;
}

void StepKeeper::prepend(engine::Step step) {
  const bool under_form = step.before.formOver() != nullptr;
  history_.prepend(std::move(step));
  if (under_form) journal_.stateRead(history_.first());
}

void StepKeeper::keepStroke(const engine::Version& field, const haptic::LoopPlace& at) {
  if (!differs(field)) return;
  const haptic::ToolRow& tool = haptic::rowOf(stroke_tool_);
  (void)push(tool.edits == haptic::ToolEdits::kNothing ? "Stroke" : std::string(tool.title),
             tool.edits == haptic::ToolEdits::kMarks ? engine::StepKind::kMark : engine::StepKind::kStroke,
             field, at);
}

void StepKeeper::endStroke(const engine::Version& field, const engine::SampleRect& rect,
                           const haptic::LoopPlace& at) {
  last_rect_ = rect;
  keepStroke(field, at);
}

void StepKeeper::adopted(const engine::Version& field, const haptic::LoopPlace& at) {
  if (adopting_ && history_.canUndo()) {
    static_cast<void>(history_.undo());
    journal_.moveTo(history_.number());
  }
  // A round that changed nothing made no step: the next one has none to replace.
  adopting_ = push(adoption_name_, engine::StepKind::kFilter, field, at);
}

void StepKeeper::change(std::string name, engine::StepKind kind, const engine::Version& field,
                        const haptic::LoopPlace& at, HandChange change) {
  (void)push(std::move(name), kind, field, at, std::move(change));
}

void StepKeeper::restoreRequested(std::uint64_t id) {
  adopting_ = false;
  journal_.restoreRequested(id, history_.number());
}

bool StepKeeper::push(std::string name, engine::StepKind kind, const engine::Version& after,
                      const haptic::LoopPlace& at, std::optional<HandChange> change) {
  engine::StepInfo info;
  info.name = name;
  info.kind = kind;
  info.time = engine::stepTimeNow();
  const std::int64_t undone = history_.last() - history_.number();
  const bool pushed = history_.push(std::move(info), after);
  committed_ = after;
  if (!pushed) return false;
  // Of the rounds of one filter each takes the place of the one before, which nobody undid.
  if (!adopting_) replaced_ += undone;
  const std::int64_t state = history_.number();
  if (kind == engine::StepKind::kFilter || change) last_rect_ = history_.info(state).rect;
  if (!journal_.records()) return true;
  haptic::journal::StepMade made{state, std::move(name), kind, at};
  if (!change) {
    journal_.commit(made, history_.step(state), {});
    return true;
  }
  made.heights = change->heights;
  made.form = kind == engine::StepKind::kForm && !made.heights;
  made.lines = kind == engine::StepKind::kLines;
  made.marks = kind == engine::StepKind::kMark;
  made.suggested = change->suggested;
  made.fitted = std::move(change->fitted);
  made.maker = change->maker;
  journal_.commit(made, history_.step(state), std::move(change->data));
  return true;
}

}  // namespace fettle::app

#include "app/work/step_keeper.h"

#include <utility>

namespace fettle::app {

void StepKeeper::begin(const haptic::Scene& scene) {
  committed_ = history_.current();
  adopting_ = false;
  journal_.begin(history_.number(), scene);
}

void StepKeeper::keepStroke(const engine::Version& field, const haptic::LoopPlace& at) {
  if (!differs(field)) return;
  const haptic::ToolRow& tool = haptic::rowOf(stroke_tool_);
  push(tool.edits == haptic::ToolEdits::kNothing ? "Stroke" : std::string(tool.title),
       tool.edits == haptic::ToolEdits::kMarks ? engine::StepKind::kMark : engine::StepKind::kStroke, field,
       at);
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
  push(adoption_name_, engine::StepKind::kFilter, field, at);
  adopting_ = true;
}

void StepKeeper::change(std::string name, engine::StepKind kind, const engine::Version& field,
                        const haptic::LoopPlace& at, std::string changes) {
  push(std::move(name), kind, field, at, Source::kChange, std::move(changes));
}

void StepKeeper::restoreRequested(std::uint64_t id) {
  adopting_ = false;
  journal_.restoreRequested(id, history_.number());
}

void StepKeeper::push(std::string name, engine::StepKind kind, const engine::Version& after,
                      const haptic::LoopPlace& at, Source source, std::string data) {
  engine::StepInfo info;
  info.name = name;
  info.kind = kind;
  info.time = engine::stepTimeNow();
  const bool made = history_.push(std::move(info), after);
  committed_ = after;
  if (!made) return;
  const std::int64_t state = history_.number();
  if (kind == engine::StepKind::kFilter || source == Source::kChange) last_rect_ = history_.info(state).rect;
  if (!journal_.records()) return;
  const bool changed = source == Source::kChange;
  const bool lines = changed && kind == engine::StepKind::kLines;
  journal_.commit({state, std::move(name), kind, at, changed && !lines, lines}, history_.step(state),
                  std::move(data));
}

}  // namespace fettle::app

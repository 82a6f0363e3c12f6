#include "haptic/journal/early_heights.h"

namespace fettle::haptic {

EarlyHeights::EarlyHeights(const engine::Version& before, const HeightsMaker& maker) {
  if (const auto* const fill = std::get_if<engine::FillOptions>(&maker))
    view_.emplace<engine::FillView>(before, *fill);
  else if (const auto* const lines = std::get_if<engine::LineOptions>(&maker))
    view_.emplace<engine::LineView>(before, *lines);
}

engine::Status EarlyHeights::see(const engine::FieldView& view, const engine::ShowEarly& show,
                                 engine::JobControl& job) {
  const std::scoped_lock lock(mutex_);
  if (job.cancelled()) return engine::cancelled();
  if (auto* const fill = std::get_if<engine::FillView>(&view_)) return fill->see(view, show, job);
  if (auto* const lines = std::get_if<engine::LineView>(&view_)) return lines->see(view, show, job);
  return {};
}

}  // namespace fettle::haptic

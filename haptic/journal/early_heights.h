#pragma once

#include <mutex>
#include <variant>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "engine/field/version.h"
#include "engine/fill/fill_view.h"
#include "engine/measure/line_view.h"
#include "haptic/journal/computed_heights.h"

namespace fettle::haptic {

/// What is seen of computed heights before all of them are there, one view after the other: engine::FillView, engine::LineView. Removed
/// samples come at once.
///
/// Threading: any; a thread waits for another one's view, some tenths of a second.
class EarlyHeights {
 public:
  EarlyHeights(const engine::Version& before, const HeightsMaker& maker);

  /// Errors are those of the whole, but for kCancelled.
  [[nodiscard]] engine::Status see(const engine::FieldView& view, const engine::ShowEarly& show,
                                   engine::JobControl& job);

 private:
  std::mutex mutex_;
  std::variant<std::monostate, engine::FillView, engine::LineView> view_;  // guarded by mutex_
};

}  // namespace fettle::haptic

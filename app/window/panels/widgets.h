#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <imgui.h>

#include "app/window/actions.h"

namespace fettle::app {

/// "name      value" on one line of a panel; values too long for it are cut, and shown whole under the
/// cursor.
void figure(const char* name, const std::string& value);

/// Where an action goes that a button, a tick box or a menu asks for.
using Act = std::function<void(Action)>;

/// The keys of an action, under the cursor of the last item.
void tip(Action action);
/// A button and a tick box for an action, with its tip.
void actionButton(const char* name, Action action, const Act& act);
void actionTick(const char* name, bool ticked, Action action, const Act& act);

/// Puts the next button or tick box, which reads `text`, next to the last item where there is room for it,
/// else below.
enum class Beside : std::uint8_t { kButton, kTick };
void besideOrBelow(const char* text, Beside what = Beside::kButton);

/// Fields under each other, names to the left: between beginFields() and endFields(), field() gives the rest
/// of the line to what `edit` puts there and returns what it returns. A name too long for its column has a
/// line of its own.
void beginFields();
void endFields();
void fieldName(const char* name);
template <class Edit>
bool field(const char* name, const Edit& edit) {
  fieldName(name);
  return edit();
}

/// A number to be typed in, with its unit: what was typed and confirmed, of any size but finite; nothing
/// while it is the value that was there. For fields whose range is a matter of its own, and is refused with
/// words.
[[nodiscard]] std::optional<double> typedNumber(const char* id, double value, const std::string& format);

/// The same cut to a range: true when it was changed and confirmed, never to what is not
/// finite.
[[nodiscard]] bool typeNumber(const char* id, double& value, double low, double high,
                              const std::string& format);

/// "17.2 kB".
[[nodiscard]] std::string bytesText(double bytes);

[[nodiscard]] constexpr double microseconds(std::int64_t ns) noexcept {
  return 1e-3 * static_cast<double>(ns);
}

}  // namespace fettle::app

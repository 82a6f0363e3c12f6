#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include <imgui.h>

#include "app/window/actions.h"
#include "app/work/background.h"
#include "render/plan/number_text.h"
#include "render/plan/panel_colours.h"

// What stands in the source as a name, a label, a tip or a text, `const char*` or of a table, is translated here (app/texts): the
// ids of widgets do not depend on the language. Text that was made, a std::string, is not translated; what is written here is
// written as screenText() has it.
namespace fettle::app {

/// The theme of all that is laid out from now on. Once per frame, as ImGui's own style.
void usePanelTheme(render::Theme theme);
/// A colour of it.
[[nodiscard]] ImU32 colourOf(render::PanelColour colour);
/// A text in it: on one line, or as wide as there is room.
void textIn(render::PanelColour colour, const std::string& text);
void writeIn(render::PanelColour colour, const std::string& text);
void writeIn(render::PanelColour colour, const char* text);

/// "name   value" on one line of a panel; values that are too long are truncated, and shown completely as a
/// tip.
void figure(const char* name, const std::string& value);

/// The bar of a job, with what is being done and how long that still takes. `width`: below 0, the rest of the line less
/// that.
void workBar(const WorkProgress& progress, float width, const char* what);

/// The same with a button behind it; true when the work is to end.
[[nodiscard]] bool cancelledBar(const WorkProgress& progress, const char* what, const char* cancel_id);
/// The same in a row that stays free while there is no work: what is below stays where it is.
[[nodiscard]] bool workRow(const std::optional<WorkProgress>& progress, const char* what,
                           const char* cancel_id);
/// A place of so many lines for what comes and goes, up to endPlace(): what is below stays where it is. More of it scrolls.
void beginPlace(const char* id, int lines);
void endPlace();
/// A list at its end does not keep the wheel: before its end, how far the wheel goes beyond it [notches], and behind it the same
/// for the window that it is in. Both are in endPlace().
[[nodiscard]] float wheelPastEnd();
void scrollOn(float wheel);

/// Receives the actions of buttons, tick boxes and menus.
using Act = std::function<void(Action)>;

/// A tip of the last item: to the left of its panel where there is room, else below it.
void explain(std::string_view says);
/// What is wrong with the value of the last item, beside its panel or below it, while it is being edited: over the rows, which
/// stay where they are.
void problemBeside(std::string_view says);
/// A value at the cursor, beside it.
void valueTip(std::string_view says);
/// Shows what an action does and its keys as a tip of the last item.
void tip(Action action);
/// A text in lines of at most `width` [pixels], brokenText().
[[nodiscard]] std::string inLines(const std::string& text, float width);
/// Text as wide as there is room; no line ends within a number, or between it and its unit.
void writeWrapped(const std::string& text);
void writeWrapped(const char* text);
/// A button and a tick box for an action, with its tip. `width`: 0: as its name needs.
void actionButton(const char* name, Action action, const Act& act, float width = 0.0F);
void actionTick(const char* name, bool ticked, Action action, const Act& act);

/// A button, a tick box and a list of words, each with its tip; true when it was pressed or changed.
bool pressButton(const char* name, std::string_view says);
bool tickBox(const char* name, bool& on, std::string_view says);
/// BeginCombo() that Tab comes by, where the keyboard is in the panels or in a dialog: of ImGui's own fields only those that are
/// typed into are stops of Tab.
[[nodiscard]] bool beginList(const char* id, const char* now, ImGuiComboFlags flags = 0);
/// Behind an item that is no stop of Tab but may have the focus, as a header or a button: Tab goes on from there, and not from the
/// first field of the window.
void tabGoesOn();
/// `chosen`: the place of a word in the list, from 0. The tip is that of the field() that it is in.
bool chooseWord(const char* id, int& chosen, std::initializer_list<const char*> words);
/// chooseWord() of the samples that count: 0: all, 1: marked, 2: not marked.
bool chooseRegion(const char* id, int& chosen);

/// The button of a preview, as wide with each of its words, so that what is beside it stays where it is: "Preview", "Drop
/// preview" while one is shown, and in the colour of what is to be pressed "Show it" where the fields say something else than
/// what is shown. `id`: which of several in a panel.
enum class PreviewWord : std::uint8_t { kNone, kShown, kBehind };
void previewButton(PreviewWord word, const char* id, Action action, const Act& act);

/// Puts the next button or tick box, with the label `text`, next to the last item where there is room for it,
/// otherwise below.
enum class ItemKind : std::uint8_t { kButton, kTick };
void sameLineIfFits(const char* text, ItemKind what = ItemKind::kButton);

/// Fields one below the other, names to the left: between beginFields() and endFields(), field() gives the
/// rest of the line to `edit` and returns its result. A name too long for its column has a line of its own.
void beginFields();
void endFields();
/// `says`: the tip of the name and of the field. There is no field without one.
void fieldName(const char* name, std::string_view says);
bool field(const char* name, std::string_view says, const auto& edit) {
  fieldName(name, says);
  const bool changed = edit();
  explain(says);
  return changed;
}

/// The next field takes the rest of the line of the last item.
void restOfLine();
/// In the place of a field whose number does not count now: dimmed, what holds instead. What is below stays where it is.
void noField(const char* says);

/// A typed number with its unit: returns what was typed when the field is left by Enter, Tab or a click elsewhere, any finite
/// value; nothing while it is unchanged or after Escape. What is not understood is said beside the panel. For fields whose range is checked elsewhere and refused with a message.
[[nodiscard]] std::optional<double> typedNumber(const char* id, double value, const std::string& format);

/// The same with what stands in the field while it is being edited, where that is another number.
struct NumberInField {
  std::optional<double> so_far;  ///< not confirmed
  std::optional<double> done;
};
[[nodiscard]] NumberInField typingNumber(const char* id, double value, const std::string& format);

/// typedNumber() clamped to a range, which is said there as well: true when it was changed and confirmed; never a value that is not finite.
[[nodiscard]] bool typeNumber(const char* id, double& value, double low, double high,
                              const std::string& format);

/// A whole number with buttons for a step and, with Ctrl, five of them: clamped to the range, which is said.
[[nodiscard]] bool typeCount(const char* id, int& value, int low, int high, int step);

/// The same as typeNumber() for a length that is kept in one unit and shown in another: `value`, `low` and `high` in the unit it is kept
/// in. What is typed is taken in the unit that stands beside it, or in one that is typed behind the number.
/// `when_zero`: what stands there in place of a 0, after "0: "; empty: the number.
[[nodiscard]] bool typeLength(const char* id, double& value, double low, double high,
                              const render::ShownUnit& unit, const std::string& when_zero = {});

/// "12.3 \u00b5m", of a length in the unit that it is kept in; `digits` significant ones.
[[nodiscard]] std::string lengthText(double value, const render::ShownUnit& unit, int digits = 4);

/// "17.2 kB".
[[nodiscard]] std::string bytesText(double bytes);

}  // namespace fettle::app

#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/window/actions.h"

namespace fettle::app {

using render::Key;
using render::Modifiers;

constexpr std::pair<Key, const char*> kKeyNames[] = {
    {Key::kSpace, textOf("Space")},
    {Key::kEscape, textOf("Esc")},
    {Key::kEnter, textOf("Enter")},
    {Key::kTab, textOf("Tab")},
    {Key::kBackspace, textOf("Backspace")},
    {Key::kDelete, textOf("Delete")},
    {Key::kInsert, textOf("Insert")},
    {Key::kLeft, textOf("Left")},
    {Key::kRight, textOf("Right")},
    {Key::kUp, textOf("Up")},
    {Key::kDown, textOf("Down")},
    {Key::kHome, textOf("Home")},
    {Key::kEnd, textOf("End")},
    {Key::kPageUp, textOf("Page up")},
    {Key::kPageDown, textOf("Page down")},
    {Key::kKeypadPeriod, textOf("keypad .")},
    {Key::kKeypadPlus, textOf("keypad +")},
    {Key::kKeypadMinus, textOf("keypad -")},
    {Key::kKeypadEnter, textOf("keypad Enter")},
    {Key::kPause, textOf("Pause")},
};

std::string keyText(Key key, Modifiers modifiers) {
  std::string text;
  if (modifiers.control) text += tr("Ctrl+");
  if (modifiers.shift) text += tr("Shift+");
  if (modifiers.alt) text += tr("Alt+");
  const int code = static_cast<int>(key);
  if (code > 32 && code < 127) return text + static_cast<char>(code);
  if (key >= keypadKey(0) && key <= keypadKey(9))
    return text + trFormat("keypad {}", code - static_cast<int>(keypadKey(0)));
  if (key >= functionKey(1) && key <= functionKey(12))
    return text + fmt::format("F{}", code - static_cast<int>(functionKey(1)) + 1);
  for (const auto& [named, name] : kKeyNames)
    if (named == key) return text + tr(name);
  return text;
}

}  // namespace fettle::app

#include <utility>

#include <fmt/format.h>

#include "app/window/actions.h"

namespace fettle::app {

using render::Key;
using render::Modifiers;

constexpr std::pair<Key, const char*> kKeyNames[] = {
    {Key::kSpace, "Space"},
    {Key::kEscape, "Esc"},
    {Key::kEnter, "Enter"},
    {Key::kTab, "Tab"},
    {Key::kBackspace, "Backspace"},
    {Key::kDelete, "Delete"},
    {Key::kInsert, "Insert"},
    {Key::kLeft, "Left"},
    {Key::kRight, "Right"},
    {Key::kUp, "Up"},
    {Key::kDown, "Down"},
    {Key::kHome, "Home"},
    {Key::kEnd, "End"},
    {Key::kPageUp, "Page up"},
    {Key::kPageDown, "Page down"},
    {Key::kKeypadPeriod, "keypad ."},
    {Key::kKeypadPlus, "keypad +"},
    {Key::kKeypadMinus, "keypad -"},
    {Key::kKeypadEnter, "keypad Enter"},
    {Key::kPause, "Pause"},
};

std::string keyText(Key key, Modifiers modifiers) {
  std::string text;
  if (modifiers.control) text += "Ctrl+";
  if (modifiers.shift) text += "Shift+";
  if (modifiers.alt) text += "Alt+";
  const int code = static_cast<int>(key);
  if (code > 32 && code < 127) return text + static_cast<char>(code);
  if (key >= keypadKey(0) && key <= keypadKey(9))
    return text + fmt::format("keypad {}", code - static_cast<int>(keypadKey(0)));
  if (key >= functionKey(1) && key <= functionKey(12))
    return text + fmt::format("F{}", code - static_cast<int>(functionKey(1)) + 1);
  for (const auto& [named, name] : kKeyNames)
    if (named == key) return text + name;
  return text;
}

}  // namespace fettle::app

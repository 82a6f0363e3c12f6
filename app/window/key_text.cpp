#include <fmt/format.h>

#include "app/window/actions.h"

namespace fettle::app {

using render::Key;
using render::Modifiers;

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
  switch (key) {
    case Key::kSpace:
      return text + "Space";
    case Key::kEscape:
      return text + "Esc";
    case Key::kEnter:
      return text + "Enter";
    case Key::kTab:
      return text + "Tab";
    case Key::kBackspace:
      return text + "Backspace";
    case Key::kDelete:
      return text + "Delete";
    case Key::kInsert:
      return text + "Insert";
    case Key::kLeft:
      return text + "Left";
    case Key::kRight:
      return text + "Right";
    case Key::kUp:
      return text + "Up";
    case Key::kDown:
      return text + "Down";
    case Key::kHome:
      return text + "Home";
    case Key::kEnd:
      return text + "End";
    case Key::kPageUp:
      return text + "Page up";
    case Key::kPageDown:
      return text + "Page down";
    case Key::kKeypadPeriod:
      return text + "keypad .";
    case Key::kKeypadPlus:
      return text + "keypad +";
    case Key::kKeypadMinus:
      return text + "keypad -";
    case Key::kKeypadEnter:
      return text + "keypad Enter";
    case Key::kPause:
      return text + "Pause";
    default:
      return text;
  }
}

}  // namespace fettle::app

#include "render/window/window_keys.h"

#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fettle::render {
namespace {

constexpr std::pair<int, Key> kSpecialKeys[] = {
    {GLFW_KEY_SPACE, Key::kSpace},
    {GLFW_KEY_ESCAPE, Key::kEscape},
    {GLFW_KEY_ENTER, Key::kEnter},
    {GLFW_KEY_TAB, Key::kTab},
    {GLFW_KEY_BACKSPACE, Key::kBackspace},
    {GLFW_KEY_DELETE, Key::kDelete},
    {GLFW_KEY_INSERT, Key::kInsert},
    {GLFW_KEY_LEFT, Key::kLeft},
    {GLFW_KEY_RIGHT, Key::kRight},
    {GLFW_KEY_UP, Key::kUp},
    {GLFW_KEY_DOWN, Key::kDown},
    {GLFW_KEY_HOME, Key::kHome},
    {GLFW_KEY_END, Key::kEnd},
    {GLFW_KEY_PAGE_UP, Key::kPageUp},
    {GLFW_KEY_PAGE_DOWN, Key::kPageDown},
    {GLFW_KEY_KP_DECIMAL, Key::kKeypadPeriod},
    {GLFW_KEY_KP_ADD, Key::kKeypadPlus},
    {GLFW_KEY_KP_SUBTRACT, Key::kKeypadMinus},
    {GLFW_KEY_KP_ENTER, Key::kKeypadEnter},
    {GLFW_KEY_PAUSE, Key::kPause},
};

Key specialKey(int key) {
  for (const auto& [code, special] : kSpecialKeys)
    if (code == key) return special;
  const auto offset = [](Key first, int by) { return static_cast<Key>(static_cast<int>(first) + by); };
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) return offset(Key::kF1, key - GLFW_KEY_F1);
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return offset(Key::kKeypad0, key - GLFW_KEY_KP_0);
  return Key::kNone;
}

}  // namespace

Key keyOf(int key, int scancode) {
  if (const Key special = specialKey(key); special != Key::kNone) return special;
  const char* name = glfwGetKeyName(key, scancode);
  char c = name != nullptr && name[0] != '\0' && name[1] == '\0' ? name[0] : '\0';
  // A layout without Latin letters: GLFW's name of the key, which is its position on a US keyboard.
  if (c == '\0' && key >= 32 && key < 127) c = static_cast<char>(key);
  if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return static_cast<Key>(static_cast<unsigned char>(c));
}

Modifiers modifiersOf(int bits) {
  return {(bits & GLFW_MOD_CONTROL) != 0, (bits & GLFW_MOD_SHIFT) != 0, (bits & GLFW_MOD_ALT) != 0};
}

}  // namespace fettle::render

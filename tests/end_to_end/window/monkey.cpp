#include "tests/end_to_end/window/monkey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "app/window/actions.h"

namespace fettle::tests {
namespace {

using render::Key;

constexpr int kScrollBar = 10;     // pixels at the right of the panels
constexpr double kWholeLine = 15;  // pixels, of a header's letters at scale 1

std::string nameOf(Key key) {
  const int code = static_cast<int>(key);
  if ((code >= 'A' && code <= 'Z')) return std::string(1, static_cast<char>(code - 'A' + 'a'));
  if (code >= '0' && code <= '9') return std::string(1, static_cast<char>(code));
  if (key >= Key::kF1 && key < Key::kKeypad0)
    return fmt::format("F{}", code - static_cast<int>(Key::kF1) + 1);
  if (key >= Key::kKeypad0 && key < Key::kKeypadPeriod)
    return fmt::format("KP_{}", code - static_cast<int>(Key::kKeypad0));
  static const std::map<Key, const char*> kNames{
      {Key::kSpace, "space"},
      {Key::kComma, "comma"},
      {Key::kMinus, "minus"},
      {Key::kPeriod, "period"},
      {Key::kPlus, "plus"},
      {Key::kLeftBracket, "bracketleft"},
      {Key::kRightBracket, "bracketright"},
      {Key::kEscape, "Escape"},
      {Key::kEnter, "Return"},
      {Key::kTab, "Tab"},
      {Key::kBackspace, "BackSpace"},
      {Key::kDelete, "Delete"},
      {Key::kInsert, "Insert"},
      {Key::kLeft, "Left"},
      {Key::kRight, "Right"},
      {Key::kUp, "Up"},
      {Key::kDown, "Down"},
      {Key::kHome, "Home"},
      {Key::kEnd, "End"},
      {Key::kPageUp, "Prior"},
      {Key::kPageDown, "Next"},
      {Key::kKeypadPeriod, "KP_Decimal"},
      {Key::kKeypadPlus, "KP_Add"},
      {Key::kKeypadMinus, "KP_Subtract"},
      {Key::kKeypadEnter, "KP_Enter"},
      {Key::kPause, "Pause"},
  };
  const auto found = kNames.find(key);
  if (found == kNames.end()) throw std::runtime_error(fmt::format("xdotool has no word for key {}", code));
  return found->second;
}

std::string withoutDigits(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return text;
}

void say(std::vector<std::string>& words, std::initializer_list<std::string> more) {
  words.insert(words.end(), more);
}
void moveTo(std::vector<std::string>& words, int x, int y) {
  say(words, {"mousemove", std::to_string(x), std::to_string(y)});
}

}  // namespace

const std::vector<std::string>& keysOfActions() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all;
    for (const app::ActionRow& s : app::actions()) {
      std::string key;
      if (s.modifiers.control) key += "ctrl+";
      if (s.modifiers.shift) key += "shift+";
      if (s.modifiers.alt) key += "alt+";
      all.push_back(key + nameOf(s.key));
    }
    return all;
  }();
  return keys;
}

const std::vector<std::string>& namesOfPanels() {
  static const std::vector<std::string> names{"Tool",
                                              "Edges",
                                              "Edge lines",
                                              "Suggested filters",
                                              "Filters",
                                              "Remove samples",
                                              "Holes and lines",
                                              "Form",
                                              "Steps",
                                              "Change since the scan",
                                              "Measure",
                                              "Section",
                                              "Fit",
                                              "Features",
                                              "Transform",
                                              "Join",
                                              "Compare",
                                              "Colours",
                                              "Display",
                                              "Status",
                                              "Haptics"};
  return names;
}

Monkey::Monkey(std::uint64_t seed, int width, int height) : random_(seed), width_(width), height_(height) {}

int Monkey::actions() {
  constexpr double kMost = 50.0;
  const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random_);
  return std::clamp(static_cast<int>(std::pow(kMost + 1.0, share)), 1, static_cast<int>(kMost));
}

void Monkey::key(std::vector<std::string>& words, const State& state) {
  static const std::array<std::string, 12> kAnswers{"Escape", "Return", "Delete", "n",         "s", "space",
                                                    "Tab",    "Left",   "ctrl+1", "BackSpace", "5", "ctrl+a"};
  static const std::array<std::string, 4> kWork{"s", "m", "u", "ctrl+i"};
  // A dialog takes few keys, and those that leave it are among them.
  const bool dialog = state.value("dialog", "none") != "none";
  const auto any = [&](const auto& keys) {
    return keys[static_cast<std::size_t>(below(static_cast<int>(keys.size())))];
  };
  const int what = below(6);
  const std::string chosen = what == 0 || (dialog && what < 3) ? any(kAnswers)
                             : what == 1                       ? any(kWork)
                                                               : any(keysOfActions());
  say(words, {"key", "--delay", "0", chosen});
}

void Monkey::mouse(std::vector<std::string>& words, const State&) {
  moveTo(words, below(width_), below(height_));
  switch (below(4)) {
    case 0:
      say(words, {"click", "--delay", "0", std::to_string(1 + below(3))});
      break;
    case 1:
      say(words, {"click", "--delay", "0", std::to_string(4 + below(2))});
      break;
    default:
      break;
  }
}

void Monkey::click(std::vector<std::string>& words, const State& state) {
  const State texts = state.value("texts", State::array());
  const State* chosen = nullptr;
  int least = 0, ties = 0;
  for (const State& t : texts) {
    const auto text = t["text"].get<std::string>();
    // These would lead it out of its folder.
    if (text.empty() || text == "Up" || text == "Home" || t["cut"] == true) continue;
    const int times = clicked_[withoutDigits(text)];
    if (chosen == nullptr || times < least) ties = 0;
    if (chosen != nullptr && times > least) continue;
    // Of those clicked on least any one.
    if (below(++ties) == 0) chosen = &t;
    least = times;
  }
  if (chosen == nullptr) return;
  ++clicked_[withoutDigits((*chosen)["text"].get<std::string>())];
  const State& box = (*chosen)["at"];
  moveTo(words, box[0].get<int>() + box[2].get<int>() / 2, box[1].get<int>() + box[3].get<int>() / 2);
  say(words, {"click", "--delay", "0", "1"});
}

void Monkey::stroke(std::vector<std::string>& words, const State& state) {
  const State area = state.value("picture", State{0, 0, width_, height_});
  const auto place = [&] {
    moveTo(words, area[0].get<int>() + below(std::max(area[2].get<int>(), 1)),
           area[1].get<int>() + below(std::max(area[3].get<int>(), 1)));
  };
  if (!held_.empty()) {
    for (int i = below(4); i >= 0; --i) place();
    if (below(2) == 0) say(words, {"mouseup", std::exchange(held_, "")});
    return;
  }
  static const std::array<std::string, 3> kModifiers{"ctrl", "shift", "alt"};
  const bool modified = below(4) == 0;
  const std::string& modifier = kModifiers[static_cast<std::size_t>(below(3))];
  held_ = std::to_string(below(4) == 0 ? 2 + below(2) : 1);
  place();
  if (modified) say(words, {"keydown", modifier});
  say(words, {"mousedown", held_});
  for (int i = below(4); i >= 0; --i) place();
  if (modified) say(words, {"keyup", modifier});
  if (below(2) == 0) say(words, {"mouseup", std::exchange(held_, "")});
}

std::vector<std::string> Monkey::letGo() {
  if (held_.empty()) return {};
  return {"mouseup", std::exchange(held_, "")};
}

std::vector<std::string> Monkey::burst(int count, const State& state) {
  std::vector<std::string> words;
  for (int i = 0; i < count; ++i) {
    const int what = below(20);
    if (what < 10)
      key(words, state);
    else if (what < 13)
      mouse(words, state);
    else if (what < 17)
      click(words, state);
    else
      stroke(words, state);
  }
  return words;
}

std::vector<std::string> Monkey::step(const std::string& step, const State& state) {
  if (step.starts_with("drop ")) return {};
  if (step.starts_with("type ")) return {"type", "--delay", "0", step.substr(5)};
  if (step.starts_with("hold ")) return {"keydown", step.substr(5)};
  if (step.starts_with("release ")) return {"keyup", step.substr(8)};
  const State picture = state.value("picture", State{0, 0, width_, height_});
  if (step.starts_with("over ")) {
    std::vector<std::string> words;
    std::istringstream shares(step.substr(5));
    int x = 0, y = 0;
    shares >> x >> y;
    moveTo(words, picture[0].get<int>() + picture[2].get<int>() * x / 100,
           picture[1].get<int>() + picture[3].get<int>() * y / 100);
    return words;
  }
  if (!step.starts_with("panel ")) return {"key", "--delay", "0", step};
  const std::string name = step.substr(6);
  for (const State& open : state.value("panels", State::array()))
    if (open == name) return {};
  const int left = picture[0].get<int>() + picture[2].get<int>();
  const int right = state.value("frame", State{width_, height_})[0].get<int>();
  if (left >= right) return {"key", "--delay", "0", "Tab"};
  std::vector<std::string> words;
  const auto placeOf = [](const std::string& panel) {
    return std::ranges::find(namesOfPanels(), panel) - namesOfPanels().begin();
  };
  bool above = below(2) == 0;  // whether the header is above what is seen
  for (const State& t : state.value("texts", State::array())) {
    const State& box = t["at"];
    if (box[0] < left) continue;
    if (const auto place = placeOf(t["text"]); place < std::ssize(namesOfPanels()))
      above = placeOf(name) < place;
    if (t["text"] != name) continue;
    // Half of it is above or below what is seen: it takes no click.
    if (box[3].get<double>() < std::floor(kWholeLine * state.value("scale", 1.0))) {
      above = box[1].get<int>() < picture[1].get<int>() + picture[3].get<int>() / 2;
      break;
    }
    moveTo(words, box[0].get<int>() + box[2].get<int>() / 2, box[1].get<int>() + box[3].get<int>() / 2);
    say(words, {"click", "--delay", "0", "1"});
    return words;
  }
  // Scrolled away: some way towards it, with the wheel over the scroll bar, since some of what is listed scrolls by itself.
  moveTo(words, right - kScrollBar / 2, picture[1].get<int>() + picture[3].get<int>() / 2);
  // What reads like a header may be none.
  if (below(4) == 0) above = !above;
  const std::string notches = std::to_string(1 + below(40));
  say(words, {"click", "--repeat", notches, "--delay", "0", above ? "4" : "5"});
  return words;
}

}  // namespace fettle::tests

#include "tests/end_to_end/window/user.h"

#include <cstdlib>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "render/png/png.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

constexpr auto kGlance = 20ms;  // between two looks at the screen: the server draws it, and notifies nobody
constexpr int kLine = 20;       // pixels, about a line of a panel
constexpr int kWholeLine = 15;  // pixels, of its letters at scale 1
constexpr int kTries = 20;      // to point at a text that moves

bool rests(const User::State& s) {
  return s.value("settled", false);
}

}  // namespace

User::User(const Display& display, ViewProgram& program, std::string name)
    : display_(display), program_(program), name_(std::move(name)) {}

std::uint64_t User::counter(const char* name) {
  const State now = program_.now();
  return now.is_object() ? now.value(name, std::uint64_t{0}) : 0;
}

User::State User::press(const std::string& name) {
  const std::uint64_t before = counter("keys");
  display_.hands({"key", name});
  return waitFor("key " + name, [&](const State& s) { return s["keys"] > before; });
}

User::State User::key(const std::string& name) {
  const std::uint64_t before = counter("keys");
  display_.hands({"key", name});
  return waitFor("key " + name, [&](const State& s) { return s["keys"] > before && rests(s); });
}

void User::type(const std::string& text) {
  (void)waitFor("a place to type",
                [](const State& s) { return s["text_field"] == true || s["adjusting"] != ""; });
  display_.hands({"type", "--delay", "0", "--", text});
  (void)waitFor("typed " + text,
                [&](const State& s) { return s["dialog_path"] == text || s["typed"] == text; });
}

void User::at(Place place) {
  display_.hands({"mousemove", std::to_string(place.x), std::to_string(place.y)});
  (void)waitFor(fmt::format("cursor at {}, {}", place.x, place.y), [&](const State& s) {
    return s["cursor"] == State{place.x, place.y};
  });
}

void User::down(int button) {
  const std::uint64_t before = counter("buttons");
  display_.hands({"mousedown", std::to_string(button)});
  (void)waitFor("button down", [&](const State& s) { return s["buttons"] > before; });
}

void User::up(int button) {
  const std::uint64_t before = counter("buttons");
  display_.hands({"mouseup", std::to_string(button)});
  (void)waitFor("button up", [&](const State& s) { return s["buttons"] > before; });
}

User::State User::wheel(int steps) {
  const std::uint64_t wanted = counter("wheels") + static_cast<std::uint64_t>(std::abs(steps));
  display_.hands(
      {"click", "--repeat", std::to_string(std::abs(steps)), "--delay", "1", steps > 0 ? "4" : "5"});
  return waitFor("wheel", [&](const State& s) { return s["wheels"] >= wanted && rests(s); });
}

User::State User::drag(int button, Place from, Place to, int steps, const std::string& modifier) {
  at(from);
  if (!modifier.empty()) display_.hands({"keydown", modifier});
  down(button);
  for (int i = 1; i <= steps; ++i)
    at({from.x + (to.x - from.x) * i / steps, from.y + (to.y - from.y) * i / steps});
  up(button);
  if (!modifier.empty()) display_.hands({"keyup", modifier});
  return rest("after a drag");
}

User::State User::stroke(Place from, Place to, int steps) {
  draw(from, to, steps);
  return rest("after a stroke");
}

void User::draw(Place from, Place to, int steps) {
  // The stylus follows the cursor with a lag; two cells off is there.
  const auto follow = [&](bool pressed) {
    (void)waitFor("the stylus at the cursor", [&](const State& s) {
      return s["under_cursor"].is_array() && s["stroke"] == pressed && s["touching"] == pressed &&
             std::abs(s["under_cursor"][0].get<int>() - s["stylus_at"][0].get<int>()) <= 2 &&
             std::abs(s["under_cursor"][1].get<int>() - s["stylus_at"][1].get<int>()) <= 2;
    });
  };
  at(from);
  follow(false);
  down(1);
  follow(true);
  for (int i = 1; i <= steps; ++i) {
    at({from.x + (to.x - from.x) * i / steps, from.y + (to.y - from.y) * i / steps});
    follow(true);
  }
  up(1);
}

std::optional<User::Place> User::readable(const State& now, const std::string& text) {
  for (const State& t : now["texts"]) {
    if (t["text"] != text) continue;
    const State& box = t["at"];
    const Place middle{box[0].get<int>() + box[2].get<int>() / 2, box[1].get<int>() + box[3].get<int>() / 2};
    const State& picture = now["picture"];
    const bool in_panels = middle.x >= picture[0].get<int>() + picture[2].get<int>();
    // A line at the panels' lower edge may show half of itself, with its middle below the edge; a whole one is that of a
    // notice, which stand there.
    const bool whole = box[3].get<int>() >= kWholeLine;
    if (in_panels && middle.y < picture[1].get<int>() + kLine / 2) continue;  // half of it is above them
    if (in_panels && !whole && middle.y > picture[1].get<int>() + picture[3].get<int>() - kLine) continue;
    return middle;
  }
  return std::nullopt;
}

std::optional<User::Place> User::scrolledTo(const std::string& text) {
  const State now = program_.now();
  if (const auto place = readable(now, text)) return place;
  const State& picture = now["picture"];
  // Without panels nothing can be scrolled: it is still to come.
  if (picture[0].get<int>() + picture[2].get<int>() >= now["frame"][0].get<int>())
    return readable(waitFor("words: " + text, [&](const State& s) { return readable(s, text).has_value(); }),
                    text);
  at({picture[0].get<int>() + picture[2].get<int>() + kLine,
      picture[1].get<int>() + picture[3].get<int>() / 2});
  for (const int notch : {-1, 1})  // to the panels' end, then back to their top
    for (State before; before != program_.now()["texts"];) {
      before = program_.now()["texts"];
      if (const auto place = readable(wheel(notch), text)) return place;
    }
  return std::nullopt;
}

bool User::pointAt(const std::string& text) {
  // What lies above it may grow while the cursor is on its way.
  for (int tries = 0; tries < kTries; ++tries) {
    const auto place = scrolledTo(text);
    if (!place) break;
    at(*place);
    if (const auto still = readable(program_.now(), text);
        still && still->x == place->x && still->y == place->y)
      return true;
  }
  ADD_FAILURE() << name_ << ": nothing to read there: " << text << "\n" << program_.now()["texts"].dump();
  return false;
}

void User::tap(const std::string& text) {
  if (!pointAt(text)) return;
  down(1);
  up(1);
}

User::State User::enter(const std::string& name, const std::string& value) {
  if (!typeIn(name, value)) return program_.now();
  (void)press("Return");
  return waitFor("after typing " + name, [](const State& s) { return s["text_field"] == false && rests(s); });
}

bool User::typeIn(const std::string& name, const std::string& value) {
  if (!pointAt(name)) return false;
  const State now = program_.now();
  const int left = now["picture"][0].get<int>() + now["picture"][2].get<int>();
  const int width = now["frame"][0].get<int>() - left;
  // Right of the names and of a tick before the number, left of the buttons behind it.
  at({left + 6 * width / 10, now["cursor"][1]});
  // Each press and release is answered before the next: on a busy machine that may be too slow for a double click, and is tried again.
  for (int tries = 0; tries < 8 && program_.now()["text_field"] != true; ++tries) {
    for (int i = 0; i < 2; ++i) {
      down(1);
      up(1);
    }
    const std::uint64_t drawn = counter("frames");
    (void)waitFor("a field, or none",
                  [&](const State& s) { return s["text_field"] == true || s["frames"] >= drawn + 4; });
  }
  (void)waitFor("a field to type " + name + " in", [](const State& s) { return s["text_field"] == true; });
  (void)press("ctrl+a");
  display_.hands({"type", "--delay", "0", "--", value});
  (void)waitFor("typed " + value, [&](const State& s) { return s["field_text"] == value; });
  return true;
}

void User::writeOver(const std::string& now, const std::string& text) {
  (void)click(now);
  program_.until("a field", [](const State& s) { return s["text_field"] == true; });
  (void)press("ctrl+a");
  write(text);
  program_.until(text, [&](const State& s) {
    return std::any_of(s["texts"].begin(), s["texts"].end(),
                       [&](const State& t) { return t["text"] == text; });
  });
}

User::State User::click(const std::string& text, int count) {
  if (!pointAt(text)) return program_.now();
  for (int i = 0; i < count; ++i) {
    down(1);
    up(1);
  }
  return rest("after a click on " + text);
}

User::State User::rest(const std::string& what) {
  program_.skipToNewest();
  return waitFor(what, rests);
}

bool User::reads(const std::string& text) {
  const State now = program_.now();
  for (const State& t : now["texts"])
    if (t["text"].get<std::string>().find(text) != std::string::npos) return true;
  return false;
}

Part User::surface() {
  const State area = program_.now()["picture"];
  const int x = area[0], y = area[1], width = area[2], height = area[3];
  // The colour bar stands at the right, the scale below.
  return {x + 4, y + 20, width - 130, height - 90};
}

void User::keep(const Screen& screen, const std::string& what) {
  const char* folder = std::getenv("FETTLE_WINDOW_SHOTS");
  if (folder == nullptr || screen.width == 0) return;
  std::filesystem::create_directories(folder);
  render::Image image{screen.width, screen.height, {}};
  for (std::size_t i = 0; i < screen.rgb.size(); ++i) {
    image.rgba.push_back(screen.rgb[i]);
    if (i % 3 == 2) image.rgba.push_back(255);
  }
  std::string file = fmt::format("{}_{:02}_{}.png", name_, ++shots_, what);
  for (char& c : file) c = c == ' ' || c == '/' ? '_' : c;
  const auto written = render::writePng(image, (std::filesystem::path(folder) / file).string());
  EXPECT_TRUE(written);
}

Screen User::until(const std::string& what, const std::function<bool(const Screen&)>& is) {
  const auto end = std::chrono::steady_clock::now() + ViewProgram::kPatience;
  const Part part = surface();
  Screen before = display_.screen();
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(kGlance);
    Screen now = display_.screen();
    if (now.width > 0 && now.width == before.width && differing(now, before, part, 2) == 0 && is(now)) {
      keep(now, what);
      return now;
    }
    before = std::move(now);
  }
  keep(before, "instead of " + what);
  ADD_FAILURE() << name_ << ": never seen: " << what;
  return before;
}

Screen User::glance(const std::string& what) {
  Screen now = display_.screen();
  keep(now, what);
  return now;
}

Screen User::look(const std::string& what) {
  return until(what, [](const Screen&) { return true; });
}
Screen User::changed(const std::string& what, const Screen& before, int pixels) {
  const Part part = surface();
  return until(what, [&](const Screen& now) { return differing(before, now, part) >= pixels; });
}
Screen User::same(const std::string& what, const Screen& as) {
  const Part part = surface();
  return until(what, [&](const Screen& now) { return differing(as, now, part) == 0; });
}

}  // namespace fettle::tests

#include "tests/xr_runtime/script.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <set>
#include <sstream>

namespace fettle::tests::xr {

bool Script::understand(const std::string& line, long frame_now) {
  static const std::set<std::string> kEvents{"keep", "hide",     "show", "stop", "lose",
                                             "end",  "recentre", "busy", "hang"};
  static const std::set<std::string> kValues{"trigger", "squeeze", "scroll", "button", "infer", "broken"};
  std::istringstream words(line.substr(0, line.find('#')));
  std::string first, what, next;
  if (!(words >> first)) return true;
  if (first == "size") return static_cast<bool>(words >> width >> height);
  if (first == "rate") return static_cast<bool>(words >> rate_hz);
  if (first == "keep-takes") return static_cast<bool>(words >> keep_takes_s);
  if (first == "start-hangs") return start_hangs_ = true;
  if (first == "answer") {
    answered_ = frame_now + 1;
    return true;
  }
  std::istringstream counted(first);
  long frame = 0;
  if (!(counted >> frame && words >> what)) return false;
  if (first[0] == '+') frame += frame_now;
  if (kEvents.count(what) > 0) {
    events_.emplace(frame, what);
    return true;
  }
  if (!(words >> next)) return false;
  if (kValues.count(next) > 0) return static_cast<bool>(words >> values_[what + " " + next][frame]);
  std::istringstream x(next);
  Place at;
  if (!(x >> at.x && words >> at.y >> at.z >> at.yaw_deg >> at.pitch_deg)) return false;
  places_[what][frame] = at;
  return true;
}

bool Script::read(const std::string& path) {
  path_ = path;
  file_.open(path);
  std::string line;
  while (std::getline(file_, line)) {
    ++number_;
    if (understand(line, 0)) continue;
    std::fprintf(stderr, "xr runtime: %s:%d is not understood\n", path.c_str(), number_);
    return false;
  }
  if (number_ == 0) std::fprintf(stderr, "xr runtime: %s has no lines\n", path.c_str());
  return number_ > 0;
}

void Script::readOn(long frame) {
  file_.clear();
  std::string line;
  while (std::getline(file_, line)) {
    ++number_;
    if (!understand(line, frame))
      std::fprintf(stderr, "xr runtime: %s:%d is not understood\n", path_.c_str(), number_);
  }
}

bool Script::place(const std::string& of, long frame, Place& at) const {
  const auto known = places_.find(of);
  if (known == places_.end()) return false;
  const auto after = known->second.upper_bound(frame);
  if (after == known->second.begin()) return false;
  const auto before = std::prev(after);
  at = before->second;
  if (after == known->second.end()) return true;
  const double share =
      static_cast<double>(frame - before->first) / static_cast<double>(after->first - before->first);
  const Place& to = after->second;
  at.x += share * (to.x - at.x);
  at.y += share * (to.y - at.y);
  at.z += share * (to.z - at.z);
  at.yaw_deg += share * (to.yaw_deg - at.yaw_deg);
  at.pitch_deg += share * (to.pitch_deg - at.pitch_deg);
  return true;
}

double Script::value(const std::string& of, long frame) const {
  const auto known = values_.find(of);
  if (known == values_.end()) return 0.0;
  const auto after = known->second.upper_bound(frame);
  return after == known->second.begin() ? 0.0 : std::prev(after)->second;
}

std::vector<std::string> Script::events(long frame) const {
  std::vector<std::string> words;
  for (auto [it, last] = events_.equal_range(frame); it != last; ++it) words.push_back(it->second);
  return words;
}

bool Script::has(const std::string& event, long frame) const {
  const std::vector<std::string> words = events(frame);
  return std::find(words.begin(), words.end(), event) != words.end();
}

bool Script::hangs(long frame) const {
  return frame > answered_ && (frame == 0 ? start_hangs_ : has("hang", frame));
}

}  // namespace fettle::tests::xr

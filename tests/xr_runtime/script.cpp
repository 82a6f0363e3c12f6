#include "tests/xr_runtime/script.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

namespace fettle::tests::xr {

bool Script::read(const std::string& path) {
  static const std::set<std::string> kEvents{"keep", "hide", "show", "stop", "lose"};
  static const std::set<std::string> kValues{"trigger", "squeeze", "button"};
  std::ifstream file(path);
  std::string line;
  int number = 0;
  while (std::getline(file, line)) {
    ++number;
    std::istringstream words(line.substr(0, line.find('#')));
    std::string first;
    if (!(words >> first)) continue;
    bool understood = false;
    if (first == "size") {
      understood = static_cast<bool>(words >> width >> height);
    } else if (first == "rate") {
      understood = static_cast<bool>(words >> rate_hz);
    } else {
      std::istringstream counted(first);
      long frame = 0;
      std::string what, next;
      if (counted >> frame && words >> what) {
        if (kEvents.count(what) > 0) {
          events_.emplace(frame, what);
          understood = true;
        } else if (words >> next && kValues.count(next) > 0) {
          double value = 0.0;
          understood = static_cast<bool>(words >> value);
          values_[what + " " + next][frame] = value;
        } else {
          Place at;
          std::istringstream x(next);
          understood = x >> at.x && words >> at.y >> at.z >> at.yaw_deg >> at.pitch_deg;
          places_[what][frame] = at;
        }
      }
    }
    if (!understood) {
      std::fprintf(stderr, "xr runtime: %s:%d is not understood\n", path.c_str(), number);
      return false;
    }
  }
  if (number == 0) std::fprintf(stderr, "xr runtime: %s has no lines\n", path.c_str());
  return number > 0;
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

}  // namespace fettle::tests::xr

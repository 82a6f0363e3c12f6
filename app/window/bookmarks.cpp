#include "app/window/bookmarks.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "app/window/view_text.h"

namespace fettle::app {

void Bookmarks::set(std::size_t number, const render::View& view) {
  render::View kept = view;
  kept.width = render::View{}.width;
  kept.height = render::View{}.height;
  views_[number] = kept;
}

std::size_t Bookmarks::count() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(views_.begin(), views_.end(), [](const auto& view) { return view.has_value(); }));
}

std::string Bookmarks::text() const {
  auto notes = nlohmann::json::array();
  for (const auto& view : views_)
    notes.push_back(view ? nlohmann::json::parse(viewText(*view)) : nlohmann::json());
  return notes.dump();
}

void Bookmarks::restore(const std::string& text) {
  clear();
  const auto notes = nlohmann::json::parse(text, nullptr, false);
  if (!notes.is_array()) return;
  for (std::size_t i = 0; i < std::min(kCount, notes.size()); ++i) views_[i] = parseView(notes[i].dump());
}

}  // namespace fettle::app

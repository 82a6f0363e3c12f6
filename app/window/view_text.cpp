#include "app/window/view_text.h"

#include <nlohmann/json.hpp>

namespace fettle::app {

render::View startView() {
  render::View view;
  view.azimuth_deg = 330.0;
  return view;
}

std::string viewText(const render::View& view) {
  return nlohmann::json{{"azimuth", view.azimuth_deg},
                        {"elevation", view.elevation_deg},
                        {"zoom", view.zoom},
                        {"centre", {view.centre_x, view.centre_y}},
                        {"exaggeration", view.vertical_exaggeration},
                        {"perspective", view.projection == render::Projection::kPerspective}}
      .dump();
}

render::View viewOf(const std::string& text) {
  const auto note = nlohmann::json::parse(text, nullptr, false);
  render::View view = startView();
  if (!note.is_object()) return view;
  try {
    view.azimuth_deg = note.at("azimuth").get<double>();
    view.elevation_deg = note.at("elevation").get<double>();
    view.zoom = note.at("zoom").get<double>();
    view.centre_x = note.at("centre").at(0).get<double>();
    view.centre_y = note.at("centre").at(1).get<double>();
    view.vertical_exaggeration = note.at("exaggeration").get<double>();
    if (note.at("perspective").get<bool>()) view.projection = render::Projection::kPerspective;
  } catch (const nlohmann::json::exception&) {
    return startView();
  }
  return view;
}

}  // namespace fettle::app

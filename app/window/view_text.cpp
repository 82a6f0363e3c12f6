#include "app/window/view_text.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace fettle::app {
namespace {

// A file may say anything; what lies outside would be refused with every frame.
bool canBeShown(const render::View& view) {
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  return std::isfinite(view.azimuth_deg) && in(view.elevation_deg, 0.0, 90.0) && in(view.zoom, 1e-3, 1e6) &&
         std::isfinite(view.centre_x) && std::isfinite(view.centre_y) && in(view.centre_z, -100.0, 100.0) &&
         (view.vertical_exaggeration == 0.0 || in(view.vertical_exaggeration, 1e-9, 1e9));
}

}  // namespace

render::View startView() {
  render::View view;
  view.azimuth_deg = 330.0;
  return view;
}

std::string viewText(const render::View& view) {
  return nlohmann::json{{"azimuth", view.azimuth_deg},
                        {"elevation", view.elevation_deg},
                        {"zoom", view.zoom},
                        {"centre", {view.centre_x, view.centre_y, view.centre_z}},
                        {"exaggeration", view.vertical_exaggeration},
                        {"perspective", view.projection == render::Projection::kPerspective}}
      .dump();
}

std::optional<render::View> parseView(const std::string& text) {
  const auto note = nlohmann::json::parse(text, nullptr, false);
  if (!note.is_object()) return std::nullopt;
  render::View view = startView();
  try {
    view.azimuth_deg = note.at("azimuth").get<double>();
    view.elevation_deg = note.at("elevation").get<double>();
    view.zoom = note.at("zoom").get<double>();
    const auto& centre = note.at("centre");
    view.centre_x = centre.at(0).get<double>();
    view.centre_y = centre.at(1).get<double>();
    // Older sessions have none.
    if (centre.size() > 2) view.centre_z = centre.at(2).get<double>();
    view.vertical_exaggeration = note.at("exaggeration").get<double>();
    if (note.at("perspective").get<bool>()) view.projection = render::Projection::kPerspective;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  if (!canBeShown(view)) return std::nullopt;
  return view;
}

render::View viewOf(const std::string& text) {
  return parseView(text).value_or(startView());
}

}  // namespace fettle::app

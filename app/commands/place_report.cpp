#include "app/commands/place_report.h"

#include <string>

#include <fmt/format.h>

#include "engine/inspect/noise.h"
#include "engine/suggest/worth_places.h"

namespace fettle::app {

engine::Result<Report> placeReport(const engine::Version& field, int most, int threads,
                                   engine::JobControl& job) {
  const auto noise = engine::estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (!(noise->sigma > 0.0))
    return engine::inputError("no noise that a filter could remove was found in the scan", "--places",
                              "leave it out");
  engine::WorthRequest request;
  request.noise = noise->sigma;
  request.most = static_cast<std::size_t>(most);
  request.threads = threads;
  const auto found = engine::findWorthPlaces(field, request, job);
  if (!found) return tl::unexpected(found.error());
  const engine::Grid& grid = field.grid();
  const auto world = [&](glm::dvec2 at) {
    return Report{grid.origin_x + at.x * grid.spacing_x, grid.origin_y + at.y * grid.spacing_y};
  };
  Report places = Report::array();
  for (std::size_t i = 0; i < found->places.size(); ++i) {
    const engine::WorthPlace& place = found->places[i];
    const Report middle = world(place.path[place.path.size() / 2]);
    places.push_back({{"x", middle[0]},
                      {"y", middle[1]},
                      {"from", world(place.path.front())},
                      {"to", world(place.path.back())},
                      {"samples", place.length},
                      {"gain", place.gain},
                      {"rmse_after", found->rmseAfter(i + 1)},
                      {"seconds", place.seconds}});
  }
  return Report{{"places", places},
                {"pieces_left_out", found->left_out},
                {"rmse_without", found->rmseAfter(0)},
                {"places_unit", grid.height_unit.name},
                {"places_lateral_unit", grid.lateral_unit.name}};
}

void printPlaces(const Report& report) {
  const std::string unit = report["places_unit"], lateral = report["places_lateral_unit"];
  const Report& places = report["places"];
  if (places.empty()) {
    fmt::print("No place was found where an edge line drawn by hand would gain tgv anything.\n");
    return;
  }
  if (const auto left_out = report["pieces_left_out"].get<std::size_t>(); left_out > 0)
    fmt::print("{} pieces of the scan with fewer edges were not searched.\n", left_out);
  double seconds = 0.0;
  for (const Report& place : places) seconds += place["seconds"].get<double>();
  fmt::print(
      "tgv is estimated to leave {:.3g} {}; with edge lines drawn by hand at these places, some {:.0f} s of "
      "work, "
      "{:.3g} {} (the order is surer than the figures; docs/decisions/worth-places.md).\nThose of most worth "
      "for the time first (fettle view, key Z, goes from one to the "
      "next):\n\n"
      "{:>4}{:>16}{:>16}{:>10}{:>8}{:>18}\n",
      report["rmse_without"].get<double>(), unit, seconds, places.back()["rmse_after"].get<double>(), unit,
      "", "x, " + lateral, "y, " + lateral, "samples", "s", "then left, " + unit);
  int number = 0;
  for (const Report& place : places)
    fmt::print("{:>4}{:>16.10g}{:>16.10g}{:>10.0f}{:>8.1f}{:>18.4g}\n", ++number, place["x"].get<double>(),
               place["y"].get<double>(), place["samples"].get<double>(), place["seconds"].get<double>(),
               place["rmse_after"].get<double>());
}

}  // namespace fettle::app

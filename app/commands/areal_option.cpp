#include "app/commands/areal_option.h"

#include <utility>

#include <fmt/format.h>

namespace fettle::app {

void addArealOptions(Command command, ArealArguments& arguments) {
  command.add({{.name = "--ratios",
                .to = &arguments.volumes,
                .text = "Material ratios where peaks end and dales begin in Vmp, Vmc, Vvc and Vvv, in %",
                .shown = "P,Q",
                .otherwise = "10,80",
                .values = 2,
                .between = ','},
               {.name = "--height-between",
                .to = &arguments.difference,
                .text = "Sdc, the height difference between two material ratios, in %",
                .shown = "P,Q",
                .values = 2,
                .between = ','},
               {.name = "--prune",
                .to = &arguments.prune,
                .text = "Hills and dales that are lower than this over their saddle are no features",
                .range = Range{0.0, 100.0},
                .unit = "% of Sz"}});
}

engine::Status checkAreal(const ArealArguments& arguments) {
  for (const auto& [ratios, option] :
       {std::pair(&arguments.volumes, "--ratios"), {&arguments.difference, "--height-between"}}) {
    if (ratios->empty()) continue;
    for (const double ratio : *ratios)
      if (!(ratio >= 0.0 && ratio <= 100.0))
        return engine::inputError(fmt::format("{:.6g} is no material ratio", ratio), option,
                                  "give 0 to 100, in per cent");
    if (!((*ratios)[0] < (*ratios)[1]))
      return engine::inputError(
          fmt::format("the ratios {:.6g} and {:.6g} are not in order", (*ratios)[0], (*ratios)[1]), option,
          "give the smaller one first");
  }
  return {};
}

ArealChoice choiceOf(const ArealArguments& arguments) {
  ArealChoice choice;
  if (!arguments.volumes.empty())
    choice.volumes = {arguments.volumes[0] / 100.0, arguments.volumes[1] / 100.0};
  choice.prune = arguments.prune / 100.0;
  if (!arguments.difference.empty())
    choice.difference = {arguments.difference[0] / 100.0, arguments.difference[1] / 100.0};
  return choice;
}

}  // namespace fettle::app

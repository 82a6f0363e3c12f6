#include <memory>

#include "app/commands/command.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/window/workstation.h"
#include "haptic/devices/enumerate.h"
#include "haptic/loop/pacer.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

namespace {

struct ViewArguments {
  ViewOptions view;
  std::string scene;
  std::string size = "1280x800";
  bool validate = false;
};

engine::Result<Report> view(const ViewArguments& given, engine::JobControl& job) {
  ViewOptions options = given.view;
  const auto size = parseSize(given.size, "--size", kWindowSides);
  if (!size) return tl::unexpected(size.error());
  std::tie(options.window.width, options.window.height) = *size;
  if (!given.scene.empty()) {
    auto scene = haptic::loadScene(given.scene);
    if (!scene) return tl::unexpected(scene.error());
    options.scene = *std::move(scene);
  }
  if (given.validate) options.window.validation = render::Validation::kOn;
  auto station = Workstation::create(options);
  if (!station) return tl::unexpected(station.error());
  auto report = (*station)->run(job);
  if (report)
    for (const auto& message : (*report)["validation_messages"])
      warn("validation: " + message.get<std::string>());
  return report;
}

constexpr const char* kViewFooter =
    "F1 in the window lists the keys. Without a device that gives force the mouse is the stylus: choose a "
    "tool,\n"
    "press with the left button, deeper with the wheel.";

}  // namespace

void addView(Command root, Chosen& chosen) {
  auto options = std::make_shared<ViewArguments>();
  Command command = addCommand(
      root, chosen, "view", "The window: view, touch and clean a scan",
      [options](engine::JobControl& job) { return view(*options, job); }, printReport, Progress::kOwn);
  command.option("SCAN", options->view.scan, "The scan to open; without it, drop one on the window");
  command.option("--scene", options->scene, "Scene file: tip, stiffness, brush, effects (TOML)");
  command
      .option("--device", options->view.client.device,
              "An id of fettle devices or one of " + haptic::driverWords())
      .showDefault();
  command.option("--rate", options->view.client.rate_hz, "Ticks of the loop per second, 1000 to 10000")
      .check(within(haptic::Pacer::kLowestRate_hz, haptic::Pacer::kHighestRate_hz))
      .showDefault();
  command.option("--size", options->size, "Pixels of the window, WIDTHxHEIGHT").showDefault();
  command
      .option("--ui-scale", options->view.window.scale,
              "Factor on the size of text and panels, 0.5 to 4; without it, the display's")
      .check(within(0.5, 4.0));
  command.flag("--sharp-motion", options->view.sharp_motion,
               "Draw every pixel also while the view moves; without it, every second one in each direction");
  command.option("--seconds", options->view.seconds, "End after this time").check(within(1e-3, 86400.0));
  command
      .option("--events", options->view.events,
              "Write the state of the window and its actions to it: one JSON object per line, for scripts")
      .typeName("FILE");
  command.option("--gpu", options->view.window.device, "Use the Vulkan device whose name contains this");
  command.flag("--validate", options->validate, "Load the Vulkan validation layers; they must be installed");
  addScanOptions(command, options->view.reading);
  command.footer(kViewFooter);
}

}  // namespace fettle::app

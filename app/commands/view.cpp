#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/report_draft.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/window/workstation/workstation.h"
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
  bool plain_rest = false;
  std::string xr_scale = "giant";
  std::string theme;
};

engine::Status writeWindowReport(const ReportRequest& request, const std::string& path,
                                 engine::JobControl& job) {
  ReportArguments arguments;
  arguments.scan = request.file;
  arguments.reading = request.reading;
  arguments.name = request.name;
  arguments.kept = request.sections;
  arguments.out = path;
  const auto written = writeReport(arguments, job);
  return written ? engine::Status() : tl::unexpected(written.error());
}

engine::Result<Report> view(const ViewArguments& given, engine::JobControl& job) {
  ViewOptions options = given.view;
  options.write_report = writeWindowReport;
  options.drawing.smooth_at_rest = !given.plain_rest;
  const auto size = parseSize(given.size, "--size", kWindowSides);
  if (!size) return tl::unexpected(size.error());
  std::tie(options.window.width, options.window.height) = *size;
  if (!given.scene.empty()) {
    auto scene = haptic::loadScene(given.scene);
    if (!scene) return tl::unexpected(scene.error());
    options.scene = *std::move(scene);
    options.scene_path = given.scene;
  }
  if (!given.theme.empty())
    options.theme = given.theme == "light" ? render::Theme::kLight : render::Theme::kDark;
  options.xr_scale = given.xr_scale == "true" ? RoomScale::kTrue : RoomScale::kGiant;
  if (given.validate) options.window.validation = render::Validation::kOn;
  auto station = Workstation::create(options);
  if (!station) return tl::unexpected(station.error());
  auto report = (*station)->run(job);
  if (report)
    for (const auto& message : (*report)["validation_messages"])
      warn("validation: " + message.get<std::string>());
  return report;
}

}  // namespace

void addView(Command root, Chosen& chosen) {
  auto options = std::make_shared<ViewArguments>();
  Command command = addCommand(
      root, chosen, "view", "The window: view, touch and clean a scan",
      [options](engine::JobControl& job) { return view(*options, job); }, printReport, Progress::kOwn);
  command.add({
      {.name = "SCAN",
       .to = &options->view.scan,
       .text = "The scan to open; without it, drop one on the window",
       .kind = ValueKind::kInput},
      {.name = "--scene",
       .to = &options->scene,
       .text = "Scene file: tip, stiffness, brush, effects (TOML)",
       .kind = ValueKind::kFile},
      {.name = "--device",
       .to = &options->view.client.device,
       .text = "An id of fettle devices or one of " + haptic::driverWords(),
       .proposed = haptic::driversAlone()},
      {.name = "--rate",
       .to = &options->view.client.rate_hz,
       .text = "Rate of the loop",
       .range = Range{haptic::Pacer::kLowestRate_hz, haptic::Pacer::kHighestRate_hz},
       .unit = "ticks per second"},
      {.name = "--size",
       .to = &options->size,
       .text =
           fmt::format("Size of the window, each side {} to {}", kWindowSides.smallest, kWindowSides.largest),
       .kind = ValueKind::kSize,
       .unit = "pixels"},
      {.name = "--ui-scale",
       .to = &options->view.window.scale,
       .text = "Factor on the size of text and panels",
       .range = Range{0.5, 4.0},
       .otherwise = "as chosen in the window, the display's at first"},
      {.name = "--theme",
       .to = &options->theme,
       .text = "Colours of panels and dialogs, from now on",
       .words = {{"dark", "light text on dark panels"}, {"light", "dark text on light panels"}},
       .otherwise = "as chosen in the window, dark at first"},
      {.name = "--sharp-motion",
       .to = &options->view.drawing.sharp_motion,
       .text = "Draw every pixel also while the view moves; without it, every second one in each direction"},
      {.name = "--steady",
       .to = &options->view.drawing.steady,
       .text = "Draw the same however long it takes; without it, every fourth pixel in each direction while "
               "the view moves, "
               "and no shadow of the stylus, where frames take long"},
      {.name = "--plain-rest",
       .to = &options->plain_rest,
       .text = "Draw one ray per pixel also at rest; without it, four"},
      {.name = "--seconds",
       .to = &options->view.seconds,
       .text = "End after this time",
       .range = Range{1e-3, 86400.0},
       .unit = "seconds",
       .otherwise = "the window stays until it is closed"},
      {.name = "--events",
       .to = &options->view.events,
       .text = "Write the state of the window and its actions to it: one JSON object per line, for scripts",
       .kind = ValueKind::kNewFile},
      {.name = "--xr",
       .to = &options->view.xr,
       .text = "Show the field in a headset as well, by the OpenXR runtime that is installed"},
      {.name = "--xr-scale",
       .to = &options->xr_scale,
       .text = "How large the field is in the headset at first",
       .words = {{"giant", "as a giant sees it: its longer side is 0.6 m, on a table"},
                 {"true", "a millimetre is a millimetre"}}},
      {.name = "--gpu",
       .to = &options->view.window.device,
       .text = "Use the Vulkan device whose name contains this"},
      {.name = "--validate",
       .to = &options->validate,
       .text = "Load the Vulkan validation layers; they must be installed"},
  });
  addScanOptions(command, options->view.reading);
  command.notes(
      "F1 in the window lists the keys. Without a device that gives force the mouse is the stylus: choose a "
      "tool, press with the left button, deeper with the wheel.");
}

}  // namespace fettle::app

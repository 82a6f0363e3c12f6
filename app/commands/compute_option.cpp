#include "app/commands/compute_option.h"

#include <fmt/format.h>

#include "app/terminal.h"
#include "render/compute/tgv_compute.h"

namespace fettle::app {

void addComputeOption(Command command, std::string& word) {
  command.add({{.name = "--compute",
                .to = &word,
                .text = fmt::format("Where {} takes its steps", engine::filterWords(engine::runsOnDevices)),
                .words = {{"auto", "on a hardware device where the machine has one, else on the processor"},
                          {"cpu", "on the processor"},
                          {"gpu", "on a graphics device"}}}});
}

engine::Result<FilterCompute> chooseCompute(const std::string& word, const engine::Filter& filter) {
  if (word == "cpu") return FilterCompute(Compute::kCpu, nullptr);
  const Compute where = word == "gpu" ? Compute::kGpu : Compute::kAuto;
  if (!engine::runsOnDevices(filter)) {
    if (where == Compute::kAuto) return FilterCompute(where, nullptr);
    return engine::inputError(
        fmt::format("{} runs on the processor alone", filter.word), "--compute",
        fmt::format("leave it out, or take --filter {}", engine::filterWords(engine::runsOnDevices, " or ")));
  }
  render::DeviceOptions options;
  if (where == Compute::kAuto) options.kind = render::DriverKind::kHardware;
  auto device = render::TgvCompute::create(options);
  if (device) return FilterCompute(where, *std::move(device));
  if (where == Compute::kGpu) return tl::unexpected(device.error());
  warn(fmt::format("{}: the processor filters", device.error().line()));
  return FilterCompute(where, nullptr);
}

}  // namespace fettle::app

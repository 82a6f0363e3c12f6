#include "python/calls.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "app/commands/call.h"
#include "app/commands/command.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "python/errors.h"
#include "python/waiting.h"
#include "render/plan/picture.h"

namespace fettle::python {

namespace py = pybind11;

namespace {

py::object pictureOf(const render::Image& picture) {
  py::array_t<std::uint8_t> pixels({picture.height, picture.width, 4});
  std::copy(picture.rgba.begin(), picture.rgba.end(), pixels.mutable_data());
  return pixels;
}

// What a command wrote to a place; None where it wrote nothing there.
py::object writtenTo(const app::MemoryPlace& place, const Scan* source) {
  if (place.picture) return pictureOf(*place.picture);
  if (place.page) return py::bytes(*place.page);
  if (place.lines) return py::cast(rowsOf(*place.lines));
  if (!place.scan) return py::none();
  Scan scan{*place.scan};
  if (!scan.data.original && source != nullptr) {
    const engine::Grid &made = scan.data.field.grid(), &before = source->original().grid();
    if (made.width == before.width && made.height == before.height) scan.data.original = source->original();
  }
  return py::cast(std::move(scan));
}

}  // namespace

py::tuple callCommand(const std::vector<std::string>& arguments, const Given& given,
                      const std::vector<std::string>& made, const std::string& source,
                      const std::string& help, const py::object& progress) {
  std::map<std::string, app::MemoryPlace> places;
  const Scan* origin = nullptr;
  for (const auto& [name, value] : given)
    if (const auto* scan = std::get_if<Scan>(&value)) {
      places[name].scan = scan->data;
      if (name == source) origin = scan;
    }
  // Lines are those of a field: that of the source.
  for (const auto& [name, value] : given)
    if (const auto* rows = std::get_if<std::vector<LineRow>>(&value); rows != nullptr && origin != nullptr)
      places[name].lines = linesOf(*rows, origin->grid());
  for (const std::string& name : made) places[name];

  engine::JobControl job;
  std::optional<engine::Result<app::Report>> report;
  std::vector<std::string> warnings;
  waitFor(
      [&] {
        app::KeptMessages messages;
        app::MemoryPlaces memory;
        for (const auto& [name, place] : places) memory.at(name) = place;
        report = app::callCommand(arguments, app::addScanCommands, help, job);
        for (const std::string& name : made) places[name] = std::move(memory.at(name));
        warnings = std::move(messages.warnings);
      },
      job, progress);
  const app::Report done = valueOf(*std::move(report));
  py::dict written;
  for (const std::string& name : made) written[py::str(name)] = writtenTo(places[name], origin);
  return py::make_tuple(done.dump(-1, ' ', false, app::Report::error_handler_t::replace), written,
                        textsOf(warnings));
}

std::string commandTables() {
  return app::commandTables(app::addScanCommands).dump();
}

}  // namespace fettle::python

#include "app/commands/still_picture.h"

#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "render/live/picture_rows.h"
#include "render/png/png.h"

namespace fettle::app {

engine::Result<render::FrameStatistics> drawPicture(render::LivePicture& picture, const render::Shown& shown,
                                                    const render::FrameInput& input, const std::string& path,
                                                    engine::JobControl& job, const std::string& name) {
  if (auto status = picture.update(shown); !status) return tl::unexpected(status.error());
  picture.refreshRanges();
  const auto warned = [&](const render::FrameStatistics& frame) {
    for (const std::string& warning : frame.warnings)
      warn(name.empty() ? warning : fmt::format("{}: {}", name, warning));
  };
  if (MemoryPlace* place = memoryPlace(path)) {
    render::Image whole{input.view.width, input.view.height, {}};
    whole.rgba.reserve(std::size_t{4} * input.view.width * input.view.height);
    const auto append = [&](const render::Image& rows) -> engine::Status {
      whole.rgba.insert(whole.rgba.end(), rows.rgba.begin(), rows.rgba.end());
      return {};
    };
    auto frame = render::drawRows(picture, input, append, job);
    if (!frame) return frame;
    if (job.cancelled()) return engine::cancelled();
    warned(*frame);
    place->picture = std::move(whole);
    return frame;
  }
  auto png = render::PngWriter::create(path, input.view.width, input.view.height);
  if (!png) return tl::unexpected(png.error());
  auto frame = render::drawRows(
      picture, input, [&](const render::Image& rows) { return png->write(rows); }, job);
  if (!frame) return frame;
  if (job.cancelled()) return engine::cancelled();
  warned(*frame);
  if (auto status = png->finish(); !status) return tl::unexpected(status.error());
  return frame;
}

}  // namespace fettle::app

#include "app/commands/still_picture.h"

#include "app/terminal.h"
#include "render/live/picture_rows.h"
#include "render/png/png.h"

namespace fettle::app {

engine::Result<render::FrameStatistics> drawPicture(render::LivePicture& picture, const render::Shown& shown,
                                                    const render::FrameInput& input, const std::string& path,
                                                    engine::JobControl& job, const std::string& name) {
  if (auto status = picture.update(shown); !status) return tl::unexpected(status.error());
  picture.refreshRanges();
  auto png = render::PngWriter::create(path, input.view.width, input.view.height);
  if (!png) return tl::unexpected(png.error());
  auto frame = render::drawRows(
      picture, input, [&](const render::Image& rows) { return png->write(rows); }, job);
  if (!frame) return frame;
  if (job.cancelled()) return engine::cancelled();
  for (const std::string& warning : frame->warnings) warn(name.empty() ? warning : name + ": " + warning);
  if (auto status = png->finish(); !status) return tl::unexpected(status.error());
  return frame;
}

}  // namespace fettle::app

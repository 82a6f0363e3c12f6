#include "app/commands/report_pictures.h"

#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "app/commands/still_picture.h"
#include "app/work/streams.h"
#include "render/live/picture_rows.h"

namespace fettle::app {

engine::Status addPictures(ReportDraft& draft) {
  const auto picture = render::LivePicture::create();
  if (!picture) return tl::unexpected(picture.error());
  const auto scratch = ScratchFolder::create();
  if (!scratch) return tl::unexpected(scratch.error());
  const std::string file = (std::filesystem::path(scratch->path()) / "picture.png").string();
  render::View view;
  view.width = 1400;
  view.height = 640;
  int drawn_pictures = 0;
  const auto draw = [&](const render::Shown& shown, const render::FrameInput& input,
                        std::string caption) -> engine::Status {
    const auto drawn = drawPicture(**picture, shown, input, file, draft.job);
    if (!drawn) return tl::unexpected(drawn.error());
    std::ifstream in(file, std::ios::binary);
    draft.page.parts.emplace_back(ReportPage::Picture{
        std::move(caption),
        std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>())});
    ++drawn_pictures;
    draft.report["pictures"] = drawn_pictures;
    return {};
  };
  render::Shown shown;
  render::FrameInput input = render::stillInput(view);
  const bool two = draft.states.size() > 1;
  for (const ShownState& state : draft.states) {
    shown.versions.push_back(state.field);
    input.titles.push_back(two ? state.name : draft.page.title);
  }
  const auto caption = [two](const char* where) {
    return fmt::format("{} {}", two ? "Before and after, from" : "From", where);
  };
  if (auto status = draw(shown, input, caption("the side")); !status) return status;
  input.view.azimuth_deg = 0.0;
  input.view.elevation_deg = 90.0;
  if (auto status = draw(shown, input, caption("above")); !status) return status;
  if (!two) return {};
  shown.versions = {draft.states.back().field};
  shown.original = draft.states.front().field;
  input.titles = {"Change"};
  if (draft.change->p99 > 0.0) input.range = render::ValueRange{-draft.change->p99, draft.change->p99};
  return draw(shown, input, "Change from before to after; colours end at 99 % of the samples");
}

}  // namespace fettle::app

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "render/live/live_picture.h"
#include "render/trials/detail_trial.h"

namespace fettle::bench {

constexpr std::int64_t kAllVertices = std::int64_t{1} << 24;
constexpr render::Sharpness kFull = render::Sharpness::kFull;

constexpr trials::DetailChoice kDetailChoices[] = {
    {"bound 8 px", 8.0, kAllVertices, kFull},
    {"bound 4 px", 4.0, kAllVertices, kFull},
    {"bound 2 px", 2.0, kAllVertices, kFull},
    {"bound 1 px", 1.0, kAllVertices, kFull},
    {"bound 0.5 px", 0.5, kAllVertices, kFull},
    {"16 k vertices", 1.0, 16384, kFull},
    {"32 k vertices", 1.0, 32768, kFull},
    {"64 k vertices", 1.0, 65536, kFull},
    {"64 k vertices, half as sharp", 1.0, 65536, render::Sharpness::kHalf},
};

engine::Result<Study> detailStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"detail",
              "Picture: level of detail",
              "What does a faster frame leave out?",
              {"time per frame", "ms"},
              {"mean difference of a pixel", "codes of 255"}};
  study.wrong_name = "pixels more than 16 codes off";
  const auto scans = partAndScan("milled part, 1M samples", options, job);
  if (!scans) return tl::unexpected(scans.error());
  const int views = std::max(2, static_cast<int>(std::lround(12 * options.effort)));
  job.begin("level of detail",
            scans->size() * static_cast<std::size_t>(views) * (std::size(kDetailChoices) + 1));

  auto created = render::LivePicture::create();
  if (!created) return tl::unexpected(created.error());
  render::LivePicture& picture = **created;
  for (const StudiedScan& subject : *scans) {
    if (auto ok =
            picture.update(render::Shown{{subject.field}, std::nullopt, {}, render::MarksOverlay::kHide});
        !ok)
      return tl::unexpected(ok.error());
    picture.finish();
    render::FrameInput input;
    input.view.width = 1280;
    input.view.height = 800;
    input.view.azimuth_deg = 315.0;
    input.decoration = render::Decoration::kNone;
    const auto figures =
        trials::measureDetail(picture, input, views, kDetailChoices, trials::everySample(), job);
    if (!figures) return tl::unexpected(figures.error());
    for (std::size_t k = 0; k < figures->size(); ++k) {
      const trials::DetailFigures& f = (*figures)[k];
      AccuracyRow row{subject.name,
                      k < std::size(kDetailChoices) ? kDetailChoices[k].name : trials::everySample().name};
      row.cost = f.ms;
      row.cost_worst = f.ms_worst;
      row.error = f.mean_codes;
      row.error_p99 = f.p99_codes;
      row.error_worst = f.worst_codes;
      row.wrong = f.far_off;
      row.hash = f.hash;
      row.note = fmt::format("geometry within {:.2f} px, {} vertices", f.bound_px, f.vertices);
      study.rows.push_back(std::move(row));
    }
  }
  study.reference = fmt::format(
      "The picture of every sample, drawn by the same shaders on {}, 1280 x 800, from {} sides. The "
      "geometric bound is proved (render/detail/detail.h) and held against brute force by ctest -R Detail.",
      picture.device(), views);
  const std::string& name = scans->front().name;
  const AccuracyRow& usual = rowOf(study, name, "64 k vertices");
  const AccuracyRow& every = rowOf(study, name, "every sample");
  const AccuracyRow& half = rowOf(study, name, "64 k vertices, half as sharp");
  study.answer = fmt::format(
      "The usual 64 k vertices draw in {:.0f} ms what takes {:.0f} ms with every sample; pixels are {:.1f} "
      "codes of 255 off on average, {:.1f} % of them by more than 16. While the camera moves, half as sharp "
      "takes {:.0f} ms and is {:.1f} codes off.",
      usual.cost, every.cost, usual.error, 100 * usual.wrong, half.cost, half.error);
  return study;
}

}  // namespace fettle::bench

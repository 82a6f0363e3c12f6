#include "render/trials/detail_trial.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/base/statistics.h"
#include "engine/base/stopwatch.h"

namespace fettle::trials {
namespace {

constexpr double kFarOff = 16.0;  // codes of 255

struct Seen {
  std::vector<double> ms, off;
  DetailFigures figures;
};

engine::Status draw(render::LivePicture& picture, render::FrameInput& input, const DetailChoice& choice,
                    const engine::JobControl& job, render::Image& image, Seen& out) {
  input.error_px = choice.error_px;
  input.vertex_budget = choice.vertices;
  input.sharpness = choice.sharpness;
  // Draw until all pages that this view requests are on the device, then measure the time.
  for (int i = 0; i < 200; ++i) {
    if (job.cancelled()) return engine::cancelled();
    const auto warm = picture.drawAndWait(input);
    if (!warm) return tl::unexpected(warm.error());
    if (warm->upload.pending_tiles == 0) break;
  }
  const engine::Stopwatch watch;
  const auto stats = picture.drawAndWait(input);
  if (!stats) return tl::unexpected(stats.error());
  out.ms.push_back(watch.ms());
  out.figures.bound_px = std::max(out.figures.bound_px, stats->bound_px);
  out.figures.vertices = std::max(out.figures.vertices, stats->vertices);
  if (const auto shown = picture.draw(input, image); !shown) return tl::unexpected(shown.error());
  return {};
}

}  // namespace

const DetailChoice& everySample() {
  static constexpr DetailChoice kAll{"every sample", 1e-6, std::int64_t{1} << 24};
  return kAll;
}

engine::Result<std::vector<DetailFigures>> measureDetail(render::LivePicture& picture,
                                                         render::FrameInput input, int views,
                                                         std::span<const DetailChoice> choices,
                                                         const DetailChoice& reference,
                                                         engine::JobControl& job) {
  input.redraw = render::FrameInput::Redraw::kAll;
  const double first_deg = input.view.azimuth_deg;
  std::vector<Seen> seen(choices.size() + 1);
  for (int view = 0; view < views; ++view) {
    input.view.azimuth_deg = std::fmod(first_deg + 360.0 * view / views, 360.0);
    render::Image full, image;
    if (auto ok = draw(picture, input, reference, job, full, seen.back()); !ok)
      return tl::unexpected(ok.error());
    job.advance();
    for (std::size_t k = 0; k < choices.size(); ++k) {
      if (auto ok = draw(picture, input, choices[k], job, image, seen[k]); !ok)
        return tl::unexpected(ok.error());
      for (std::size_t i = 0; i < full.rgba.size(); i += 4) {
        int off = 0;
        for (std::size_t c = i; c < i + 3; ++c) off = std::max(off, std::abs(full.rgba[c] - image.rgba[c]));
        seen[k].off.push_back(off);
      }
      job.advance();
    }
  }
  std::vector<DetailFigures> out;
  for (Seen& s : seen) {
    const engine::TimeSpread times = engine::timeSpread(std::move(s.ms));
    DetailFigures& figures = out.emplace_back(s.figures);
    figures.ms = times.median;
    figures.ms_worst = times.worst;
    figures.hash = engine::hashOf(s.off);
    if (!s.off.empty())
      figures.far_off = static_cast<double>(std::count_if(s.off.begin(), s.off.end(),
                                                          [](double off) { return off > kFarOff; })) /
                        static_cast<double>(s.off.size());
    const engine::ErrorSummary summary = engine::errorSummary(std::move(s.off));
    figures.mean_codes = summary.mean;
    figures.p99_codes = summary.p99;
    figures.worst_codes = summary.worst;
  }
  return out;
}

}  // namespace fettle::trials

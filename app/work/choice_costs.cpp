#include "app/work/choice_costs.h"

#include <utility>

#include "app/texts/texts.h"

namespace fettle::app {
namespace {

constexpr std::int64_t kTicks = 2000;
constexpr int kRepeats = 3;
constexpr std::int64_t kTruthVertices = std::int64_t{1} << 21;

constexpr trials::DetailChoice kDetail[] = {
    {textOf("16 k vertices"), 1.0, 16384},   {textOf("32 k vertices"), 1.0, 32768},
    {textOf("64 k vertices"), 1.0, 65536},   {textOf("128 k vertices"), 1.0, 131072},
    {textOf("256 k vertices"), 1.0, 262144},
};

template <class Figures>
void takeIn(Background<std::vector<Figures>>& run, std::vector<Figures>& figures,
            std::vector<engine::Error>& errors) {
  const bool cancelled = run.cancelling();
  auto result = run.take();
  if (!result) return;
  if (*result && !cancelled)
    figures = std::move(**result);
  else if (!*result && result->error().kind != engine::ErrorKind::kCancelled)
    errors.push_back(result->error());
}

}  // namespace

std::span<const trials::DetailChoice> detailChoices() {
  return kDetail;
}

void ChoiceCosts::measureContact(const engine::Version& field) {
  contact_run_.start([field](engine::JobControl& job) -> engine::Result<std::vector<trials::ContactFigures>> {
    const auto choices = trials::contactChoices();
    job.begin("contact levels", choices.size());
    std::vector<trials::ContactFigures> out;
    std::optional<trials::ContactTrial> trial;
    double tried = -1.0;  // the tip that the trial is for
    for (const trials::ContactChoice& choice : choices) {
      if (std::exchange(tried, choice.ball_radius_cells) != choice.ball_radius_cells) {
        auto next = trials::ContactTrial::make(field, tried, tried > 0.0 ? kTicks / 10 : kTicks, job);
        if (!next) return tl::unexpected(next.error());
        trial = *std::move(next);
      }
      trials::ContactFigures& figures = out.emplace_back();
      if (trial) {
        const auto measured = trial->measure(choice, kRepeats, job);
        if (!measured) return tl::unexpected(measured.error());
        figures = *measured;
      }
      job.advance();
    }
    return out;
  });
}

void ChoiceCosts::measureDetail(const engine::Version& field, const render::View& view) {
  detail_run_.start([field,
                     view](engine::JobControl& job) -> engine::Result<std::vector<trials::DetailFigures>> {
    job.begin("level of detail", std::size(kDetail) + 1);
    auto picture = render::LivePicture::create();
    if (!picture) return tl::unexpected(picture.error());
    if (auto ok = (*picture)->update(render::Shown{{field}, std::nullopt, {}, render::MarksOverlay::kHide});
        !ok)
      return tl::unexpected(ok.error());
    render::FrameInput input;
    input.view = view;
    input.decoration = render::Decoration::kNone;
    const trials::DetailChoice truth{"the finest", 1e-6, kTruthVertices};
    return trials::measureDetail(**picture, input, 1, kDetail, truth, job);
  });
}

void ChoiceCosts::reset() noexcept {
  contact_run_.cancel();
  detail_run_.cancel();
  contact_.clear();
  detail_.clear();
}

std::vector<engine::Error> ChoiceCosts::poll() {
  std::vector<engine::Error> errors;
  takeIn(contact_run_, contact_, errors);
  takeIn(detail_run_, detail_, errors);
  return errors;
}

}  // namespace fettle::app

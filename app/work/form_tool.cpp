#include "app/work/form_tool.h"

#include <memory>
#include <utility>

#include "app/texts/texts.h"
#include "app/work/form_figures.h"
#include "app/work/through_noise.h"
#include "engine/measure/form_surface.h"

namespace fettle::app {
namespace {

engine::Result<FormTool::Fit> fitOf(const engine::Version& field, const engine::FormChoice& options,
                                    engine::JobControl& job) {
  const auto samples = engine::withoutLayer(field, job);
  if (!samples) return tl::unexpected(samples.error());
  auto fit = engine::fitNominalForm(*samples, options, job);
  if (!fit) return tl::unexpected(fit.error());
  if (auto status = addThroughNoise(*fit, *samples, options, job); !status)
    return tl::unexpected(status.error());
  return FormTool::Fit{options,
                       std::make_shared<const engine::NominalForm>(fit->form),
                       fit->samples,
                       fit->rms,
                       fit->open,
                       fit->leaves,
                       fit->beyond,
                       engine::tiltOf(*fit, field.grid()),
                       formFigures(fit->form, field.grid())};
}

}  // namespace

void FormTool::measure(const LoopClient& client) {
  dropApproximation();
  working_.replace(
      [field = client.newest(), what = options](engine::JobControl& job) -> engine::Result<Work> {
        auto fit = fitOf(field, what, job);
        if (!fit) return tl::unexpected(fit.error());
        return Work{*std::move(fit), std::nullopt, std::nullopt};
      });
}

void FormTool::preview(const LoopClient& client) {
  slot_ = std::make_shared<Slot>();
  working_.replace([field = client.newest(), what = options,
                    slot = slot_](engine::JobControl& job) -> engine::Result<Work> {
    if (field.formOver() == nullptr && formTakesLong(field.grid())) {
      // Its errors are those of the whole, which will report them.
      if (auto coarse = coarseForm(field, what, job)) {
        const std::scoped_lock lock(slot->mutex);
        slot->preview = Preview{what, coarse->surface, nullptr, *std::move(coarse)};
      }
    }
    auto fit = fitOf(field, what, job);
    if (!fit) return tl::unexpected(fit.error());
    const engine::FieldForm& over = field.formOver();
    auto surface = engine::formSurface(field.grid(), *fit->form, over.get(), job);
    if (!surface) return tl::unexpected(surface.error());
    return Work{*std::move(fit), std::nullopt, Preview{what, *std::move(surface), over, std::nullopt}};
  });
}

void FormTool::followOptions(const LoopClient& client) {
  if (preview_ && !working_.busy() && !(preview_->options == options)) preview(client);
}

void FormTool::dropPreview() {
  if (slot_) working_.cancel();  // it works the rest out
  preview_.reset();
}

// Other work takes the place of what would make it exact.
void FormTool::dropApproximation() {
  slot_.reset();
  if (preview_ && preview_->coarse) preview_.reset();
}

void FormTool::takeOut(const LoopClient& client) {
  dropApproximation();
  working_.replace([field = client.newest(), scan = client.scan(),
                    what = options](engine::JobControl& job) -> engine::Result<Work> {
    auto fit = fitOf(field, what, job);
    if (!fit) return tl::unexpected(fit.error());
    auto change = makeFormChange(FormStep::kTakeOut, fit->form, field, scan, job);
    if (!change) return tl::unexpected(change.error());
    change->choice = what;
    return Work{*std::move(fit), *std::move(change), std::nullopt};
  });
}

void FormTool::start(const LoopClient& client, FormStep step) {
  if (client.newest().formOver() == nullptr) return;
  dropApproximation();
  working_.replace(
      [field = client.newest(), scan = client.scan(), step](engine::JobControl& job) -> engine::Result<Work> {
        auto change = makeFormChange(step, nullptr, field, scan, job);
        if (!change) return tl::unexpected(change.error());
        return Work{std::nullopt, *std::move(change), std::nullopt};
      });
}

bool FormTool::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  if (preview_ && preview_->over != client.newest().formOver()) {
    preview_.reset();
    changed = true;
  }
  const bool dropped = working_.cancelling();
  if (slot_ && !dropped && working_.busy()) {
    const std::scoped_lock lock(slot_->mutex);
    if (slot_->preview) {
      preview_ = std::exchange(slot_->preview, std::nullopt);
      changed = true;
    }
  }
  auto done = working_.take();
  if (!done) return changed;
  slot_.reset();
  if (dropped) {
    preview_.reset();
    return true;
  }
  if (!*done) {
    preview_.reset();  // of other options
    if (done->error().kind != engine::ErrorKind::kCancelled)
      notices.push_back({done->error().what, done->error().remedy});
    return true;
  }
  Work work = std::move(**done);
  if (work.fit) fit_ = work.fit;
  if (work.preview) preview_ = std::move(work.preview);
  if (work.fit && !work.fit->open.empty())
    notices.push_back({work.fit->open, textOf("of the planes that come nearest to them it is the flattest")});
  if (work.fit && !work.fit->leaves.empty())
    notices.push_back({work.fit->leaves,
                       textOf("beyond its region it is a guess: take a lower degree, or a larger region")});
  if (!work.change || client.changeForm(*work.change)) return true;
  // The field was filtered meanwhile: once more, near what is known.
  working_.replace([field = client.newest(),
                    work = std::move(work)](engine::JobControl& job) mutable -> engine::Result<Work> {
    if (auto moved = work.change->moveTo(field, job); !moved) return tl::unexpected(moved.error());
    return Work{std::nullopt, std::move(work.change), std::nullopt};
  });
  return true;
}

void FormTool::clear() {
  working_.cancel();
  slot_.reset();
  fit_.reset();
  preview_.reset();
}

}  // namespace fettle::app

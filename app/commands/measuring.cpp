#include "app/commands/measuring.h"

#include "app/terminal.h"
#include "engine/field/piece.h"

namespace fettle::app {

PlannedOnPieces plannedMeasuring(const PlannedMeasuring& measuring) {
  // As many trials as the whole has: a piece alone would have more.
  const int trials = noiseTrials(measuring.trials, measuring.counted.grid().samples());
  PlannedOnPieces pieces;
  pieces.share = measuring.states;
  // The autocorrelation is that of a field of twice the sides, in doubles; measured on 1200 and 2500 samples a side.
  if (measuring.areal.spatial || measuring.areal.analysis) pieces.memory_each = 90.0 / measuring.states;
  pieces.work = [measuring, trials](const engine::SampleRect& r,
                                    engine::JobControl& job) -> engine::Result<engine::Version> {
    const KeptMessages said;  // of the scan the command itself says it
    const engine::Version piece = engine::pieceOf(measuring.counted, r.column, r.row, r.columns, r.rows);
    const auto measure = [&](const engine::Version& field,
                             engine::TrialNoise of) -> engine::Result<engine::ArealParameters> {
      const auto limited =
          scaleLimited(field, measuring.scan, measuring.imported, measuring.form, measuring.scale, job);
      if (!limited) return tl::unexpected(limited.error());
      return engine::measureAreal(limited->field, limited->form, engine::optionsOf(measuring.areal, of), job);
    };
    // Of a piece of holes there is nothing to measure.
    const auto taken = [&](const engine::Error& error) -> engine::Result<engine::Version> {
      if (error.kind == engine::ErrorKind::kInput) return piece;
      return tl::unexpected(error);
    };
    auto measured = measure(piece, engine::TrialNoise::kOwn);
    if (!measured) return taken(measured.error());
    if (trials == 0) return piece;
    const auto noise = arealNoise(piece, *measured, measure, trials, job);
    if (!noise) return taken(noise.error());
    return piece;
  };
  return pieces;
}

engine::Result<std::optional<PartNoise>> noiseOfMeasured(const PlannedMeasuring& measuring,
                                                         const ScaleLimited& limited,
                                                         const engine::ArealParameters& stated,
                                                         engine::JobControl& job) {
  const auto limitedOf = [&](const engine::Version& field, const FormArguments& form) {
    return scaleLimited(field, measuring.scan, measuring.imported, form, measuring.scale, job);
  };
  const engine::Version& counted = measuring.counted;
  const engine::ArealOptions& areal = measuring.areal;
  if (measuring.trials != kUsualTrials || noiseTrials(kUsualTrials, counted.grid().samples()) > 0) {
    auto noise = arealNoise(
        counted, stated,
        [&](const engine::Version& noisy,
            engine::TrialNoise noise_of) -> engine::Result<engine::ArealParameters> {
          const auto of = limitedOf(noisy, measuring.form);
          if (!of) return tl::unexpected(of.error());
          return engine::measureAreal(of->field, of->form, engine::optionsOf(areal, noise_of), job);
        },
        measuring.trials, job);
    if (!noise) return tl::unexpected(noise.error());
    return *noise ? std::optional<PartNoise>(PartNoise{**std::move(noise)}) : std::nullopt;
  }
  const auto surface = surfaceField(limited, areal.region, counted, job);
  if (!surface) return tl::unexpected(surface.error());
  // The difference that noise makes in a piece has next to none of any form: a plane does for all.
  FormArguments form = measuring.form;
  form.form = engine::infoOf(engine::FormKind::kPlane).word;
  form.robust = false;
  setThrough(std::nullopt, form);
  return arealNoiseOfPart(
      counted, *surface, stated, areal,
      [&](const engine::Version& piece) -> engine::Result<engine::Version> {
        const auto of = limitedOf(piece, form);
        if (!of) return tl::unexpected(of.error());
        return surfaceField(*of, areal.region, piece, job);
      },
      job);
}

}  // namespace fettle::app

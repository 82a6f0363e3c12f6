#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/levelling.h"
#include "app/commands/scan_options.h"
#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/io/export.h"
#include "engine/io/import.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

// `fettle level --layer`: a form as a layer over the field of a session (engine/field/seen_field.h) instead of heights.

inline constexpr const char* kLayerPut = "put";
inline constexpr const char* kLayerRemove = "remove";
inline constexpr const char* kLayerBake = "bake";

/// "put", "remove", "bake".
[[nodiscard]] std::vector<Word> layerWords();

/// Refuses a form of which the layer says nothing, or which no layer can be, and an output that stores no layer.
[[nodiscard]] engine::Status checkLayer(const std::string& layer, const FormArguments& form,
                                        const std::vector<BatchTask>& tasks);

/// The work of putting a form over samples, for an estimate: what is seen of them is lowered, once or, with what its changes are limited from, twice.
/// `samples` live as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedLayer(const engine::Version& samples, const FormArguments& form,
                                           Lowered lowered);

/// A field and the original that its changes are limited from, under another form, both as they are seen.
struct Layered {
  engine::Version field;
  engine::Version original;
  std::optional<engine::FittedForm> fit;  ///< of a form that was put
};

/// The same of a field that is in memory, as a step of a recipe does it. `scan` is its path. Errors: those of formOf; no form
/// to remove or bake (kInput).
[[nodiscard]] engine::Result<Layered> withLayer(const std::string& layer, const FormArguments& form,
                                                const engine::Version& field, const engine::Version& original,
                                                const engine::Imported& imported, const std::string& scan,
                                                engine::JobControl& job);

/// `fettle level --layer` of one scan.
struct LayerChange {
  const std::string& layer;
  const FormArguments& form;
  const ScanOptions& reading;
  const engine::ExportOptions& writing;
  bool estimate;
};

/// Puts a form over a scan, takes it away or makes it heights, and writes the result; or an estimate of that alone.
[[nodiscard]] engine::Result<Report> changeLayer(const LayerChange& change, const BatchTask& task,
                                                 engine::JobControl& job);

}  // namespace fettle::app

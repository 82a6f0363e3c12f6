#pragma once

#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/scan_options.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/io/export.h"

namespace fettle::app {

// `fettle level --layer`: a form as a layer over the field of a session (engine/field/seen_field.h) instead of heights.

/// "put", "remove", "bake".
[[nodiscard]] std::vector<Word> layerWords();

/// Refuses a form of which the layer says nothing, or which no layer can be, and an output that stores no layer.
[[nodiscard]] engine::Status checkLayer(const std::string& layer, const FormArguments& form,
                                        const std::vector<BatchTask>& tasks);

/// Puts a form over a scan, takes it away or makes it heights, and writes the result.
[[nodiscard]] engine::Result<Report> changeLayer(const std::string& layer, const FormArguments& form,
                                                 const ScanOptions& reading,
                                                 const engine::ExportOptions& writing, const BatchTask& task,
                                                 engine::JobControl& job);

}  // namespace fettle::app

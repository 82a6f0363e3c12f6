#pragma once

#include <string>

#include "app/report.h"
#include "engine/field/version.h"

namespace fettle::app {

// The form that lies over a scan as a layer (`fettle level --layer put`, the panel Form): what is measured of the scan is
// measured without it, and says so. In a table it is the column kLayerKey, empty where none lies over the scan.

inline constexpr const char* kLayerKey = "layer";
/// Of the scan beside it, where a report is of two.
inline constexpr const char* kOtherLayerKey = "other_layer";

/// Its word, as of formWords(); empty: no form lies over the field.
[[nodiscard]] std::string layerOver(const engine::Version& field);

/// Adds it to a report under a key, if a form lies over the field.
void addLayer(Report& report, const engine::Version& field, const char* key = kLayerKey);

/// That of a report; empty: it has none.
[[nodiscard]] std::string layerOf(const Report& report, const char* key = kLayerKey);

/// "without the form poly2 that lies over the scan"; empty without a layer.
[[nodiscard]] std::string layerText(const std::string& layer, const char* scan = "the scan");

/// The same of a report as a line of text, with its end.
void printLayer(const Report& report);

}  // namespace fettle::app

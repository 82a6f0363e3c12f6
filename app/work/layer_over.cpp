#include "app/work/layer_over.h"

#include <utility>

#include <fmt/format.h>

#include "engine/measure/form_kind.h"

namespace fettle::app {

std::string layerOver(const engine::Version& field) {
  const engine::FieldForm& form = field.formOver();
  return form == nullptr ? std::string() : std::string(engine::infoOf(*form).word);
}

void addLayer(Report& report, const engine::Version& field, const char* key) {
  if (std::string layer = layerOver(field); !layer.empty()) report[key] = std::move(layer);
}

std::string layerOf(const Report& report, const char* key) {
  return report.value(key, std::string());
}

std::string layerText(const std::string& layer, const char* scan) {
  return layer.empty() ? std::string() : fmt::format("without the form {} that lies over {}", layer, scan);
}

void printLayer(const Report& report) {
  if (const std::string text = layerText(layerOf(report)); !text.empty()) fmt::print("{}\n", text);
}

}  // namespace fettle::app

#include "app/files/reading_memory.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "app/work/recent_files.h"

namespace fettle::app {
namespace {

std::string absolutePath(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  return error ? path : absolute.lexically_normal().string();
}

// Every field of a form with its name in the file.
void eachField(ImportForm& form, const auto& visit) {
  visit("spacing_x", form.spacing_x);
  visit("spacing_y", form.spacing_y);
  visit("unit", form.unit);
  visit("z_scale", form.z_scale);
  visit("no_data", form.no_data);
  visit("cell_size", form.cell_size);
  visit("cell_rule", form.cell_rule);
  static constexpr const char* kCamera[] = {"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < form.camera.size(); ++i) visit(kCamera[i], form.camera[i]);
}

}  // namespace

ReadingMemory::ReadingMemory(std::string file) : file_(std::move(file)) {
  std::ifstream in(file_);
  const auto all = nlohmann::json::parse(in, nullptr, false);
  if (!all.is_array()) return;
  for (const auto& one : all) {
    if (!one.is_object() || !one.contains("path") || !one["path"].is_string() || said_.size() >= kMost)
      continue;
    Said said{one["path"], {}};
    eachField(said.form, [&](const char* name, std::string& value) {
      if (one.contains(name) && one[name].is_string()) value = one[name];
    });
    said_.push_back(std::move(said));
  }
}

std::optional<ScanOptions> ReadingMemory::find(const std::string& path) const {
  const std::string absolute = absolutePath(path);
  const auto said =
      std::find_if(said_.begin(), said_.end(), [&](const Said& s) { return s.path == absolute; });
  if (said == said_.end()) return std::nullopt;
  auto reading = said->form.read();
  return reading ? std::optional(*std::move(reading)) : std::nullopt;
}

void ReadingMemory::note(const std::string& path, const ScanOptions& reading) {
  const std::string absolute = absolutePath(path);
  std::erase_if(said_, [&](const Said& s) { return s.path == absolute; });
  said_.insert(said_.begin(), {absolute, ImportForm::of(reading)});
  if (said_.size() > kMost) said_.resize(kMost);
  save();
}

void ReadingMemory::save() const {
  if (file_.empty()) return;
  auto all = nlohmann::json::array();
  for (Said said : said_) {
    nlohmann::json one{{"path", said.path}};
    eachField(said.form, [&](const char* name, const std::string& value) {
      if (!value.empty()) one[name] = value;
    });
    all.push_back(std::move(one));
  }
  // A path may be no UTF-8; what cannot be kept is said again next time.
  std::ofstream(file_, std::ios::trunc)
      << all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

std::string readingFile() {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + "/readings.json";
}

}  // namespace fettle::app

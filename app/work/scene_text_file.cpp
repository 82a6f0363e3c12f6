#include "app/work/scene_text_file.h"

#include <fstream>
#include <iterator>
#include <utility>

#include "haptic/contact/sphere_tip.h"

namespace fettle::app {

engine::Result<haptic::Scene> readSceneFor(const std::string& path, const engine::Grid& grid) {
  auto scene = haptic::loadScene(path);
  if (!scene || scene->tip != haptic::TipShape::kSphere) return scene;
  if (auto problem = haptic::sphereProblem(scene->tip_radius_mm, grid))
    return engine::inputError(*std::move(problem), path, "give it a smaller tip_radius_mm");
  return scene;
}

engine::Status writeScene(const std::string& path, const haptic::Scene& scene) {
  auto file = prepareScene(path, scene);
  return file ? file->commit() : tl::unexpected(file.error());
}

engine::Result<engine::AtomicFile> prepareScene(const std::string& path, const haptic::Scene& scene) {
  if (auto problem = haptic::sceneProblem(scene)) return engine::inputError(*std::move(problem), path);
  auto file = engine::AtomicFile::create(path);
  if (!file) return file;
  if (auto status = file->write(haptic::sceneText(scene)); !status) return tl::unexpected(status.error());
  return file;
}

bool isAsWritten(const std::string& path, const haptic::Scene& scene) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {}) == haptic::sceneText(scene);
}

std::string sceneBeside(const std::string& strokes) {
  return strokes + ".scene.toml";
}

}  // namespace fettle::app

#include "app/work/scene_text_file.h"

#include "engine/io/files/atomic_file.h"
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
  if (auto problem = haptic::sceneProblem(scene)) return engine::inputError(*std::move(problem), path);
  return engine::writeFileAtomically(path, haptic::sceneText(scene));
}

}  // namespace fettle::app

#include "app/window/scene_files.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/live/fitted_scene.h"
#include "app/texts/texts.h"
#include "app/work/scene_text_file.h"
#include "app/work/session_guard.h"

namespace fettle::app {
namespace {

std::string nameIn(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

// All but these.
haptic::Scene withToolsOf(haptic::Scene scene, const haptic::Scene& other) {
  const haptic::Scene felt = std::exchange(scene, other);
  scene.effects = felt.effects;
  scene.params = felt.params;
  scene.stiffness_n_per_mm = felt.stiffness_n_per_mm;
  scene.force_limit_n = felt.force_limit_n;
  return scene;
}

}  // namespace

void SceneFiles::begin(const LoopClient& client, std::string path) {
  path_ = std::move(path);
  saved_ = client.scene();
  saved_fit_ = client.fit();
}

bool SceneFiles::open(const std::string& path, LoopClient& client, Feedback& feedback) {
  const auto scene = readSceneFor(path, client.field().grid());
  const engine::Status set = scene ? client.openScene(*scene) : tl::unexpected(scene.error());
  if (!set) {
    // Back to the dialog in which it was chosen.
    feedback.questions.ask(
        {.kind = Question::Kind::kOpenScene,
         .path = path,
         .said = {fmt::format("{}: {}", nameIn(path), set.error().what), set.error().remedy}});
    return false;
  }
  begin(client, path);
  feedback.status = trFormat("the scene is {}", nameIn(path));
  return true;
}

bool SceneFiles::askToSave(Question from, const LoopClient& client, Feedback& feedback) {
  if (std::filesystem::path(from.path).extension() != kExtension) from.path += kExtension;
  ReplacedFiles files = replacedFiles({from.path}, {});
  if (files.texts.empty()) return save(from.path, client, feedback);
  files.texts.push_back(tr("Comments in it are not kept."));
  feedback.questions.ask({.kind = Question::Kind::kReplace,
                          .path = std::move(from.path),
                          .afterwards = std::move(from.afterwards),
                          .from = from.kind,
                          .typed = true,
                          .replaced = std::move(files.texts)});
  return false;
}

bool SceneFiles::save(const std::string& path, const LoopClient& client, Feedback& feedback) {
  if (const engine::Status written = writeScene(path, client.scene()); !written) {
    feedback.message(written.error().line(), tr("the scene stays as it is here; save it elsewhere"));
    return false;
  }
  begin(client, path);
  feedback.status = trFormat("written: {}", path);
  return true;
}

std::string SceneFiles::title(const LoopClient& client) const {
  const std::string name = path_.empty() ? tr("no file") : nameIn(path_);
  return changed(client) ? trFormat("{}, changed", name) : name;
}

bool SceneFiles::changed(const LoopClient& client) const {
  haptic::Scene saved = saved_;
  if (const auto& fit = client.fit(); fit && saved_fit_) {
    saved = withEdits(fit->fitted, saved_, saved_fit_->fitted);
    saved.effects = saved_.effects;
  }
  return withToolsOf(client.scene(), saved) != saved;
}

}  // namespace fettle::app

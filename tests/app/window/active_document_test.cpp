// The scene of a session is meant as it was when it was noted, whatever the words in it mean since.
#include "app/window/active_document.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "app/window/view_text.h"
#include "app/work/filter_preview.h"
#include "engine/formats/formats.h"
#include "haptic/journal/session_player.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::TempFolder;

constexpr std::size_t kHistoryBytes = std::size_t{64} << 20;

engine::Result<Document> documentOf(const std::string& path) {
  engine::JobControl job;
  return openDocument(path, {}, Recovery::kLeave, kHistoryBytes, job);
}

// The window's frames go round the open document until `is`; false when that never comes.
bool framesUntil(ActiveDocument& document, Feedback& feedback, const std::function<bool()>& is) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < end) {
    document.poll(startView(), feedback);
    if (is()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

struct NotedScene {
  const char* name;
  int revision;       // of the fixture, tests/haptic/journal/sessions
  const char* noted;  // in place of what the fixture notes; nullptr: that
};

class ActiveDocumentOf : public testing::TestWithParam<NotedScene> {};

TEST_P(ActiveDocumentOf, AnOlderContactRevisionKeepsItsSceneWhenOpenedFilteredAndSaved) {
  const NotedScene& tried = GetParam();
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  std::filesystem::copy_file(tests::inSourceTree("tests/haptic/journal/sessions/contact_revision_" +
                                                 std::to_string(tried.revision) + ".fettle"),
                             path);
  if (tried.noted != nullptr) {
    auto document = documentOf(path);
    ASSERT_TRUE(document) << document.error().line();
    SessionKeeper keeper(*document);
    keeper.setNote("scene", tried.noted);
    ASSERT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));
  }
  auto document = documentOf(path);
  ASSERT_TRUE(document) << document.error().line();
  // The first revision had no note of it.
  EXPECT_EQ(document->notes.contains("contact"), tried.revision > 1);
  const std::string noted = document->notes.at("scene");
  const auto meant = haptic::parseScene(noted, "noted", tried.revision);
  ASSERT_TRUE(meant) << meant.error().line();
  // Read as today it is another scene.
  EXPECT_NE(*haptic::parseScene(noted, "noted"), *meant);

  Feedback feedback;
  const std::string saved = folder.file("saved.fettle");
  std::uint64_t field = 0;
  {
    ActiveDocument active;
    const engine::Status opened = active.open(*document, {}, {});
    ASSERT_TRUE(opened) << opened.error().line();
    EXPECT_EQ(active.client()->scene(), *meant);
    const std::int64_t before = active.client()->history().number();
    FilterPreview filters;
    filters.spec.kind = engine::FilterKind::kMedian;
    filters.spec.window = 5;
    filters.apply(*active.client());
    ASSERT_TRUE(framesUntil(active, feedback, [&] {
      static_cast<void>(filters.poll(*active.client(), feedback.notices));
      return filters.applied() == 1 && !filters.applying() &&
             active.client()->history().number() == before + 1;
    }));
    filters.finish(*active.client());
    active.keeper()->saveAs(saved, engine::OriginalStorage::kEmbedded);
    ASSERT_TRUE(framesUntil(active, feedback, [&] {
      active.keeper()->poll();
      return active.keeper()->saved().has_value();
    }));
    field = engine::contentHash(active.client()->history().current());
    ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
  }
  for (const Notice& notice : feedback.notices) ADD_FAILURE() << notice.what;

  auto again = documentOf(saved);
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->notes.at("contact"), std::to_string(haptic::kContactRevision));
  EXPECT_EQ(*haptic::parseScene(again->notes.at("scene"), "noted again"), *meant);
  {
    ActiveDocument active;
    ASSERT_TRUE(active.open(*again, {}, {}));
    EXPECT_EQ(active.client()->scene(), *meant);
    ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
  }
  // The ticks of then, and the filter of now, to their bits.
  engine::JobControl job;
  const auto session = engine::openSession(saved, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(played->filters, 1);
  EXPECT_GT(played->ticks, 300);
  EXPECT_EQ(engine::contentHash(played->field), field);
}

constexpr NotedScene kNoted[] = {
    {"LevelOfTheFirst", 1, "[contact]\nlevel = \"paper\"\nsearch_rounds = 5"},
    {"BallOfTheFirst", 1, "tip = \"sphere\"\ntip_radius_mm = 0.2"},
    {"BallOfTheSecond", 2, nullptr},
    {"BallOfTheThird", 3, nullptr},
};

INSTANTIATE_TEST_SUITE_P(Sessions, ActiveDocumentOf, testing::ValuesIn(kNoted),
                         [](const auto& tried) { return std::string(tried.param.name); });

// A revision that this program does not know is refused, and the scene is the default one.
TEST(ActiveDocument, ASceneOfANewerContactRevisionIsNotGuessedAt) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  std::filesystem::copy_file(tests::inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             path);
  {
    auto document = documentOf(path);
    ASSERT_TRUE(document) << document.error().line();
    SessionKeeper keeper(*document);
    keeper.setNote("scene", "tip = \"sphere\"");
    keeper.setNote("contact", std::to_string(haptic::kContactRevision + 1));
    ASSERT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));
  }
  auto document = documentOf(path);
  ASSERT_TRUE(document) << document.error().line();
  ActiveDocument active;
  ASSERT_TRUE(active.open(*document, {}, {}));
  EXPECT_EQ(active.client()->scene().tip, haptic::TipShape::kPoint);
  ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
}

// "Fit to the scan" keeps force, brush, tip and effects of the user's scene, also for who opens the session again: with a device
// of the same kind it is the same scene, with another one the same user's.
TEST(ActiveDocument, AnOwnSceneThatWasFittedIsTheSameWhenItsSessionIsOpenedAgain) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  std::filesystem::copy_file(tests::inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             path);
  haptic::Scene own = haptic::defaultScene();
  own.force_limit_n = 5.0;
  own.stiffness_n_per_mm = 0.8;
  own.brush_radius_samples = 12.0;
  own.mark_radius_samples = 7.0;
  own.tip = haptic::TipShape::kSphere;
  own.effects.push_back(haptic::EffectKind::kFriction);
  own.params.friction.static_coefficient = 0.8;
  own.params.sound.knock = 2.5;
  own.params.velocity.filter_ms = 3.0;
  LoopClientOptions desk;
  desk.device = "woodenhaptics";  // not plugged in: the scene is known without it
  haptic::Scene fitted;
  {
    auto document = documentOf(path);
    ASSERT_TRUE(document) << document.error().line();
    ActiveDocument active;
    ASSERT_TRUE(active.open(*document, own, desk));
    ASSERT_TRUE(active.client()->fitScene());
    fitted = active.client()->scene();
    EXPECT_EQ(fitted.force_limit_n, 5.0);
    EXPECT_EQ(fitted.brush_radius_samples, 12.0);
    Feedback feedback;
    active.poll(startView(), feedback);  // notes
    ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
  }
  {
    auto document = documentOf(path);
    ASSERT_TRUE(document) << document.error().line();
    ActiveDocument active;
    ASSERT_TRUE(active.open(*document, {}, desk));
    EXPECT_EQ(haptic::sceneText(active.client()->scene()), haptic::sceneText(fitted));
    EXPECT_TRUE(active.client()->fit());
    ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
  }
  auto document = documentOf(path);
  ASSERT_TRUE(document) << document.error().line();
  ActiveDocument active;
  ASSERT_TRUE(active.open(*document, {}, {}));
  const haptic::Scene& with_mouse = active.client()->scene();
  EXPECT_EQ(with_mouse.force_limit_n, 5.0);
  EXPECT_EQ(with_mouse.brush_radius_samples, 12.0);
  EXPECT_EQ(with_mouse.mark_radius_samples, 7.0);
  EXPECT_EQ(with_mouse.tip, haptic::TipShape::kSphere);
  EXPECT_EQ(with_mouse.params.friction.static_coefficient, 0.8);
  EXPECT_EQ(with_mouse.params.sound.knock, 2.5);
  EXPECT_EQ(with_mouse.params.velocity.filter_ms, 3.0);
  ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
}

// What one device does not hold is lowered for it; who opens the session with another has it as it was.
TEST(ActiveDocument, ASessionKeepsWhatADeviceDidNotHold) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  std::filesystem::copy_file(tests::inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             path);
  haptic::Scene edited;
  {
    auto document = documentOf(path);
    ASSERT_TRUE(document) << document.error().line();
    ActiveDocument active;
    ASSERT_TRUE(active.open(*document, {}, {}));
    edited = active.client()->scene();
    edited.effects.push_back(haptic::EffectKind::kEdgeSnap);
    edited.params.edge_snap = {5.0, 1e-3};
    ASSERT_TRUE(active.client()->setScene(edited));
    ASSERT_TRUE(active.client()->setDevice("woodenhaptics"));
    EXPECT_LT(active.client()->scene().params.edge_snap.force_n, 1.0);
    Feedback feedback;
    active.poll(startView(), feedback);  // notes
    ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
  }
  auto document = documentOf(path);
  ASSERT_TRUE(document) << document.error().line();
  ActiveDocument active;
  ASSERT_TRUE(active.open(*document, {}, {}));
  EXPECT_EQ(active.client()->scene().params.edge_snap.force_n, 5.0);
  ASSERT_TRUE(active.close(SessionKeeper::Afterwards::kKeep));
}

}  // namespace
}  // namespace fettle::app

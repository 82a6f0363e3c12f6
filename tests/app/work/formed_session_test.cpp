// A session with a form over its field, opened in the window: worked on as its samples are, the form stays over them.

#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "haptic/journal/session_player.h"
#include "tests/app/work/hand_play.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

engine::Version partUnderForm() {
  const engine::Version part = roughPart();
  return part.withForm(std::make_shared<const engine::PolynomialForm>(
      engine::PolynomialForm{1, part.grid().width, part.grid().height, 2.0, {0.1, -0.2, 0.3}}));
}

TEST(SessionUnderAForm, IsWorkedOnAndReplayedWithTheFormOverIt) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::JobControl job;
  const engine::Version part = partUnderForm();
  ASSERT_TRUE(engine::exportField(part, path, {}, job));
  auto document = app::openDocument(path, {}, app::Recovery::kLeave, std::size_t{64} << 20, job);
  ASSERT_TRUE(document) << document.error().line();
  ASSERT_EQ(document->warnings.size(), 1U);
  EXPECT_NE(document->warnings[0].find("form"), std::string::npos);
  EXPECT_EQ(engine::contentHash(document->history.current()), engine::contentHash(part));

  const engine::History history = document->history;
  const engine::Version original = document->original;
  app::SessionKeeper keeper(*document);
  auto client = app::LoopClient::start(history, original, brushScene(), {}, &keeper);
  ASSERT_TRUE(client) << client.error().line();
  HandPlay play(**client, keeper, 7);
  // Undo may go back to before the form: work until there are steps above it.
  while ((*client)->history().number() < 4) static_cast<void>(play.act());
  play.settle();
  (*client)->finish();
  const engine::Version worked = (*client)->history().current();
  EXPECT_NE(engine::contentHash(worked), engine::contentHash(part));
  ASSERT_TRUE(keeper.close(app::SessionKeeper::Afterwards::kKeep));

  const auto session = engine::openSession(path, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(engine::contentHash(session->history.current()), engine::contentHash(worked));
  EXPECT_EQ(session->history.current().form() == nullptr, worked.form() == nullptr);
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(engine::contentHash(played->field), engine::contentHash(worked));
  EXPECT_EQ(played->field.form() == nullptr, worked.form() == nullptr);
  // Commands see it without its form.
  const auto read = engine::importField(path, {}, job);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->field.seenOf() == nullptr, worked.form() == nullptr);
  EXPECT_EQ(engine::contentHash(*engine::restored(read->field, job)), engine::contentHash(worked));
}

// The content decides what a file is, whatever its name.
TEST(SessionUnderAForm, OfAnotherNameOpensAsItsSamples) {
  const TempFolder folder;
  engine::JobControl job;
  const engine::Version part = partUnderForm();
  ASSERT_TRUE(engine::exportField(part, folder.file("a.fettle"), {}, job));
  std::filesystem::rename(folder.file("a.fettle"), folder.file("a.tif"));
  const auto document =
      app::openDocument(folder.file("a.tif"), {}, app::Recovery::kLeave, std::size_t{64} << 20, job);
  ASSERT_TRUE(document) << document.error().line();
  EXPECT_EQ(document->warnings.size(), 1U);
  EXPECT_EQ(document->original.seenOf(), nullptr);
  EXPECT_EQ(engine::contentHash(document->original), engine::contentHash(part));
}

}  // namespace
}  // namespace fettle::tests

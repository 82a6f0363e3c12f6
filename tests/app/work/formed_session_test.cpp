// A session with forms over its field, worked on in the window as it is seen without them.

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "engine/field/builder.h"
#include "engine/field/nominal_form.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "haptic/journal/session_player.h"
#include "tests/app/work/hand_play.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

constexpr std::size_t kMuch = std::size_t{1} << 30;

// The part far above 0: an edit is rounded there, so that what is stored is seen a little beside what was felt.
engine::Version highPart() {
  const engine::Version part = roughPart();
  const engine::Grid& grid = part.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  part.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  for (float& height : z) height += 1000.0F;
  return engine::makeField(grid, z, {});
}

engine::Version partUnderForm() {
  const engine::Version part = highPart();
  return part.withForm(std::make_shared<const engine::NominalForm>(
      engine::PolynomialForm{1, part.grid().width, part.grid().height, 1000.0, {0.1, -0.2, 0.3}}));
}

std::vector<std::uint32_t> bitsOf(const engine::Version& field) {
  const engine::Grid& grid = field.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  engine::upright(field).reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  std::vector<std::uint32_t> bits;
  bits.reserve(z.size());
  for (const float each : z) bits.push_back(std::isnan(each) ? 0U : std::bit_cast<std::uint32_t>(each));
  return bits;
}

// Every step as it was seen beside what the file has of it: a sample that the step did not change has its bits.
void expectUntouchedSamplesKept(const engine::History& seen, const std::string& path) {
  engine::JobControl job;
  engine::SessionOpenOptions options;
  options.history_bytes = engine::History::kNoBound;
  const auto session = engine::openSession(path, options, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  const engine::History& stored = session->history;
  ASSERT_EQ(stored.number(), seen.number());
  for (std::int64_t k = seen.first(); k <= seen.last(); ++k) {
    EXPECT_EQ(engine::contentHash(stored.state(k)), storedHash(seen.state(k))) << k;
    EXPECT_EQ(stored.state(k).form() == nullptr, seen.state(k).formOver() == nullptr) << k;
    if (k == seen.first()) continue;
    const auto after = bitsOf(stored.state(k)), before = bitsOf(stored.state(k - 1));
    if (seen.info(k).kind == engine::StepKind::kForm) {
      if (seen.info(k).name.starts_with("Form")) {
        EXPECT_TRUE(before == after) << seen.info(k).name;
        EXPECT_EQ(engine::measureChange(stored.state(k - 1), stored.state(k)).tiles, 0);
      }
      continue;
    }
    const auto seen_after = bitsOf(seen.state(k)), seen_before = bitsOf(seen.state(k - 1));
    std::size_t changed = 0;
    for (std::size_t i = 0; i < after.size(); ++i)
      if (seen_after[i] == seen_before[i] && after[i] != before[i]) ++changed;
    EXPECT_EQ(changed, 0U) << seen.info(k).name;
    // Only what a step changed is written.
    EXPECT_LE(engine::measureChange(stored.state(k - 1), stored.state(k)).tiles,
              engine::measureChange(seen.state(k - 1), seen.state(k)).tiles);
  }
}

// Three lives of one session, in two of them at two rates: the first begins under the form that a command laid over it.
TEST(SessionUnderForms, KeepsWhatWasNotTouchedAndReplaysToItsBits) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(partUnderForm(), path, {}, job));
  std::map<std::string, int> did;
  std::uint64_t expected = engine::contentHash(partUnderForm());
  for (std::uint64_t life = 0; life < 3; ++life) {
    auto document = app::openDocument(path, {}, app::Recovery::kLeave, kMuch, job);
    ASSERT_TRUE(document) << document.error().line();
    EXPECT_TRUE(document->warnings.empty());
    EXPECT_EQ(storedHash(document->history.current()), expected);
    if (life == 0) {
      ASSERT_NE(document->history.current().seenOf(), nullptr);
      EXPECT_EQ(document->originals.at(document->history.current()).formOver(),
                document->history.current().formOver());
    }
    const engine::History history = document->history;
    const app::FormOriginals originals = document->originals;
    app::SessionKeeper keeper(*document);
    auto client = app::LoopClient::start(history, originals, brushScene(), {}, &keeper);
    ASSERT_TRUE(client) << client.error().line();
    HandPlay play(**client, keeper, 70 + life);
    for (int i = 0; i < 14; ++i) ++did[play.act()];
    play.settle();
    ASSERT_TRUE((*client)->setRate(life == 1 ? 1500.0 : 1000.0));
    play.takeOutPlane();
    for (int i = 0; i < 8; ++i) ++did[play.act()];
    play.settle();
    if (life == 1) {
      // Elsewhere, with what waits to be written.
      const std::string other = folder.file("other.fettle");
      keeper.saveAs(other, engine::OriginalStorage::kEmbedded);
      std::optional<engine::Status> saved;
      while (!saved) {
        keeper.poll();
        saved = keeper.saved();
      }
      ASSERT_TRUE(*saved) << saved->error().line();
      std::filesystem::remove(path);
      std::filesystem::copy_file(other, folder.file("copy.fettle"));
    }
    (*client)->finish();
    for (const app::Notice& notice : play.notices()) std::printf("  notice: %s\n", notice.what.c_str());
    expected = storedHash((*client)->history().current());
    const engine::History worked = (*client)->history();
    const std::string kept = keeper.path();
    ASSERT_TRUE(keeper.close(app::SessionKeeper::Afterwards::kKeep));
    expectUntouchedSamplesKept(worked, kept);
    if (kept != path) std::filesystem::rename(kept, path);

    const auto session = engine::openSession(path, {}, engine::importField, job);
    ASSERT_TRUE(session) << session.error().line();
    EXPECT_EQ(engine::contentHash(session->history.current()), expected);
    engine::SessionOpenOptions all;
    all.history_bytes = engine::History::kNoBound;
    const auto played = haptic::playSession(*engine::openSession(path, all, engine::importField, job), job);
    ASSERT_TRUE(played) << played.error().line();
    EXPECT_EQ(engine::contentHash(played->field), expected);
    EXPECT_EQ(played->field.form() == nullptr, session->history.current().form() == nullptr);
    // Commands see it without its form.
    const auto read = engine::importField(path, {}, job);
    ASSERT_TRUE(read);
    EXPECT_EQ(storedHash(read->field), expected);
  }
  for (const auto& [what, count] : did) std::printf("  %3d %s\n", count, what.c_str());
}

// The content decides what a file is, whatever its name.
TEST(SessionUnderForms, OfAnotherNameOpensAsItIsSeen) {
  const TempFolder folder;
  engine::JobControl job;
  const engine::Version part = partUnderForm();
  ASSERT_TRUE(engine::exportField(part, folder.file("a.fettle"), {}, job));
  std::filesystem::rename(folder.file("a.fettle"), folder.file("a.tif"));
  const auto document = app::openDocument(folder.file("a.tif"), {}, app::Recovery::kLeave, kMuch, job);
  ASSERT_TRUE(document) << document.error().line();
  EXPECT_TRUE(document->warnings.empty());
  EXPECT_EQ(engine::contentHash(document->original), engine::contentHash(part));
  const auto seen = engine::SeenField::of(part, job);
  EXPECT_EQ(engine::contentHash(document->history.current()), engine::contentHash(seen->seen()));
  EXPECT_EQ(document->history.current(), document->first);
}

// What is seen of a session that is opened is that of what is stored, which differs from what was felt by a rounding.
TEST(SessionUnderForms, IsSeenFromWhatIsStoredWhenItIsOpenedAgain) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(highPart(), path, {}, job));
  std::uint64_t felt = 0, expected = 0;
  for (int life = 0; life < 2; ++life) {
    auto document = app::openDocument(path, {}, app::Recovery::kLeave, kMuch, job);
    ASSERT_TRUE(document) << document.error().line();
    const engine::History history = document->history;
    const app::FormOriginals originals = document->originals;
    app::SessionKeeper keeper(*document);
    auto client = app::LoopClient::start(history, originals, brushScene(), {}, &keeper);
    ASSERT_TRUE(client) << client.error().line();
    HandPlay play(**client, keeper, 9);
    if (life == 0) {
      play.takeOutPlane();
      engine::FilterSpec spec;
      spec.window = 5;
      play.apply(spec);
      play.settle();
      ASSERT_TRUE((*client)->setRate(1500.0));
      felt = engine::contentHash((*client)->history().current());
    } else {
      EXPECT_NE(engine::contentHash((*client)->history().current()), felt);
    }
    if (life == 1) play.makeHeights();
    play.settle();
    (*client)->finish();
    expected = storedHash((*client)->history().current());
    ASSERT_TRUE(keeper.close(app::SessionKeeper::Afterwards::kKeep));
  }
  engine::SessionOpenOptions all;
  all.history_bytes = engine::History::kNoBound;
  const auto played = haptic::playSession(*engine::openSession(path, all, engine::importField, job), job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(engine::contentHash(played->field), expected);
}

// Steps that memory no longer holds are read from the file again, across forms.
TEST(SessionUnderForms, GoesBackToStepsThatOnlyTheFileHas) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(highPart(), path, {}, job));
  auto document = app::openDocument(path, {}, app::Recovery::kLeave, 1, job);  // the newest step alone
  ASSERT_TRUE(document) << document.error().line();
  const engine::History history = document->history;
  const app::FormOriginals originals = document->originals;
  app::SessionKeeper keeper(*document);
  auto client = app::LoopClient::start(history, originals, brushScene(), {}, &keeper);
  ASSERT_TRUE(client) << client.error().line();
  HandPlay play(**client, keeper, 5);
  engine::FilterSpec spec;
  spec.window = 5;
  std::vector<std::uint64_t> hashes{engine::contentHash(highPart())};
  const auto keep = [&] {
    play.settle();
    while (hashes.size() <= static_cast<std::size_t>((*client)->history().number()))
      hashes.push_back(storedHash((*client)->history().state(static_cast<std::int64_t>(hashes.size()))));
  };
  play.takeOutPlane();
  keep();
  play.apply(spec);
  keep();
  play.takeOutPlane();
  keep();
  play.apply(spec);
  keep();
  ASSERT_GT((*client)->history().first(), 1);
  for (std::int64_t state = (*client)->history().number(); state > 0; --state) {
    if (!(*client)->canUndo()) {
      keeper.readOlder((*client)->history());
      std::optional<engine::Result<app::SessionKeeper::Older>> older;
      while (!older) older = keeper.older();
      ASSERT_TRUE(*older) << older->error().line();
      (*client)->prepend((*older)->step, (*older)->original);
    }
    (*client)->undo();
    play.settle();
    EXPECT_EQ(storedHash((*client)->history().current()), hashes[static_cast<std::size_t>(state - 1)])
        << state;
    // The heights of a state that was read are those of what is stored, not of what was felt before.
    if (state == 3) break;
  }
  play.makeHeights();
  for (int i = 0; i < 4; ++i) static_cast<void>(play.act());
  play.settle();
  (*client)->finish();
  const std::uint64_t expected = storedHash((*client)->history().current());
  ASSERT_TRUE(keeper.close(app::SessionKeeper::Afterwards::kKeep));
  engine::SessionOpenOptions all;
  all.history_bytes = engine::History::kNoBound;
  const auto played = haptic::playSession(*engine::openSession(path, all, engine::importField, job), job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(engine::contentHash(played->field), expected);
}

}  // namespace
}  // namespace fettle::tests

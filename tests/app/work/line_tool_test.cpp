// Edge lines drawn with the stylus on the real loop, in real time, and kept in a session.
#include "app/work/line_tool.h"

#include <limits>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "app/work/session_keeper.h"
#include "engine/formats/formats.h"
#include "engine/session/line_codec.h"
#include "haptic/journal/session_player.h"
#include "tests/app/work/part.h"
#include "tests/engine/edges/edge_fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using app::LoopClient;
using app::SessionKeeper;
using haptic::Tool;

// Steps at columns 60.5 and 120.5, ten times the noise; holes on the way along columns 80 and 61.
engine::Version step() {
  return engine::edgeField(160, 200, [](int c, int r) {
    const bool beside = c >= 74 && c < 88 && r >= 35 && r % 20 < 10,
               at_edge = c >= 50 && c < 72 && r >= 130 && r < 142;
    if (beside || at_edge) return std::numeric_limits<double>::quiet_NaN();
    return (c > 60 ? 0.1 : 0.0) + (c > 120 ? 0.1 : 0.0) + 0.01 * engine::whiteNoise(c, r);
  });
}

class LineTool : public testing::Test {
 protected:
  LineTool() {
    document_.path = folder_.file("scan.tif");
    document_.original = step();
    document_.history = engine::History(document_.original, std::size_t{64} << 20);
    keeper_ = std::make_unique<SessionKeeper>(document_);
    keeper_->saveAs(path_, engine::OriginalStorage::kEmbedded);
    auto client = LoopClient::start(engine::History(document_.original, std::size_t{64} << 20),
                                    document_.original, brushScene(), {}, keeper_.get());
    EXPECT_TRUE(client) << (client ? "" : client.error().line());
    client_ = std::move(*client);
  }

  bool until(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      client_->poll();
      keeper_->poll();
      if (follows_) tool_.follow(*client_, edit_, draws_);
      static_cast<void>(edit_.poll(*client_, notices_));
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  // Along a straight line [samples], until the tool is up.
  void draw(Tool tool, glm::dvec2 from, glm::dvec2 to) {
    const engine::Grid& grid = client_->field().grid();
    haptic::MouseStylus& mouse = *client_->mouse();
    client_->setTool(tool);
    constexpr int kMoves = 60;
    for (int i = 0; i <= kMoves; ++i) {
      const glm::dvec2 at = from + (to - from) * (static_cast<double>(i) / kMoves);
      mouse.setCursor({at.x * grid.spacingXMm(), at.y * grid.spacingYMm(), 0.05 * grid.height_unit.mm});
      mouse.press(tool);
      const std::uint64_t tick = client_->state().tick;
      ASSERT_TRUE(until([&] { return client_->state().tick > tick + 3; }));
    }
    mouse.release();
    ASSERT_TRUE(until([&] { return !mouse.busy(); }));
  }
  // Until all that follows from the strokes is done.
  void settle() {
    const std::uint64_t tick = client_->state().tick;
    ASSERT_TRUE(until([&] {
      return client_->state().tick > tick + 300 && !edit_.busy() &&
             client_->upright() == client_->history().current();
    }));
  }
  void stroke(Tool tool, glm::dvec2 from, glm::dvec2 to) {
    draw(tool, from, to);
    settle();
  }
  [[nodiscard]] std::size_t lines() const {
    const engine::EdgeLines lines = client_->history().current().lines();
    return lines ? lines->size() : 0;
  }
  [[nodiscard]] std::string lineBytes() const {
    return engine::packLines(client_->history().current().lines());
  }

  TempFolder folder_;
  std::string path_ = folder_.file("work.fettle");
  app::Document document_;
  std::unique_ptr<SessionKeeper> keeper_;
  std::unique_ptr<LoopClient> client_;
  app::MarkEdit edit_;
  app::LineTool tool_;
  bool draws_ = true;
  bool follows_ = true;
  std::vector<app::Notice> notices_;
};

TEST_F(LineTool, AStrokeBecomesALineThatUndoRedoSessionAndReplayKeep) {
  stroke(Tool::kMark, {61.5, 30}, {59.5, 100});
  ASSERT_EQ(lines(), 1U);
  const engine::History& history = client_->history();
  EXPECT_EQ(history.info(history.number()).kind, engine::StepKind::kLines);
  EXPECT_FALSE(history.info(history.number()).rect.empty());
  EXPECT_EQ(engine::summarize(history.current()).marked, 0);
  const auto& figures = tool_.figures(client_->upright());
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_NEAR(figures[0].length_mm, 70.0, 12.0);
  EXPECT_GT(figures[0].located, 0.9);
  EXPECT_NEAR(figures[0].step, 0.1, 0.02);
  const std::string drawn = lineBytes();

  client_->undo();
  ASSERT_TRUE(until([&] { return client_->upright() == history.current(); }));
  EXPECT_EQ(lines(), 0U);
  EXPECT_GT(engine::summarize(history.current()).marked, 100) << "the marks of the stroke";
  client_->redo();
  ASSERT_TRUE(until([&] { return client_->upright() == history.current(); }));
  EXPECT_EQ(lineBytes(), drawn);

  stroke(Tool::kUnmark, {50, 65}, {71, 65});
  ASSERT_EQ(lines(), 2U);
  const std::string cut = lineBytes();
  EXPECT_EQ(notices_.size(), 0U);
  client_->finish();
  const std::uint64_t hash = engine::contentHash(history.current());
  ASSERT_TRUE(keeper_->close(SessionKeeper::Afterwards::kKeep));

  engine::JobControl job;
  const auto session = engine::openSession(path_, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(engine::packLines(session->history.current().lines()), cut);
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(engine::contentHash(played->field), hash);
  EXPECT_EQ(engine::packLines(played->field.lines()), cut);
}

TEST_F(LineTool, StrokesOneAfterTheOtherAreEachALine) {
  draw(Tool::kMark, {61.5, 30}, {59.5, 100});
  draw(Tool::kMark, {121.5, 30}, {119.5, 100});
  settle();
  EXPECT_EQ(lines(), 2U);
  EXPECT_EQ(engine::summarize(client_->history().current()).marked, 0);
  EXPECT_EQ(notices_.size(), 0U);
}

TEST_F(LineTool, WhatIsUndoneBecomesNoLine) {
  // The stroke has ended and is undone before the tool looks at it.
  follows_ = false;
  stroke(Tool::kMark, {61.5, 30}, {59.5, 100});
  ASSERT_EQ(client_->history().number(), 1);
  client_->undo();
  follows_ = true;
  settle();
  EXPECT_EQ(lines(), 0U);
  EXPECT_EQ(client_->history().number(), 0);
  EXPECT_TRUE(client_->canRedo());
}

TEST_F(LineTool, WithoutDrawingAStrokeRemainsMarks) {
  draws_ = false;
  stroke(Tool::kMark, {61.5, 30}, {59.5, 100});
  EXPECT_EQ(lines(), 0U);
  EXPECT_EQ(client_->history().number(), 1);
  EXPECT_GT(engine::summarize(client_->history().current()).marked, 100);
}

TEST_F(LineTool, AStrokeAwayFromEdgesSaysThatItStaysAMark) {
  stroke(Tool::kMark, {100, 30}, {104, 100});
  EXPECT_EQ(lines(), 0U);
  EXPECT_GT(engine::summarize(client_->history().current()).marked, 100);
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_TRUE(notices_[0].what.starts_with("no edge was found along the stroke at x ")) << notices_[0].what;
}

TEST_F(LineTool, StrokesAwayFromEdgesAreOneLineWithTheirNumber) {
  for (const int column : {100, 104, 108}) stroke(Tool::kMark, {column, 30}, {column + 2, 100});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_EQ(notices_[0].what, "3 strokes lie along no edge: they stay marks");
  EXPECT_EQ(notices_[0].remedy, "");
}

// One drag is one stroke, however many holes lie under it.
TEST_F(LineTool, AStrokeOverHolesAwayFromEdgesIsCountedOnce) {
  stroke(Tool::kMark, {80, 30}, {81, 100});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_TRUE(notices_[0].what.starts_with("no edge was found along the stroke at x ")) << notices_[0].what;
  stroke(Tool::kMark, {82, 30}, {83, 100});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_EQ(notices_[0].what, "2 strokes lie along no edge: they stay marks");
}

TEST_F(LineTool, AStrokeAlongAnEdgeOverAHoleIsOneStepOfTwoLines) {
  stroke(Tool::kMark, {61, 102}, {60.5, 170});
  EXPECT_EQ(lines(), 2U);
  EXPECT_EQ(client_->history().number(), 2) << "the marks, and the lines in their place";
  EXPECT_EQ(notices_.size(), 0U);
  stroke(Tool::kUnmark, {61, 102}, {60.5, 170});
  EXPECT_EQ(lines(), 0U);
  EXPECT_EQ(client_->history().number(), 3);
}

TEST_F(LineTool, ALineIsChosenAndRemovedOrJoined) {
  stroke(Tool::kMark, {61.5, 30}, {59.5, 100});
  ASSERT_EQ(lines(), 1U);
  stroke(Tool::kUnmark, {50, 65}, {71, 65});
  ASSERT_EQ(lines(), 2U);
  EXPECT_FALSE(tool_.chosen(*client_));
  tool_.chooseNext(*client_);
  EXPECT_EQ(tool_.chosen(*client_), 1);
  tool_.joinChosen(*client_, edit_);
  ASSERT_TRUE(until([&] { return !edit_.busy() && client_->upright() == client_->history().current(); }));
  EXPECT_EQ(lines(), 1U);
  EXPECT_EQ(tool_.chosen(*client_), 1);
  tool_.removeChosen(*client_, edit_);
  ASSERT_TRUE(until([&] { return !edit_.busy() && client_->upright() == client_->history().current(); }));
  EXPECT_EQ(lines(), 0U);
  EXPECT_FALSE(tool_.chosen(*client_));
  EXPECT_EQ(notices_.size(), 0U);
}

}  // namespace
}  // namespace fettle::tests

#include "engine/session/line_codec.h"

#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/session/database.h"
#include "engine/session/session.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

EdgeLines twoLines() {
  EdgeLine first;
  first.id = -7;
  first.closed = true;
  for (int i = 0; i < 5; ++i) {
    EdgePoint point;
    point.position = {1.0 / 3.0 + i, 1e-300};
    first.points.push_back(point);
  }
  EdgeLine second = first;
  second.id = std::numeric_limits<std::int64_t>::max();
  second.closed = false;
  for (EdgePoint& point : second.points) {
    point.located = true;
    point.kind = LineKind::kCrease;
    point.deviation = std::numeric_limits<double>::denorm_min();
    point.step = -0.0;
    point.step_deviation = 1e300;
    point.slope_change = -1.0 / 7.0;
    point.slope_deviation = 0.5;
  }
  return std::make_shared<const std::vector<EdgeLine>>(std::vector<EdgeLine>{first, second, EdgeLine{}});
}

TEST(LineCodec, EveryBitComesBack) {
  const std::string bytes = packLines(twoLines());
  const auto back = unpackLines(bytes);
  ASSERT_TRUE(back);
  ASSERT_TRUE(*back);
  ASSERT_EQ((*back)->size(), 3U);
  EXPECT_EQ(packLines(*back), bytes);
  EXPECT_EQ((**back)[1].points[2].step_deviation, 1e300);
  EXPECT_TRUE((**back)[0].closed);
  const auto none = unpackLines(packLines(nullptr));
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(LineCodec, OtherBytesAreRefused) {
  const std::string bytes = packLines(twoLines());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(unpackLines(std::string_view(bytes).substr(0, size))) << size;
  EXPECT_FALSE(unpackLines(bytes + 'x'));
  EXPECT_FALSE(unpackLines(std::string(4, '\xff')));  // four thousand million lines
  const auto withPoint = [](const EdgePoint& point) {
    EdgeLine line;
    line.points.push_back(point);
    return packLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  };
  EdgePoint point;
  point.located = true;
  EXPECT_TRUE(unpackLines(withPoint(point)));
  point.step = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(unpackLines(withPoint(point)));
  point.step = 0.0;
  point.deviation = -1.0;
  EXPECT_FALSE(unpackLines(withPoint(point)));
  point.deviation = 0.0;
  point.position.x = 2e6;
  EXPECT_FALSE(unpackLines(withPoint(point)));
  const EdgeLine line;
  EXPECT_FALSE(unpackLines(
      packLines(std::make_shared<const std::vector<EdgeLine>>(std::vector<EdgeLine>{line, line}))));
}

std::int64_t formatOf(const std::string& path) {
  auto database = Database::open(path, DatabaseAccess::kRead, path);
  EXPECT_TRUE(database);
  return (*database)->integer("PRAGMA user_version").value_or(-1);
}

TEST(SessionLines, OnlyASessionWithLinesNeedsAProgramThatKnowsThem) {
  const tests::TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  Session session;
  session.original = strangeField(1, 90, 70);
  session.scan.format = "none";
  session.history = History(session.original);
  ASSERT_TRUE(saveSession(session, path, job));
  EXPECT_EQ(formatOf(path), 1);
  session.history.push({"Edge line", StepKind::kLines, {}, {}, 0}, session.original.withLines(twoLines()));
  ASSERT_TRUE(saveSession(session, path, job));
  EXPECT_EQ(formatOf(path), 2);
  EXPECT_EQ(differenceOnDisk(session, path), "");
}

TEST(SessionLines, AFieldWithLinesGoesInAndComesOutWithThem) {
  const tests::TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  const Version plain = strangeField(2, 90, 70), lined = plain.withLines(twoLines());
  ASSERT_TRUE(exportField(lined, path, {}, job));
  auto read = importField(path, {}, job);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(difference(lined, read->field), "");
  ExportOptions options;
  options.original = plain;
  // Whether samples have changed as well, or not.
  for (const Version& worked : {strangeField(3, 90, 70).withLines(twoLines()), lined}) {
    ASSERT_TRUE(exportField(worked, path, options, job));
    read = importField(path, {}, job);
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(packLines(read->field.lines()), packLines(twoLines()));
  }
}

}  // namespace
}  // namespace fettle::engine

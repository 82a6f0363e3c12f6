// Edge lines from strokes to a filter: fettle mark --strokes --lines-out, fettle filter --lines.

#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "engine/scanner/scanner.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Lines : public ::testing::Test {
 protected:
  static constexpr int kSide = 512;

  void SetUp() override {
    ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--noise", "3", "--size", "512x512", "--truth", truth,
                      "--edges", edges})
                  .status,
              0);
  }
  // A hand about a sample off, that lifts between the edges.
  void drawTrueEdges() const {
    engine::ScannerSpec spec;
    spec.part = "steps";
    spec.noise = 3.0;
    spec.width = spec.height = kSide;
    engine::JobControl job;
    const auto simulated = engine::simulateScan(spec, job);
    ASSERT_TRUE(simulated) << simulated.error().line();
    const double sample = simulated->scan.grid().spacingXMm();
    std::ofstream rows(strokes);
    rows << "t,x,y,z,tool\n";
    int tick = 0;
    for (const engine::Edge& edge : simulated->edge_lines) {
      for (const glm::dvec2& p : edge.points_mm) {
        const double along = 0.05 * ++tick;
        rows << 0.001 * tick << ',' << p.x + sample * std::sin(along) << ','
             << p.y + sample * std::cos(0.7 * along) << ",0,mark\n";
      }
      rows << 0.001 * ++tick << ",nan,nan,nan,mark\n";
      rows << 0.001 * ++tick << ",0,0,9,feel\n";
    }
  }
  [[nodiscard]] double errorNearEdges(const std::string& lines) const {
    std::vector<std::string> arguments{"filter", scan, clean, "--filter", "tgv"};
    if (!lines.empty()) arguments.insert(arguments.end(), {"--lines", lines});
    const auto report = fettleJson(arguments);
    EXPECT_EQ(report.contains("lines"), !lines.empty());
    EXPECT_FALSE(report.contains("window") || report.contains("sigma"));
    EXPECT_TRUE(report.contains("range_sigma"));
    return fettleJson({"compare", scan, clean, "--truth", truth, "--edges", edges})["rmse_edge"];
  }

  TempFolder folder;
  std::string scan = folder.file("scan.tif"), truth = folder.file("truth.tif"),
              edges = folder.file("edges.png");
  std::string strokes = folder.file("strokes.csv"), marks = folder.file("marks.png");
  std::string clean = folder.file("clean.tif");
};

TEST_F(Lines, located_from_strokes_they_lower_the_error_near_edges) {
  ASSERT_NO_FATAL_FAILURE(drawTrueEdges());
  const double alone = errorNearEdges("");
  for (const char* name : {"lines.csv", "lines.geojson", "lines.gpkg", "lines.dxf"}) {
    const std::string lines = folder.file(name);
    const auto report = fettleJson({"mark", scan, marks, "--strokes", strokes, "--lines-out", lines});
    EXPECT_GT(report["lines"], 2);
    EXPECT_GT(report["line_points"], 1000);
    EXPECT_GT(report["located"], 0.8);
    EXPECT_LT(report["deviation"], 1.0);
    EXPECT_GT(report["marked"], report["line_points"]);
    EXPECT_LT(errorNearEdges(lines), 0.75 * alone) << name;
  }
}

// Lines of another program, twice with one number: two lines, not one that goes over each place and back.
TEST_F(Lines, a_number_used_twice_is_that_of_two_lines) {
  const std::string lines = folder.file("lines.geojson");
  const auto hashWith = [&](int copies, const char* properties) {
    std::string features;
    for (int i = 0; i < copies; ++i)
      features += std::string(i > 0 ? "," : "") + R"({"type":"Feature","properties":)" + properties +
                  R"(,"geometry":{"type":"LineString","coordinates":[[10.3,5],[10.3,40]]}})";
    std::ofstream(lines) << R"({"type":"FeatureCollection","features":[)" << features << "]}";
    return fettleJson({"filter", scan, clean, "--filter", "tgv", "--lines", lines})["hash"];
  };
  const auto once = hashWith(1, R"({"line":3,"located":1})");
  EXPECT_NE(once, fettleJson({"filter", scan, clean, "--filter", "tgv"})["hash"]);
  EXPECT_EQ(hashWith(2, R"({"line":3,"located":1})"), once);
  EXPECT_EQ(hashWith(2, "{}"), once);
  for (const char* unclear : {R"({"located":"yes"})", R"({"kind":"wall"})", R"({"deviation":"abc"})"}) {
    SCOPED_TRACE(unclear);
    std::ofstream(lines) << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":)"
                         << unclear
                         << R"(,"geometry":{"type":"LineString","coordinates":[[10,5],[10,40]]}}]})";
    expectRefused(fettle({"filter", scan, clean, "--filter", "tgv", "--lines", lines}),
                  "cannot be understood");
  }
}

TEST_F(Lines, of_suggested_edges_end_the_windows_of_the_paper) {
  const std::string lines = folder.file("lines.csv");
  const auto report = fettleJson({"mark", scan, marks, "--edges", "--lines-out", lines});
  EXPECT_GT(report["lines"], 5);
  EXPECT_GT(report["located"], 0.5);
  const auto error = [&](std::vector<std::string> more) -> double {
    more.insert(more.begin(), {"filter", scan, clean, "--window", "5"});
    EXPECT_EQ(fettle(std::move(more)).status, 0);
    return fettleJson({"compare", scan, clean, "--truth", truth, "--edges", edges})["rmse_edge"];
  };
  for (const char* filter : {"box", "median"}) {
    const double alone = error({"--filter", filter});
    EXPECT_LT(error({"--filter", filter, "--lines", lines}), 0.6 * alone) << filter;
  }
}

TEST_F(Lines, what_cannot_be_done_is_refused) {
  std::ofstream(strokes) << "t,x,y,z,tool\n0,1,1,0,mark\n0.001,9,9,0,mark\n";
  const std::string lines = folder.file("lines.csv");
  const auto mark = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"mark", scan, marks});
    return fettle(std::move(more));
  };
  ASSERT_EQ(mark({"--strokes", strokes, "--lines-out", lines}).status, 0);
  expectRefused(mark({"--lines-out", lines}), "--strokes");
  expectRefused(mark({"--strokes", strokes, "--lines-out", folder.file("lines.shp")}), ".shp");
  expectRefused(mark({"--strokes", strokes, "--thickness", "99"}), "thickness");
  expectRefused(mark({"--strokes", strokes, "--hand", "9"}), "hand");
  expectRefused(mark({"--strokes", folder.file("none.csv")}), "none.csv");
  EXPECT_EQ(mark({"--strokes", strokes, "--edges"}).status, 2);
  const auto filter = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"filter", scan, clean});
    return fettle(std::move(more));
  };
  expectRefused(filter({"--filter", "tv", "--lines", lines}), "tgv");
  expectRefused(filter({"--filter", "median", "--window", "53", "--lines", lines}), "51");
  expectRefused(filter({"--filter", "tgv", "--lines", strokes}), "header");
  expectRefused(filter({"--filter", "tgv", "--lines", folder.file("none.gpkg")}), "none.gpkg");
  expectRefused(filter({"--suggest", "--tolerance", "1", "--lines", lines}), "--lines");
  std::ofstream(strokes) << "t,x,y,z,tool\n0,1,1,0,feel\n";
  expectRefused(mark({"--strokes", strokes}), "no stroke of the tool mark");
}

TEST_F(Lines, steps_and_angles_along_lines_come_as_table_plot_and_csv) {
  ASSERT_NO_FATAL_FAILURE(drawTrueEdges());
  const std::string lines = folder.file("lines.csv"), csv = folder.file("sections.csv"),
                    plot = folder.file("plot.svg"), other = folder.file("other.gpkg");
  (void)fettleJson({"mark", scan, marks, "--strokes", strokes, "--lines-out", lines});
  const auto report = fettleJson({"lines", scan, lines, "--csv", csv, "--plot", plot, "--out", other});
  ASSERT_GT(report["lines"].size(), 2U);
  std::size_t points = 0, measured = 0;
  for (const auto& line : report["lines"]) {
    points += line["points"].get<std::size_t>();
    if (line["measured"] == 0) {
      EXPECT_TRUE(line["step"].is_null());
      continue;
    }
    measured += 1;
    EXPECT_GT(line["step_deviation"], 0.0);
    EXPECT_LE(line["step_low"], line["step"]);
    EXPECT_GE(line["step_high"], line["step"]);
  }
  EXPECT_GT(measured, 2U);
  std::ifstream rows(csv);
  std::size_t count = 0;
  std::string text;
  std::getline(rows, text);
  EXPECT_EQ(text, "line,along_mm,x_mm,y_mm,step_mm,step_deviation_mm,turn_deg,turn_deviation_deg");
  while (std::getline(rows, text)) count += 1;
  EXPECT_EQ(count, points);
  std::ifstream svg(plot);
  std::getline(svg, text, '\0');
  EXPECT_NE(text.find("</svg>"), std::string::npos);
  EXPECT_NE(text.find("turn [degrees]"), std::string::npos);
  // The lines of a session, one of them alone.
  const std::string session = folder.file("work.fettle");
  (void)fettleJson({"filter", scan, session, "--filter", "tgv", "--lines", other});
  EXPECT_EQ(fettleJson({"info", session})["lines"], fettleJson({"lines", scan, other})["lines"].size());
  const auto one = fettleJson({"lines", session, "--only", "1"});
  ASSERT_EQ(one["lines"].size(), 1U);
  EXPECT_EQ(one["lines"][0]["line"], 1);
  expectRefused(fettle({"lines", scan}), "no edge lines");
  expectRefused(fettle({"lines", session, "--only", "1,999"}), "no line 999");
  expectRefused(fettle({"lines", scan, lines, "--plot", "/no/such/folder/p.svg"}), "/no/such/folder");
}

TEST_F(Lines, of_a_session_are_not_lost_in_silence) {
  const std::string lines = folder.file("lines.csv"), session = folder.file("work.fettle");
  (void)fettleJson({"mark", scan, marks, "--edges", "--as-lines", "--lines-out", lines});
  (void)fettleJson({"filter", scan, session, "--filter", "planes", "--lines", lines});
  const auto lost = fettle({"convert", session, clean});
  EXPECT_EQ(lost.status, 0);
  EXPECT_NE(lost.err.find("the edge lines of the session are not stored"), std::string::npos) << lost.err;
  const auto kept = fettle({"convert", session, folder.file("again.fettle")});
  EXPECT_EQ(kept.status, 0);
  EXPECT_EQ(kept.err.find("are not stored"), std::string::npos) << kept.err;
  const auto none = fettle({"convert", scan, folder.file("again.tif")});
  EXPECT_EQ(none.err.find("are not stored"), std::string::npos) << none.err;
}

TEST_F(Lines, are_drawn_from_a_file_or_a_session_and_missed_by_a_filter_that_knows_none) {
  ASSERT_NO_FATAL_FAILURE(drawTrueEdges());
  const std::string lines = folder.file("lines.csv"), session = folder.file("work.fettle");
  (void)fettleJson({"mark", scan, marks, "--strokes", strokes, "--lines-out", lines});
  (void)fettleJson({"filter", scan, session, "--filter", "planes", "--lines", lines});
  const auto drawn = [&](std::vector<std::string> more) {
    more.insert(more.begin() + 1, {marks, "--size", "320x240", "--title", "t"});
    more.insert(more.begin(), "render");
    EXPECT_EQ(fettle(more).status, 0);
    std::ifstream png(marks, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(png), {});
  };
  const std::string plain = drawn({scan});
  EXPECT_NE(drawn({scan, "--lines", lines}), plain);
  EXPECT_EQ(drawn({scan, "--lines", lines, "--bare"}), drawn({scan, "--bare"}));
  (void)fettle({"filter", scan, clean, "--filter", "planes", "--lines", lines});
  EXPECT_NE(drawn({session}), drawn({clean}));
  // Next to another scan, whose lines are its own.
  const auto beside = [&](const std::string& left, const std::string& right) {
    return drawn({left, "--compare", right, "--compare-title", "t"});
  };
  EXPECT_NE(beside(clean, session), beside(clean, clean));
  EXPECT_NE(beside(clean, session), beside(session, session));
  EXPECT_EQ(drawn({session, "--lines", lines}), drawn({session}));
  const auto tv = fettle({"filter", session, clean, "--filter", "tv", "--window", "3"});
  EXPECT_EQ(tv.status, 0);
  EXPECT_NE(tv.err.find("tv knows no edge lines"), std::string::npos) << tv.err;
}

}  // namespace
}  // namespace fettle::tests

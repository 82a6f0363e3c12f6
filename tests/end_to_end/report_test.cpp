// fettle report: the page as a browser reads it.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "engine/formats/formats.h"
#include "engine/session/session.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

std::size_t countIn(const std::string& text, const std::string& piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1)) ++count;
  return count;
}

TEST(ReportPage, OfASessionHasItsStepsAndBothStates) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), page = folder.file("r.html");
  ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--size", "128x96"}).status, 0);
  engine::JobControl job;
  const auto imported = engine::importField(scan, {}, job);
  ASSERT_TRUE(imported) << imported.error().line();
  engine::Session made;
  made.original = imported->field;
  made.history = engine::History(imported->field);
  for (const auto& [kind, window, name] : {std::tuple{engine::FilterKind::kMedian, 3, "Median 3 x 3"},
                                           {engine::FilterKind::kBox, 5, "Box 5 x 5"}}) {
    engine::FilterSpec spec;
    spec.kind = kind;
    spec.window = window;
    const auto filtered = engine::applyFilter(made.history.current(), imported->field, spec, job);
    ASSERT_TRUE(filtered);
    engine::StepInfo info;
    info.name = name;
    info.kind = engine::StepKind::kFilter;
    ASSERT_TRUE(made.history.push(info, filtered->field));
  }
  ASSERT_TRUE(engine::saveSession(made, work, job));
  const auto report = fettleJson({"report", work, page, "--title", "Part <7> & \"co\""});
  EXPECT_EQ(report["steps"], 2);
  EXPECT_EQ(report["pictures"], 3);
  const auto differ = fettleJson({"compare", scan, work});
  EXPECT_NEAR(report["rms_change"], differ["rms"], 1e-12);
  EXPECT_NEAR(report["sq_before"], fettleJson({"measure", scan})["sq"], 1e-12);
  EXPECT_NEAR(report["sq"], fettleJson({"measure", work})["sq"], 1e-12);
  const std::string text = bytesOf(page);
  EXPECT_EQ(countIn(text, "src=\"data:image/png;base64,iVBORw0KGgo"), 3U);
  EXPECT_EQ(countIn(text, "src="), 3U);
  EXPECT_NE(text.find("<h1>Part &lt;7&gt; &amp; &quot;co&quot;</h1>"), std::string::npos);
  EXPECT_NE(text.find("Median 3 x 3"), std::string::npos);
  EXPECT_NE(text.find("Box 5 x 5"), std::string::npos);
  for (const char* key : {"hash", "original_hash"})
    EXPECT_NE(text.find("#" + report[key].get<std::string>()), std::string::npos) << key;
  // The hash of the last step is that of the field.
  EXPECT_EQ(countIn(text, "#" + report["hash"].get<std::string>()), 2U);
  EXPECT_EQ(text.find(folder.path()), std::string::npos) << "no path of this machine";
  ASSERT_EQ(fettle({"report", work, folder.file("again.html"), "--title", "Part <7> & \"co\""}).status, 0);
  EXPECT_EQ(bytesOf(folder.file("again.html")), text);
}

TEST(ReportPage, OfAScanAloneHasOneStateAndNoNumberThatIsNone) {
  const TempFolder folder;
  const std::string flat = folder.file("flat.asc"), page = folder.file("r.html");
  for (const std::string z : {"1", "-9999"}) {
    std::ofstream(flat) << "ncols 3\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 1\nNODATA_value -9999\n"
                        << z << " 1 1\n1 1 " << z << "\n";
    const auto report = fettleJson({"report", flat, page, "--unit", "mm"});
    EXPECT_EQ(report["pictures"], 2);
    EXPECT_FALSE(report.contains("original_hash"));
    const std::string text = bytesOf(page);
    EXPECT_EQ(text.find("<td>nan"), std::string::npos);
    EXPECT_EQ(text.find(">Before<"), std::string::npos);
  }
}

TEST(ReportPage, RefusesWhatItCannotCompareOrMeasure) {
  const TempFolder folder;
  const std::string a = folder.file("a.tif"), b = folder.file("b.tif"), page = folder.file("r.html");
  ASSERT_EQ(fettle({"synth", a, "--size", "64x64"}).status, 0);
  ASSERT_EQ(fettle({"synth", b, "--size", "64x65"}).status, 0);
  expectRefused(fettle({"report", a, page, "--original", b}), "64 x 65");
  expectRefused(fettle({"report", a, a}), a);
  std::ofstream(folder.file("holes.asc"))
      << "ncols 2\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 1\nNODATA_value 0\n0 0\n0 0\n";
  expectRefused(fettle({"report", folder.file("holes.asc"), page, "--unit", "mm"}), "hole");
  EXPECT_FALSE(std::filesystem::exists(page));
}

}  // namespace
}  // namespace fettle::tests

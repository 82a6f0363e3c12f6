// fettle report: the page as a browser and a reader of PDF read it.

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/work/kept_sections.h"
#include "engine/filter/filter.h"
#include "engine/formats/formats.h"
#include "engine/marks/chosen_marks.h"
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

// A scan, and a session of it with two filters.
void makeSession(const std::string& scan, const std::string& work) {
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
  made.notes["scene"] = "# stiff\n[contact]\nstiffness = 0.5\n";
  ASSERT_TRUE(engine::saveSession(made, work, job));
}

// The same with two sections that the window kept with it: of the first cursors and a step, of the second a groove that is not there.
void makeSessionWithSections(const std::string& scan, const std::string& work) {
  makeSession(scan, work);
  engine::JobControl job;
  auto session = engine::openSession(work, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  app::KeptSection step{.from = {0.0, 5.0}, .to = {31.0, 5.0}, .width_mm = 3.0, .cursors = {1.0, 30.0}};
  step.step = true;
  app::KeptSection groove{.from = {0.0, 5.0}, .to = {12.0, 5.0}, .width_mm = 0.0, .cursors = {1.0, 11.0}};
  groove.groove = true;
  session->notes[engine::kSectionsNote] = app::sectionsText({step, groove});
  ASSERT_TRUE(engine::saveSession(*session, work, job));
}

// Text of a PDF as `pdftotext` of poppler-utils finds it.
std::string textOf(const std::string& pdf) {
  return runProcess({"pdftotext", "-layout", pdf, "-"}).out;
}

// GDAL is loaded by the first file that needs it, and what pages are drawn with by the first page: with theirs they are over a hundred libraries, which
// were most of what the program did at its start.
TEST(Libraries, AreLoadedByWhatNeedsThem) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--size", "40x30"}).status, 0);
  // What the loader says goes to a file for each process: plots are drawn by another program, which may load what it likes.
  const auto loadedBy = [&](const std::string& name, std::vector<std::string> arguments) {
    const std::string said = folder.file(name);
    arguments.insert(arguments.begin(), {"env", "LD_DEBUG=files", "LD_DEBUG_OUTPUT=" + said, FETTLE_PROGRAM});
    const Outcome outcome = runProcess(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::string text;
    for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
      if (!file.path().filename().string().starts_with(name + ".")) continue;
      std::ifstream in(file.path());
      const std::string one{std::istreambuf_iterator<char>(in), {}};
      if (one.find("initialize program: " FETTLE_PROGRAM) != std::string::npos) text += one;
    }
    return text;
  };
  const std::string help = loadedBy("help", {"filter", "--help"});
  ASSERT_NE(help.find("libtiff"), std::string::npos) << "the loader says what it does";
  EXPECT_EQ(help.find("libgdal"), std::string::npos);
  const std::string info = loadedBy("info", {"info", scan, "--quiet"});
  EXPECT_NE(info.find("libgdal.so.32"), std::string::npos);
  for (const char* library : {"libcairo", "librsvg", "libpango", "libgio", "libpixman"})
    EXPECT_EQ(info.find(library), std::string::npos) << library;
  const std::string page = loadedBy("page", {"report", scan, folder.file("page.pdf"), "--quiet"});
  EXPECT_NE(page.find("libcairo.so.2"), std::string::npos);
  EXPECT_NE(page.find("librsvg-2.so.2"), std::string::npos);
}

TEST(ReportPage, OfASessionHasTheSectionsThatAreKeptWithIt) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), page = folder.file("r.html");
  makeSessionWithSections(scan, work);
  const auto report = fettleJson({"report", work, page, "--section", "1,1:30,1"});
  EXPECT_EQ(report["sections"], 1);
  EXPECT_EQ(report["kept_sections"], 2);
  const std::string text = bytesOf(page);
  for (const char* heading : {"<h2>Section 1</h2>", "<h2>Kept section 1</h2>", "<h2>Kept section 2</h2>"})
    EXPECT_EQ(countIn(text, heading), 1U) << heading;
  EXPECT_EQ(countIn(text, "means of 4 lanes"), 1U);
  // The command's figures of both states.
  for (const std::string& of : {scan, work}) {
    const auto figures =
        fettleJson({"section", of, "--start", "0,5", "--end", "31,5", "--width", "3", "--cursors", "1,30",
                    "--step", "auto", "--within", "1,30"})["sections"][0];
    for (const auto& [kind, key] : {std::pair{"cursors", "dz_mm"}, {"step", "step_mm"}}) {
      const std::string shown = fmt::format(">{:.5g} +- ", figures[kind][key].get<double>());
      EXPECT_NE(text.find(shown), std::string::npos) << of << " " << kind << " " << shown;
    }
  }
  EXPECT_NE(text.find("no groove or ridge stands out"), std::string::npos);
  // A scan has none to show.
  EXPECT_FALSE(fettleJson({"report", scan, page}).contains("kept_sections"));
}

TEST(ReportPage, OfASessionHasItsStepsAndBothStates) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), page = folder.file("r.html");
  makeSession(scan, work);
  const auto report = fettleJson({"report", work, page, "--title", "Part <7> & \"co\""});
  EXPECT_EQ(report["steps"], 2);
  EXPECT_EQ(report["pictures"], 3);
  const auto differ = fettleJson({"compare", scan, work});
  EXPECT_NEAR(report["rms_change"], differ["rms"], 1e-12);
  EXPECT_NEAR(report["sq_before"], fettleJson({"measure", scan})["sq"], 1e-12);
  EXPECT_NEAR(report["sq"], fettleJson({"measure", work})["sq"], 1e-12);
  // The same scales as of measure, and said so.
  const std::vector<std::string> scales{"--s-filter", "2", "--l-filter", "8", "--l-filter-kind", "spline"};
  std::vector<std::string> limited{"report", work, folder.file("limited.html")}, measured{"measure", work};
  limited.insert(limited.end(), scales.begin(), scales.end());
  measured.insert(measured.end(), scales.begin(), scales.end());
  const auto scaled = fettleJson(limited);
  EXPECT_NEAR(scaled["sq"], fettleJson(measured)["sq"], 1e-12);
  EXPECT_EQ(scaled["l_filter_kind"], "spline");
  EXPECT_NE(bytesOf(folder.file("limited.html")).find("S-filter 2 mm, areal-gaussian; L-filter 8 mm, spline"),
            std::string::npos);
  const std::string text = bytesOf(page);
  EXPECT_EQ(countIn(text, "src=\"data:image/png;base64,iVBORw0KGgo"), 3U);
  EXPECT_EQ(countIn(text, "src="), 3U);
  EXPECT_EQ(report["curves"], 3);
  EXPECT_EQ(countIn(text, "<svg"), 3U);
  EXPECT_EQ(countIn(text, ">Before, along x<"), 1U) << "before and after in one plot";
  EXPECT_EQ(countIn(text, ">After, along x<"), 1U);
  EXPECT_NE(text.find("[contact]; stiffness = 0.5<"), std::string::npos);
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

// One content: what the HTML page says in its tables, captions and plots is text in the PDF.
// The scan before has none of the marks that were made in the session.
TEST(ReportPage, OfMarkedSamplesMeasuresTheSameOnesBeforeAndAfter) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), page = folder.file("r.html");
  makeSession(scan, work);
  const engine::SampleRect part{20, 10, 50, 40};
  engine::JobControl job;
  auto session = engine::openSession(work, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  const auto marked = engine::onlyMarked(
      session->history.current(),
      [&](std::int32_t tc, std::int32_t tr) { return engine::rowsInside(part, tc, tr); }, job);
  ASSERT_TRUE(marked);
  engine::StepInfo info;
  info.name = "Marks";
  ASSERT_TRUE(session->history.push(info, *marked));
  ASSERT_TRUE(engine::saveSession(*session, work, job));
  const auto report = fettleJson({"report", work, page, "--region", "marked"});
  const auto sqOf = [&](const std::string& of, const std::string& region) {
    return fettleJson({"measure", of, "--region", region, "--only", "height", "--noise-trials", "0"})["sq"]
        .get<double>();
  };
  EXPECT_EQ(report["sq"], sqOf(work, "marked"));
  const double spacing = session->original.grid().spacingXMm();
  const std::string same =
      fmt::format("rectangle {},{},{},{}", 20 * spacing, 10 * spacing, 69 * spacing, 49 * spacing);
  EXPECT_EQ(report["sq_before"], sqOf(scan, same));
}

TEST(ReportPage, AsPdfHasTheSameTextAndNoDateOfNow) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), pdf = folder.file("r.pdf");
  makeSession(scan, work);
  const std::vector<std::string> more = {"--title",         "Part <7> & \"co\" \u00e4\u03a9",
                                         "--section",       "1,2:20,14:22,3",
                                         "--section",       "2,2:30,2",
                                         "--cutoff",        "6",
                                         "--section-width", "0.5"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto report = fettleJson(with({"report", work, pdf}));
  EXPECT_EQ(report["sections"], 2);
  const std::string text = textOf(pdf);
  for (const std::string& piece :
       {std::string("Part <7> & \"co\" \u00e4\u03a9"), std::string("Median 3 x 3"), std::string("Box 5 x 5"),
        "#" + report["hash"].get<std::string>(), "#" + report["original_hash"].get<std::string>(),
        std::string("Surface texture"), std::string("root mean square"), std::string("autocorrelation"),
        std::string("spatial frequency"), std::string("After, along y"), std::string("Section 2"),
        std::string("RSm"), std::string("Surface texture without noise"), std::string("Noise trials"),
        std::string("stiffness = 0.5"), std::string("L-filter"), std::string("1 of ")})
    EXPECT_NE(text.find(piece), std::string::npos) << piece << "\n" << text;
  EXPECT_EQ(text.find(folder.path()), std::string::npos) << "no path of this machine";
  const std::string bytes = bytesOf(pdf);
  EXPECT_TRUE(bytes.starts_with("%PDF-"));
  for (const char* date : {"CreationDate", "ModDate", "/ID"})
    EXPECT_EQ(bytes.find(date), std::string::npos) << date;
  // A second later or more: the seconds of a date would differ.
  const auto made = std::filesystem::last_write_time(pdf);
  while (std::filesystem::file_time_type::clock::now() < made + std::chrono::milliseconds(1100))
    std::this_thread::yield();
  ASSERT_EQ(fettle(with({"report", work, folder.file("again.pdf")})).status, 0);
  EXPECT_EQ(bytesOf(folder.file("again.pdf")), bytes);
  // To standard output.
  const Outcome streamed = fettle(with({"report", work, "-", "--type", "pdf"}));
  EXPECT_EQ(streamed.status, 0);
  EXPECT_EQ(streamed.out, bytes);
  expectRefused(fettle({"report", work, pdf, "--type", "html"}), "--type");
  expectRefused(fettle({"report", work, pdf, "--cutoff", "2.5"}), "--section");
  expectRefused(fettle({"report", work, pdf, "--section", "1,2"}), "--section");
}

// Long names, malformed UTF-8 and a table of several sheets.
TEST(ReportPage, AsPdfTakesAnyText) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), pdf = folder.file("r.pdf");
  ASSERT_EQ(fettle({"synth", scan, "--size", "32x24"}).status, 0);
  const std::string word(400, 'w');
  ASSERT_EQ(fettle({"report", scan, pdf, "--title", word + " end"}).status, 0);
  EXPECT_NE(textOf(pdf).find("end"), std::string::npos);
  ASSERT_EQ(fettle({"report", scan, pdf, "--title", "a\xff\x01z", "--quiet"}).status, 0);
  EXPECT_NE(textOf(pdf).find("a\xef\xbf\xbd z"), std::string::npos);
  ASSERT_EQ(fettle({"report", scan, pdf, "--title", ""}).status, 0);
}

TEST(ReportPage, OfDamagedOrEmptySessionsIsRefused) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), work = folder.file("w.fettle"), pdf = folder.file("r.pdf");
  makeSession(scan, work);
  const std::string bytes = bytesOf(work), bad = folder.file("bad.fettle");
  const std::string halved = bytes.substr(0, bytes.size() / 2);
  for (const std::string& content : {std::string(), halved, std::string(4096, 'x')}) {
    std::ofstream(bad, std::ios::binary) << content;
    const Outcome outcome = fettle({"report", bad, pdf});
    expectRefused(outcome, "bad.fettle");
    EXPECT_FALSE(std::filesystem::exists(pdf));
  }
  // A session without a step has both states in one.
  engine::JobControl job;
  const auto imported = engine::importField(scan, {}, job);
  ASSERT_TRUE(imported);
  engine::Session none;
  none.original = imported->field;
  none.history = engine::History(imported->field);
  ASSERT_TRUE(engine::saveSession(none, bad, job));
  const auto report = fettleJson({"report", bad, pdf});
  EXPECT_EQ(report["steps"], 0);
  EXPECT_FALSE(report.contains("original_hash"));
  EXPECT_EQ(textOf(pdf).find("Steps"), std::string::npos);
}

// A disk that takes 20 kB, which is less than the pictures need.
TEST(ReportPage, OfAFullDiskLeavesNothing) {
  const TempFolder folder, out;
  const std::string scan = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "64x64"}).status, 0);
  for (const char* name : {"r.pdf", "r.html"}) {
    ProcessOptions full;
    full.file_limit = 20'000;
    const Outcome outcome = fettle({"report", scan, out.file(name)}, full);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(std::filesystem::is_empty(out.path())) << outcome.err;
    std::ofstream(out.file(name)) << "what was there";
    EXPECT_EQ(fettle({"report", scan, out.file(name)}, full).status, 1);
    EXPECT_EQ(bytesOf(out.file(name)), "what was there");
    std::filesystem::remove(out.file(name));
  }
}

// The ratios and the pruning of fettle measure, with its figures.
TEST(ReportPage, RatiosAndPruningAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), page = folder.file("page.html");
  ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--size", "128x96"}).status, 0);
  const std::vector<std::string> asked = {"--ratios", "5,90", "--height-between", "10,60",
                                          "--prune",  "12",   "--noise-trials",   "0"};
  std::vector<std::string> report{"report", scan, page}, measure{"measure", scan};
  report.insert(report.end(), asked.begin(), asked.end());
  measure.insert(measure.end(), asked.begin(), asked.end());
  ASSERT_EQ(fettle(report).status, 0);
  std::ostringstream html_text;
  html_text << std::ifstream(page).rdbuf();
  const std::string html = html_text.str(), text = fettle(measure).out;
  for (const char* said :
       {"(5 to 90 %)", "of 12 % of Sz", "height difference of the material ratios 10 and 60 %"}) {
    EXPECT_NE(html.find(said), std::string::npos) << said;
    EXPECT_NE(text.find(said), std::string::npos) << said;
  }
  // "Sdc   12.345 um   ...": the same figure in the same unit.
  std::istringstream line(text.substr(text.find("Sdc")));
  std::string name, figure;
  line >> name >> figure;
  EXPECT_NE(html.find(">" + figure + "<", html.find("Sdc")), std::string::npos) << figure;
  const Outcome wrong = fettle({"report", scan, page, "--ratios", "90,5"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("not in order"), std::string::npos) << wrong.err;
}

// Curves are no reason to refuse: where gnuplot is not on the path the page says so.
TEST(ReportPage, WithoutGnuplotSaysThatCurvesAreMissing) {
  const TempFolder folder, nothing;
  const std::string scan = folder.file("s.tif"), page = folder.file("r.html");
  ASSERT_EQ(fettle({"synth", scan, "--size", "32x24"}).status, 0);
  const char* const path = std::getenv("PATH");
  const std::string kept = path == nullptr ? "" : path;
  setenv("PATH", nothing.path().c_str(), 1);
  const auto report = fettleJson({"report", scan, page});
  const Outcome section = fettle({"report", scan, page, "--section", "0,0:3,3"});
  setenv("PATH", kept.c_str(), 1);
  EXPECT_EQ(report["curves"], 0);
  EXPECT_NE(bytesOf(page).find("install gnuplot-nox"), std::string::npos);
  expectFailed(section, "gnuplot");
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

TEST(ReportPage, OfSamplesThatNeverLieBesideEachOtherHasNoSpectrum) {
  const TempFolder folder;
  const std::string scan = folder.file("checker.asc"), page = folder.file("page.html");
  {
    std::ofstream out(scan);
    out << "ncols 40\nnrows 40\nxllcenter 0\nyllcenter 0\ncellsize 0.1\nNODATA_value -9999\n";
    for (int r = 0; r < 40; ++r)
      for (int c = 0; c < 40; ++c)
        out << ((r + c) % 2 == 0 ? -9999.0 : 0.001 * (c * 37 % 11 + r * 13 % 7)) << (c == 39 ? '\n' : ' ');
  }
  const Outcome made = fettle({"report", scan, page, "--unit", "mm"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(bytesOf(page).find("no samples of a line lie beside each other"), std::string::npos);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--spectrum", "-"}), "no power spectrum");
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

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bench/accuracy/approximate_filters.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/subjects.h"
#include "haptic/trials/contact_trial.h"

namespace fettle::bench {
namespace {

Plane planeOf(std::int32_t width, std::int32_t height, double (*z)(int, int)) {
  Plane plane{width, height, {}};
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) plane.z.push_back(z(c, r));
  return plane;
}

double sumOf(const Plane& plane) {
  double sum = 0.0;
  for (const double z : plane.z) sum += z;
  return sum;
}

double middleMedian(const Plane& in, std::int32_t c, std::int32_t r, int radius) {
  std::vector<double> window;
  for (std::int32_t y = std::max(0, r - radius); y <= std::min(in.height - 1, r + radius); ++y)
    for (std::int32_t x = std::max(0, c - radius); x <= std::min(in.width - 1, c + radius); ++x)
      window.push_back(in.at(x, y));
  std::sort(window.begin(), window.end());
  return window[(window.size() - 1) / 2];  // the lower one
}

TEST(ApproximateFilters, KeepAConstant) {
  const Plane seven = planeOf(40, 23, [](int, int) { return 7.0; });
  for (const Plane& out : {gaussianInFloat(seven, 2.0, 8), gaussianRecursive(seven, 2.0),
                           medianSeparable(seven, 3), medianOfLevels(seven, 3, 256)})
    for (const double z : out.z) EXPECT_NEAR(z, 7.0, 1e-5);
}

TEST(ApproximateFilters, SpreadASpikeAsAGaussianDoes) {
  const Plane spike = planeOf(61, 61, [](int c, int r) { return c == 30 && r == 30 ? 1000.0 : 0.0; });
  const double peak = 1000.0 / (2.0 * M_PI * 9.0);
  for (const Plane& out : {gaussianInFloat(spike, 3.0, 18), gaussianRecursive(spike, 3.0)}) {
    EXPECT_NEAR(sumOf(out), 1000.0, 0.5);
    EXPECT_NEAR(out.at(30, 30), peak, 0.05 * peak);
    for (int d = 0; d < 12; ++d) {
      EXPECT_NEAR(out.at(30 + d, 30), out.at(30, 30 - d), 1e-3 * peak) << d;
      EXPECT_NEAR(out.at(30 + d, 30), peak * std::exp(-d * d / 18.0), 0.06 * peak) << d;
    }
  }
}

TEST(ApproximateFilters, MedianOfWholeNumbersIsExactWithAsManyLevels) {
  const Plane steps =
      planeOf(37, 29, [](int c, int r) { return static_cast<double>((c * 7919 + r * 104729) % 256); });
  const Plane out = medianOfLevels(steps, 4, 256);
  for (std::int32_t r = 0; r < steps.height; ++r)
    for (std::int32_t c = 0; c < steps.width; ++c)
      ASSERT_NEAR(out.at(c, r), middleMedian(steps, c, r, 4), 1e-9) << c << ", " << r;
}

TEST(ApproximateFilters, SeparableMedianIsThatOfRowsThenColumns) {
  const Plane noise = planeOf(20, 20, [](int c, int r) { return whiteNoise(5, c, r); });
  const Plane out = medianSeparable(noise, 1);
  std::vector<double> rows;
  for (int r = 9; r <= 11; ++r) {
    std::vector<double> three{noise.at(9, r), noise.at(10, r), noise.at(11, r)};
    std::sort(three.begin(), three.end());
    rows.push_back(three[1]);
  }
  std::sort(rows.begin(), rows.end());
  EXPECT_EQ(out.at(10, 10), rows[1]);
}

TEST(Measure, SummarisesByNearestRank) {
  AccuracyRow row;
  std::vector<double> errors;
  for (int i = 200; i >= 1; --i) errors.push_back(i);
  summarise(errors, row);
  EXPECT_EQ(row.error, 100.5);
  EXPECT_EQ(row.error_p99, 198.0);
  EXPECT_EQ(row.error_worst, 200.0);
  summarise({}, row);
  EXPECT_EQ(row.error_worst, 0.0);
}

// What the page says about contact rests on these.
TEST(ContactStudy, CertifiedIsExactWithinItsRadiusAndMoreStepsAreNeverWorse) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.02;
  const auto study = contactStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  for (const std::string subject : {"flat", "step", "ridge", "groove", "noise"}) {
    const AccuracyRow& sure = rowOf(*study, subject, "certified, 8 cells");
    // The presses go to 0.3 mm, six cells, plus half a step's height at a wall's foot.
    EXPECT_LT(sure.error, subject == "step" ? 0.05 : 1e-12) << subject;
    if (subject != "step") {
      EXPECT_EQ(sure.wrong, 0.0) << subject;
    }
    EXPECT_LE(rowOf(*study, subject, "paper").wrong, 1.0);
  }
  const AccuracyRow& rest = rowOf(*study, "flat", "paper");
  EXPECT_LT(rest.error_worst, 1e-9);
  EXPECT_GT(rowOf(*study, "noise", "paper").wrong, 0.05);
  EXPECT_GT(rowOf(*study, "flat", "descent, 1 Newton step per tick").error, rest.error);
}

// The table of the accuracy page: each method on each ground, with its time, its longest ticks and what differs from the
// source's text.
TEST(PaperStudy, ComparesEveryMethodOnEveryGround) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.02;
  const auto study = paperStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  const auto grounds = searchGrounds(256);
  ASSERT_TRUE(grounds);
  ASSERT_EQ(study->columns.size(), 4U);
  for (const Subject& ground : *grounds) {
    const AccuracyRow& literal = rowOf(*study, ground.name, "literal paper");
    const AccuracyRow& paper = rowOf(*study, ground.name, "paper");
    EXPECT_GT(literal.error, 0.01) << ground.name;
    EXPECT_NEAR(paper.error, literal.error, 1e-7) << ground.name;
    EXPECT_EQ(paper.wrong, literal.wrong) << ground.name;
    EXPECT_EQ(paper.more[0], 0.0) << ground.name;
    EXPECT_EQ(paper.more[1], 0.0) << ground.name;
    EXPECT_EQ(rowOf(*study, ground.name, "certified, 8 cells").wrong, 0.0) << ground.name;
    const AccuracyRow& ball = rowOf(*study, ground.name, "ball, radius 2 cells");
    EXPECT_GT(ball.error, 0.01) << ground.name;
    EXPECT_TRUE(std::isnan(ball.wrong) && std::isnan(ball.more[0])) << ground.name;
    for (const char* method :
         {"literal paper", "descent", "paper", "certified, 8 cells", "ball, radius 2 cells"}) {
      const AccuracyRow& row = rowOf(*study, ground.name, method);
      ASSERT_EQ(row.more.size(), study->columns.size()) << method;
      EXPECT_GT(row.more[2], 0.0) << ground.name << ", " << method;
      EXPECT_NEAR(row.more[3], 1e3 / row.cost, 1e-9 * row.more[3]) << ground.name << ", " << method;
    }
  }
}

// A ball whose steps are limited in plan and whose searches are bounded is as near as one before contact revision 4, on
// average over the ticks; at a step it falls faster.
TEST(ContactTrial, ABallIsAsNearAsBeforeRevision4) {
  engine::JobControl job;
  const trials::ContactChoice now{"now", haptic::ContactLevel::kPaper, 2048, 2, 2.0};
  trials::ContactChoice before = now;
  before.before_revision_4 = true;
  const auto subjects = hardSubjects(512);
  ASSERT_TRUE(subjects);
  for (const Subject& subject : *subjects) {
    const auto trial = trials::ContactTrial::make(subject.field, 2.0, 3000, job);
    ASSERT_TRUE(trial && trial->has_value()) << subject.name;
    const auto a = (*trial)->measure(before, 1, job);
    const auto b = (*trial)->measure(now, 1, job);
    ASSERT_TRUE(a && b);
    std::printf(
        "%s: mean %.5f mm before, %.5f now; p99 %.4f, %.4f; worst %.4f, %.4f; not nearest %.3f, %.3f\n",
        subject.name.c_str(), a->mean_mm, b->mean_mm, a->p99_mm, b->p99_mm, a->worst_mm, b->worst_mm,
        a->wrong, b->wrong);
    EXPECT_LE(b->mean_mm, 1.05 * a->mean_mm + 1e-6) << subject.name;
    EXPECT_LE(b->worst_mm, 1.1 * a->worst_mm + 1e-5) << subject.name;
  }
}

// Of the note "0.12 um from the same in double".
double offTwin(const AccuracyRow& row) {
  return std::strtod(row.note.c_str(), nullptr);
}

TEST(SurfaceStudy, TrianglesAreAnotherSurfaceAndFloatLosesFarFromTheCorner) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.02;
  const auto study = surfaceStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  EXPECT_EQ(rowOf(*study, "noise 20 um", "bilinear, all stationary points, double").error, 0.0);
  EXPECT_GT(rowOf(*study, "noise 20 um", "two triangles").error, 1e-4);
  // A float's last bit is 0.5 um at 8 m and some 1e-6 um next to the corner.
  const AccuracyRow& far = rowOf(*study, "noise 20 um, 8 m away", "two triangles, float");
  const AccuracyRow& near = rowOf(*study, "noise 20 um", "two triangles, float");
  EXPECT_GT(offTwin(far), 0.1) << far.note;
  EXPECT_LT(offTwin(near), 0.01) << near.note;
}

TEST(UploadStudy, RoundingStaysWithinHalfAStep) {
  engine::JobControl job;
  const auto study = uploadStudy({}, job);
  ASSERT_TRUE(study) << study.error().line();
  EXPECT_EQ(rowOf(*study, "milled part", "32-bit float (used)").error_worst, 0.0);
  const AccuracyRow& whole = rowOf(*study, "milled part", "16 bits over the whole field's range");
  const AccuracyRow& tiles = rowOf(*study, "milled part", "16 bits over each tile's range");
  EXPECT_GT(whole.error_worst, 0.0);
  EXPECT_LE(tiles.error_worst, whole.error_worst);
  EXPECT_LT(whole.error_worst, 10.0);  // a part of some tens of millimetres over 65535 steps, halved
}

TEST(RestorationStudy, FiltersThatKeepEdgesBeatThoseThatDoNotAndEffortPaysForTheLatter) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.01;
  const auto study = restorationStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  for (const AccuracyRow& row : study->rows) EXPECT_EQ(row.more.size(), study->columns.size()) << row.method;
  const double nothing = rowOf(*study, "unfiltered scan", "nothing").error;
  for (const char* keeps : {"bilateral 5", "tv 17"}) {
    const AccuracyRow& row = rowOf(*study, "alone", keeps);
    EXPECT_LT(row.error, 0.7 * nothing) << keeps;
    EXPECT_LT(row.more[0], 0.5 * rowOf(*study, "unfiltered scan", "nothing").more[0]) << keeps;
  }
  EXPECT_GT(rowOf(*study, "alone", "box 5, 2 passes").error, nothing);
  ASSERT_EQ(study->views.size(), 1U);
  const Study& effort = study->views[0];
  const AccuracyRow& alone = rowOf(effort, "box, Gaussian, median", "alone");
  const AccuracyRow& by_hand = rowOf(effort, "box, Gaussian, median", "by hand: all edges");
  EXPECT_EQ(alone.cost, 0.0);
  EXPECT_GT(by_hand.cost, 10.0);
  EXPECT_LT(by_hand.error, alone.error);
  EXPECT_LT(rowOf(effort, "box, Gaussian, median", "by hand: long edges").cost, by_hand.cost);
}

TEST(AutomaticStudy, GeneralisedVariationIsNearestOnEveryPart) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.01;
  const auto study = automaticStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  int subjects = 0;
  for (const AccuracyRow& row : study->rows) {
    ASSERT_EQ(row.more.size(), study->columns.size()) << row.method;
    EXPECT_LE(row.error, row.error_worst);
    if (row.method == "tgv") continue;
    const AccuracyRow& nearest = rowOf(*study, row.subject, "tgv");
    EXPECT_LT(nearest.error, row.error) << row.subject << ", " << row.method;
    subjects += row.method == "nothing" ? 1 : 0;
  }
  EXPECT_EQ(subjects, 7);
}

TEST(ProcessStudy, MarksKeepTheNoiseOfTheScanAndLinesLoseNothing) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.01;
  options.parts = {"steps"};
  const auto study = processStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  std::set<std::string> subjects;
  for (const AccuracyRow& row : study->rows) {
    ASSERT_EQ(row.more.size(), study->columns.size()) << row.method;
    subjects.insert(row.subject);
  }
  EXPECT_EQ(subjects.size(), 2U);
  EXPECT_EQ(study->rows.size(), 9 * subjects.size());
  for (const std::string& subject : subjects) {
    const auto near = [&](const char* method) { return rowOf(*study, subject, method).more[1]; };
    // Nearly every sample near an edge is marked.
    EXPECT_NEAR(near("HEG with box"), near("nothing"), 0.02 * near("nothing")) << subject;
    EXPECT_LT(near("HEG with box"), 0.5 * near("box alone")) << subject;
    EXPECT_LT(near("tgv alone"), near("HEG with median")) << subject;
    const double alone = rowOf(*study, subject, "tgv alone").error;
    EXPECT_LE(rowOf(*study, subject, "tgv, lines of the hand").error, 1.02 * alone) << subject;
    EXPECT_LE(rowOf(*study, subject, "tgv, true lines").error, 1.02 * alone) << subject;
    EXPECT_GT(rowOf(*study, subject, "HEG with box").cost, 60.0) << subject;
  }
  options.parts = {"plate"};
  EXPECT_EQ(processStudy(options, job).error().kind, engine::ErrorKind::kInput);
}

TEST(SuggestionStudy, HasEveryFilterOnEveryPartAndTheOneThatIsNamed) {
  engine::JobControl job;
  AccuracyOptions options;
  options.seeds = 1;
  options.side = 160;
  const auto study = suggestionStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  std::set<std::pair<std::string, std::string>> rows;
  int named = 0;
  for (const AccuracyRow& row : study->rows) {
    EXPECT_TRUE(rows.emplace(row.subject, row.method).second) << row.subject << ", " << row.method;
    ASSERT_EQ(row.more.size(), study->columns.size());
    named += row.method == "the one that is named" ? 1 : 0;
    // The unfiltered scan has its noise, and the method measures it. The ribs' flats are 40 samples here.
    if (row.method == "the unchanged scan" && !row.subject.starts_with("ribs")) {
      EXPECT_NEAR(row.more[0], 1.0, 0.15) << row.subject;
    }
  }
  EXPECT_EQ(named, 14);
}

TEST(SuggestionStudy, HasChosenPartsAndFiltersAlone) {
  engine::JobControl job;
  AccuracyOptions options;
  options.seeds = 1;
  options.side = 128;
  options.parts = {"plate", "steps"};
  options.methods = {"tv 31"};
  const auto study = suggestionStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  std::multiset<std::string> methods;
  for (const AccuracyRow& row : study->rows) {
    EXPECT_TRUE(row.subject.starts_with("plate") || row.subject.starts_with("steps")) << row.subject;
    methods.insert(row.method);
  }
  EXPECT_EQ(methods.size(), 8U);
  EXPECT_EQ(methods.count("tv 31"), 4U);
  EXPECT_EQ(methods.count("the one that is named"), 4U);
  options.parts = {"plate"};
  options.methods = {"named"};
  const auto named = suggestionStudy(options, job);
  ASSERT_TRUE(named) << named.error().line();
  ASSERT_EQ(named->rows.size(), 2U);
  for (const AccuracyRow& row : named->rows) {
    EXPECT_EQ(row.method, "the one that is named");
    EXPECT_GT(row.more[0], 0.0);
  }
}

TEST(SuggestionStudy, RefusesPartsAndFiltersThatThereAreNot) {
  engine::JobControl job;
  AccuracyOptions options;
  options.seeds = 1;
  options.side = 128;
  options.parts = {"cube"};
  EXPECT_EQ(suggestionStudy(options, job).error().kind, engine::ErrorKind::kInput);
  options.parts = {"plate"};
  options.methods = {"tv 30"};
  EXPECT_EQ(suggestionStudy(options, job).error().kind, engine::ErrorKind::kInput);
}

TEST(EdgeLineStudy, LocatedLinesAreNearerThanTheHandAndTheirDeviationsAreHonest) {
  engine::JobControl job;
  AccuracyOptions options;
  options.effort = 0.01;
  const auto study = edgeLineStudy(options, job);
  ASSERT_TRUE(study) << study.error().line();
  ASSERT_EQ(study->rows.size(), 10U);
  for (const AccuracyRow& row : study->rows) {
    EXPECT_EQ(row.more.size(), study->columns.size());
    if (row.method != "located line") continue;
    const AccuracyRow& hand = rowOf(*study, row.subject, "hand");
    // 512 samples: ribs and terraces are half as wide as in the full study, and a rough hand is as far off as
    // the next terrace, whose edge it then takes in places.
    const bool rough = row.subject == "steps x3, rough hand";
    EXPECT_LT(row.error, (rough ? 0.7 : 0.5) * hand.error) << row.subject;
    EXPECT_GT(row.more[0], 0.4) << row.subject;
    EXPECT_GT(row.more[1], 0.5) << row.subject;
    EXPECT_LT(row.more[1], rough ? 5.0 : 2.0) << row.subject;
    EXPECT_GT(row.cost, 0.0);
  }
}

}  // namespace
}  // namespace fettle::bench

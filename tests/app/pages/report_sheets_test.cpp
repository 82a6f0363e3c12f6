// How a report is laid out on sheets, and what its PDF does with damaged pictures.

#include "app/pages/report_sheets.h"

#include <map>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/pages/report_page.h"

namespace fettle::app {
namespace {

// An 8 x 4 PNG by its signature and header alone: enough for its place.
std::string pngOf(int width, int height) {
  std::string png = "\x89PNG\r\n\x1a\n";
  png += std::string("\0\0\0\rIHDR", 8);
  for (const int n : {width, height}) png += {'\0', '\0', '\0', static_cast<char>(n)};
  return png;
}

class ReportSheets : public testing::Test {
 protected:
  void SetUp() override {
    auto text = PageText::create();
    ASSERT_TRUE(text) << text.error().line();
    text_ = std::make_unique<PageText>(*std::move(text));
  }
  // Where each text stands: sheets, counted from 1. Every item is within the margins but for the foot.
  [[nodiscard]] std::multimap<std::string, int> placesOf(const ReportPage& page) const {
    std::multimap<std::string, int> places;
    const auto sheets = sheetsOf(page, *text_);
    EXPECT_TRUE(sheets) << sheets.error().line();
    if (!sheets) return places;
    int number = 0;
    for (const Sheet& sheet : *sheets) {
      ++number;
      for (const SheetItem& item : sheet.items)
        if (const auto* text = std::get_if<SheetText>(&item)) {
          places.emplace(text->text, number);
          EXPECT_GE(text->x, kSheetMargin - 1e-6) << text->text;
          EXPECT_LE(text->x + text_->widthOf(text->text, text->size, text->weight),
                    kSheetWidth - kSheetMargin + 1e-3)
              << text->text;
          EXPECT_LT(text->y, kSheetHeight) << text->text;
        }
    }
    return places;
  }
  std::unique_ptr<PageText> text_;
};

TEST_F(ReportSheets, ATableOfManyRowsHasEachOnceAndItsHeadOnEachSheet) {
  ReportPage page{"Title", "Made by a test.", {}};
  ReportPage::Table table{"Steps", "A note.", {"No.", "Name"}, {}};
  for (int i = 0; i < 300; ++i) table.rows.push_back({fmt::format("{}", i), fmt::format("row number {}", i)});
  page.parts.emplace_back(table);
  const auto places = placesOf(page);
  int last = 1;
  for (int i = 0; i < 300; ++i) {
    const std::string name = fmt::format("row number {}", i);
    ASSERT_EQ(places.count(name), 1U) << name;
    EXPECT_GE(places.find(name)->second, last);
    last = places.find(name)->second;
  }
  EXPECT_GT(last, 3);
  EXPECT_EQ(places.count("Name"), static_cast<std::size_t>(last));
  EXPECT_EQ(places.count(fmt::format("{0} of {0}", last)), 1U);
  EXPECT_EQ(places.find("A note.")->second, last);
}

// At every height on a sheet at which a heading may come, what it is of stands on the same sheet.
TEST_F(ReportSheets, AHeadingIsOnTheSheetOfWhatFollows) {
  for (int before = 0; before < 80; ++before) {
    ReportPage page{"T", "m", {}};
    for (int i = 0; i < before; ++i)
      page.parts.emplace_back(ReportPage::Paragraph{fmt::format("line {}", i)});
    page.parts.emplace_back(ReportPage::Table{"Heading", "", {"Head"}, {{"first"}, {"second"}}});
    const auto places = placesOf(page);
    EXPECT_EQ(places.find("Heading")->second, places.find("first")->second) << before;
    EXPECT_EQ(places.find("Head")->second, places.find("first")->second) << before;
  }
}

TEST_F(ReportSheets, ACellLongerThanASheetGoesOn) {
  ReportPage page{"T", "m", {}};
  std::string all;
  for (int i = 0; i < 4000; ++i) all += fmt::format("w{} ", i);
  page.parts.emplace_back(ReportPage::Table{"Long", "", {"a", "b"}, {{"x", all + "end"}}});
  const auto places = placesOf(page);
  std::size_t words = 0;
  for (const auto& [text, sheet] : places)
    for (std::size_t at = text.find('w'); at != std::string::npos; at = text.find('w', at + 1)) ++words;
  EXPECT_EQ(words, 4000U);
}

TEST_F(ReportSheets, TextsThatAreNoneHaveNoEffect) {
  EXPECT_EQ(text_->linesOf("", 8.0, FaceWeight::kBold, 100.0), std::vector<std::string>{""});
  const std::vector<std::string> broken = text_->linesOf("mmmmmmmmmm", 10.0, FaceWeight::kRegular, 30.0);
  EXPECT_EQ(broken.size(), 4U);
  EXPECT_EQ(text_->linesOf("m", 10.0, FaceWeight::kRegular, 0.0), std::vector<std::string>{"m"});
  EXPECT_EQ(text_->linesOf("a\xff", 10.0, FaceWeight::kRegular, 99.0).front(), "a\xef\xbf\xbd");
}

TEST(ReportPdf, OfADamagedPictureOrPlotIsAnError) {
  ReportPage page{"T", "m", {}};
  page.parts.emplace_back(ReportPage::Picture{"no picture", "text"});
  EXPECT_FALSE(reportPdf(page));
  page.parts = {ReportPage::Picture{"a head alone", pngOf(8, 4)}};
  const auto cut = reportPdf(page);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().where, "a head alone");
  page.parts = {ReportPage::Plot{"no plot", "<svg"}};
  EXPECT_FALSE(reportPdf(page));
  page.parts = {};
  const auto empty = reportPdf(page);
  ASSERT_TRUE(empty) << empty.error().line();
  EXPECT_TRUE(empty->starts_with("%PDF-"));
  EXPECT_EQ(*empty, *reportPdf(page));
}

}  // namespace
}  // namespace fettle::app

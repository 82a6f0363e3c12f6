#include "app/texts/catalogue.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/catalogue_file.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::catalogueBytes;

std::string refusalOf(std::string bytes) {
  const auto read = Catalogue::parse(std::move(bytes), "de.mo");
  return read ? "" : read.error().what;
}

void put32(std::string& bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(number >> (8 * i) & 0xffU);
}

TEST(Catalogue, has_the_translation_of_each_text_and_none_of_others) {
  const auto read = Catalogue::parse(
      catalogueBytes({{"Save", "Sichern"}, {"Save as", "Sichern als"}, {"Undo", ""}}), "de.mo");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_STREQ(read->find("Save"), "Sichern");
  EXPECT_STREQ(read->find("Save as"), "Sichern als");
  EXPECT_EQ(read->find("Undo"), nullptr) << "not translated yet";
  EXPECT_EQ(read->find("Sav"), nullptr);
  EXPECT_EQ(read->find(""), nullptr) << "the header is no text";
  EXPECT_TRUE(read->refused().empty());
}

TEST(Catalogue, has_a_form_for_each_number) {
  using namespace std::string_literals;
  const auto read =
      Catalogue::parse(catalogueBytes({{"{} step\0{} steps"s, "ein Schritt\0{} Schritte"s}}), "de.mo");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_STREQ(read->find("{} step", "{} steps", 1), "ein Schritt");
  EXPECT_STREQ(read->find("{} step", "{} steps", 5), "{} Schritte");
  EXPECT_EQ(read->find("{} step", "{} steps of {}", 5), nullptr) << "not what was checked";
  EXPECT_EQ(read->find("{} step"), nullptr);
}

TEST(Catalogue, of_fewer_forms_than_its_rule_has_gives_the_last) {
  using namespace std::string_literals;
  const auto read = Catalogue::parse(
      catalogueBytes({{"{} step\0{} steps"s, "{} A\0{} B"s}}, "nplurals=3; plural=n;"), "xx.mo");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_STREQ(read->find("{} step", "{} steps", 2), "{} B");
}

TEST(Catalogue, leaves_out_what_cannot_take_the_place_of_its_source) {
  using namespace std::string_literals;
  const auto read = Catalogue::parse(catalogueBytes({{"{} of {}", "{} von {} und {}"},
                                                     {"{:.3g} mm", "{:100000000.3f} mm"},
                                                     {"written: {}", "geschrieben: {"},
                                                     {"Remove", "Weg##damit"},
                                                     {"Undo", "Zurück\0oder"s},
                                                     {"kept", "behalten"}}),
                                     "de.mo");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->size(), 1);
  EXPECT_STREQ(read->find("kept"), "behalten");
  EXPECT_EQ(read->refused().size(), 5);
  EXPECT_EQ(read->find("{} of {}"), nullptr);
}

TEST(Catalogue, that_is_none_is_refused) {
  EXPECT_EQ(refusalOf(""), "this is no catalogue of texts");
  EXPECT_EQ(refusalOf(std::string(28, '\0')), "this is no catalogue of texts");
  EXPECT_EQ(refusalOf("\x95\x04\x12\xde" + std::string(24, '\0')),
            "the catalogue of texts is for other processors");
  std::string later = catalogueBytes({{"a", "b"}});
  put32(later, 4, 7U << 16U);
  EXPECT_EQ(refusalOf(later), "this is no catalogue of texts") << "of a version to come";
  EXPECT_EQ(refusalOf(std::string(Catalogue::kMostBytes + 1, 'x')), "this is no catalogue of texts");
}

TEST(Catalogue, whose_tables_or_strings_lie_outside_is_refused) {
  const std::string good = catalogueBytes({{"a", "b"}});
  for (const std::uint32_t far : {0x7fffffffU, 0xffffffffU, static_cast<std::uint32_t>(good.size())}) {
    for (const std::size_t table : {12U, 16U}) {
      std::string bytes = good;
      put32(bytes, table, far);
      EXPECT_NE(refusalOf(bytes), "") << table;
    }
    std::string count = good;
    put32(count, 8, far);
    EXPECT_EQ(refusalOf(count), "the catalogue of texts is cut off");
    for (const std::size_t number : {28U, 32U, 36U, 40U, 44U, 48U, 52U, 56U}) {
      std::string bytes = good;
      put32(bytes, number, far);
      EXPECT_EQ(refusalOf(bytes), "the catalogue of texts is damaged") << number;
    }
  }
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_NE(refusalOf(good.substr(0, size)), "") << size;
}

TEST(Catalogue, in_another_charset_or_without_a_usable_header_is_refused) {
  EXPECT_EQ(refusalOf(catalogueBytes({{"a", "\xff"}})), "the catalogue of texts is not in UTF-8");
  EXPECT_EQ(refusalOf(catalogueBytes({{"a", "\xc0\xaf"}})), "the catalogue of texts is not in UTF-8")
      << "overlong";
  EXPECT_EQ(refusalOf(catalogueBytes({{"a", "\xed\xa0\x80"}})), "the catalogue of texts is not in UTF-8")
      << "surrogate";
  EXPECT_EQ(refusalOf(catalogueBytes({{"a", "\xf4\x90\x80\x80"}})), "the catalogue of texts is not in UTF-8");
  EXPECT_EQ(refusalOf(catalogueBytes({}, "nplurals=99; plural=0;")),
            "the header of the catalogue of texts cannot be used");
  EXPECT_EQ(refusalOf(catalogueBytes({}, "nplurals=2; plural=system(n);")),
            "the header of the catalogue of texts cannot be used");
  std::string other = catalogueBytes({{"a", "b"}});
  other.replace(other.find("UTF-8"), 5, "CP437");
  EXPECT_EQ(refusalOf(other), "the header of the catalogue of texts cannot be used");
}

// Whatever a file says, what is found in it lies in it and can be formatted: the sanitizers see the rest.
TEST(Catalogue, with_any_byte_changed_is_refused_or_read) {
  using namespace std::string_literals;
  const std::string good = catalogueBytes({{"Save", "Sichern"},
                                           {"{} step\0{} steps"s, "{} Schritt\0{} Schritte"s},
                                           {"of {:.3g} mm", "aus {:.3g} mm"}});
  std::mt19937_64 random(20);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = good;
    for (int k = 0; k < 1 + i % 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto read = Catalogue::parse(bytes, "de.mo");
    if (!read) continue;
    if (const char* text = read->find("Save")) {
      EXPECT_LE(std::string_view(text).size(), bytes.size());
    }
    if (const char* text = read->find("of {:.3g} mm")) {
      EXPECT_NO_THROW((void)fmt::format(fmt::runtime(text), 3.0));
    }
    if (const char* text = read->find("{} step", "{} steps", random())) {
      EXPECT_NO_THROW((void)fmt::format(fmt::runtime(text), 3));
    }
  }
}

TEST(Catalogue, is_read_from_a_file_and_an_unreadable_one_is_named) {
  const tests::TempFolder folder;
  const std::string path = folder.file("de.mo");
  std::ofstream(path, std::ios::binary) << catalogueBytes({{"Save", "Sichern"}});
  const auto read = Catalogue::read(path);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_STREQ(read->find("Save"), "Sichern");
  const auto none = Catalogue::read(folder.file("fr.mo"));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().where, folder.file("fr.mo"));
  std::filesystem::resize_file(path, Catalogue::kMostBytes + 1);
  EXPECT_EQ(Catalogue::read(path).error().what, "the catalogue of texts is too large");
}

}  // namespace
}  // namespace fettle::app

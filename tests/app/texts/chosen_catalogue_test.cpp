#include "app/texts/chosen_catalogue.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/catalogue_file.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using Names = std::vector<std::string>;

TEST(ChosenCatalogue, is_that_of_the_locale_with_and_without_its_country) {
  EXPECT_EQ(catalogueNames({"", "", "de_AT.UTF-8"}), (Names{"de_AT", "de"}));
  EXPECT_EQ(catalogueNames({"", "", "ca@valencia"}), (Names{"ca"}));
  EXPECT_EQ(catalogueNames({"", "", "fr"}), (Names{"fr"}));
}

TEST(ChosenCatalogue, follows_the_list_of_languages_up_to_english) {
  EXPECT_EQ(catalogueNames({"", "pt_BR:es", "de_DE.UTF-8"}), (Names{"pt_BR", "pt", "es"}));
  EXPECT_EQ(catalogueNames({"", "fr:en:de", "de_DE.UTF-8"}), (Names{"fr"}));
  EXPECT_EQ(catalogueNames({"", "", "en_GB.UTF-8"}), Names{});
}

TEST(ChosenCatalogue, is_none_in_the_locale_c_as_in_every_program_with_gettext) {
  for (const char* locale : {"", "C", "POSIX", "C.UTF-8"})
    EXPECT_EQ(catalogueNames({"", "de", locale}), Names{}) << locale;
}

TEST(ChosenCatalogue, has_no_name_that_leads_out_of_its_folders) {
  EXPECT_EQ(catalogueNames({"", "../../tmp/x:de", "de_DE"}), (Names{"de"}));
}

TEST(ChosenCatalogue, of_the_first_folder_counts_and_the_one_that_is_named_before_all) {
  const tests::TempFolder folder;
  const auto make = [&](const std::string& path, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << tests::catalogueBytes({{"Save", text}});
  };
  const std::string own = folder.file("own"), program = folder.file("program"),
                    named = folder.file("named.mo");
  make(program + "/de.mo", "Sichern");
  const auto now = [&](const LanguageWords& words) -> std::string {
    const auto chosen = chosenCatalogue(words, {own, program});
    if (!chosen) return chosen.error().what;
    return *chosen ? (*chosen)->find("Save") : "none";
  };
  EXPECT_EQ(now({"", "", "de_DE"}), "Sichern");
  EXPECT_EQ(now({"", "", "fr_FR"}), "none");
  make(own + "/de.mo", "Ablegen");
  EXPECT_EQ(now({"", "", "de_DE"}), "Ablegen");
  make(program + "/de_DE.mo", "Speichern");
  EXPECT_EQ(now({"", "", "de_DE"}), "Speichern") << "nearer to what was asked for";
  make(named, "Sauvegarder");
  EXPECT_EQ(now({named, "", "C"}), "Sauvegarder");
  std::ofstream(named, std::ios::binary) << "no catalogue";
  EXPECT_EQ(now({named, "", "de_DE"}), "this is no catalogue of texts");
}

}  // namespace
}  // namespace fettle::app

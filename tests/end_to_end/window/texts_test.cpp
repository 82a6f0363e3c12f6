// The window in another language: what a person reads is translated, and nothing else depends on it.
#include <algorithm>
#include <cctype>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "tests/end_to_end/window/monkey.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/catalogue_file.h"
#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Words that are the same in every language: units, names of parameters of standards, of files, and of what is on the machine.
const std::set<std::string>& wordsOfData() {
  static const std::set<std::string> words{"us",   "um",     "deg",  // units
                                           "Sa",   "Sal",    "ISO",  // parameters
                                           "tif",  "fettle", "toml",
                                           "html", "csv",    "png"};  // endings of files
  return words;
}

const std::set<std::string>& namesOfFormats() {
  static const std::set<std::string> names{"Fettle session", "GeoTIFF and TIFF"};
  return names;
}

// Words of two letters and more with a vowel as it stands in the source: the translation has none.
std::set<std::string> untranslatedWords(const std::string& text) {
  std::set<std::string> found;
  std::string word;
  const auto end = [&] {
    const bool vowel = word.find_first_of("aeiouAEIOU") != std::string::npos;
    const bool plain =
        std::all_of(word.begin(), word.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    if (word.size() > 1 && vowel && plain && !wordsOfData().contains(word)) found.insert(word);
    word.clear();
  };
  for (const char c : text)
    if (std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80)
      word += c;
    else
      end();
  end();
  return found;
}

std::string withoutNumbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return text;
}

class TranslatedWindow : public WindowTest {
 protected:
  TranslatedWindow() : WindowTest(1500, 1400) {}

  void SetUp() override {
    WindowTest::SetUp();
    if (IsSkipped()) return;
    std::ofstream(catalogue, std::ios::binary) << pseudoCatalogue(inSourceTree("assets/texts/fettle.pot"));
  }
  void openPanels() const {
    State panels;
    for (const std::string& each : namesOfPanels()) panels[each] = true;
    std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels", panels}};
  }
  [[nodiscard]] std::map<std::string, std::string> language() const { return {{"FETTLE_TEXTS", catalogue}}; }

  // Without the folder of the test and the names of the files in it.
  [[nodiscard]] std::string withoutPaths(std::string text) const {
    for (const std::string& name :
         {folder.path().string(), folder.path().filename().string(), std::string("part_fettled"),
          std::string("part_report"), std::string("part")})
      for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
        text.erase(at, name.size());
    return text;
  }

  // What is not translated, by the text that it stands in.
  void gather(const State& state) {
    for (const State& text : state["texts"]) {
      const std::string read = withoutPaths(text["text"]);
      if (namesOfFormats().contains(read) || untranslatedWords(read).empty() || !seen.insert(read).second)
        continue;
      untranslated += read + "\n";
    }
  }
  // Everything of the side panel, from its top to its end, and the tip of each text.
  void gatherPanels(User& user) {
    const State first = user.program().now();
    const int left = first["picture"][0].get<int>() + first["picture"][2].get<int>();
    std::set<std::string> pointed;
    const auto pointAtTexts = [&] {
      const std::size_t before = pointed.size();
      const State now = user.program().now();
      gather(now);
      for (const State& text : now["texts"]) {
        const State& box = text["at"];
        if (box[0].get<int>() < left || !pointed.insert(withoutNumbers(text["text"])).second) continue;
        user.at({box[0].get<int>() + box[2].get<int>() / 2, box[1].get<int>() + box[3].get<int>() / 2});
        gather(user.program().now());
      }
      return pointed.size() > before;
    };
    // Figures change all the time: the end is where nothing else is new.
    while (pointAtTexts()) {
      (void)user.look("panels");
      user.at({left + 20, 700});
      (void)user.wheel(-6);
    }
  }

  std::string catalogue = folder.file("pseudo.mo");
  std::set<std::string> seen;
  std::string untranslated;
};

TEST_F(TranslatedWindow, has_no_text_of_the_source_in_its_panels_and_their_tips) {
  openPanels();
  const auto program = start({scan}, language());
  User user(display, *program, "translated panels");
  (void)opened(*program);
  gatherPanels(user);
  EXPECT_EQ(untranslated, "");
  quit(user);
}

TEST_F(TranslatedWindow, has_no_text_of_the_source_in_its_menus_dialogs_and_status_bar) {
  const auto program = start({scan}, language());
  User user(display, *program, "translated dialogs");
  gather(opened(*program));
  for (const char* menu : {"File", "Edit", "Filter", "Tool", "Marks", "View", "Device", "Help"}) {
    gather(user.click(pseudoText(menu)));
    (void)user.look(menu);
    (void)user.key("Escape");
  }
  for (const char* key : {"F1", "ctrl+o", "ctrl+shift+s", "ctrl+e", "alt+o", "alt+s", "ctrl+shift+o", "alt+e",
                          "alt+b", "alt+j", "ctrl+shift+d"}) {
    (void)user.press(key);
    gather(program->until("a dialog",
                          [](const State& s) { return s["dialog"] != "none" && s["settled"] == true; }));
    (void)user.look(key);
    (void)user.key("Escape");
    gather(program->until("no dialog",
                          [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; }));
  }
  for (const char* key : {"b", "l", "f", "e"}) {
    gather(user.key(key));
    (void)user.key("Escape");
  }
  (void)user.key("7");
  (void)user.key("m");
  gather(user.stroke({240, 360}, {340, 360}, 4));
  (void)user.key("Escape");
  (void)user.press("ctrl+q");
  gather(program->until("a question",
                        [](const State& s) { return s["dialog"] == "unsaved" && s["settled"] == true; }));
  (void)user.look("unsaved");
  (void)user.press("Delete");
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  EXPECT_EQ(untranslated, "");
}

TEST_F(TranslatedWindow, is_in_english_with_a_catalogue_that_cannot_be_used_and_says_so) {
  std::ofstream(catalogue, std::ios::binary) << "no catalogue";
  const auto program = start({scan}, language());
  User user(display, *program, "no catalogue");
  const State now = opened(*program);
  EXPECT_NE(now["texts"].dump().find("\"File\""), std::string::npos);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0);
  EXPECT_EQ(program->report()["warnings"][0],
            "this is no catalogue of texts, " + catalogue +
                ", make it with msgfmt of the texts in assets/texts/fettle.pot; the window is in English");
}

TEST_F(TranslatedWindow, follows_the_language_of_the_locale) {
  const std::filesystem::path own = folder.path() / "fettle" / "texts";
  std::filesystem::create_directories(own);
  std::filesystem::copy_file(catalogue, own / "xx.mo");
  const auto program = start({}, {{"LC_ALL", "en_US.UTF-8"}, {"LANGUAGE", "yy:xx_ZZ"}});
  program->until("a translated menu", [](const State& s) {
    return s["texts"].dump().find(pseudoText("Open a scan")) != std::string::npos;
  });
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
}

}  // namespace
}  // namespace fettle::tests

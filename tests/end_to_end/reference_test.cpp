// Help, man pages, completions and the reference are made of one table: they agree with each other and with the
// program.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/end_to_end/shell_line.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

std::string textOf(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class Reference : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    ASSERT_EQ(fettle({"reference", folder_->file("pages")}).status, 0);
    tables_ = nlohmann::json::parse(textOf(pages() / "parameters.json"));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string file(const std::string& name) { return folder_->file(name); }
  static fs::path pages() { return folder_->file("pages"); }

  static void forEach(const std::function<void(const nlohmann::json&)>& f) { visit(tables_["program"], f); }

  // What bash offers for the last of these words.
  static std::vector<std::string> completed(const std::string& words) {
    const std::string script = "source " + (pages() / "completion/fettle.bash").string() + "; COMP_WORDS=(" +
                               words +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _fettle; "
                               "printf '%s\\n' \"${COMPREPLY[@]}\"";
    ProcessOptions here;
    here.folder = folder_->path().string();
    std::istringstream lines(runProcess({"bash", "-c", script}, here).out);
    std::vector<std::string> offered;
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) offered.push_back(line);
    return offered;
  }

 private:
  static void visit(const nlohmann::json& command, const std::function<void(const nlohmann::json&)>& f) {
    f(command);
    for (const auto& below : command["commands"]) visit(below, f);
  }

  static inline TempFolder* folder_ = nullptr;
  static inline nlohmann::json tables_;
};

using Words = std::vector<std::string>;

std::string manPageOf(std::string path) {
  std::replace(path.begin(), path.end(), ' ', '-');
  return "man/" + path + ".1";
}

TEST_F(Reference, EveryParameterIsInTheHelpAndTheManPageAndTheReference) {
  const std::string reference = textOf(pages() / "reference.md");
  int commands = 0, parameters = 0;
  forEach([&](const nlohmann::json& command) {
    std::istringstream path(command["path"].get<std::string>());
    Words words;
    for (std::string word; path >> word;) words.push_back(word);
    words.erase(words.begin());
    words.emplace_back("--help");
    const std::string help = fettle(words).out;
    std::string page = textOf(pages() / manPageOf(command["path"]));
    std::erase(page, '\\');
    ++commands;
    EXPECT_NE(reference.find("## " + command["path"].get<std::string>() + "\n"), std::string::npos);
    for (const auto& parameter : command["parameters"]) {
      const auto name = parameter["name"].get<std::string>();
      ++parameters;
      EXPECT_NE(help.find(name), std::string::npos) << words[0] << " " << name;
      EXPECT_NE(page.find(name), std::string::npos) << words[0] << " " << name;
      EXPECT_NE(reference.find(name), std::string::npos) << name;
      EXPECT_FALSE(parameter["text"].get<std::string>().empty()) << name;
      EXPECT_FALSE(parameter["text"].get<std::string>().ends_with('.')) << name;
      for (const auto& word : parameter["words"])
        EXPECT_NE(help.find(word["word"].get<std::string>()), std::string::npos) << name;
    }
  });
  EXPECT_GT(commands, 20);
  EXPECT_GT(parameters, 200);
}

TEST_F(Reference, AValueOutsideItsRangeIsRefused) {
  int tried = 0;
  forEach([&](const nlohmann::json& command) {
    for (const auto& parameter : command["parameters"]) {
      if (parameter["range"].is_null() || parameter["range"][1].is_null()) continue;
      std::istringstream path(command["path"].get<std::string>());
      Words words;
      for (std::string word; path >> word;) words.push_back(word);
      words.erase(words.begin());
      for (const auto& other : command["parameters"])
        if (other["positional"] == true && other["required"] == true) words.insert(words.end(), {"a", "b"});
      words.push_back(parameter["name"].get<std::string>() + "=" +
                      std::to_string(2.0 * parameter["range"][1].get<double>()));
      expectRefused(fettle(words), "number from");
      ++tried;
    }
  });
  EXPECT_GT(tried, 20);
}

TEST_F(Reference, IsTheSameInEveryFolder) {
  const std::string other = file("other");
  ASSERT_EQ(fettle({"reference", other}).status, 0);
  for (const char* name :
       {"reference.md", "parameters.json", "man/fettle-reference.1", "completion/fettle.bash"})
    EXPECT_EQ(textOf(fs::path(other) / name), textOf(pages() / name)) << name;
}

TEST_F(Reference, ManPagesHaveNoErrorOfRoff) {
  if (runProcess({"sh", "-c", "command -v groff"}).status != 0) GTEST_SKIP() << "groff is not installed";
  for (const fs::directory_entry& page : fs::directory_iterator(pages() / "man")) {
    const Outcome set = runProcess({"groff", "-man", "-Tutf8", "-ww", "-z", page.path().string()});
    EXPECT_EQ(set.status, 0) << page.path();
    EXPECT_EQ(set.err, "") << page.path();
  }
}

TEST_F(Reference, BashCompletesCommandsOptionsWordsAndFiles) {
  std::ofstream(file("scan one.tif")) << "";
  EXPECT_EQ(completed("fettle filt"), Words{"filter"});
  EXPECT_EQ(completed("fettle bench ef"), Words{"effects"});
  EXPECT_EQ(completed("fettle filter --max"), Words{"--max-change"});
  EXPECT_EQ(completed("fettle filter in.tif out.tif --filter t"), (Words{"tv", "tgv"}));
  EXPECT_EQ(completed("fettle filter in.tif out.tif --filter = b"), (Words{"box", "bilateral"}));
  EXPECT_EQ(completed("fettle bench filters --ground h"), Words{"holes"});
  EXPECT_EQ(completed("fettle bench filters --kind tgv,p"), Words{"tgv,planes"});
  EXPECT_EQ(completed("fettle bench filters --kind = tgv,p"), Words{"tgv,planes"});
  EXPECT_EQ(completed("fettle info scan.tif --unit f"), (Words{"ft", "ftUS"}));
  EXPECT_EQ(completed("fettle info - --from = sd"), Words{"sdf"});
  EXPECT_EQ(completed("fettle convert a.tif - --to as"), Words{"asc"});
  EXPECT_EQ(completed("fettle mark a.tif - --to ''"), (Words{"png", "tif"}));
  EXPECT_EQ(completed("fettle help rec"), (Words{"recipe", "record"}));
  EXPECT_EQ(completed("fettle nope fil"), Words{});
  EXPECT_EQ(completed("fettle info scan"), Words{"scan one.tif"});
  EXPECT_EQ(completed("fettle filter --keep sc"), Words{"scan one.tif"});
  EXPECT_EQ(completed("fettle demo pag"), Words{"pages"});
  EXPECT_EQ(completed("fettle render scan.tif p.png --zoom ''"), Words{});
}

TEST_F(Reference, TheScriptsOfOtherShellsAreReadByThem) {
  int read = 0;
  for (const auto& [shell, script] : {std::pair{"zsh", "_fettle"}, std::pair{"fish", "fettle.fish"}}) {
    if (runProcess({"sh", "-c", std::string("command -v ") + shell}).status != 0) continue;
    const Outcome parsed = runProcess({shell, "-n", (pages() / "completion" / script).string()});
    EXPECT_EQ(parsed.status, 0) << parsed.err;
    EXPECT_EQ(parsed.err, "");
    ++read;
  }
  if (read == 0) GTEST_SKIP() << "neither zsh nor fish is installed";
}

TEST_F(Reference, FishKnowsTheCommandByItsPlace) {
  if (runProcess({"sh", "-c", "command -v fish"}).status != 0) GTEST_SKIP() << "fish is not installed";
  const auto offered = [](const std::string& line) {
    return runProcess(
               {"fish", "--no-config", "-c",
                "source " + (pages() / "completion/fettle.fish").string() + "; complete -C '" + line + "'"})
        .out;
  };
  EXPECT_EQ(offered("fettle bench render --azi"), "");  // of fettle render
  EXPECT_EQ(offered("fettle info render --azi"), "");
  EXPECT_NE(offered("fettle render --azi").find("--azimuth"), std::string::npos);
  EXPECT_NE(offered("fettle --json bench render --sce").find("--scene"), std::string::npos);
  EXPECT_NE(offered("fettle filter a b --filter tg").find("tgv"), std::string::npos);
  EXPECT_NE(offered("fettle bench filters --kind tgv,pl").find("tgv,planes"), std::string::npos);
  EXPECT_EQ(offered("fettle help bench acc"), "");  // "accuracy" is no command of "bench"
}

// What is typed and what Tab makes of it, the same in each shell, in a terminal.
TEST_F(Reference, EachShellCompletesValuesInATerminal) {
  const std::vector<std::pair<std::string, std::string>> lines{
      {"fettle info scan.tif --unit ftU", "fettle info scan.tif --unit ftUS"},
      {"fettle info scan.tif --unit=k", "fettle info scan.tif --unit=km"},
      {"fettle info - --from sd", "fettle info - --from sdf"},
      {"fettle convert scan.tif - --to=asc", "fettle convert scan.tif - --to=asc"},
      {"fettle compare a.tif b.tif --to x3", "fettle compare a.tif b.tif --to x3p"},
      {"fettle bench filters --kind tgv,pl", "fettle bench filters --kind tgv,planes"},
      {"fettle bench filters --kind=tgv,med", "fettle bench filters --kind=tgv,median"},
      {"fettle measure scan.tif --only hyb", "fettle measure scan.tif --only hybrid"},
      {"fettle trans", "fettle transform"},
      {"fettle help trans", "fettle help transform"},
      {"fettle help bench hap", "fettle help bench haptic"},
      {"fettle record scan.tif s.csv --device inv", "fettle record scan.tif s.csv --device inverse3"},
  };
  std::vector<std::string> typed;
  typed.reserve(lines.size());
  for (const auto& line : lines) typed.push_back(line.first);
  const std::string scripts = (pages() / "completion").string();
  const struct {
    std::vector<std::string> shell, setup;
  } shells[] = {
      {{"bash", "--norc", "--noprofile", "-i"},
       {"source " + scripts + "/fettle.bash",
        R"(bind -x '"\C-x\C-x": printf "\074%s\076" "$READLINE_LINE"')"}},
      {{"zsh", "-f", "-i"},
       {"fpath=(" + scripts + " $fpath)", "autoload -Uz compinit; compinit -u -D",
        R"(show() { printf '\074%s\076' "$BUFFER" }; zle -N show; bindkey -e; bindkey '^X^X' show)"}},
      {{"fish", "--no-config", "-i"},
       {"source " + scripts + "/fettle.fish", R"(bind \cx\cx 'printf "\074%s\076" (commandline)')"}},
  };
  int tried = 0;
  for (const auto& each : shells) {
    if (runProcess({"sh", "-c", "command -v " + each.shell[0]}).status != 0) continue;
    ++tried;
    const std::vector<std::string> completed = completedInTerminal(each.shell, each.setup, typed);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      // Without the blank that was typed and that of a shell which ends a finished word.
      const std::string got = completed[k].substr(0, completed[k].find_last_not_of(' ') + 1);
      EXPECT_EQ(got, lines[k].second) << each.shell[0];
    }
  }
  EXPECT_GT(tried, 0);  // bash is part of every Debian
}

TEST_F(Reference, EveryExampleRuns) {
  const TempFolder work;  // with the files that the examples name
  ProcessOptions here;
  here.folder = work.path().string();
  const fs::path program = fs::path(FETTLE_PROGRAM).parent_path();
  const auto shell = [&](const std::string& line) {
    return runProcess({"bash", "-c", "PATH=" + program.string() + ":$PATH; " + line}, here);
  };
  ASSERT_EQ(shell("fettle synth scan.tif --size 256x256 --truth truth.tif --edges edges.png && "
                  "fettle synth other.tif --size 64x64 --seed 2 && "
                  "fettle filter scan.tif clean.tif --filter box && "
                  "fettle mark scan.tif marks.png --edges --lines-out lines.csv && "
                  "fettle convert truth.tif nominal.stl && "
                  "fettle transform scan.tif west.tif --crop-samples 0,0,256,160 && "
                  "fettle transform scan.tif east.tif --crop-samples 0,96,256,160")
                .status,
            0);
  std::ofstream strokes(work.file("strokes.csv"));
  strokes << "t,x,y,z,tool\n";
  for (int k = 0; k < 200; ++k)
    strokes << 0.001 * k << "," << 1.0 + 0.01 * k << ",2.0,0.0," << (k % 100 < 50 ? "smooth" : "mark")
            << "\n";
  strokes.close();
  std::ofstream(work.file("clean.toml")) << "recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\n";
  int run = 0;
  forEach([&](const nlohmann::json& command) {
    for (const auto& example : command["examples"]) {
      const Outcome outcome = shell(example["line"].get<std::string>());
      EXPECT_EQ(outcome.status, 0) << example["line"] << "\n" << outcome.err;
      ++run;
    }
  });
  EXPECT_GT(run, 12);
}

}  // namespace
}  // namespace fettle::tests

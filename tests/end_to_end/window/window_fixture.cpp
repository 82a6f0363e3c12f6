#include "tests/end_to_end/window/window_fixture.h"

#include <cmath>
#include <cstdlib>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "engine/formats/formats.h"
#include "tests/support/process.h"

namespace fettle::tests {

engine::Version load(const std::string& path) {
  engine::JobControl job;
  auto field = engine::importField(path, {}, job);
  if (!field) {
    ADD_FAILURE() << field.error().line();
    std::abort();
  }
  return field->field;
}

Differences compare(const engine::Version& a, const engine::Version& b) {
  Differences d;
  const engine::FieldReader x = a.reader(), y = b.reader();
  for (std::int32_t r = 0; r < x.height(); ++r)
    for (std::int32_t c = 0; c < x.width(); ++c) {
      const float p = x.heightAt(c, r), q = y.heightAt(c, r);
      const bool differs = !(p == q || (std::isnan(p) && std::isnan(q)));
      d.marked += y.markedAt(c, r);
      if (!differs) continue;
      ++d.changed;
      d.changed_marked += y.markedAt(c, r);
      d.most = std::max(d.most, std::abs(static_cast<double>(p) - static_cast<double>(q)));
      if (d.first_row < 0) d.first_row = r;
      d.last_row = r;
      d.first_column = d.first_column < 0 ? c : std::min(d.first_column, c);
      d.last_column = std::max(d.last_column, c);
    }
  return d;
}

WindowTest::WindowTest(int width, int height, Frames frames)
    : display(width, height, folder.path(),
              frames == Frames::kShared ? std::vector<std::string>{}
                                        : std::vector<std::string>{"-extension", "MIT-SHM"}),
      other(display.name()),
      width_(width),
      height_(height) {}

void WindowTest::SetUp() {
  if (!display.works()) GTEST_SKIP() << "no Xvfb";
  setenv("DISPLAY", display.name().c_str(), 1);
  setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
  setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  setenv("XDG_DATA_HOME", folder.path().c_str(), 1);
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "320x320", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  // Strokes are marks, each a step: whether an edge is found along one is not what most of these tests are about.
  const std::filesystem::path settings = folder.path() / "fettle";
  std::filesystem::create_directories(settings);
  std::ofstream(settings / "window.json") << User::State{{"edge_lines", false}};
}

std::unique_ptr<ViewProgram> WindowTest::start(std::vector<std::string> arguments,
                                               const std::map<std::string, std::string>& environment,
                                               AtRest at_rest) const {
  if (at_rest == AtRest::kPlain) arguments.emplace_back("--plain-rest");
  if (std::find(arguments.begin(), arguments.end(), "--size") == arguments.end())
    arguments.insert(arguments.end(), {"--size", std::to_string(width_) + "x" + std::to_string(height_)});
  return std::make_unique<ViewProgram>(arguments, environment);
}

User::State WindowTest::opened(ViewProgram& program) {
  return program.until("the scan is shown", [](const User::State& s) {
    return s["loading"] == false && !s["path"].get<std::string>().empty() && s["settled"] == true;
  });
}

void WindowTest::saveAs(User& user, const std::string& path) {
  ViewProgram& program = user.program();
  (void)user.press("ctrl+shift+s");
  program.until("a dialog",
                [](const User::State& s) { return s["dialog"] == "save as" && s["settled"] == true; });
  user.type(path);
  (void)user.press("Return");
  program.until("written", [&](const User::State& s) {
    return s["dialog"] == "none" && s["saving"] == false &&
           s["status"].get<std::string>().find(path) != std::string::npos;
  });
}

User::State WindowTest::endOf(ViewProgram& program) {
  EXPECT_EQ(program.wait(), 0) << program.err();
  expectSilence(program);
  return program.report();
}

User::State WindowTest::quit(User& user) {
  (void)user.press("ctrl+q");
  return endOf(user.program());
}

User::State WindowTest::quitWithoutSaving(User& user) {
  (void)user.press("ctrl+q");
  (void)user.program().until(
      "a question", [](const User::State& s) { return s["dialog"] == "unsaved" && s["settled"] == true; });
  (void)user.press("Delete");
  return endOf(user.program());
}

void WindowTest::expectSilence(const ViewProgram& program) {
  const User::State report = program.report();
  EXPECT_EQ(report.value("validation_messages", User::State()), User::State::array());
}

}  // namespace fettle::tests

// What keys may ask for is drawn before they do: the driver finds its shaders compiled when they are pressed.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

class RehearsalTest : public WindowTest {
 protected:
  // Mesa writes a file for each shader that it compiles, the last ones when the program ends.
  [[nodiscard]] std::ptrdiff_t compiled() const {
    const std::filesystem::recursive_directory_iterator all(cache());
    return std::count_if(begin(all), end(all), [](const auto& entry) { return entry.is_regular_file(); });
  }
  [[nodiscard]] std::map<std::string, std::string> environment() const {
    std::filesystem::create_directories(cache());
    return {{"MESA_SHADER_CACHE_DIR", cache().string()}};
  }
  void showUntilRehearsed(const std::string& path) const {
    const auto program = start({path}, environment());
    // It lets everything else go first: beside other programs it takes minutes.
    (void)program->until(
        "the rehearsal", [](const State& s) { return s.value("rehearsed", false); },
        5 * ViewProgram::kPatience);
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
  }
  void pressKeys(const std::string& path, const std::vector<std::string>& keys) {
    const auto program = start({path}, environment());
    User user(display, *program, "rehearsal");
    const State picture = opened(*program)["picture"];
    user.at({static_cast<int>(picture[0]) + static_cast<int>(picture[2]) / 2,
             static_cast<int>(picture[1]) + static_cast<int>(picture[3]) / 2});
    for (const std::string& key : keys) {
      // Over the middle of the picture.
      (void)(key == "wheel" ? user.wheel(40) : user.key(key));
      if (key == "p")
        (void)program->until("all of the preview", [](const State& s) { return s["filtering"] == false; });
    }
    (void)quit(user);
  }

 private:
  [[nodiscard]] std::filesystem::path cache() const { return folder.path() / "shaders"; }
};

const std::vector<std::string> kKeys{"c", "p", "d",       "c",    "5", "d",
                                     "c", "5", "Page_Up", "Home", "t", "Escape"};

TEST_F(RehearsalTest, what_keys_ask_for_is_compiled_before) {
  showUntilRehearsed(scan);
  const std::ptrdiff_t before = compiled();
  pressKeys(scan, kKeys);
  EXPECT_EQ(compiled(), before);
}

// Without it they are compiled when they are pressed.
TEST_F(RehearsalTest, keys_compile_what_was_not_rehearsed) {
  pressKeys(scan, {});
  const std::ptrdiff_t before = compiled();
  ASSERT_GT(before, 0) << "this driver keeps no shaders";
  pressKeys(scan, kKeys);
  EXPECT_GT(compiled(), before + 5);
}

// Of a field on demand the samples lie in other images. A preview of means has a few pages only.
TEST_F(RehearsalTest, a_large_field_is_rehearsed_as_it_is_drawn) {
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "4000x3000", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  // The coarse picture while it is read, which only a slow machine comes to draw, lies in one image as a small field's.
  pressKeys(scan, {});
  showUntilRehearsed(large);
  const std::ptrdiff_t before = compiled();
  pressKeys(large, {"c", "d", "c", "d", "Page_Up", "Home", "p", "c", "c"});
  EXPECT_EQ(compiled(), before);
}

// Its cells are smaller than a pixel also where those of other fields are not any more; seen from near, a preview has larger ones, too.
TEST_F(RehearsalTest, a_long_field_is_rehearsed_from_near) {
  const std::string strip = folder.file("long.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", strip, "--size", "60000x96", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  pressKeys(scan, {});
  showUntilRehearsed(strip);
  const std::ptrdiff_t before = compiled();
  pressKeys(strip, {"7", "wheel", "c", "d", "c", "d", "p", "c"});
  EXPECT_EQ(compiled(), before);
}

}  // namespace
}  // namespace fettle::tests

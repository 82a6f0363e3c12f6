#include "app/files/import_form.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(ImportForm, without_a_text_says_nothing) {
  const auto options = ImportForm().read();
  ASSERT_TRUE(options);
  EXPECT_EQ(scanOptionsText(*options), "");
}

TEST(ImportForm, is_what_the_command_line_would_say_and_comes_back) {
  ImportForm form;
  form.spacing_x = " 0,5 ";
  form.unit = "um";
  form.z_scale = "+2e-3";
  form.no_data = "-9999";
  form.cell_size = "0.25";
  form.cell_rule = "highest";
  const auto options = form.read();
  ASSERT_TRUE(options) << options.error().line();
  EXPECT_EQ(
      scanOptionsText(*options),
      " --no-data -9999 --spacing 0.5,0.5 --z-scale 0.002 --unit um --cell-size 0.25 --cell-rule highest");
  const auto import = importOptions(*options);
  ASSERT_TRUE(import);
  EXPECT_EQ(scanOptionsText(scanOptionsOf(*import)), scanOptionsText(*options));
  EXPECT_EQ(scanOptionsText(*ImportForm::of(*options).read()), scanOptionsText(*options));
}

TEST(ImportForm, keeps_other_row_distances_and_a_camera) {
  ImportForm form;
  form.spacing_x = "0.1";
  form.spacing_y = "0.4";
  EXPECT_EQ(scanOptionsText(*form.read()), " --spacing 0.1,0.4");
  EXPECT_EQ(ImportForm::of(*form.read()).spacing_y, "0.4");
  form = {};
  form.camera = {"500", "501", "320", "-1"};
  EXPECT_EQ(scanOptionsText(*form.read()), " --depth-camera 500,501,320,-1");
  const auto import = importOptions(*form.read());
  EXPECT_EQ(scanOptionsText(scanOptionsOf(*import)), " --depth-camera 500,501,320,-1");
  // One number is what a maker states.
  form.camera = {"500", "", "", ""};
  EXPECT_EQ(scanOptionsText(*form.read()), " --depth-camera 500");
  EXPECT_EQ(scanOptionsText(scanOptionsOf(*importOptions(*form.read()))), " --depth-camera 500,500");
  EXPECT_EQ(ImportForm::of(*form.read()).camera[0], "500");
  form.camera = {"500", "", "1", "2"};
  EXPECT_EQ(scanOptionsText(*form.read()), " --depth-camera 500,500,1,2");
  ScanOptions three;
  three.depth_camera = {1.0, 2.0, 3.0};
  EXPECT_EQ(importOptions(three).error().where, "--depth-camera");
}

TEST(ImportForm, names_the_field_that_cannot_be_read_and_what_it_takes) {
  const auto wrong = [](auto set, const char* where) {
    ImportForm form;
    set(form);
    const auto options = form.read();
    ASSERT_FALSE(options) << where;
    EXPECT_EQ(options.error().kind, engine::ErrorKind::kInput);
    EXPECT_EQ(options.error().where, where);
    EXPECT_FALSE(options.error().remedy.empty());
  };
  for (const char* text : {"0", "-1", "nan", "inf", "1 mm", "1.2.3", "x"})
    wrong([&](ImportForm& form) { form.spacing_x = text; }, "spacing");
  wrong([](ImportForm& form) { form.spacing_y = "1"; }, "spacing");
  wrong([](ImportForm& form) { form.z_scale = "0"; }, "z scale");
  wrong([](ImportForm& form) { form.no_data = "none"; }, "no data");
  wrong([](ImportForm& form) { form.cell_size = "-2"; }, "cell size");
  wrong([](ImportForm& form) { form.camera = {"1", "1", "1", ""}; }, "depth camera");
  wrong([](ImportForm& form) { form.camera = {"0", "1", "1", "1"}; }, "depth camera");
  wrong([](ImportForm& form) { form.camera = {"", "1", "", ""}; }, "depth camera");
  wrong(
      [](ImportForm& form) {
        form.camera = {"1", "1", "1", "1"};
        form.spacing_x = "1";
      },
      "depth camera");
  wrong([](ImportForm& form) { form.unit = "parsec"; }, "--unit");
}

TEST(ImportForm, takes_any_number_for_holes) {
  ImportForm form;
  for (const char* text : {"nan", "inf", "-1e30", "0"}) {
    form.no_data = text;
    EXPECT_TRUE(form.read()) << text;
  }
}

}  // namespace
}  // namespace fettle::app

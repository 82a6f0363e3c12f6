#include "engine/session/form_codec.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/session/database.h"
#include "engine/session/session.h"
#include "tests/engine/session/play.h"
#include "tests/support/shape_forms.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

FieldForm formOver(const Grid& grid, int degree) {
  PolynomialForm form{degree, grid.width, grid.height, 1.0 / 3.0, {}};
  for (int k = 0; k < PolynomialForm::terms(degree); ++k)
    form.coefficients.push_back(k % 3 == 0   ? -0.0
                                : k % 3 == 1 ? std::numeric_limits<double>::denorm_min()
                                             : -k / 7.0);
  return std::make_shared<const NominalForm>(std::move(form));
}

constexpr FormShape kEveryShape[] = {FormShape::kSphere, FormShape::kCylinder, FormShape::kCone};

FieldForm shapeOver(const Grid& grid, FormShape shape) {
  return std::make_shared<const NominalForm>(someShape(grid, shape, 1.0 / 3.0, 7));
}

std::int64_t sessionFormatOf(const std::string& path) {
  auto database = Database::open(path, DatabaseAccess::kRead, path);
  EXPECT_TRUE(database);
  return (*database)->integer("PRAGMA user_version").value_or(-1);
}

Version withoutMarks(const Version& field) {
  LiveField live(field, Growth::kAllowed);
  for (std::int32_t r = 0; r < field.grid().height; ++r)
    for (std::int32_t c = 0; c < field.grid().width; ++c) EXPECT_TRUE(live.setMark(c, r, false));
  return live.snapshot();
}

TEST(FormCodec, EveryBitComesBack) {
  const Version field = strangeField(1, 90, 70);
  for (int degree = 0; degree <= PolynomialForm::kMostDegree; ++degree) {
    const std::string bytes = packForm(formOver(field.grid(), degree));
    const auto back = unpackForm(bytes, field.grid());
    ASSERT_TRUE(back);
    ASSERT_TRUE(*back);
    EXPECT_EQ(packForm(*back), bytes);
    ASSERT_NE((*back)->polynomial(), nullptr);
    EXPECT_EQ((*back)->polynomial()->degree, degree);
    EXPECT_EQ((*back)->width(), 90);
    EXPECT_EQ((*back)->height(), 70);
    EXPECT_FALSE(isPackedShape(bytes));
  }
  for (const FormShape shape : kEveryShape) {
    const std::string bytes = packForm(shapeOver(field.grid(), shape));
    const auto back = unpackForm(bytes, field.grid());
    ASSERT_TRUE(back);
    ASSERT_TRUE(*back);
    EXPECT_EQ(**back, *shapeOver(field.grid(), shape));
    EXPECT_EQ(packForm(*back), bytes);
    EXPECT_TRUE(isPackedShape(bytes));
  }
  EXPECT_EQ(packForm(nullptr), "");
  const auto none = unpackForm("", field.grid());
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(FormCodec, OtherBytesAreRefused) {
  const Version field = strangeField(1, 90, 70);
  const std::string bytes = packForm(formOver(field.grid(), 2));
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_FALSE(unpackForm(std::string_view(bytes).substr(0, size), field.grid())) << size;
  EXPECT_FALSE(unpackForm(bytes + 'x', field.grid()));
  std::string other = bytes;
  other[0] = 3;
  EXPECT_FALSE(unpackForm(other, field.grid()));
  EXPECT_FALSE(unpackForm(std::string(200, '\xff'), field.grid()));
  for (const double number :
       {std::numeric_limits<double>::infinity(), -1e39, std::numeric_limits<double>::quiet_NaN()}) {
    PolynomialForm form = *formOver(field.grid(), 1)->polynomial();
    form.coefficients[1] = number;
    EXPECT_FALSE(unpackForm(packForm(std::make_shared<const NominalForm>(form)), field.grid()));
  }
}

TEST(FormCodec, ShapesThatHaveNoHeightsAreRefused) {
  const Version field = strangeField(1, 90, 70);
  for (const FormShape shape : kEveryShape) {
    const std::string bytes = packForm(shapeOver(field.grid(), shape));
    for (std::size_t size = 1; size < bytes.size(); ++size)
      EXPECT_FALSE(unpackForm(std::string_view(bytes).substr(0, size), field.grid())) << size;
    EXPECT_FALSE(unpackForm(bytes + 'x', field.grid()));
    const auto refused = [&](const auto& change) {
      ShapeForm form = *shapeOver(field.grid(), shape)->shape();
      change(form);
      return !unpackForm(packForm(std::make_shared<const NominalForm>(form)), field.grid());
    };
    for (const double number :
         {std::numeric_limits<double>::infinity(), -1e39, std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.base = number; }));
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.column = number; }));
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.curvature = number; }));
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.normal.x = number; }));
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.axis.z = number; }));
      EXPECT_TRUE(refused([&](ShapeForm& f) { f.height_mm = number; }));
    }
    EXPECT_TRUE(refused([](ShapeForm& f) { f.curvature = 0.0; }));
    EXPECT_TRUE(refused([](ShapeForm& f) { f.spacing_x_mm = 0.0; }));
    EXPECT_TRUE(refused([](ShapeForm& f) { f.normal = {1.0, 0.0, 0.0}; }));
    EXPECT_TRUE(refused([](ShapeForm& f) { f.normal = -f.normal; }));
    EXPECT_TRUE(refused([](ShapeForm& f) { f.axis *= 1.01; }));
    std::string other = bytes;
    other[0] = 19;
    EXPECT_FALSE(unpackForm(other, field.grid()));
  }
  EXPECT_TRUE(unpackForm(packForm(shapeOver(field.grid(), FormShape::kCylinder)), field.grid()));
}

TEST(SessionForms, OnlyASessionWithAFormNeedsAProgramThatKnowsThem) {
  const tests::TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  Session session;
  session.original = strangeField(1, 90, 70);
  session.scan.format = "none";
  session.history = History(session.original);
  ASSERT_TRUE(saveSession(session, path, job));
  EXPECT_EQ(sessionFormatOf(path), 1);
  session.history.push({"Form", StepKind::kForm, {}, {}, 0},
                       session.original.withForm(formOver(session.original.grid(), 1)));
  EXPECT_EQ(session.history.bytes(), 0U);
  session.history.push({"Form", StepKind::kForm, {}, {}, 0}, session.original);
  ASSERT_TRUE(saveSession(session, path, job));
  EXPECT_EQ(sessionFormatOf(path), 3);
  EXPECT_EQ(differenceOnDisk(session, path), "");
  // A shape asks for a program that knows shapes.
  Session shaped = session;
  for (const FormShape shape : kEveryShape)
    shaped.history.push({"Form", StepKind::kForm, {}, {}, 0},
                        session.original.withForm(shapeOver(session.original.grid(), shape)));
  ASSERT_TRUE(saveSession(shaped, path, job));
  EXPECT_EQ(sessionFormatOf(path), 4);
  EXPECT_EQ(differenceOnDisk(shaped, path), "");
  // Nothing was stored of the heights, in nor out.
  const auto size = saveSession(session, path, job);
  ASSERT_TRUE(size);
  Session plain = session;
  plain.history = History(session.original);
  EXPECT_EQ(saveSession(plain, path, job)->tiles, size->tiles);
}

TEST(SessionForms, AFieldWithAFormGoesInAndComesOutWithIt) {
  const tests::TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  const Version plain = strangeField(2, 90, 70);
  for (const FieldForm& form : {formOver(plain.grid(), 3), shapeOver(plain.grid(), FormShape::kSphere),
                                shapeOver(plain.grid(), FormShape::kCone)})
    for (const Version& worked : {plain, strangeField(3, 90, 70)})
      for (const Version& formed : {worked.withForm(form), worked.withForm(form).inverted()}) {
        ExportOptions options;
        options.original = formed.reader().sign() < 0.0F ? plain.inverted() : plain;
        ASSERT_TRUE(exportField(formed, path, options, job));
        const auto read = importField(path, {}, job);
        ASSERT_TRUE(read) << read.error().line();
        // What is read is what is seen, of the scan as well; and the same samples lie under it.
        EXPECT_EQ(difference(SeenField::of(formed, job)->seen(), read->field), "");
        EXPECT_EQ(difference(*restored(read->field, job), formed), "");
        ASSERT_TRUE(read->original);
        EXPECT_EQ(difference(*restored(*read->original, job), options.original->withForm(form)), "");
      }
}

TEST(SessionForms, WhatIsSeenIsWrittenWithItsForm) {
  const tests::TempFolder folder;
  JobControl job;
  const Version plain = strangeField(5, 150, 70);
  const SeenField seen = *SeenField::of(plain.withForm(formOver(plain.grid(), 2)), job);
  LiveField live(seen.seen(), Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(3, 4, 0.5F));
  const Version edited = *restored(live.snapshot(), job);
  EXPECT_EQ(changedTiles(edited, plain).size(), 1U);
  // A format without a layer gets the samples, and says so; a session both.
  const auto tif = exportField(live.snapshot(), folder.file("a.tif"), {}, job);
  ASSERT_TRUE(tif) << tif.error().line();
  ASSERT_EQ(tif->warnings.size(), 1U);
  EXPECT_NE(tif->warnings[0].find("with the form"), std::string::npos);
  EXPECT_EQ(contentHash(importField(folder.file("a.tif"), {}, job)->field.withForm(nullptr)),
            contentHash(withoutMarks(edited)));
  const auto session = exportField(live.snapshot(), folder.file("a.fettle"), {}, job);
  ASSERT_TRUE(session);
  EXPECT_TRUE(session->warnings.empty());
  EXPECT_EQ(difference(*restored(importField(folder.file("a.fettle"), {}, job)->field, job), edited), "");
  // Baked, it is a field as any other.
  const Version baked = live.snapshot().withSeenOf(nullptr);
  EXPECT_EQ(*restored(baked, job), baked);
  // With another unit it is still the same numbers.
  Grid metres = plain.grid();
  metres.height_unit = {"m", 1000.0};
  EXPECT_EQ(restored(live.snapshot().withGrid(metres), job)->grid().height_unit.name, "m");
  // Another field, as it is seen under that form.
  EXPECT_EQ(contentHash(*seenLike(plain, seen.seen(), job)), contentHash(seen.seen()));
  EXPECT_EQ(contentHash(*seenLike(seen.seen(), plain, job)), contentHash(plain));
  EXPECT_EQ(*seenLike(plain, plain, job), plain);
}

}  // namespace
}  // namespace fettle::engine

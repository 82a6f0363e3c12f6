// Nominal shapes from STL files: whole ones, damaged ones, hostile ones.

#include "engine/io/mesh/nominal_file.h"

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/io/mesh/stl_file.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

std::string bytesOfFloat(float value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

// A square of two triangles, 10 x 10 at z = 2; `first` is the first coordinate.
std::string binaryStl(std::uint32_t counted, float first = 0.0F, std::string head = "exported") {
  head.resize(80, ' ');
  std::string out = head;
  for (int k = 0; k < 4; ++k) out += static_cast<char>((counted >> (8 * k)) & 255U);
  const float corners[2][9] = {{first, 0, 2, 10, 0, 2, 10, 10, 2}, {0, 0, 2, 10, 10, 2, 0, 10, 2}};
  for (const auto& triangle : corners) {
    out += std::string(12, '\0');
    for (const float value : triangle) out += bytesOfFloat(value);
    out += std::string(2, '\0');
  }
  return out;
}

std::string textStl(const std::string& first = "0", const std::string& end = "endsolid part\n") {
  return fmt::format(
      "solid part\n facet normal 0 0 1\n  outer loop\n   vertex {} 0 2\n   vertex 10 0 2\n   vertex 10 10 2\n"
      "  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 2\n   vertex 1e1 10 2\n   "
      "vertex 0 "
      "10 2\n  endloop\n endfacet\n{}",
      first, end);
}

Result<NominalFile> fileOf(const std::string& path, const std::optional<LengthUnit>& unit = {}) {
  JobControl job;
  return readNominal(path, unit, job);
}

Result<NominalMesh> nominalOf(const std::string& path, const std::optional<LengthUnit>& unit = {}) {
  Result<NominalFile> read = fileOf(path, unit);
  if (!read) return tl::unexpected(read.error());
  return std::move(read->mesh);
}

TEST(NominalFile, TrianglesAreCountedBeforeTheyAreRead) {
  const TempFolder folder;
  writeBytes(folder.file("b.stl"), binaryStl(2));
  const auto file = InputFile::open(folder.file("b.stl"));
  ASSERT_TRUE(file);
  JobControl job;
  ASSERT_TRUE(readStlMesh(*file, job));
  EXPECT_STREQ(job.stage(), "reading");
  EXPECT_EQ(job.total(), 2U);
}

TEST(NominalFile, ReadsBytesAndTextAlike) {
  const TempFolder folder;
  writeBytes(folder.file("b.stl"), binaryStl(2));
  writeBytes(folder.file("s.stl"), binaryStl(2, 0.0F, "solid, but of bytes"));
  writeBytes(folder.file("t.stl"), textStl());
  for (const char* name : {"b.stl", "s.stl", "t.stl"}) {
    const auto mesh = nominalOf(folder.file(name));
    ASSERT_TRUE(mesh) << mesh.error().line();
    EXPECT_EQ(mesh->triangles().size(), 2U);
    EXPECT_EQ(mesh->corners().size(), 4U);
    EXPECT_EQ(mesh->openSides(), 4U);
    EXPECT_EQ(mesh->box().high, glm::dvec3(10, 10, 2));
    const auto inches = nominalOf(folder.file(name), LengthUnit{"in", 25.4});
    ASSERT_TRUE(inches);
    EXPECT_EQ(inches->box().high, glm::dvec3(254, 254, 50.8));
  }
  writeBytes(folder.file("far.stl"), textStl("-4999990"));
  const auto far = nominalOf(folder.file("far.stl"));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->corner().x, -4999990.0);
}

TEST(NominalFile, AHeaderSaysUnitAndZeroToTheLastDigit) {
  LengthUnit unit{"ftUS", 304.8006096012192};
  for (const double x : {0.0, 0.1, -5000000.125, -1.2345678901234567e-105, 1e15})
    for (const double y : {0.0, 1.0 / 3.0, -1.2345678901234567e-105}) {
      const std::string text = stlHeader(unit, {x, y});
      ASSERT_EQ(text.size(), 80U);
      EXPECT_NE(text.substr(0, 5), "solid");
      const StlHeader read = stlHeaderOf(text);
      EXPECT_EQ(read.unit, unit) << text;
      EXPECT_EQ(read.zero, glm::dvec2(x, y)) << text;
    }
  unit.name = std::string(90, 'u');
  const glm::dvec2 zero(7.0, -1.2345678901234567e-105);
  EXPECT_EQ(stlHeaderOf(stlHeader(unit, zero)).zero, zero);
  EXPECT_FALSE(stlHeaderOf(stlHeader(unit, zero)).unit);
}

TEST(NominalFile, OtherHeadersMoveNothing) {
  for (const char* text : {"", "exported", "field, units mm, zero at ", "field, zero at 1",
                           "field, zero at 1,2", "field, zero at 1 x", "field, zero at nan 1",
                           "field, zero at 1 inf", "field, zero at 1e16 0", "field, zero at 1 -1e300"}) {
    std::string head = text;
    head.resize(80, ' ');
    EXPECT_EQ(stlHeaderOf(head).zero, glm::dvec2(0.0)) << text;
    EXPECT_EQ(stlHeaderOf(text).zero, glm::dvec2(0.0)) << text;
  }
  std::string padded = "units in, zero at 1 2";
  padded.resize(80, '\0');
  EXPECT_FALSE(stlHeaderOf(padded).unit);
  EXPECT_EQ(stlHeaderOf(padded).zero, glm::dvec2(0.0));
}

TEST(NominalFile, TheUnitIsTheTypedOneElseTheStatedElseMillimetres) {
  const TempFolder folder;
  writeBytes(folder.file("a.stl"), binaryStl(2, 0.0F, "field, units um, zero at -4 1000.5"));
  writeBytes(folder.file("b.stl"), binaryStl(2));
  const auto stated = fileOf(folder.file("a.stl")),
             typed = fileOf(folder.file("a.stl"), LengthUnit{"in", 25.4}),
             none = fileOf(folder.file("b.stl"));
  ASSERT_TRUE(stated && typed && none);
  EXPECT_EQ(stated->unit.name, "um");
  EXPECT_EQ(stated->mesh.corner(), glm::dvec3(-4e-3, 1000.5e-3, 0.0));
  EXPECT_DOUBLE_EQ(stated->mesh.box().high.x, 10e-3);
  EXPECT_EQ(typed->unit.name, "in");
  EXPECT_EQ(typed->mesh.corner(), 25.4 * glm::dvec3(-4, 1000.5, 0.0));
  EXPECT_EQ(none->unit.name, "mm");
  EXPECT_EQ(none->mesh.corner(), glm::dvec3(0.0));
}

TEST(NominalFile, RefusesDamagedFilesByWhatIsWrong) {
  const TempFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const struct {
    std::string bytes;
    const char* text;
  } cases[] = {
      {binaryStl(3), "the file is too short for 3 triangles"},
      {binaryStl(0xFFFFFFFFU), "the file is too short for 4294967295 triangles"},
      {binaryStl(1), "its header counts 1 triangles, its bytes are those of 2"},
      {binaryStl(0), "its header counts 0 triangles"},
      {binaryStl(2, nan), "triangle 1 has a corner that is not finite"},
      {binaryStl(2, inf), "triangle 1 has a corner that is not finite"},
      {binaryStl(2, 1e30F), "triangle 1 has a corner that is not finite or beyond 1e15 mm"},
      {binaryStl(2).substr(0, 100), "too short"},
      {binaryStl(2).substr(0, 30), "too short"},
      {textStl("nan"), "triangle 1 has a corner that is not finite"},
      {textStl("1e400"), "triangle 1 has a corner that is not finite"},
      {textStl("ten"), "corner 1 does not hold three numbers"},
      {textStl("0", ""), "ends before its endsolid"},
      {"solid nothing\nendsolid nothing\n", "no triangle that has an area"},
      {"ply\nformat ascii 1.0\n", "the PLY header has no end"},
  };
  int number = 0;
  for (const auto& one : cases) {
    const std::string path = folder.file(fmt::format("{}.stl", ++number));
    writeBytes(path, one.bytes);
    const auto mesh = nominalOf(path);
    ASSERT_FALSE(mesh) << one.text;
    EXPECT_EQ(mesh.error().kind, ErrorKind::kInput);
    EXPECT_NE(mesh.error().line().find(one.text), std::string::npos) << mesh.error().line();
    EXPECT_NE(mesh.error().line().find(path), std::string::npos) << mesh.error().line();
  }
  EXPECT_FALSE(nominalOf(folder.file("none.stl")));
  // Some bytes behind the triangles, as some programs leave there, are no triangle.
  writeBytes(folder.file("more.stl"), binaryStl(2) + "attributes");
  EXPECT_TRUE(nominalOf(folder.file("more.stl")));
}

}  // namespace
}  // namespace fettle::engine

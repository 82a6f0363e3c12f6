// OpenEXR pictures of other programs, made with its library.

#include <cmath>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

constexpr int kWidth = 70, kHeight = 41;

std::vector<float> ramp() {
  std::vector<float> z;
  for (int i = 0; i < kWidth * kHeight; ++i) z.push_back(static_cast<float>(i % 97) * 0.25F - 3.0F);
  return z;
}

// A picture whose window does not begin at 0, 0, with channel `name` and, if asked, transparency.
void writeExr(const std::string& path, const std::string& name, Imf::PixelType type, bool tiled, bool alpha,
              Imf::Compression compression = Imf::PIZ_COMPRESSION) {
  const Imath::Box2i window({-5, 7}, {-5 + kWidth - 1, 7 + kHeight - 1});
  Imf::Header header(window, window);
  header.compression() = compression;
  header.channels().insert(name, Imf::Channel(type));
  if (alpha) header.channels().insert("A", Imf::Channel(Imf::FLOAT));
  std::vector<float> z = ramp(), a(z.size(), 1.0F);
  std::vector<half> h(z.begin(), z.end());
  a[3] = 0.0F;
  Imf::FrameBuffer frame;
  const auto slice = [&](Imf::PixelType t, void* data, std::size_t bytes) {
    return Imf::Slice::Make(t, data, window, bytes, bytes * kWidth);
  };
  frame.insert(
      name, type == Imf::HALF ? slice(type, h.data(), sizeof(half)) : slice(type, z.data(), sizeof(float)));
  if (alpha) frame.insert("A", slice(Imf::FLOAT, a.data(), sizeof(float)));
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(16, 32));
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(kHeight);
  }
}

TEST(Exr, LinesAndTilesFloatsAndHalvesAreRead) {
  const TempFolder folder;
  for (const char* name : {"Y", "Z", "R", "quota"})
    for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF})
      for (const bool tiled : {false, true}) {
        writeExr(folder.file("a.exr"), name, type, tiled, false);
        FETTLE_LOAD(scan, folder.file("a.exr"));
        EXPECT_EQ(scan.format, "EXR");
        ASSERT_EQ(scan.field.grid().width, kWidth);
        ASSERT_EQ(scan.field.grid().height, kHeight);
        const auto z = ramp();  // quarters: exact as halves
        for (int r = 0; r < kHeight; ++r)
          for (int c = 0; c < kWidth; ++c)
            ASSERT_EQ(stored(scan.field, r, c), z[static_cast<std::size_t>(r * kWidth + c)]) << r << " " << c;
        EXPECT_TRUE(warned(scan.warnings, "states no unit"));
      }
}

TEST(Exr, WhatIsTransparentIsAHole) {
  const TempFolder folder;
  writeExr(folder.file("a.exr"), "Y", Imf::FLOAT, false, true);
  FETTLE_LOAD(scan, folder.file("a.exr"));
  EXPECT_TRUE(std::isnan(stored(scan.field, 0, 3)));
  EXPECT_EQ(summarize(scan.field).no_data, 1);
  EXPECT_FALSE(warned(scan.warnings, "channels"));
}

TEST(Exr, AttributesOfTwoGigabytesAreRefusedBeforeMemoryIsTaken) {
  const TempFolder folder;
  Grid grid = gridOf(3, 2);
  ASSERT_TRUE(save(makeField(grid, {1, 2, 3, 4, 5, 6}), folder.file("a.exr")));
  const std::string whole = readBytes(folder.file("a.exr"));
  const std::string name("fettle\0string\0", 14);
  const std::size_t at = whole.find(name);
  ASSERT_NE(at, std::string::npos);
  std::string lying = whole;
  lying.replace(at + name.size(), 4, "\xff\xff\xff\x7f");
  writeBytes(folder.file("lying.exr"), lying);
  const auto scan = load(folder.file("lying.exr"));
  ASSERT_FALSE(scan);
  EXPECT_NE(scan.error().what.find("attributes"), std::string::npos) << scan.error().line();
}

TEST(Exr, ValuesThatAreNotAsLongAsTheyAreSaidToBeAreRefused) {
  // The library reads some by their type and others by the size that is said: between the two it would lose
  // its place and take any four bytes for a size.
  const TempFolder folder;
  ASSERT_TRUE(save(makeField(gridOf(3, 2), {1, 2, 3, 4, 5, 6}), folder.file("a.exr")));
  const std::string whole = readBytes(folder.file("a.exr"));
  for (const std::string& name :
       {std::string("channels\0chlist\0", 16), std::string("dataWindow\0box2i\0", 17),
        std::string("compression\0compression\0", 24), std::string("screenWindowCenter\0v2f\0", 23)}) {
    const std::size_t at = whole.find(name);
    ASSERT_NE(at, std::string::npos) << name;
    for (const int more : {-1, 1, 60}) {
      std::string lying = whole;
      lying[at + name.size()] = static_cast<char>(lying[at + name.size()] + more);
      writeBytes(folder.file("lying.exr"), lying);
      const auto scan = load(folder.file("lying.exr"));
      ASSERT_FALSE(scan) << name << more;
      EXPECT_NE(scan.error().what.find("attributes"), std::string::npos) << scan.error().line();
    }
  }
}

TEST(Exr, DamagedAndLyingPicturesAreRefused) {
  const TempFolder folder;
  for (const bool tiled : {false, true}) {
    writeExr(folder.file("a.exr"), "Y", Imf::FLOAT, tiled, true, Imf::ZIP_COMPRESSION);
    const std::string whole = readBytes(folder.file("a.exr"));
    FETTLE_LOAD(sound, folder.file("a.exr"));
    EXPECT_EQ(summarize(sound.field).no_data, 1);
    for (std::size_t bytes = 4; bytes < whole.size(); bytes += bytes < 500 ? 13 : 211) {
      writeBytes(folder.file("cut.exr"), whole.substr(0, bytes));
      ::testing::internal::CaptureStderr();
      const auto cut = load(folder.file("cut.exr"));
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
      ASSERT_FALSE(cut) << bytes;
      EXPECT_EQ(cut.error().kind, ErrorKind::kInput);
    }
    const std::size_t window = whole.find("dataWindow");
    ASSERT_NE(window, std::string::npos);
    for (const char* corner :
         {"\xff\xff\xff\x7f", "\x00\x00\x00\x80", "\xff\xff\x03\x00", "\x00\x20\x00\x00"}) {
      std::string lying = whole;
      lying.replace(window + 11 + 6 + 4 + 8, 8, std::string(corner, 4) + std::string(corner, 4));
      writeBytes(folder.file("lying.exr"), lying);
      const auto scan = load(folder.file("lying.exr"));
      ASSERT_FALSE(scan);
      EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    }
    // Any damage is refused or harmless, and never said on stderr.
    std::uint32_t state = 3;
    const auto random = [&state] { return state = state * 1664525U + 1013904223U, state >> 8; };
    int refused = 0;
    for (int round = 0; round < 200; ++round) {
      std::string bad = whole;
      bad[random() % bad.size()] = static_cast<char>(random());
      writeBytes(folder.file("bad.exr"), bad);
      ::testing::internal::CaptureStderr();
      const auto scan = load(folder.file("bad.exr"));
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
      refused += scan ? 0 : 1;
    }
    EXPECT_GT(refused, 50);
  }
}

}  // namespace
}  // namespace fettle::engine

// What BlockPacker makes is a zlib stream of the predictor's bytes, computed here again in plain code, and
// GDAL reads the files made of such blocks bit for bit.
#include "engine/io/tiff/block_packer.h"
#include "engine/formats/formats.h"

#include <bit>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>
#include <vector>

#include <gdal.h>
#include <gdal_frmts.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <zlib.h>

#include "engine/io/tiff/block_unpacker.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

std::vector<float> anyFloats(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values{0.0F, -0.0F, FLT_MIN, FLT_TRUE_MIN, -FLT_TRUE_MIN, FLT_MAX, -FLT_MAX, kNan};
  while (values.size() < count) {
    const float v = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    values.push_back(std::isfinite(v) ? v : kNan);
  }
  values.resize(count);
  return values;
}

std::vector<float> slope(std::size_t count, std::size_t columns) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = static_cast<float>(i % columns) * 0.01F + static_cast<float>(i / columns) * 0.25F;
  return values;
}

// Byte by byte, as the technical note says.
std::vector<std::uint8_t> predicted(const std::vector<float>& samples, std::size_t columns) {
  std::vector<std::uint8_t> out;
  for (std::size_t at = 0; at < samples.size(); at += columns) {
    std::uint8_t before = 0;
    for (const int shift : {24, 16, 8, 0})
      for (std::size_t i = at; i < at + columns; ++i) {
        const auto byte = static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(samples[i]) >> shift);
        out.push_back(static_cast<std::uint8_t>(byte - before));
        before = byte;
      }
  }
  return out;
}

TEST(BlockPacker, AnyInflaterFindsThePredictedBytes) {
  BlockPacker packer;  // one for all: nothing of a block may stay for the next
  for (const std::size_t columns : {1U, 2U, 3U, 15U, 16U, 17U, 255U, 256U, 1000U})
    for (const std::size_t rows : {1U, 2U, 7U, 256U}) {
      const std::size_t count = columns * rows;
      for (const std::vector<float>& samples :
           {anyFloats(count, 7), slope(count, columns), std::vector<float>(count, 1.5F),
            std::vector<float>(count, kNan), std::vector<float>(count, 0.0F)}) {
        const auto packed = packer.pack(samples, columns);
        ASSERT_FALSE(packed.empty());
        std::vector<std::uint8_t> bytes(4 * count + 1);
        uLongf size = bytes.size();
        ASSERT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
        bytes.resize(size);
        ASSERT_EQ(bytes, predicted(samples, columns)) << columns << " x " << rows;
      }
    }
}

TEST(BlockPacker, WhatDoesNotPackGrowsLittleAndWhatRepeatsBecomesSmall) {
  BlockPacker packer;
  const std::size_t bytes = std::size_t{4} * 256 * 256;
  EXPECT_LT(packer.pack(anyFloats(bytes / 4, 3), 256).size(), bytes + bytes / 100);
  EXPECT_LT(packer.pack(std::vector<float>(bytes / 4, 2.5F), 256).size(), bytes / 100);
  EXPECT_LT(packer.pack(slope(bytes / 4, 256), 256).size(), bytes / 2);
}

TEST(BlockUnpacker, GivesBackWhatWasPackedAndRefusesDamage) {
  const TempFolder folder;
  const std::string path = folder.file("block");
  BlockPacker packer;
  BlockUnpacker unpacker;
  std::vector<char> out;
  for (const std::size_t columns : {1U, 3U, 17U, 256U, 1000U})
    for (const std::vector<float>& samples : {anyFloats(columns * 200, 4), slope(columns * 200, columns)}) {
      const auto packed = packer.pack(samples, columns);
      std::string bytes = "head" + std::string(packed.begin(), packed.end()) + "tail";
      const PackedBlock block{4, packed.size(), columns, 4, 3};
      const auto unpack = [&](std::size_t rows) {
        writeBytes(path, bytes);
        const auto file = InputFile::open(path);
        return file && unpacker.unpack(*file, block, rows, out);
      };
      for (const std::size_t rows : {200U, 1U, 7U}) {
        ASSERT_TRUE(unpack(rows)) << columns;
        ASSERT_EQ(std::memcmp(out.data(), samples.data(), 4 * rows * columns), 0) << columns << ' ' << rows;
      }
      EXPECT_FALSE(unpack(201));
      // The checksum at the end, a bit in the middle.
      for (const std::size_t at : {bytes.size() - 5, 4 + packed.size() / 2}) {
        bytes[at] = static_cast<char>(bytes[at] ^ 16);
        EXPECT_FALSE(unpack(200)) << columns << ' ' << at;
        bytes[at] = static_cast<char>(bytes[at] ^ 16);
      }
      bytes.resize(4 + packed.size() / 2);
      EXPECT_FALSE(unpack(200));
    }
}

TEST(TiffExport, GdalReadsEveryBitOfEveryLayout) {
  const TempFolder folder;
  GDALRegister_GTiff();
  for (const auto& [w, h] : {std::pair{1, 1},
                             {256, 256},
                             {257, 257},
                             {600, 770},
                             {512, 512},
                             {1000, 5},
                             {5, 1000},
                             {256, 1000},
                             {1000, 256}}) {
    const std::vector<float> heights =
        anyFloats(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 9);
    const Version field = makeField(gridOf(w, h), heights);
    for (const char* name : {"none", "lzw", "deflate", "zstd"}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(w) + " x " + std::to_string(h));
      const std::string path = folder.file("t.tif");
      ExportOptions options;
      options.tiff_compression = tiffCompressionFromName(name);
      ASSERT_TRUE(options.tiff_compression);
      ASSERT_TRUE(save(field, path, options));
      GDALDatasetH dataset = GDALOpen(path.c_str(), GA_ReadOnly);
      ASSERT_NE(dataset, nullptr);
      std::string upper(name);
      for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      const char* item = GDALGetMetadataItem(dataset, "COMPRESSION", "IMAGE_STRUCTURE");
      EXPECT_EQ(item != nullptr ? item : "NONE", upper);
      std::vector<float> read(heights.size());
      ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(dataset, 1), GF_Read, 0, 0, w, h, read.data(), w, h,
                             GDT_Float32, 0, 0),
                CE_None);
      GDALClose(dataset);
      for (int r = 0; r < h; ++r)
        for (int c = 0; c < w; ++c) {
          const float wrote = heights[static_cast<std::size_t>(h - 1 - r) * static_cast<std::size_t>(w) +
                                      static_cast<std::size_t>(c)];
          const float got =
              read[static_cast<std::size_t>(r) * static_cast<std::size_t>(w) + static_cast<std::size_t>(c)];
          if (std::isnan(wrote))
            ASSERT_TRUE(std::isnan(got));
          else
            ASSERT_EQ(std::bit_cast<std::uint32_t>(wrote), std::bit_cast<std::uint32_t>(got));
        }
      FETTLE_LOAD(again, path);
      EXPECT_EQ(contentHash(again.field), contentHash(field));
    }
  }
}

TEST(TiffExport, TheBytesDoNotDependOnTheNumberOfThreads) {
  const TempFolder folder;
  const Version field = makeField(gridOf(900, 1100), slope(std::size_t{900} * 1100, 900));
  for (const TiffCompression compression :
       {TiffCompression::kNone, TiffCompression::kLzw, TiffCompression::kDeflate, TiffCompression::kZstd}) {
    ExportOptions options;
    options.tiff_compression = compression;
    ASSERT_TRUE(save(field, folder.file("all.tif"), options));
    {
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      ASSERT_TRUE(save(field, folder.file("one.tif"), options));
    }
    const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 7);
    ASSERT_TRUE(save(field, folder.file("seven.tif"), options));
    const std::string all = readBytes(folder.file("all.tif"));
    EXPECT_EQ(all, readBytes(folder.file("one.tif")));
    EXPECT_EQ(all, readBytes(folder.file("seven.tif")));
  }
}

TEST(TiffExport, OnlyATiffTakesACompression) {
  const TempFolder folder;
  ExportOptions options;
  options.tiff_compression = TiffCompression::kLzw;
  const auto written = save(makeField(gridOf(2, 1), {1.0F, 2.0F}), folder.file("a.asc"), options);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kInput);
  EXPECT_NE(written.error().line().find("--compress"), std::string::npos);
  EXPECT_EQ(tiffCompressionFromName("jpeg"), std::nullopt);
}

TEST(TiffExport, ACancelledOneLeavesNothing) {
  const TempFolder folder;
  JobControl job;
  job.cancel();
  const auto written = exportField(makeField(gridOf(600, 600), slope(std::size_t{600} * 600, 600)),
                                   folder.file("t.tif"), {}, job);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace fettle::engine

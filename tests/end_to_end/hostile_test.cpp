// Files made to do harm, by hand, through the whole program: each is refused with one line, within 256 MB
// over its own size. Nothing here is timed; each case prints what it took.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

// One entry of a zip, packed by Deflate: `head`, then `times` pieces of `piece`, then `tail`. The pieces are
// packed once and repeated, so that gigabytes cost nothing to make.
struct Entry {
  std::string name;
  std::string head;
  std::string piece = {};
  std::uint64_t times = 0;
  std::string tail = {};
};

std::string deflated(const std::string& bytes, bool last) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, last ? Z_FINISH : Z_FULL_FLUSH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string zip(const std::vector<Entry>& entries) {
  std::string bytes, directory;
  for (const Entry& entry : entries) {
    const std::string piece = entry.times > 0 ? deflated(entry.piece, false) : std::string();
    std::string packed = deflated(entry.head, false);
    for (std::uint64_t i = 0; i < entry.times; ++i) packed += piece;
    packed += deflated(entry.tail, true);
    const std::uint64_t size = entry.head.size() + entry.piece.size() * entry.times + entry.tail.size();
    uLong crc =
        crc32(0, reinterpret_cast<const Bytef*>(entry.head.data()), static_cast<uInt>(entry.head.size()));
    if (entry.times == 0)
      crc =
          crc32(crc, reinterpret_cast<const Bytef*>(entry.tail.data()), static_cast<uInt>(entry.tail.size()));
    const auto at = static_cast<std::uint32_t>(bytes.size());
    const auto common = [&](std::string& out) {
      append<std::uint16_t>(out, 20);
      append<std::uint16_t>(out, 0);
      append<std::uint16_t>(out, 8);
      append<std::uint32_t>(out, 0);
      append(out, static_cast<std::uint32_t>(crc));
      append(out, static_cast<std::uint32_t>(packed.size()));
      append(out, static_cast<std::uint32_t>(std::min<std::uint64_t>(size, 0xfffffffeU)));
      append(out, static_cast<std::uint16_t>(entry.name.size()));
      append<std::uint16_t>(out, 0);
    };
    bytes += "PK\x03\x04";
    common(bytes);
    bytes += entry.name + packed;
    directory += "PK\x01\x02";
    append<std::uint16_t>(directory, 20);
    common(directory);
    append<std::uint16_t>(directory, 0);
    append<std::uint16_t>(directory, 0);
    append<std::uint16_t>(directory, 0);
    append<std::uint32_t>(directory, 0);
    append(directory, at);
    directory += entry.name;
  }
  const auto start = static_cast<std::uint32_t>(bytes.size());
  bytes += directory;
  bytes += "PK\x05\x06";
  append<std::uint32_t>(bytes, 0);
  append(bytes, static_cast<std::uint16_t>(std::min<std::size_t>(entries.size(), 0xffff)));
  append(bytes, static_cast<std::uint16_t>(std::min<std::size_t>(entries.size(), 0xffff)));
  append(bytes, static_cast<std::uint32_t>(directory.size()));
  append(bytes, start);
  append<std::uint16_t>(bytes, 0);
  return bytes;
}

// main.xml of an x3p; `heights` is what Record3 contains in addition to the dimensions.
std::string mainXml(const std::string& width, const std::string& height, const std::string& heights,
                    const std::string& type = "F") {
  return fmt::format(
      "<?xml version=\"1.0\"?><p:ISO5436_2 "
      "xmlns:p=\"x\"><Record1><FeatureType>SUR</FeatureType><Axes><CX><AxisType>I</AxisType><DataType>D</"
      "DataType><Increment>1e-6</Increment></CX><CY><AxisType>I</AxisType><DataType>D</"
      "DataType><Increment>1e-6</Increment></CY><CZ><AxisType>A</AxisType><DataType>{}</DataType></CZ></"
      "Axes></Record1><Record3><MatrixDimension><SizeX>{}</SizeX><SizeY>{}</SizeY><SizeZ>1</SizeZ></"
      "MatrixDimension>{}",
      type, width, height, heights);
}
const std::string kLink = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";
const std::string kEnd = "</Record3></p:ISO5436_2>";

std::string las(std::uint64_t points) {
  std::string bytes(227, '\0');
  bytes.replace(0, 4, "LASF");
  bytes[24] = 1;
  bytes[25] = 2;
  put<std::uint16_t>(bytes, 94, 227);
  put<std::uint32_t>(bytes, 96, 227);
  put<std::uint16_t>(bytes, 105, 20);
  put(bytes, 107, static_cast<std::uint32_t>(points));
  for (std::size_t k = 0; k < 3; ++k) put(bytes, 131 + 8 * k, 1.0);
  return bytes;
}

std::string sur(std::int32_t width, std::int32_t height, bool packed) {
  std::string bytes(512, ' ');
  bytes.replace(0, 12, packed ? "DSCOMPRESSED" : "DIGITAL SURF");
  put<std::int16_t>(bytes, 12, 0);
  put<std::int16_t>(bytes, 14, 1);
  put<std::int16_t>(bytes, 18, 2);
  put<std::int16_t>(bytes, 86, 1);
  put<std::int16_t>(bytes, 98, 32);
  put<std::int32_t>(bytes, 100, 0);
  put(bytes, 108, width);
  put(bytes, 112, height);
  put(bytes, 116,
      static_cast<std::int32_t>(static_cast<std::uint32_t>(width) * static_cast<std::uint32_t>(height)));
  for (const std::size_t at : {120, 124, 128}) put(bytes, at, 1.0F);
  for (const std::size_t at : {180, 196, 212}) bytes.replace(at, 3, std::string("mm\0", 3));
  put<std::int16_t>(bytes, 334, 0);
  put<std::int16_t>(bytes, 336, 0);
  for (const std::size_t at : {466, 470, 474}) put(bytes, at, 0.0F);
  return bytes;
}

// One line of half floats; the window is that of data and of display.
std::string exr(std::array<std::int32_t, 4> window, const std::string& extra = {}) {
  std::string bytes("\x76\x2f\x31\x01\x02\0\0\0", 8);
  const auto attribute = [&](const std::string& name, const std::string& type, const std::string& value) {
    bytes += name + '\0' + type + '\0';
    append(bytes, static_cast<std::uint32_t>(value.size()));
    bytes += value;
  };
  std::string channel("Y\0", 2);
  append<std::int32_t>(channel, 2);
  append<std::uint32_t>(channel, 0);
  append<std::int32_t>(channel, 1);
  append<std::int32_t>(channel, 1);
  std::string box;
  for (const std::int32_t side : window) append(box, side);
  std::string one;
  append(one, 1.0F);
  attribute("channels", "chlist", channel + '\0');
  attribute("compression", "compression", std::string(1, '\x03'));
  attribute("dataWindow", "box2i", box);
  attribute("displayWindow", "box2i", box);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", one);
  attribute("screenWindowCenter", "v2f", std::string(8, '\0'));
  attribute("screenWindowWidth", "float", one);
  return bytes + extra + '\0' + std::string(64, '\0');
}

// Triangles from the same three corners, again and again: `side` samples along each leg.
std::string deepStl(std::uint32_t triangles, float side) {
  std::string bytes(80, ' ');
  append(bytes, triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float z = static_cast<float>(i);
    for (const float v : {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, z, side, 0.0F, z, 0.0F, side, z}) append(bytes, v);
    append<std::uint16_t>(bytes, 0);
  }
  return bytes;
}

class Hostile : public testing::Test {
 protected:
  void SetUp() override {
    write("sound.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n");
    const Outcome outcome = fettle({"info", folder.file("sound.asc")});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    base = outcome.peak_bytes;
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder.file(name), std::ios::binary) << bytes;
  }
  // What the program holds before it reads anything does not count.
  void refused(const std::string& what, const std::string& name, const std::string& bytes,
               const std::vector<std::string>& options = {}) const {
    SCOPED_TRACE(what);
    write(name, bytes);
    std::vector<std::string> arguments{"info", folder.file(name)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = fettle(arguments);
    expectRefused(outcome, name);
    const std::size_t more = outcome.peak_bytes - std::min(base, outcome.peak_bytes);
    std::cout << fmt::format("{:<52}{:>8.2f} MB {:>6.2f} s, {:>6.1f} MB more: {}", what,
                             static_cast<double>(bytes.size()) * 1e-6, outcome.seconds.count(),
                             static_cast<double>(more) * 1e-6,
                             outcome.err.substr(outcome.err.find("error: ") + 7));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which keep memory of their own
    EXPECT_LT(more, (std::size_t{256} << 20) + bytes.size());
#endif
  }

  TempFolder folder;
  std::size_t base = 0;
};

TEST_F(Hostile, ArchivesThatUnpackToFarMoreThanTheyAre) {
  const std::string zeros(std::size_t{1} << 20, '\0');
  const std::string spaces(std::size_t{1} << 20, ' ');
  refused(
      "10 GB of heights in 10 MB", "a.x3p",
      zip({{"main.xml", mainXml("51200", "51200", kLink) + kEnd}, {"bindata/data.bin", "", zeros, 10000}}));
  refused("8 GB of spaces before the matrix", "a.x3p",
          zip({{"main.xml", "<p:ISO5436_2>", spaces, 8000, "<DataList>"}}));
  refused("8 GB of spaces in the matrix", "a.x3p",
          zip({{"main.xml", mainXml("100", "100", "<DataList>"), spaces, 8000, "</DataList>" + kEnd}}));
  std::string comments;
  while (comments.size() < (std::size_t{1} << 20)) comments += "<!-- -->";
  refused("8 GB of comments in the matrix", "a.x3p",
          zip({{"main.xml", mainXml("100", "100", "<DataList>"), comments, 8000, "</DataList>" + kEnd}}));
  refused(
      "8 GB in one height of the matrix", "a.x3p",
      zip({{"main.xml", mainXml("100", "100", "<DataList><Datum>"), spaces, 8000, "1</Datum></DataList>"}}));
  std::string elements;
  while (elements.size() < (std::size_t{1} << 20)) elements += "<a/>";
  refused("2 billion elements", "a.x3p", zip({{"main.xml", "<p:ISO5436_2>", elements, 8000, kEnd}}));
  std::string nested;
  while (nested.size() < (std::size_t{1} << 20)) nested += "<a>";
  refused("600,000 elements in each other", "a.x3p", zip({{"main.xml", nested, "", 0, ""}}));
  refused("8 GB after the end of main.xml, and no heights", "a.x3p",
          zip({{"main.xml", mainXml("2", "2", kLink) + kEnd, spaces, 8000, ""}}));
}

TEST_F(Hostile, ArchivesThatLeadOutside) {
  for (const char* path :
       {"../../../../../../etc/passwd", "/etc/passwd", "..\\..\\etc\\passwd", "file:///etc/passwd"})
    refused(
        path, "a.x3p",
        zip({{"main.xml",
              mainXml("2", "2", fmt::format("<DataLink><PointDataLink>{}</PointDataLink></DataLink>", path)) +
                  kEnd}}));
  refused(
      "an entity from outside", "a.x3p",
      zip({{"main.xml", "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]>" +
                            mainXml("&b;", "2", kLink).substr(21) + kEnd},
           {"bindata/data.bin", std::string(16, '\0')}}));
  std::vector<Entry> many(60000, Entry{"a/entry", ""});
  refused("60,000 entries and no main.xml", "a.x3p", zip(many));
}

TEST_F(Hostile, HeadersOfTwoToThe31AndBelowNothing) {
  for (const char* side : {"2147483647", "2147483648", "4294967296", "-1", "-2147483648", "1e300"})
    refused(
        fmt::format("x3p of side {}", side), "a.x3p",
        zip({{"main.xml", mainXml(side, side, kLink) + kEnd}, {"bindata/data.bin", std::string(64, '\0')}}));
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  refused("EXR of 2^31 x 2^31", "a.exr", exr({0, 0, kMost - 1, kMost - 1}));
  refused("EXR from end to end", "a.exr", exr({kLeast, kLeast, kMost, kMost}));
  refused("EXR of 1 x 2^31", "a.exr", exr({0, 0, 0, kMost - 1}));
  refused("EXR of 2^31 x 1", "a.exr", exr({0, 0, kMost - 1, 0}));
  refused("EXR that ends before it begins", "a.exr", exr({10, 10, -10, -10}));
  refused("EXR of 30000 x 30000 in 400 bytes", "a.exr", exr({0, 0, 29999, 29999}));

  const auto pcd = [](const std::string& size, const std::string& count, const std::string& width,
                      const std::string& height, const std::string& points, const std::string& data) {
    return fmt::format(
        "VERSION 0.7\nFIELDS x y z\nSIZE {}\nTYPE F F F\nCOUNT {}\nWIDTH {}\nHEIGHT {}\nPOINTS {}\nDATA {}\n",
        size, count, width, height, points, data);
  };
  for (const char* n : {"2147483647", "2147483648", "18446744073709551615", "-1", "99999999999999999999999"})
    for (const char* data : {"ascii", "binary", "binary_compressed"})
      refused(fmt::format("PCD of {} points, {}", n, data), "a.pcd",
              pcd("4 4 4", "1 1 1", n, "1", n, data) + std::string(64, '1'));
  refused("PCD of 65536 x 65536", "a.pcd",
          pcd("4 4 4", "1 1 1", "65536", "65536", "4294967296", "binary") + std::string(64, '1'));
  refused("PCD with 2^31 numbers a field", "a.pcd",
          pcd("4 4 4", "1 2147483647 1", "1", "1", "1", "binary") + std::string(64, '1'));
  refused("PCD with -1 bytes a number", "a.pcd", pcd("4 -1 4", "1 1 1", "1", "1", "1", "binary"));
  std::string packed = pcd("4 4 4", "1 1 1", "357913941", "1", "357913941", "binary_compressed");
  append<std::uint32_t>(packed, 16);
  append<std::uint32_t>(packed, 0xfffffffcU);
  refused("PCD that unpacks 16 bytes to 4 GB", "a.pcd", packed + std::string(16, '\xff'));

  for (const std::uint64_t n : {std::uint64_t{0x7fffffff}, std::uint64_t{0xffffffff}})
    refused(fmt::format("LAS of {} points", n), "a.las", las(n) + std::string(40, '\0'));
  std::string far = las(2);
  for (const std::int32_t v : {kLeast, kLeast, 0, 0, 0, kMost, kMost, 1, 0, 0}) append(far, v);
  refused("LAS over 2^32 x 2^32 cells of its own step", "a.las", far, {"--cell-size", "1"});

  for (const bool deflated_rows : {false, true}) {
    for (const std::int32_t side : {kMost, -1, kLeast, 46340})
      refused(fmt::format("Digital Surf of side {}, {}", side, deflated_rows ? "packed" : "plain"), "a.sur",
              sur(side, side, deflated_rows) + std::string(64, '\0'));
    std::string comment = sur(2, 2, deflated_rows);
    put<std::int16_t>(comment, 334, -1);
    refused("Digital Surf with a comment of -1 bytes", "a.sur", comment);
  }
  std::string streams = sur(100, 100, true);
  append<std::uint32_t>(streams, 0xffffffffU);
  refused("Digital Surf of 2^32 streams", "a.sur", streams + std::string(64, '\0'));
  std::string stream = sur(8000, 8000, true);
  append<std::uint32_t>(stream, 1);
  append<std::uint32_t>(stream, 0xffffffffU);
  append<std::uint32_t>(stream, 64);
  refused("Digital Surf stream of 4 GB in 64 bytes", "a.sur", stream + std::string(64, '\0'));
}

TEST_F(Hostile, MeshesThatAskForMoreThanTheyAre) {
  std::string count(80, ' ');
  append<std::uint32_t>(count, 0xffffffffU);
  refused("STL of 2^32 triangles", "a.stl", count + std::string(100, '\0'));
  refused("STL over 10^10 samples", "a.stl", deepStl(1, 1e5F), {"--cell-size", "1"});
  refused("STL 10,000 deep over a million samples", "a.stl", deepStl(10000, 1000.0F), {"--cell-size", "1"});
  const auto ply = [](const std::string& vertices, const std::string& faces, const std::string& list) {
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\nelement face {}\nproperty list {} int vertex_indices\nend_header\n",
        vertices, faces, list);
  };
  for (const char* n : {"2147483648", "18446744073709551615", "-1", "99999999999999999999999"}) {
    refused(fmt::format("PLY of {} corners", n), "a.ply", ply(n, "1", "uchar") + std::string(64, '\0'));
    refused(fmt::format("PLY of {} faces", n), "a.ply", ply("1", n, "uchar") + std::string(64, '\0'));
  }
  std::string corners = ply("3", "1", "int");
  for (const float v : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F}) append(corners, v);
  for (const std::int32_t n : {std::numeric_limits<std::int32_t>::max(), -1}) {
    std::string face = corners;
    append(face, n);
    refused(fmt::format("PLY face of {} corners", n), "a.ply", face + std::string(64, '\0'));
  }
  refused("points over 10^10 cells", "a.xyz", "0 0 1\n100000 100000 2\n1 1 3\n", {"--cell-size", "1"});
}

}  // namespace
}  // namespace fettle::tests

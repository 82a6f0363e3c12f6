#pragma once

// Files of instruments, made byte by byte as their specifications have them.

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <liblzf/lzf.h>
#include <zlib.h>

namespace fettle::engine {

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  if (bytes.size() < at + sizeof(T)) bytes.resize(at + sizeof(T), '\0');
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}
template <class T>
void append(std::string& bytes, T value) {
  put(bytes, bytes.size(), value);
}

// An SDF of rows of `width` numbers, 1 um and 2 um apart, 10 nm a count.
template <class T>
[[nodiscard]] std::string binarySdf(std::uint8_t type, std::uint16_t width, const std::vector<T>& numbers,
                                    const std::string& version = "bISO-1.0") {
  std::string bytes = version + "Maker     " + "010120240000" + "010120240000";
  const std::size_t rows = numbers.size() / width;
  for (const std::size_t count : {std::size_t{width}, rows}) {
    if (version[5] == '2')
      append(bytes, static_cast<std::uint32_t>(count));
    else
      append(bytes, static_cast<std::uint16_t>(count));
  }
  for (const double v : {1e-6, 2e-6, 1e-8, -1.0}) append(bytes, v);
  bytes += '\0';
  append(bytes, type);
  bytes += '\0';
  for (const T v : numbers) append(bytes, v);
  return bytes;
}

// The same of 3 x 2 numbers as text.
[[nodiscard]] inline std::string textSdf(const std::string& version, int type, const std::string& data) {
  return version +
         "\r\nManufacID   = Maker\r\n; a comment\r\nCreateDate = 010120240000\r\nModDate = 010120240000\r\n"
         "NumPoints = 3\r\nNumProfiles = 2\r\nXscale = 1.0e-6\r\nYscale = 2E-06\r\nZscale = 1e-8\r\n"
         "Zresolution = -1\r\nCompression = 0\r\nDataType = " +
         std::to_string(type) + "\r\nCheckType = 0\r\n*\r\n" + data + "*\r\nOperator = Jane\r\n*\r\n";
}

// A surface of 3 x 2 numbers; the last one of the first row is the mark of a missing point.
template <class T>
[[nodiscard]] std::string sur(bool packed) {
  std::string h(512, ' ');
  h.replace(0, 12, packed ? "DSCOMPRESSED" : "DIGITAL SURF");
  put<std::int16_t>(h, 12, 0);
  put<std::int16_t>(h, 14, 1);
  put<std::int16_t>(h, 18, 2);
  put<std::int16_t>(h, 86, 1);
  put<std::int16_t>(h, 98, 8 * sizeof(T));
  put<std::int32_t>(h, 100, -300);
  put<std::int32_t>(h, 108, 3);
  put<std::int32_t>(h, 112, 2);
  put<std::int32_t>(h, 116, 6);
  put<float>(h, 120, 0.25F);
  put<float>(h, 124, 0.1F);
  put<float>(h, 128, 0.01F);
  for (const std::size_t at : {180, 196}) h.replace(at, 3, std::string("mm\0", 3));
  h.replace(212, 4, std::string("\xb5m\0\0", 4));
  put<std::int16_t>(h, 334, 7);
  put<std::int16_t>(h, 336, 3);
  put<float>(h, 466, 5.5F);
  put<float>(h, 470, -2.0F);
  put<float>(h, 474, 1.0F);
  h += "comment___";
  std::string rows;
  for (const T v : {T{-300}, T{7}, T{-302}, T{100}, T{200}, T{300}}) append(rows, v);
  if (!packed) return h + rows;
  // Two streams, cut in the middle of a row.
  const std::size_t cut = 2 * sizeof(T);
  std::string body;
  append<std::uint32_t>(h, 2);
  for (const std::string& part : {rows.substr(0, cut), rows.substr(cut)}) {
    std::string out(100, '\0');
    uLongf size = out.size();
    EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size,
                       reinterpret_cast<const Bytef*>(part.data()), part.size()),
              Z_OK);
    append<std::uint32_t>(h, static_cast<std::uint32_t>(part.size()));
    append<std::uint32_t>(h, static_cast<std::uint32_t>(size));
    body += out.substr(0, size);
  }
  return h + body;
}

struct LasPoint {
  std::int32_t x, y, z;
};

inline std::string las(int minor, int format, int point_bytes, const std::vector<LasPoint>& points,
                       const std::string& wkt = {}) {
  const std::uint16_t header = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
  std::string h(header, '\0');
  h.replace(0, 4, "LASF");
  h[24] = 1;
  h[25] = static_cast<char>(minor);
  put<std::uint16_t>(h, 94, header);
  put<std::uint32_t>(h, 96, header + static_cast<std::uint32_t>(wkt.empty() ? 0 : 54 + wkt.size()));
  put<std::uint32_t>(h, 100, wkt.empty() ? 0 : 1);
  h[104] = static_cast<char>(format);
  put<std::uint16_t>(h, 105, static_cast<std::uint16_t>(point_bytes));
  // From format 6 on the old count stays 0.
  put<std::uint32_t>(h, 107, format >= 6 ? 0 : static_cast<std::uint32_t>(points.size()));
  if (minor >= 4) put<std::uint64_t>(h, 247, points.size());
  for (int k = 0; k < 3; ++k) {
    put<double>(h, 131 + 8 * k, k == 2 ? 0.001 : 0.5);
    put<double>(h, 155 + 8 * k, k == 1 ? -4000000.0 : 0.0);
  }
  if (!wkt.empty()) {
    std::string record(54, '\0');
    record.replace(2, 15, "LASF_Projection");
    put<std::uint16_t>(record, 18, 2112);
    put<std::uint16_t>(record, 20, static_cast<std::uint16_t>(wkt.size()));
    h += record + wkt;
  }
  for (const LasPoint& p : points) {
    std::string body(static_cast<std::size_t>(point_bytes), '\x7f');
    put(body, 0, p.x);
    put(body, 4, p.y);
    put(body, 8, p.z);
    h += body;
  }
  return h;
}

// The same bytes with a record of the user LASF_Projection more, behind the header.
inline std::string withLasRecord(std::string bytes, std::uint16_t id, const std::string& body) {
  std::uint16_t header = 0;
  std::uint32_t points_at = 0, records = 0;
  std::memcpy(&header, &bytes[94], sizeof header);
  std::memcpy(&points_at, &bytes[96], sizeof points_at);
  std::memcpy(&records, &bytes[100], sizeof records);
  std::string record(54, '\0');
  record.replace(2, 15, "LASF_Projection");
  put<std::uint16_t>(record, 18, id);
  put<std::uint16_t>(record, 20, static_cast<std::uint16_t>(body.size()));
  bytes.insert(header, record + body);
  put<std::uint32_t>(bytes, 96, points_at + static_cast<std::uint32_t>(record.size() + body.size()));
  put<std::uint32_t>(bytes, 100, records + 1);
  return bytes;
}

// GeoTIFF keys: {key, where its value lies (0: here), count, value or place}.
inline std::string geoKeys(const std::vector<std::array<std::uint16_t, 4>>& keys) {
  std::string bytes;
  for (const std::size_t n : {std::size_t{1}, std::size_t{1}, std::size_t{0}, keys.size()})
    append(bytes, static_cast<std::uint16_t>(n));
  for (const auto& key : keys)
    for (const std::uint16_t n : key) append(bytes, n);
  return bytes;
}

// Fields x, y, z among others, in another order; as rows of doubles per point: label, z, x, normal[2], y.
inline std::string pcd(const std::string& data, const std::vector<std::array<double, 3>>& points, int width) {
  std::string h = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS label z x normal y\nSIZE 1 4 8 4 8\n"
      "TYPE U F F F F\nCOUNT 1 1 1 2 1\nWIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      width, points.size() / static_cast<std::size_t>(width), points.size(), data);
  if (data == "ascii") {
    for (const auto& p : points)
      h += fmt::format("7 {} {} 0.5 nan {}\n", static_cast<float>(p[2]), p[0], p[1]);
    return h;
  }
  std::string body;
  if (data == "binary") {
    for (const auto& p : points) {
      append<std::uint8_t>(body, 7);
      append(body, static_cast<float>(p[2]));
      append(body, p[0]);
      append(body, 0.5F);
      append(body, 0.5F);
      append(body, p[1]);
    }
    return h + body;
  }
  for (std::size_t i = 0; i < points.size(); ++i) append<std::uint8_t>(body, 7);
  for (const auto& p : points) append(body, static_cast<float>(p[2]));
  for (const auto& p : points) append(body, p[0]);
  for (std::size_t i = 0; i < 2 * points.size(); ++i) append(body, 0.5F);
  for (const auto& p : points) append(body, p[1]);
  std::string packed(2 * body.size() + 64, '\0');
  const unsigned size = lzf_compress(body.data(), static_cast<unsigned>(body.size()), packed.data(),
                                     static_cast<unsigned>(packed.size()));
  EXPECT_GT(size, 0U);
  append<std::uint32_t>(h, size);
  append<std::uint32_t>(h, static_cast<std::uint32_t>(body.size()));
  return h + packed.substr(0, size);
}

}  // namespace fettle::engine

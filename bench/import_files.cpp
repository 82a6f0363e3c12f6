#include "bench/import_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"

namespace fettle::bench {

namespace {

constexpr double kCountMm = 1e-5;

// Little-endian, as all three formats and all supported machines are.
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}
template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// Calls f(column, row, height [mm]) for each sample, the lowest row first.
template <class F>
void forEachSample(const engine::Version& field, const F& f) {
  const engine::FieldReader reader = field.reader();
  for (std::int32_t r = 0; r < reader.height(); ++r)
    for (std::int32_t c = 0; c < reader.width(); ++c)
      f(c, r, reader.heightAt(c, r) * field.grid().height_unit.mm);
}

std::int32_t counts(double mm) {
  return static_cast<std::int32_t>(std::lround(mm / kCountMm));
}

}  // namespace

engine::Status writePcd(const engine::Version& field, const std::string& path) {
  const engine::Grid& grid = field.grid();
  std::string body;
  std::int64_t points = 0;
  forEachSample(field, [&](std::int32_t c, std::int32_t r, double z) {
    if (std::isnan(z)) return;
    append(body, c * grid.spacingXMm());
    append(body, r * grid.spacingYMm());
    append(body, static_cast<float>(z));
    ++points;
  });
  return engine::writeFileAtomically(
      path, fmt::format("VERSION 0.7\nFIELDS x y z\nSIZE 8 8 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\n"
                        "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
                        points) +
                body);
}

engine::Status writeLas(const engine::Version& field, const std::string& path) {
  constexpr std::uint16_t kHeader = 227;
  constexpr std::uint16_t kPoint = 20;
  const engine::Grid& grid = field.grid();
  std::string bytes(kHeader, '\0');
  std::uint32_t points = 0;
  forEachSample(field, [&](std::int32_t c, std::int32_t r, double z) {
    if (std::isnan(z)) return;
    append(bytes, counts(c * grid.spacingXMm()));
    append(bytes, counts(r * grid.spacingYMm()));
    append(bytes, counts(z));
    bytes.append(kPoint - 12, '\0');
    ++points;
  });
  bytes.replace(0, 4, "LASF");
  bytes[24] = 1;
  bytes[25] = 2;
  put(bytes, 94, kHeader);
  put(bytes, 96, std::uint32_t{kHeader});
  put(bytes, 105, kPoint);
  put(bytes, 107, points);
  for (std::size_t k = 0; k < 3; ++k) put(bytes, 131 + 8 * k, kCountMm);
  return engine::writeFileAtomically(path, bytes);
}

engine::Status writeSur(const engine::Version& field, const std::string& path) {
  const engine::Grid& grid = field.grid();
  std::string bytes(512, ' ');
  bytes.replace(0, 12, "DIGITAL SURF");
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest = std::numeric_limits<std::int32_t>::min();
  forEachSample(field, [&](std::int32_t, std::int32_t, double z) {
    if (std::isnan(z)) return;
    lowest = std::min(lowest, counts(z));
    highest = std::max(highest, counts(z));
  });
  put<std::int16_t>(bytes, 12, 0);
  put<std::int16_t>(bytes, 14, 1);
  put<std::int16_t>(bytes, 18, 2);
  put<std::int16_t>(bytes, 86, 1);
  put<std::int16_t>(bytes, 98, 32);
  put(bytes, 100, lowest);
  put(bytes, 104, highest);
  put(bytes, 108, grid.width);
  put(bytes, 112, grid.height);
  put(bytes, 116, grid.width * grid.height);
  put(bytes, 120, static_cast<float>(grid.spacingXMm()));
  put(bytes, 124, static_cast<float>(grid.spacingYMm()));
  put(bytes, 128, static_cast<float>(kCountMm));
  for (const std::size_t at : {180, 196, 212}) bytes.replace(at, 3, std::string("mm\0", 3));
  put<std::int16_t>(bytes, 334, 0);
  put<std::int16_t>(bytes, 336, 0);
  put(bytes, 466, 0.0F);
  put(bytes, 470, 0.0F);
  put(bytes, 474, 0.0F);
  forEachSample(field, [&](std::int32_t, std::int32_t, double z) {
    append(bytes, std::isnan(z) ? lowest - 2 : counts(z));
  });
  return engine::writeFileAtomically(path, bytes);
}

}  // namespace fettle::bench

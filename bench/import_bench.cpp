#include "bench/import_bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "bench/gdal_yardstick.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "bench/temporary_folder.h"
#include "engine/base/stopwatch.h"
#include "engine/field/node_pool.h"
#include "engine/field/version.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/little_endian.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

namespace {

constexpr double kCountMm = 1e-5;

// Little-endian, as all three formats and all supported machines are.
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

// Calls f(column, row, height [mm]) for each sample, the lowest row first.
void forEachSample(const engine::Version& field, const auto& f) {
  const engine::FieldReader reader = field.reader();
  for (std::int32_t r = 0; r < reader.height(); ++r)
    for (std::int32_t c = 0; c < reader.width(); ++c)
      f(c, r, reader.heightAt(c, r) * field.grid().height_unit.mm);
}

std::int32_t counts(double mm) {
  return static_cast<std::int32_t>(std::lround(mm / kCountMm));
}

// Files of the formats that are only read, to measure their import: as large as real ones, containing only
// the field. Written whole or not at all; in the units of the format. Errors: kInput for paths that cannot
// be written. Holes are left out (PCD, LAS) or marked (SUR).

// Binary points, x and y as doubles, z as float [mm]: reads back bit-identical.
engine::Status writePcd(const engine::Version& field, const std::string& path) {
  const engine::Grid& grid = field.grid();
  std::string body;
  std::int64_t points = 0;
  forEachSample(field, [&](std::int32_t c, std::int32_t r, double z) {
    if (std::isnan(z)) return;
    engine::appendLittle(body, c * grid.spacingXMm());
    engine::appendLittle(body, r * grid.spacingYMm());
    engine::appendLittle(body, static_cast<float>(z));
    ++points;
  });
  return engine::writeFileAtomically(
      path, fmt::format("VERSION 0.7\nFIELDS x y z\nSIZE 8 8 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\n"
                        "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
                        points) +
                body);
}

// LAS 1.2, point format 0, coordinates in counts of 1e-5 [mm]; |coordinates| below 21 m.
engine::Status writeLas(const engine::Version& field, const std::string& path) {
  constexpr std::uint16_t kHeader = 227;
  constexpr std::uint16_t kPoint = 20;
  const engine::Grid& grid = field.grid();
  std::string bytes(kHeader, '\0');
  std::uint32_t points = 0;
  forEachSample(field, [&](std::int32_t c, std::int32_t r, double z) {
    if (std::isnan(z)) return;
    engine::appendLittle(bytes, counts(c * grid.spacingXMm()));
    engine::appendLittle(bytes, counts(r * grid.spacingYMm()));
    engine::appendLittle(bytes, counts(z));
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

// Digital Surf, 32-bit counts of 1e-5 mm, not compressed.
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
    engine::appendLittle(bytes, std::isnan(z) ? lowest - 2 : counts(z));
  });
  return engine::writeFileAtomically(path, bytes);
}

// Text with a row of heights per line and Gwyddion's remarks, in shortest decimals: reads back bit-identical.
engine::Status writeMatrix(const engine::Version& field, const std::string& path) {
  const engine::Grid& grid = field.grid();
  const engine::FieldReader reader = field.reader();
  std::string text =
      fmt::format("# Channel: height\n# Width: {} mm\n# Height: {} mm\n# Value units: {}\n",
                  grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm(), grid.height_unit.name);
  for (std::int32_t r = grid.height - 1; r >= 0; --r)
    for (std::int32_t c = 0; c < grid.width; ++c)
      fmt::format_to(std::back_inserter(text), "{}{}", reader.heightAt(c, r),
                     c + 1 < grid.width ? '\t' : '\n');
  return engine::writeFileAtomically(path, text);
}

namespace fs = std::filesystem;

constexpr std::int32_t kEveryFormat = 2048;  // largest side
constexpr std::int32_t kLargest = 16384;

struct Case {
  std::string name;
  std::string path;
};

engine::Result<std::vector<Case>> makeFiles(const fs::path& folder, std::int32_t side,
                                            engine::JobControl& job) {
  const engine::Version field = trials::workpiece(side, kSpacingMm);
  std::vector<Case> cases;
  engine::Status status;
  const auto add = [&](const std::string& name, const std::string& file, const auto& write) {
    if (!status) return;
    cases.push_back({name, (folder / file).string()});
    if (job.cancelled())
      status = engine::cancelled();
    else
      status = write(cases.back().path);
  };
  const auto exported = [&](const engine::ExportOptions& options) {
    return [&, options](const std::string& path) -> engine::Status {
      const auto written = engine::exportField(field, path, options, job);
      if (!written) return tl::unexpected(written.error());
      return {};
    };
  };
  const auto tiff = [&](TiffLayout layout) {
    return [&, layout](const std::string& path) { return writeTiffAs(layout, field, path, job); };
  };
  engine::ExportOptions mesh;
  mesh.mesh = true;
  engine::ExportOptions cloud;
  cloud.cloud_optimised = true;
  engine::ExportOptions packed;
  packed.tiff_compression = engine::TiffCompression::kDeflate;
  add("GeoTIFF", "plain.tif", exported({}));
  add("GeoTIFF, deflate", "deflate.tif", exported(packed));
  add("GeoTIFF, cloud-optimised", "cloud.tif", exported(cloud));
  add("GeoTIFF, packed strips", "packed_strips.tif", tiff(TiffLayout::kPackedStrips));
  add("GeoTIFF, plain strips", "plain_strips.tif", tiff(TiffLayout::kPlainStrips));
  add("GeoTIFF, plain tiles", "plain_tiles.tif", tiff(TiffLayout::kPlainTiles));
  if (side > kEveryFormat) {
    if (!status) return tl::unexpected(status.error());
    return cases;
  }
  add("PNG", "counts.png", exported({}));
  add("x3p", "surface.x3p", exported({}));
  add("SDF", "surface.sdf", exported({}));
  add("OpenEXR", "image.exr", exported({}));
  add("Digital Surf", "surface.sur", [&](const std::string& path) { return writeSur(field, path); });
  add("ESRI ASCII grid", "grid.asc", exported({}));
  add("text matrix", "matrix.txt", [&](const std::string& path) { return writeMatrix(field, path); });
  add("XYZ text", "points.xyz", exported({}));
  add("PLY points", "points.ply", exported({}));
  add("PCD binary", "points.pcd", [&](const std::string& path) { return writePcd(field, path); });
  add("LAS", "points.las", [&](const std::string& path) { return writeLas(field, path); });
  add("PLY mesh", "mesh.ply", exported(mesh));
  add("STL mesh", "mesh.stl", exported({}));
  add("session", "work.fettle", exported({}));
  if (!status) return tl::unexpected(status.error());
  return cases;
}

// Wall time to read the whole file; the bytes are not used, as with `cat FILE > /dev/null`.
engine::Result<double> readPlainly(const std::string& path) {
  std::vector<char> buffer(std::size_t{1} << 20);
  const engine::Stopwatch watch;
  std::ifstream file;
  file.rdbuf()->pubsetbuf(nullptr, 0);  // directly into the buffer
  file.open(path, std::ios::binary);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()))) {
  }
  if (!file.eof()) return engine::inputError("the file cannot be read", path);
  return watch.seconds();
}

// Wall time to provide the memory of so many tiles, as an import does.
engine::Result<double> provideMemory(std::int64_t tiles) {
  const engine::Stopwatch watch;
  engine::FieldMemory memory;
  if (!memory.tiles.reserve(static_cast<std::size_t>(tiles)))
    return engine::failure("there is not enough memory", "bench import");
  return watch.seconds();
}

}  // namespace

engine::Result<ImportBenchReport> benchImport(const ImportBenchOptions& options, engine::JobControl& job) {
  if (options.side < 16 || options.side > kLargest || options.repeats < 1 || options.repeats > 100)
    return engine::inputError("an option of the benchmark is out of range", "bench import",
                              "side 16 to 16384, repeats 1 to 100");
  const auto folder = TemporaryFolder::create();
  if (!folder) return tl::unexpected(folder.error());
  std::vector<Case> cases;
  if (options.files.empty()) {
    auto made = makeFiles(folder->path(), options.side, job);
    if (!made) return tl::unexpected(made.error());
    cases = *std::move(made);
  } else {
    for (const std::string& file : options.files) cases.push_back({fs::path(file).filename().string(), file});
  }

  job.begin("measuring", cases.size() * static_cast<std::size_t>(options.repeats));
  ImportBenchReport report;
  report.machine = machine();
  report.rows.resize(cases.size());
  std::vector<std::vector<double>> imports(cases.size()), plain(cases.size()), gdal(cases.size()),
      gdal_new(cases.size()), memory(cases.size());
  std::vector<char> buffer;
  for (int i = 0; i < options.repeats; ++i)
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const auto read = readPlainly(cases[k].path);
      if (!read) return tl::unexpected(read.error());
      const auto alone = secondsOfGdal(cases[k].path, buffer);
      if (!alone) return tl::unexpected(alone.error());
      const auto alone_new = secondsOfGdalIntoNewMemory(cases[k].path);
      if (!alone_new) return tl::unexpected(alone_new.error());
      const engine::Stopwatch watch;
      const auto imported = engine::importField(cases[k].path, {}, job);
      const double seconds = watch.seconds();
      if (!imported) return tl::unexpected(imported.error());
      const std::uint64_t hash = engine::contentHash(imported->field);
      ImportBenchRow& row = report.rows[k];
      if (i > 0 && hash != row.hash)
        return engine::failure("two imports of the same file differ", cases[k].path, "please report this");
      row.name = cases[k].name;
      row.format = imported->format;
      row.bytes = static_cast<std::int64_t>(fs::file_size(cases[k].path));
      row.samples = imported->field.grid().samples();
      row.hash = hash;
      const engine::FieldReader reader = imported->field.reader();
      const auto provided = provideMemory(std::int64_t{reader.tileColumns()} * reader.tileRows());
      if (!provided) return tl::unexpected(provided.error());
      memory[k].push_back(static_cast<double>(row.bytes) / *provided);
      imports[k].push_back(static_cast<double>(row.bytes) / seconds);
      plain[k].push_back(static_cast<double>(row.bytes) / *read);
      if (*alone) gdal[k].push_back(static_cast<double>(row.bytes) / **alone);
      if (*alone_new) gdal_new[k].push_back(static_cast<double>(row.bytes) / **alone_new);
    }
  for (std::size_t k = 0; k < cases.size(); ++k) {
    ImportBenchRow& row = report.rows[k];
    row.median = median(imports[k]);
    row.slowest = *std::min_element(imports[k].begin(), imports[k].end());
    row.fastest = *std::max_element(imports[k].begin(), imports[k].end());
    row.plain = median(plain[k]);
    row.memory = median(memory[k]);
    if (!gdal[k].empty()) row.gdal = median(gdal[k]);
    if (!gdal_new[k].empty()) row.gdal_new = median(gdal_new[k]);
  }
  return report;
}

}  // namespace fettle::bench

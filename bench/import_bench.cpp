#include "bench/import_bench.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "bench/gdal_yardstick.h"
#include "bench/import_files.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "bench/temporary_folder.h"
#include "engine/base/stopwatch.h"
#include "engine/formats/formats.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

namespace {

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
  add("OpenEXR", "image.exr", exported({}));
  add("Digital Surf", "surface.sur", [&](const std::string& path) { return writeSur(field, path); });
  add("ESRI ASCII grid", "grid.asc", exported({}));
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
  std::vector<std::vector<double>> imports(cases.size()), plain(cases.size()), gdal(cases.size());
  std::vector<char> buffer;
  for (int i = 0; i < options.repeats; ++i)
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const auto read = readPlainly(cases[k].path);
      if (!read) return tl::unexpected(read.error());
      const auto alone = secondsOfGdal(cases[k].path, buffer);
      if (!alone) return tl::unexpected(alone.error());
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
      imports[k].push_back(static_cast<double>(row.bytes) / seconds);
      plain[k].push_back(static_cast<double>(row.bytes) / *read);
      if (*alone) gdal[k].push_back(static_cast<double>(row.bytes) / **alone);
    }
  for (std::size_t k = 0; k < cases.size(); ++k) {
    ImportBenchRow& row = report.rows[k];
    row.median = median(imports[k]);
    row.slowest = *std::min_element(imports[k].begin(), imports[k].end());
    row.fastest = *std::max_element(imports[k].begin(), imports[k].end());
    row.plain = median(plain[k]);
    if (!gdal[k].empty()) row.gdal = median(gdal[k]);
  }
  return report;
}

}  // namespace fettle::bench

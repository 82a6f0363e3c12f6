#include "engine/io/format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::engine {

namespace {

using namespace std::string_view_literals;

constexpr std::array kTiff{".tif"sv, ".tiff"sv};
constexpr std::array kPng{".png"sv};
constexpr std::array kAscii{".asc"sv, ".agr"sv, ".grd"sv};
constexpr std::array kPly{".ply"sv};
constexpr std::array kSession{".fettle"sv};
constexpr std::array kXyz{".xyz"sv, ".txt"sv, ".csv"sv, ".pts"sv, ".dat"sv};

// Signatures first; text that is nothing else is tried as points.
constexpr std::array kTable{
    Format{{"GTiff", "GeoTIFF and TIFF", kTiff, true, true}, looksLikeTiff, readTiff, writeTiff},
    Format{{"PNG", "16-bit grey PNG", kPng, true, true}, looksLikePng, readPng, writePng},
    Format{{"PLY", "PLY point cloud", kPly, true, true}, looksLikePly, readPly, writePly},
    Format{{"AAIGrid", "ESRI ASCII grid", kAscii, true, true},
           looksLikeAsciiGrid,
           readAsciiGrid,
           writeAsciiGrid},
    Format{{"Fettle", "Fettle session", kSession, true, true}, looksLikeSession, readSession, writeSession},
    Format{{"XYZ", "text with x y z a line", kXyz, true, true}, looksLikeXyz, readXyz, writeXyz},
};

std::string extensionsOf(bool FormatInfo::*able) {
  std::vector<std::string_view> all;
  for (const FormatInfo& info : formats())
    if (info.*able) all.insert(all.end(), info.extensions.begin(), info.extensions.end());
  return fmt::format("{}", fmt::join(all, " "));
}

Status checkOptions(const ImportOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (options.spacing && !(positive(options.spacing->first) && positive(options.spacing->second)))
    return inputError(
        fmt::format("a spacing of {} x {} cannot be", options.spacing->first, options.spacing->second),
        "--spacing", "give two positive lengths");
  if (options.z_scale && (!std::isfinite(*options.z_scale) || *options.z_scale == 0.0))
    return inputError(fmt::format("a height scale of {} cannot be", *options.z_scale), "--z-scale",
                      "give a number other than 0");
  if (options.unit && !positive(options.unit->mm))
    return inputError(fmt::format("a unit of {} mm cannot be", options.unit->mm), "--unit");
  if (options.cell_size && !positive(*options.cell_size))
    return inputError(fmt::format("a cell size of {} cannot be", *options.cell_size), "--cell-size",
                      "give a positive length");
  return {};
}

Result<Imported> import(const std::string& path, const ImportOptions& options, JobControl& job) {
  if (Status status = checkOptions(options); !status) return tl::unexpected(status.error());
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  std::string head(Format::kHeadBytes, '\0');
  const Result<std::size_t> got = file->read(0, head.data(), head.size());
  if (!got) return tl::unexpected(got.error());
  head.resize(*got);
  for (const Format& format : formatTable())
    if (format.recognises != nullptr && format.recognises(head, file->extension()))
      return format.read(*file, options, job);
  return inputError("the file is in no format that is known", path,
                    "known are " + extensionsOf(&FormatInfo::reads));
}

}  // namespace

std::span<const Format> formatTable() {
  return kTable;
}

std::span<const FormatInfo> formats() {
  static const auto infos = [] {
    std::array<FormatInfo, kTable.size()> all;
    std::transform(kTable.begin(), kTable.end(), all.begin(), [](const Format& f) { return f.info; });
    return all;
  }();
  return infos;
}

Result<Imported> importField(const std::string& path, const ImportOptions& options, JobControl& job) {
  try {
    return import(path, options, job);
  } catch (const std::bad_alloc&) {
    return inputError("the file needs more memory than is free", path, "cut the scan into parts");
  }
}

Result<Exported> exportField(const Version& field, const std::string& path, const ExportOptions& options,
                             JobControl& job) {
  if (options.height_per_count &&
      !(std::isfinite(*options.height_per_count) && *options.height_per_count > 0.0))
    return inputError(fmt::format("{} cannot be the height of a count", *options.height_per_count), path);
  const std::string extension = extensionOf(path);
  try {
    for (const Format& format : formatTable())
      if (format.write != nullptr &&
          std::ranges::find(format.info.extensions, extension) != format.info.extensions.end())
        return format.write(field, path, options, job);
  } catch (const std::bad_alloc&) {
    return failure("memory for writing could not be had", path);
  }
  return inputError(extension.empty() ? "the output has no extension that names a format"
                                      : fmt::format("{} is no format that can be written", extension),
                    path, "use one of " + extensionsOf(&FormatInfo::writes));
}

}  // namespace fettle::engine

#include "engine/formats/formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/io/format.h"
#include "engine/io/points/perspective.h"
#include "engine/io/unit_doubt.h"

namespace fettle::engine {

namespace {

// Formats with a signature first; other text is a matrix where its lines are longer than those of points.
constexpr const Format* kTable[] = {
    &kTiffFormat, &kPngFormat, &kPlyFormat, &kPcdFormat,       &kLasFormat,    &kSurFormat,    &kX3pFormat,
    &kSdfFormat,  &kExrFormat, &kStlFormat, &kAsciiGridFormat, &kFettleFormat, &kMatrixFormat, &kXyzFormat};

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
        fmt::format("a spacing of {} x {} is not valid", options.spacing->first, options.spacing->second),
        "--spacing", "give two positive lengths");
  if (options.z_scale && (!std::isfinite(*options.z_scale) || *options.z_scale == 0.0))
    return inputError(fmt::format("a height scale of {} is not valid", *options.z_scale), "--z-scale",
                      "give a number other than 0");
  if (options.unit && !positive(options.unit->mm))
    return inputError(fmt::format("a unit of {} mm is not valid", options.unit->mm), "--unit");
  if (options.depth_camera) {
    const DepthCamera& camera = *options.depth_camera;
    if (!positive(camera.fx) || !positive(camera.fy) || !std::isfinite(camera.cx.value_or(0.0)) ||
        !std::isfinite(camera.cy.value_or(0.0)))
      return inputError("the camera is not valid", "--depth-camera", "give fx[,fy[,cx,cy]] in pixels");
    if (options.spacing)
      return inputError("a depth camera has no spacing of its own", "--spacing",
                        "give either --spacing or --depth-camera");
  }
  if (options.cell_size && !positive(*options.cell_size))
    return inputError(fmt::format("a cell size of {} is not valid", *options.cell_size), "--cell-size",
                      "give a positive length");
  return {};
}

// Depth images are read like any raster, and then get the grid of their camera.
Result<Imported> readDepthImage(const Format& format, const InputFile& file, ImportOptions options,
                                JobControl& job) {
  if (!format.picture)
    return inputError(fmt::format("{} is not a depth image", format.info.description), file.path(),
                      "--depth-camera is for PNG and TIFF");
  const bool assumed = !options.no_data;
  if (assumed) options.no_data = 0.0;
  options.spacing = std::pair{1.0, 1.0};  // no guess that needs a warning
  Result<Imported> image = format.read(file, options, job);
  if (!image) return image;
  if (assumed) image->warnings.emplace_back("0 is read as no distance: change it with --no-data");
  placeInPerspective(*image, *options.depth_camera);
  return image;
}

// Null where no format recognises the file.
Result<const Format*> recognised(const InputFile& file) {
  std::string head(Format::kHeadBytes, '\0');
  const Result<std::size_t> got = file.read(0, head.data(), head.size());
  if (!got) return tl::unexpected(got.error());
  head.resize(*got);
  for (const Format* format : kTable)
    if (format->recognises != nullptr && format->recognises(head, file.extension())) return format;
  return nullptr;
}

// A field under a form is written with it: a session has both, every other format the samples.
Result<Exported> writeRestored(const Format& format, const Version& field, const std::string& path,
                               const ExportOptions& options, JobControl& job) {
  auto stored = restored(field, job);
  if (!stored) return tl::unexpected(stored.error());
  ExportOptions writing = options;
  if (writing.original) {
    auto original = restored(*writing.original, job);
    if (!original) return tl::unexpected(original.error());
    writing.original = *std::move(original);
  }
  auto written = format.write(*stored, path, writing, job);
  if (written && stored->form() != nullptr && &format != &kFettleFormat)
    written->warnings.emplace_back(
        "the heights are written with the form that lay over them: make what is seen the heights first to "
        "leave "
        "it out (fettle level --layer bake)");
  return written;
}

}  // namespace

std::span<const FormatInfo> formats() {
  static const auto infos = [] {
    std::array<FormatInfo, std::size(kTable)> all;
    std::ranges::transform(kTable, all.begin(), &Format::info);
    return all;
  }();
  return infos;
}

Result<Imported> importField(const std::string& path, const ImportOptions& options, JobControl& job) try {
  if (Status status = checkOptions(options); !status) return tl::unexpected(status.error());
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  const Result<const Format*> format = recognised(*file);
  if (!format) return tl::unexpected(format.error());
  if (*format == nullptr)
    return inputError("the format of the file is not known", path,
                      "known formats: " + extensionsOf(&FormatInfo::reads));
  Result<Imported> imported = options.depth_camera ? readDepthImage(**format, *file, options, job)
                                                   : (*format)->read(*file, options, job);
  if (imported && !(*format)->units_certain) doubtUnits(*imported, options);
  return imported;
} catch (const std::bad_alloc&) {
  return inputError("the file needs more memory than is free", path, "cut the scan into parts");
}

Result<std::optional<Preview>> importPreview(const std::string& path, const ImportOptions& options,
                                             std::int64_t max_samples, JobControl& job) try {
  if (Status status = checkOptions(options); !status) return tl::unexpected(status.error());
  if (options.depth_camera) return std::nullopt;
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  const Result<const Format*> format = recognised(*file);
  if (!format) return tl::unexpected(format.error());
  if (*format == nullptr || (*format)->preview == nullptr) return std::nullopt;
  return (*format)->preview(*file, options, max_samples, job);
} catch (const std::bad_alloc&) {
  return inputError("the file needs more memory than is free", path, "cut the scan into parts");
}

Result<std::optional<Grid>> importGrid(const std::string& path, const ImportOptions& options) try {
  if (Status status = checkOptions(options); !status) return tl::unexpected(status.error());
  if (options.depth_camera) return std::nullopt;
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  const Result<const Format*> format = recognised(*file);
  if (!format) return tl::unexpected(format.error());
  if (*format == nullptr || (*format)->grid == nullptr) return std::nullopt;
  return (*format)->grid(*file, options);
} catch (const std::bad_alloc&) {
  return inputError("the file needs more memory than is free", path, "cut the scan into parts");
}

Result<Imported> importRows(const std::string& path, const ImportOptions& options, std::int32_t first,
                            std::int32_t count, JobControl& job) try {
  const Result<std::optional<Grid>> grid = importGrid(path, options);
  if (!grid) return tl::unexpected(grid.error());
  const auto outside = [&](const Grid& whole) {
    return first < 0 || count < 1 || first > whole.height - count;
  };
  const auto refused = [&](const Grid& whole) {
    return inputError(fmt::format("the scan has {} rows, not {} from row {} on", whole.height, count, first),
                      path, "the file was changed since the work was planned");
  };
  if (*grid) {
    if (outside(**grid)) return refused(**grid);
    const Result<InputFile> file = InputFile::open(path);
    if (!file) return tl::unexpected(file.error());
    const Result<const Format*> format = recognised(*file);
    if (!format) return tl::unexpected(format.error());
    return (*format)->read_rows(*file, options, {first, count}, job);
  }
  Result<Imported> whole = importField(path, options, job);
  if (!whole) return whole;
  if (outside(whole->field.grid())) return refused(whole->field.grid());
  whole->field = rowsOf(whole->field, first, count);
  if (whole->original) whole->original = rowsOf(*whole->original, first, count);
  return whole;
} catch (const std::bad_alloc&) {
  return inputError("the file needs more memory than is free", path, "cut the scan into parts");
}

Result<Exported> exportField(const Version& field, const std::string& path, const ExportOptions& options,
                             JobControl& job) {
  if (options.height_per_count &&
      !(std::isfinite(*options.height_per_count) && *options.height_per_count > 0.0))
    return inputError(fmt::format("{} is not a valid height per count", *options.height_per_count), path);
  if (options.max_error && !(std::isfinite(*options.max_error) && *options.max_error >= 0.0))
    return inputError(fmt::format("{} is not a valid error of a mesh", *options.max_error), path);
  const std::string extension = extensionOf(path);
  const Format* format = nullptr;
  for (const Format* each : kTable)
    if (each->write != nullptr &&
        std::ranges::find(each->info.extensions, extension) != each->info.extensions.end())
      format = each;
  if ((options.mesh || options.max_error) && !(format != nullptr && format->mesh))
    return inputError("only .ply and .stl store a mesh", path, "write one of these or omit --mesh");
  if (options.mesh_unit && format != &kStlFormat)
    return inputError("only .stl is written in a unit that is chosen", path,
                      "write that or omit --mesh-unit: others state the unit of their numbers");
  if (options.mesh_unit && !(std::isfinite(options.mesh_unit->mm) && options.mesh_unit->mm > 0.0))
    return inputError(fmt::format("a unit of {} mm is not valid", options.mesh_unit->mm), path);
  if (options.cloud_optimised && !(format != nullptr && format->tiff))
    return inputError("only .tif can be cloud-optimised", path, "write that or omit the option");
  if (options.ascii && !(format != nullptr && format->ascii))
    return inputError("only .sdf has a binary form and one of text", path, "write that or omit --ascii");
  if (options.tiff_compression && !(format != nullptr && format->tiff))
    return inputError("only .tif supports the requested compression", path, "write that or omit --compress");
  try {
    if (format != nullptr) return writeRestored(*format, field, path, options, job);
  } catch (const std::bad_alloc&) {
    return failure("there is not enough memory for writing", path);
  }
  return inputError(extension.empty() ? "the output has no extension that names a format"
                                      : fmt::format("{} is not a format that can be written", extension),
                    path, "use one of " + extensionsOf(&FormatInfo::writes));
}

}  // namespace fettle::engine

#include "engine/io/files/gdal_calls.h"
#include "engine/io/lines/line_csv.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/geo/crs_text.h"
#include "engine/io/lines/line_frame.h"
#include "engine/io/lines/lines.h"

namespace fettle::engine {

namespace {

struct CloseCrs {
  void operator()(void* crs) const noexcept { gdal().OSRDestroySpatialReference(crs); }
};
struct CloseFeature {
  void operator()(void* feature) const noexcept { gdal().OGR_F_Destroy(feature); }
};
struct CloseGeometry {
  void operator()(void* geometry) const noexcept { gdal().OGR_G_DestroyGeometry(geometry); }
};
using FeaturePtr = std::unique_ptr<void, CloseFeature>;
using GeometryPtr = std::unique_ptr<void, CloseGeometry>;

// DXF has no attributes of our own: the layer of a polyline states whether it was located.
constexpr std::string_view kLocatedLayer = "located", kOtherLayer = "not_located";

const char* driverOf(const std::string& extension) {
  return extension == ".gpkg" ? "GPKG" : extension == ".dxf" ? "DXF" : "GeoJSON";
}

// Points of a line that were located, or others; [begin, end).
struct LineRun {
  std::size_t begin = 0, end = 0;
  bool located = false, ring = false;
};

std::vector<LineRun> runsOf(const EdgeLine& line) {
  std::vector<LineRun> runs;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    if (runs.empty() || runs.back().located != line.points[i].located)
      runs.push_back({i, i, line.points[i].located, false});
    runs.back().end = i + 1;
  }
  if (runs.size() == 1) runs[0].ring = line.closed && line.points.size() > 2;
  return runs;
}

// ---- writing

class LineLayer {
 public:
  LineLayer(OGRLayerH layer, bool attributes, const Grid& grid)
      : layer_(layer), attributes_(attributes), frame_(LineFrame::world(grid)) {}

  [[nodiscard]] bool createFields() {
    if (!attributes_) return true;
    constexpr std::array<std::pair<const char*, OGRFieldType>, 6> kFields{{{"line", OFTInteger64},
                                                                           {"closed", OFTInteger},
                                                                           {"located", OFTInteger},
                                                                           {"kind", OFTString},
                                                                           {"deviation", OFTReal},
                                                                           {"step", OFTReal}}};
    return std::ranges::all_of(kFields, [&](const auto& field) {
      OGRFieldDefnH definition = gdal().OGR_Fld_Create(field.first, field.second);
      const bool done = gdal().OGR_L_CreateField(layer_, definition, TRUE) == OGRERR_NONE;
      gdal().OGR_Fld_Destroy(definition);
      return done;
    });
  }

  [[nodiscard]] bool write(const EdgeLine& line, const LineRun& run) {
    const FeaturePtr feature(gdal().OGR_F_Create(gdal().OGR_L_GetLayerDefn(layer_)));
    const GeometryPtr geometry(gdal().OGR_G_CreateGeometry(wkbLineString));
    const auto add = [&](std::size_t i) {
      const glm::dvec2 p = line.points[i].position;
      gdal().OGR_G_AddPoint_2D(geometry.get(), static_cast<double>(frame_.x(p.x)),
                               static_cast<double>(frame_.y(p.y)));
    };
    for (std::size_t i = run.begin; i < run.end; ++i) add(i);
    // A line string has two points at least.
    if (run.ring || run.end - run.begin == 1) add(run.begin);
    if (gdal().OGR_F_SetGeometry(feature.get(), geometry.get()) != OGRERR_NONE) return false;
    describe(feature.get(), line, run);
    return gdal().OGR_L_CreateFeature(layer_, feature.get()) == OGRERR_NONE;
  }

 private:
  void describe(OGRFeatureH feature, const EdgeLine& line, const LineRun& run) const {
    const auto field = [&](const char* name) { return gdal().OGR_F_GetFieldIndex(feature, name); };
    if (!attributes_) {
      gdal().OGR_F_SetFieldString(feature, field("Layer"),
                                  (run.located ? kLocatedLayer : kOtherLayer).data());
      return;
    }
    double deviation = 0.0, step = 0.0;
    std::size_t creases = 0;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      deviation += line.points[i].deviation;
      step += line.points[i].step;
      creases += line.points[i].kind == LineKind::kCrease ? 1 : 0;
    }
    const std::size_t n = run.end - run.begin;
    const auto mean = [&](double sum, LineFrame::Real unit) {
      return static_cast<double>(sum / static_cast<double>(n) * unit);
    };
    gdal().OGR_F_SetFieldInteger64(feature, field("line"), line.id);
    gdal().OGR_F_SetFieldInteger(feature, field("closed"), line.closed ? 1 : 0);
    gdal().OGR_F_SetFieldInteger(feature, field("located"), run.located ? 1 : 0);
    gdal().OGR_F_SetFieldString(feature, field("kind"), 2 * creases > n ? "crease" : "step");
    gdal().OGR_F_SetFieldDouble(feature, field("deviation"), mean(deviation, frame_.sample_mm));
    gdal().OGR_F_SetFieldDouble(feature, field("step"), mean(step, frame_.height_mm));
  }

  OGRLayerH layer_;
  bool attributes_;
  LineFrame frame_;
};

bool writeLineDataset(const MemoryFile& file, const std::string& extension, std::span<const EdgeLine> lines,
                      const Grid& grid) {
  const char* driver = driverOf(extension);
  const bool dxf = std::strcmp(driver, "DXF") == 0;
  const DatasetPtr dataset(gdal().GDALCreate(gdal().GDALGetDriverByName(driver), file.path().c_str(), 0, 0, 0,
                                             GDT_Unknown, nullptr));
  if (!dataset) return false;
  const std::unique_ptr<void, CloseCrs> crs(
      grid.crs_wkt.empty() || dxf ? nullptr : gdal().OSRNewSpatialReference(grid.crs_wkt.c_str()));
  if (crs) gdal().OSRSetAxisMappingStrategy(crs.get(), OAMS_TRADITIONAL_GIS_ORDER);
  // All digits that a double has.
  std::array<const char*, 2> options{"COORDINATE_PRECISION=15", nullptr};
  if (std::strcmp(driver, "GeoJSON") != 0) options[0] = nullptr;
  OGRLayerH handle = gdal().GDALDatasetCreateLayer(dataset.get(), "edge_lines", crs.get(), wkbLineString,
                                                   const_cast<char**>(options.data()));
  if (handle == nullptr) return false;
  LineLayer layer(handle, !dxf, grid);
  if (!layer.createFields()) return false;
  // One transaction: GeoPackage would make one for each feature.
  const bool grouped = gdal().GDALDatasetTestCapability(dataset.get(), ODsCTransactions) != 0 &&
                       gdal().GDALDatasetStartTransaction(dataset.get(), FALSE) == OGRERR_NONE;
  for (const EdgeLine& line : lines)
    for (const LineRun& run : runsOf(line))
      if (!layer.write(line, run)) return false;
  return !grouped || gdal().GDALDatasetCommitTransaction(dataset.get()) == OGRERR_NONE;
}

// ---- reading

// Whether a file names the coordinate system that GDAL gives its layers: a GeoJSON without one counts as WGS 84 there,
// but here as numbers of the scan.
bool statesCrs(const InputFile& file) {
  if (std::string_view(driverOf(file.extension())) != "GeoJSON") return true;
  std::string head(std::size_t{1} << 16, '\0');
  const Result<std::size_t> got = file.read(0, head.data(), head.size());
  return got && std::string_view(head).substr(0, *got).find("\"crs\"") != std::string_view::npos;
}

class LineLayerReader {
 public:
  LineLayerReader(const InputFile& file, const Grid& grid, GdalSession& session, const JobControl* job)
      : path_(file.path()), gdal_(session), frame_(LineFrame::world(grid)), lines_(grid, path_, job) {}

  [[nodiscard]] Status read(OGRLayerH layer) {
    gdal().OGR_L_ResetReading(layer);
    // Attributes only: no lines are expected there.
    if (gdal().OGR_L_GetGeomType(layer) == wkbNone) return {};
    for (;;) {
      const FeaturePtr feature(gdal().OGR_L_GetNextFeature(layer));
      if (gdal_.failed())
        return inputError("the lines cannot be read: " + gdal_.reason("the file is damaged"), path_,
                          "the file is cut short or damaged");
      if (!feature) return {};
      // A view of a GeoPackage may have no end.
      if (features_ >= kMostFeatures)
        return inputError(fmt::format("the file has more than {} lines", kMostFeatures), path_,
                          "divide the file, or leave lines out");
      where_ = fmt::format("feature {}", ++features_);
      if (Status status = readFeature(feature.get()); !status) return status;
    }
  }
  [[nodiscard]] Result<std::vector<EdgeLine>> finish() { return lines_.finish(); }

 private:
  static constexpr std::int64_t kMostFeatures = std::int64_t{1} << 18;

  struct Attributes {
    std::optional<std::int64_t> id;
    const char* unclear = nullptr;  // the name of one that cannot be understood
    bool closed = false;
    EdgePoint point;  // all values but the position
  };

  [[nodiscard]] Attributes attributesOf(OGRFeatureH feature) const {
    const auto field = [&](const char* name) -> std::optional<int> {
      const int index = gdal().OGR_F_GetFieldIndex(feature, name);
      if (index < 0 || gdal().OGR_F_IsFieldSetAndNotNull(feature, index) == 0) return std::nullopt;
      return index;
    };
    Attributes found;
    found.point.located = true;
    const auto number = [&](const char* name) -> std::optional<int> {
      const auto i = field(name);
      if (i && gdal().OGR_Fld_GetType(gdal().OGR_F_GetFieldDefnRef(feature, *i)) == OFTString)
        found.unclear = name;
      return i;
    };
    if (const auto i = field("Layer"))
      found.point.located = gdal().OGR_F_GetFieldAsString(feature, *i) != kOtherLayer;
    if (const auto i = number("line")) found.id = gdal().OGR_F_GetFieldAsInteger64(feature, *i);
    if (const auto i = number("closed")) found.closed = gdal().OGR_F_GetFieldAsInteger(feature, *i) != 0;
    if (const auto i = number("located"))
      found.point.located = gdal().OGR_F_GetFieldAsInteger(feature, *i) != 0;
    if (!found.point.located) return found;
    if (const auto i = field("kind")) {
      const std::string_view kind = gdal().OGR_F_GetFieldAsString(feature, *i);
      if (kind == "crease")
        found.point.kind = LineKind::kCrease;
      else if (kind != "step")
        found.unclear = "kind";
    }
    if (const auto i = number("deviation"))
      found.point.deviation =
          static_cast<double>(gdal().OGR_F_GetFieldAsDouble(feature, *i) / frame_.sample_mm);
    if (const auto i = number("step"))
      found.point.step = static_cast<double>(gdal().OGR_F_GetFieldAsDouble(feature, *i) / frame_.height_mm);
    return found;
  }

  [[nodiscard]] Status readFeature(OGRFeatureH feature) {
    OGRGeometryH geometry = gdal().OGR_F_GetGeometryRef(feature);
    const OGRwkbGeometryType type =
        geometry == nullptr ? wkbNone : gdal().OGR_GT_Flatten(gdal().OGR_G_GetGeometryType(geometry));
    const Attributes attributes = attributesOf(feature);
    if (attributes.unclear != nullptr)
      return inputError(fmt::format("{}: its {} cannot be understood", where_, attributes.unclear), path_,
                        "give numbers, and step or crease as kind; or leave the attribute out");
    if (type == wkbLineString) return readLine(geometry, attributes);
    if (type != wkbMultiLineString)
      return inputError(
          fmt::format("{} is no line: {}", where_,
                      geometry == nullptr ? "it has no geometry" : gdal().OGRGeometryTypeToName(type)),
          path_, "give a file of lines alone");
    for (int i = 0; i < gdal().OGR_G_GetGeometryCount(geometry); ++i)
      if (Status status = readLine(gdal().OGR_G_GetGeometryRef(geometry, i), attributes); !status)
        return status;
    return {};
  }

  [[nodiscard]] Status readLine(OGRGeometryH geometry, const Attributes& attributes) {
    int count = gdal().OGR_G_GetPointCount(geometry);
    if (count <= 0) return {};
    EdgePoint point = attributes.point;
    const auto place = [&](int i) {
      return frame_.position(gdal().OGR_G_GetX(geometry, i), gdal().OGR_G_GetY(geometry, i));
    };
    const bool ring = count > 3 && place(0) == place(count - 1);
    if (ring || (count == 2 && place(0) == place(1))) --count;
    point.position = place(0);
    if (!continues(attributes)) {
      lines_.begin(attributes.id.value_or(features_ - 1), attributes.closed || ring);
      own_ = attributes.id.has_value();
    }
    for (int i = 0; i < count; ++i) {
      point.position = place(i);
      if (Status status = lines_.add(point, where_); !status) return status;
    }
    return {};
  }

  // Whether a run belongs to the line of the run before.
  [[nodiscard]] bool continues(const Attributes& attributes) {
    if (lines_.empty() || !own_ || !attributes.id) return false;
    const EdgeLine& line = lines_.last();
    return line.id == *attributes.id && line.closed == attributes.closed && !line.points.empty() &&
           line.points.back().located != attributes.point.located;
  }

  const std::string& path_;
  GdalSession& gdal_;
  LineFrame frame_;
  LineCollector lines_;
  std::string where_;
  std::int64_t features_ = 0;
  bool own_ = false;  // the last line has a number of its own
};

}  // namespace

Result<std::vector<EdgeLine>> readLineVectors(const InputFile& file, const Grid& grid,
                                              const JobControl* job) {
  GdalSession session;
  const std::array<const char*, 2> drivers{driverOf(file.extension()), nullptr};
  const DatasetPtr dataset(gdal().GDALOpenEx(file.pathForGdal().c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                             drivers.data(), nullptr, nullptr));
  if (!dataset || session.failed())
    return inputError(fmt::format("the lines cannot be opened: {}",
                                  session.reason(fmt::format("it is no {} file", drivers[0]))),
                      file.path(), "the file is cut short, damaged or of another format");
  LineLayerReader reader(file, grid, session, job);
  for (int i = 0; i < gdal().GDALDatasetGetLayerCount(dataset.get()); ++i) {
    OGRLayerH layer = gdal().GDALDatasetGetLayer(dataset.get(), i);
    // Definitions of a DXF; where one is used there is a point among the entities.
    if (layer == nullptr || std::string_view(gdal().OGR_L_GetName(layer)) == "blocks") continue;
    if (const OGRSpatialReferenceH crs = gdal().OGR_L_GetSpatialRef(layer); crs != nullptr && statesCrs(file))
      if (const std::string wkt = wktOf(crs); !sameHorizontalCrs(wkt, grid.crs_wkt))
        return inputError(
            fmt::format("the lines are in {}, the scan is in {}", crsName(wkt), crsName(grid.crs_wkt)),
            file.path(), "transform them first: ogr2ogr -t_srs");
    if (Status status = reader.read(layer); !status) return tl::unexpected(status.error());
  }
  return reader.finish();
}

Status writeLineVectors(const std::string& path, std::span<const EdgeLine> lines, const Grid& grid) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  GdalSession session;
  const std::string extension = extensionOf(path);
  const MemoryFile memory(extension);
  if (!writeLineDataset(memory, extension, lines, grid) || session.failed() || memory.bytes().empty())
    return failure("the lines cannot be written: " + session.reason("the library gives no reason"), path,
                   "write them as .csv");
  if (Status status = file->write(memory.bytes()); !status) return status;
  return file->commit();
}

}  // namespace fettle::engine

#include <array>
#include <utility>

#include <fmt/format.h>

#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/mesh/mesh_sampling.h"
#include "engine/io/mesh/ply_header.h"
#include "engine/io/mesh/ply_mesh.h"
#include "engine/io/points/range_grid.h"

namespace fettle::engine {

namespace {

class PlyBody {
 public:
  PlyBody(const InputFile& file, const PlyHeader& header, JobControl& job)
      : file_(file), header_(header), text_(file, header.body), job_(job) {}

  // Reads points, and the places of a range grid or the triangles of faces where present. Elements after the
  // last of the two are not read.
  Status read(TriangleMesh& mesh, RangeGrid& range) {
    const PlyElement* const places = rangeElement(header_);
    const PlyElement* const faces = places == nullptr ? listElement(header_, "face") : nullptr;
    mesh.corners.organized =
        places != nullptr || faces != nullptr;  // places and faces refer to them by number
    bool vertices_read = false, lists_read = places == nullptr && faces == nullptr;
    for (const PlyElement& element : header_.elements) {
      Status status;
      if (element.name == "vertex" && !vertices_read) {
        status = readVertices(element, mesh.corners);
        vertices_read = true;
      } else if (&element == places) {
        status = readRange(element, range);
        lists_read = true;
      } else if (&element == faces) {
        status = readLists<Fan>(element, mesh, "face");
        lists_read = true;
      } else {
        status = skipElement(element);
      }
      if (!status) return status;
      if (vertices_read && lists_read) break;
    }
    if (vertices_read) {
      if (ascii() && text_.lastLineIsOpen()) mesh.corners.warnings.emplace_back(kOpenLastLine);
      return {};
    }
    return inputError("the file holds no vertices", file_.path(), "is this a file of points?");
  }

 private:
  // The element of a name with a list of vertices, null if there is none or it is empty.
  static const PlyElement* listElement(const PlyHeader& header, std::string_view name) {
    for (const PlyElement& element : header.elements)
      if (element.name == name && element.count > 0 && cornerList(element) < element.properties.size())
        return &element;
    return nullptr;
  }

  // Without the sides of the grid its places are undefined, and the file is read as points.
  static const PlyElement* rangeElement(const PlyHeader& header) {
    return header.range_columns > 0 && header.range_rows > 0 ? listElement(header, "range_grid") : nullptr;
  }

  [[nodiscard]] bool ascii() const { return header_.encoding == PlyEncoding::kAscii; }
  [[nodiscard]] std::uint64_t left() const { return file_.size() - text_.offset(); }

  Status endsEarly() const {
    if (!text_.status()) return text_.status();
    return inputError("the file ends before all that its header states", file_.path(),
                      "the file is cut short");
  }

  // Least size of an item in the file, to detect a false count before memory is allocated for it.
  [[nodiscard]] std::uint64_t leastBytes(const PlyElement& element) const {
    std::uint64_t bytes = 0;
    for (const PlyProperty& p : element.properties)
      bytes += ascii() ? 2 : bytesOf(p.count_type ? *p.count_type : p.type);
    return bytes;
  }
  [[nodiscard]] bool promisesTooMuch(const PlyElement& element) const {
    const std::uint64_t least = leastBytes(element);
    // The last line of a text needs no end; an item without properties has no bytes.
    return least != 0 && element.count > (left() + 1) / least;
  }

  static std::size_t cornerList(const PlyElement& element) {
    std::size_t i = 0;
    while (
        i < element.properties.size() &&
        !(element.properties[i].count_type && element.properties[i].type < PlyType::kFloat32 &&
          (element.properties[i].name == "vertex_indices" || element.properties[i].name == "vertex_index")))
      ++i;
    return i;
  }

  // A polygon as a fan of triangles around its first corner, corner by corner.
  class Fan {
   public:
    explicit Fan(TriangleMesh& mesh) : mesh_(mesh) {}
    // False for an invalid number of a corner.
    bool add(double index) {
      if (!(index >= 0.0 && index < 4294967295.0)) return false;
      const auto corner = static_cast<std::uint32_t>(index);
      if (corners_ == 0) first_ = corner;
      if (corners_ >= 2) mesh_.triangles.push_back({first_, last_, corner});
      last_ = corner;
      ++corners_;
      return true;
    }

   private:
    TriangleMesh& mesh_;
    std::uint32_t first_ = 0, last_ = 0;
    std::uint64_t corners_ = 0;
  };

  // A place of a range grid: the number of its point, or none.
  class Place {
   public:
    explicit Place(RangeGrid& range) : range_(range) { range.points.push_back(RangeGrid::kNone); }
    bool add(double index) {
      if (!(index >= 0.0 && index < 4294967295.0)) return false;
      if (range_.points.back() == RangeGrid::kNone) range_.points.back() = static_cast<std::uint32_t>(index);
      return true;
    }

   private:
    RangeGrid& range_;
  };

  Status readRange(const PlyElement& element, RangeGrid& range) {
    range.columns = header_.range_columns;
    range.rows = header_.range_rows;
    if (element.count / range.columns != range.rows || element.count % range.columns != 0)
      return inputError(
          fmt::format("the range grid of {} x {} has {} places", range.columns, range.rows, element.count),
          file_.path(), "the file is damaged");
    if (promisesTooMuch(element)) return endsEarly();
    range.points.reserve(element.count);
    return readLists<Place>(element, range, "place");
  }

  // Lists of vertices, each into a Sink on `target`, which is created when a list begins and gets its
  // numbers; it returns false for an invalid one.
  template <class Sink, class Target>
  Status readLists(const PlyElement& element, Target& target, const char* what) {
    if (promisesTooMuch(element)) return endsEarly();
    const std::size_t list = cornerList(element);
    const auto damaged = [&](std::uint64_t i) {
      return inputError(fmt::format("{} {} does not hold the numbers that the header states", what, i + 1),
                        file_.path(), "the file is damaged or cut short");
    };
    std::string_view line;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (ascii() && !nextLine(line)) return endsEarly();
      const bool read = ascii() ? readAsciiList<Sink>(line, element, list, target)
                                : readBinaryList<Sink>(element, list, target);
      if (!read) return text_.status() ? Status(damaged(i)) : text_.status();
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  template <class Sink, class Target>
  bool readBinaryList(const PlyElement& element, std::size_t list, Target& target) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (p != list) {
        if (!skipBinary(property)) return false;
        continue;
      }
      const char* raw = text_.bytes(bytesOf(*property.count_type));
      if (raw == nullptr) return false;
      const double items = decodePly(raw, *property.count_type, header_.encoding);
      Sink sink(target);
      for (double k = 0.0; k < items; k += 1.0) {
        raw = text_.bytes(bytesOf(property.type));
        if (raw == nullptr || !sink.add(decodePly(raw, property.type, header_.encoding))) return false;
      }
    }
    return true;
  }

  template <class Sink, class Target>
  static bool readAsciiList(std::string_view line, const PlyElement& element, std::size_t list,
                            Target& target) {
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto next = [&](double& value) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      return parseNumber(at, end, value);
    };
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      double value = 0.0, item = 0.0;
      if (!next(value)) return false;
      if (!element.properties[p].count_type) continue;
      if (p != list) {
        for (double k = 0.0; k < value; k += 1.0)
          if (!next(item)) return false;
        continue;
      }
      Sink sink(target);
      for (double k = 0.0; k < value; k += 1.0)
        if (!next(item) || !sink.add(item)) return false;
    }
    return true;
  }

  Status skipElement(const PlyElement& element) {
    if (promisesTooMuch(element)) return endsEarly();
    if (ascii()) {
      std::string_view line;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (!nextLine(line)) return endsEarly();
        if (Status s = step(i); !s) return s;
      }
      return {};
    }
    if (const auto stride = element.stride()) {
      text_.skip(element.count * *stride);
      return {};
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& p : element.properties)
        if (!skipBinary(p)) return endsEarly();
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  bool skipBinary(const PlyProperty& property) {
    std::uint64_t bytes = bytesOf(property.type);
    if (property.count_type) {
      const char* count = text_.bytes(bytesOf(*property.count_type));
      if (count == nullptr) return false;
      const double items = decodePly(count, *property.count_type, header_.encoding);
      if (items < 0.0) return false;
      bytes *= static_cast<std::uint64_t>(items);
    }
    if (bytes > left()) return false;
    text_.skip(bytes);
    return true;
  }

  // Lines of a text body; empty ones are not items.
  bool nextLine(std::string_view& line) {
    while (text_.line(line))
      if (line.find_first_not_of(" \t") != std::string_view::npos) return true;
    return false;
  }

  Status readVertices(const PlyElement& element, PointCloud& cloud) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto index = element.indexOf(std::string(1, "xyz"[k]));
      if (!index)
        return inputError(fmt::format("the vertices have no property \"{}\"", "xyz"[k]), file_.path(),
                          "is this a file of points?");
      axes[k] = *index;
    }
    if (promisesTooMuch(element)) return endsEarly();
    for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) axis->reserve(element.count);
    if (ascii()) return readAsciiVertices(element, axes, cloud);
    return element.stride() ? readPlainVertices(element, axes, cloud)
                            : readListVertices(element, axes, cloud);
  }

  Status readPlainVertices(const PlyElement& element, const std::array<std::size_t, 3>& axes,
                           PointCloud& cloud) {
    const std::size_t stride = *element.stride();
    std::array<std::size_t, 3> at{};
    std::array<PlyType, 3> type{};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < axes[k]; ++i) at[k] += bytesOf(element.properties[i].type);
      type[k] = element.properties[axes[k]].type;
    }
    if (stride > TextReader::kLongest)
      return inputError(fmt::format("a vertex of {} bytes is not valid", stride), file_.path());
    const PlyEncoding e = header_.encoding;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const char* item = text_.bytes(stride);
      if (item == nullptr) return endsEarly();
      cloud.add(decodePly(item + at[0], type[0], e), decodePly(item + at[1], type[1], e),
                decodePly(item + at[2], type[2], e));
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  Status readListVertices(const PlyElement& element, const std::array<std::size_t, 3>& axes,
                          PointCloud& cloud) {
    std::array<double, 3> point{};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        std::size_t k = 0;
        while (k < 3 && axes[k] != p) ++k;
        if (k == 3) {
          if (!skipBinary(property)) return endsEarly();
          continue;
        }
        const char* raw = text_.bytes(bytesOf(property.type));
        if (raw == nullptr) return endsEarly();
        point[k] = decodePly(raw, property.type, header_.encoding);
      }
      cloud.add(point[0], point[1], point[2]);
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  Status readAsciiVertices(const PlyElement& element, const std::array<std::size_t, 3>& axes,
                           PointCloud& cloud) {
    std::string_view line;
    std::array<double, 3> point{};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!nextLine(line)) return endsEarly();
      if (!readAsciiVertex(line, element, axes, point))
        return inputError(fmt::format("vertex {} does not hold the numbers that the header states", i + 1),
                          file_.path(), "the file is damaged");
      cloud.add(point[0], point[1], point[2]);
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  static bool readAsciiVertex(std::string_view line, const PlyElement& element,
                              const std::array<std::size_t, 3>& axes, std::array<double, 3>& point) {
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto next = [&](double& value) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      return parseNumber(at, end, value) && (at == end || *at == ' ' || *at == '\t');
    };
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      double value = 0.0;
      if (!next(value)) return false;
      if (element.properties[p].count_type) {
        double ignored = 0.0;
        for (double items = value; items >= 1.0; items -= 1.0)
          if (!next(ignored)) return false;
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k)
        if (axes[k] == p) point[k] = value;
    }
    return true;
  }

  Status step(std::uint64_t item) {
    if (item % 65536 != 65535) return {};
    job_.advance(text_.offset() - std::exchange(reported_, text_.offset()));
    return job_.cancelled() ? Status(cancelled()) : Status{};
  }

  const InputFile& file_;
  const PlyHeader& header_;
  TextReader text_;
  JobControl& job_;
  std::uint64_t reported_ = 0;
};

bool looksLikePly(std::string_view head, std::string_view) {
  return head.starts_with("ply\n") || head.starts_with("ply\r\n") || head.starts_with("ply ");
}

Result<Imported> readPly(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const Result<PlyHeader> header = readPlyHeader(file);
  if (!header) return tl::unexpected(header.error());
  job.begin("reading", file.size());
  TriangleMesh mesh;
  mesh.corners.unit = header->unit;
  mesh.corners.takeRaster(header->raster);
  RangeGrid range;
  if (Status status = PlyBody(file, *header, job).read(mesh, range); !status)
    return tl::unexpected(status.error());
  if (range.columns > 0) return gridRange(std::move(mesh.corners), range, options, "PLY", file.path(), job);
  return mesh.corners.organized ? sampleMesh(std::move(mesh), options, "PLY", file.path(), job)
                                : gridPoints(std::move(mesh.corners), options, "PLY", file.path(), job);
}

}  // namespace

bool isPly(const InputFile& file) {
  char head[5] = {};
  const auto read = file.read(0, head, sizeof head);
  return read && looksLikePly({head, *read}, {});
}

Result<TriangleMesh> readPlyMesh(const InputFile& file, JobControl& job) {
  const Result<PlyHeader> header = readPlyHeader(file);
  if (!header) return tl::unexpected(header.error());
  job.begin("reading", file.size());
  TriangleMesh mesh;
  RangeGrid range;
  if (Status status = PlyBody(file, *header, job).read(mesh, range); !status)
    return tl::unexpected(status.error());
  if (mesh.triangles.empty())
    return inputError("it holds points and no faces", file.path(),
                      "a nominal is a mesh: export it with its faces");
  return mesh;
}

constexpr std::string_view kPlyExtensions[] = {".ply"};
constexpr Format kPlyFormat{
    .info = {"PLY", "PLY points or mesh", kPlyExtensions, true, true},
    .recognises = looksLikePly,
    .read = readPly,
    .write = writePly,
    .mesh = true,
};

}  // namespace fettle::engine

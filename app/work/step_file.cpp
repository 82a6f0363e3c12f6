#include "app/work/step_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace fettle::app {

namespace {

using engine::ShapeKind;

constexpr double kTurn = 2.0 * std::numbers::pi;

std::string realOf(double value) {
  std::string text = fmt::format("{:.15G}", value == 0.0 ? 0.0 : value);
  if (text.find('.') != std::string::npos) return text;
  const std::size_t exponent = std::min(text.find('E'), text.size());
  return fmt::format("{}.{}", text.substr(0, exponent), text.substr(exponent));
}

std::string triple(const glm::dvec3& v) {
  return fmt::format("({},{},{})", realOf(v.x), realOf(v.y), realOf(v.z));
}

// A text of ISO 10303-21: printable ASCII, apostrophes doubled, others as question marks.
std::string textOf(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += c;
    out += c < ' ' || c > '~' ? '?' : c;
  }
  return out + "'";
}

// The entities of the data section, each with its number.
class Entities {
 public:
  int add(const std::string& entity) {
    text_ += fmt::format("#{}={};\n", ++last_, entity);
    return last_;
  }
  int point(const glm::dvec3& p) { return add(fmt::format("CARTESIAN_POINT('',{})", triple(p))); }
  int direction(const glm::dvec3& d) { return add(fmt::format("DIRECTION('',{})", triple(d))); }
  int placement(const glm::dvec3& origin, const glm::dvec3& axis, const glm::dvec3& start) {
    const int p = point(origin), z = direction(axis), x = direction(start);
    return add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", p, z, x));
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
  int last_ = 0;
};

// A point of a face, and its edges along u and v.
class Face {
 public:
  explicit Face(const BoundedShape& face) : face_(face), side_(glm::cross(face.axis, face.start)) {}

  [[nodiscard]] glm::dvec3 at(double u, double v) const {
    if (face_.shape.kind == ShapeKind::kPlane) return face_.origin + u * face_.start + v * side_;
    return face_.origin + across(v) * outward(u) + along(v) * face_.axis;
  }
  // From u_from to u_to at v.
  int edgeAlongU(Entities& out, double v) const {
    if (face_.shape.kind == ShapeKind::kPlane) return line(out, at(face_.u_from, v), at(face_.u_to, v));
    return circle(out, face_.origin + along(v) * face_.axis, face_.axis, face_.start, across(v));
  }
  int edgeAlongV(Entities& out, double u) const {
    const ShapeKind kind = face_.shape.kind;
    if (kind != ShapeKind::kSphere && kind != ShapeKind::kTorus)
      return line(out, at(u, face_.v_from), at(u, face_.v_to));
    const glm::dvec3 out_of = outward(u);
    const bool ring = kind == ShapeKind::kTorus;
    return circle(out, face_.origin + (ring ? face_.shape.radius : 0.0) * out_of,
                  glm::cross(out_of, face_.axis), out_of,
                  ring ? face_.shape.tube_radius : face_.shape.radius);
  }

 private:
  [[nodiscard]] glm::dvec3 outward(double u) const { return std::cos(u) * face_.start + std::sin(u) * side_; }
  [[nodiscard]] double across(double v) const {
    const engine::Shape& s = face_.shape;
    switch (s.kind) {
      case ShapeKind::kSphere:
        return s.radius * std::cos(v);
      case ShapeKind::kTorus:
        return s.radius + s.tube_radius * std::cos(v);
      case ShapeKind::kCone:
        return face_.radius + v * std::tan(s.half_angle);
      default:
        return s.radius;
    }
  }
  [[nodiscard]] double along(double v) const {
    const engine::Shape& s = face_.shape;
    return s.kind == ShapeKind::kSphere  ? s.radius * std::sin(v)
           : s.kind == ShapeKind::kTorus ? s.tube_radius * std::sin(v)
                                         : v;
  }
  static int line(Entities& out, const glm::dvec3& from, const glm::dvec3& to) {
    const int p = out.point(from), d = out.direction(glm::normalize(to - from));
    const int v = out.add(fmt::format("VECTOR('',#{},1.)", d));
    return out.add(fmt::format("LINE('',#{},#{})", p, v));
  }
  static int circle(Entities& out, const glm::dvec3& centre, const glm::dvec3& axis, const glm::dvec3& start,
                    double radius) {
    const int at = out.placement(centre, axis, start);
    return out.add(fmt::format("CIRCLE('',#{},{})", at, realOf(radius)));
  }

  const BoundedShape& face_;
  glm::dvec3 side_;
};

int addFace(Entities& out, const BoundedShape& bounded) {
  const Face face(bounded);
  const int at = out.placement(bounded.origin, bounded.axis, bounded.start);
  const engine::Shape& s = bounded.shape;
  std::string surface;
  switch (s.kind) {
    case ShapeKind::kPlane:
      surface = fmt::format("PLANE('',#{})", at);
      break;
    case ShapeKind::kSphere:
      surface = fmt::format("SPHERICAL_SURFACE('',#{},{})", at, realOf(s.radius));
      break;
    case ShapeKind::kCylinder:
      surface = fmt::format("CYLINDRICAL_SURFACE('',#{},{})", at, realOf(s.radius));
      break;
    case ShapeKind::kCone:
      surface =
          fmt::format("CONICAL_SURFACE('',#{},{},{})", at, realOf(bounded.radius), realOf(s.half_angle));
      break;
    case ShapeKind::kTorus:
      surface = fmt::format("TOROIDAL_SURFACE('',#{},{},{})", at, realOf(s.radius), realOf(s.tube_radius));
      break;
  }
  const int of = out.add(surface);
  // Corners anticlockwise seen against the surface's normal, which is that of u times v.
  const std::array<std::pair<double, double>, 4> corners{std::pair(bounded.u_from, bounded.v_from),
                                                         {bounded.u_to, bounded.v_from},
                                                         {bounded.u_to, bounded.v_to},
                                                         {bounded.u_from, bounded.v_to}};
  std::array<int, 4> vertices{};
  for (std::size_t k = 0; k < 4; ++k) {
    const int p = out.point(face.at(corners[k].first, corners[k].second));
    vertices[k] = out.add(fmt::format("VERTEX_POINT('',#{})", p));
  }
  struct Edge {
    int curve, from, to;
    char sense;
  };
  const std::array<Edge, 4> edges{Edge{face.edgeAlongU(out, bounded.v_from), 0, 1, 'T'},
                                  {face.edgeAlongV(out, bounded.u_to), 1, 2, 'T'},
                                  {face.edgeAlongU(out, bounded.v_to), 3, 2, 'F'},
                                  {face.edgeAlongV(out, bounded.u_from), 0, 3, 'F'}};
  std::string loop;
  for (const Edge& edge : edges) {
    const int curve =
        out.add(fmt::format("EDGE_CURVE('',#{},#{},#{},.T.)", vertices[static_cast<std::size_t>(edge.from)],
                            vertices[static_cast<std::size_t>(edge.to)], edge.curve));
    loop += fmt::format("{}#{}", loop.empty() ? "" : ",",
                        out.add(fmt::format("ORIENTED_EDGE('',*,*,#{},.{}.)", curve, edge.sense)));
  }
  const int edge_loop = out.add(fmt::format("EDGE_LOOP('',({}))", loop));
  const int bound = out.add(fmt::format("FACE_BOUND('',#{},.T.)", edge_loop));
  return out.add(fmt::format("ADVANCED_FACE({},(#{}),#{},.T.)", textOf(bounded.name), bound, of));
}

// The smallest stretch of a turn that holds all angles but for gaps of less than a degree; a whole turn where no gap is larger.
std::pair<double, double> angularRange(const std::vector<double>& angles) {
  constexpr int kBins = 720;
  std::vector<bool> taken(kBins, false);
  for (const double a : angles)
    taken[static_cast<std::size_t>(std::floor((a / kTurn - std::floor(a / kTurn)) * kBins)) % kBins] = true;
  int longest = 0, behind = 0;
  for (int from = 0, run = 0; from < 2 * kBins; ++from) {
    run = taken[static_cast<std::size_t>(from % kBins)] ? 0 : run + 1;
    if (run > longest && run <= kBins) {
      longest = run;
      behind = from + 1;
    }
  }
  if (longest <= 12) return {0.0, kTurn};
  const double begin = behind * kTurn / kBins;
  double low = kTurn, high = 0.0;
  for (const double a : angles) {
    const double from_begin = a - begin, turned = from_begin - kTurn * std::floor(from_begin / kTurn);
    low = std::min(low, turned);
    high = std::max(high, turned);
  }
  return {begin + low, begin + high};
}

}  // namespace

std::vector<BoundedShape> boundedBy(const std::string& name, const engine::Shape& shape,
                                    const engine::FitSamples& samples) {
  BoundedShape face{.name = name, .shape = shape};
  face.axis = shape.kind == ShapeKind::kSphere ? glm::dvec3(1.0, 0.0, 0.0) : shape.direction;
  // Of a sphere an axis along x: what is seen from above does not reach its poles.
  const glm::dvec3 other = shape.kind == ShapeKind::kSphere ? glm::dvec3(0.0, 0.0, 1.0)
                           : std::abs(face.axis.x) < 0.8    ? glm::dvec3(1.0, 0.0, 0.0)
                                                            : glm::dvec3(0.0, 1.0, 0.0);
  face.start = glm::normalize(other - glm::dot(other, face.axis) * face.axis);
  face.origin = shape.point;
  const glm::dvec3 side = glm::cross(face.axis, face.start);
  std::vector<double> turns;
  double u_low = std::numeric_limits<double>::infinity(), u_high = -u_low, v_low = u_low, v_high = -u_low;
  engine::FitSamples::Block block;
  for (std::size_t b = 0; b < samples.blocks(); ++b) {
    samples.read(b, block);
    for (int i = 0; i < block.count; ++i) {
      const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] + samples.middle() - face.origin;
      const double x = glm::dot(p, face.start), y = glm::dot(p, side), z = glm::dot(p, face.axis);
      double v = z;
      if (shape.kind == ShapeKind::kPlane) {
        u_low = std::min(u_low, x);
        u_high = std::max(u_high, x);
        v = y;
      } else {
        turns.push_back(std::atan2(y, x));
        if (shape.kind == ShapeKind::kSphere) v = std::atan2(z, std::hypot(x, y));
        // The tube's angle from its middle, upwards of a raised ring, so that it is counted through no jump.
        if (shape.kind == ShapeKind::kTorus) {
          const double turn = std::atan2(z, std::hypot(x, y) - shape.radius);
          const double towards = (shape.hollow ? -1.0 : 1.0) * (face.axis.z < 0.0 ? -1.0 : 1.0) *
                                 (std::abs(face.axis.z) > 0.5 ? 0.25 * kTurn : 0.0);
          v = towards + std::remainder(turn - towards, kTurn);
        }
      }
      v_low = std::min(v_low, v);
      v_high = std::max(v_high, v);
    }
  }
  face.v_from = v_low;
  face.v_to = v_high;
  if (shape.kind == ShapeKind::kPlane) {
    face.u_from = u_low;
    face.u_to = u_high;
    return {face};
  }
  if (shape.kind == ShapeKind::kCone) {
    // From a thousandth of its length on: at the apex there is no normal.
    v_low = std::max(v_low, 1e-3 * v_high);
    const double middle = 0.5 * (v_low + v_high);
    face.origin += middle * face.axis;
    face.radius = middle * std::tan(shape.half_angle);
    face.v_from = v_low - middle;
    face.v_to = v_high - middle;
  }
  if (shape.kind == ShapeKind::kSphere) {
    constexpr double kNearPole = 0.49 * std::numbers::pi;
    face.v_from = std::max(face.v_from, -kNearPole);
    face.v_to = std::min(face.v_to, kNearPole);
  }
  const auto [from, to] = angularRange(turns);
  const glm::dvec3 begin = std::cos(from) * face.start + std::sin(from) * side;
  face.start = begin;
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from) / (0.6 * kTurn))));
  std::vector<BoundedShape> faces;
  for (int k = 0; k < pieces; ++k) {
    BoundedShape piece = face;
    if (pieces > 1) piece.name += fmt::format(", part {}", k + 1);
    piece.u_from = (to - from) * k / pieces;
    piece.u_to = (to - from) * (k + 1) / pieces;
    faces.push_back(piece);
  }
  return faces;
}

std::string stepFile(const std::string& product, const std::vector<BoundedShape>& faces) {
  Entities out;
  const int context = out.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
  out.add(fmt::format(
      "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{})", context));
  const int product_context = out.add(fmt::format("PRODUCT_CONTEXT('',#{},'mechanical')", context));
  const int part = out.add(fmt::format("PRODUCT({0},{0},'',(#{1}))", textOf(product), product_context));
  out.add(fmt::format("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{}))", part));
  const int formation = out.add(fmt::format("PRODUCT_DEFINITION_FORMATION('','',#{})", part));
  const int definition_context =
      out.add(fmt::format("PRODUCT_DEFINITION_CONTEXT('part definition',#{},'design')", context));
  const int definition =
      out.add(fmt::format("PRODUCT_DEFINITION('design','',#{},#{})", formation, definition_context));
  const int shape = out.add(fmt::format("PRODUCT_DEFINITION_SHAPE('','',#{})", definition));
  const int mm = out.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
  const int radian = out.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int steradian = out.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int accuracy =
      out.add(fmt::format("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#{},'distance_accuracy_value'"
                          ",'confusion accuracy')",
                          mm));
  const int units =
      out.add(fmt::format("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{}))"
                          "GLOBAL_UNIT_ASSIGNED_CONTEXT("
                          "(#{},#{},#{}))REPRESENTATION_CONTEXT('',''))",
                          accuracy, mm, radian, steradian));
  std::string models;
  for (const BoundedShape& face : faces) {
    const int shell = out.add(fmt::format("OPEN_SHELL('',(#{}))", addFace(out, face)));
    models +=
        fmt::format("{}#{}", models.empty() ? "" : ",",
                    out.add(fmt::format("SHELL_BASED_SURFACE_MODEL({},(#{}))", textOf(face.name), shell)));
  }
  const int origin = out.placement(glm::dvec3(0.0), {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0});
  const int representation =
      out.add(fmt::format("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{},{}),#{})", origin, models, units));
  out.add(fmt::format("SHAPE_DEFINITION_REPRESENTATION(#{},#{})", shape, representation));
  return fmt::format(
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('shapes fitted to a scan'),'2;1');\n"
      "FILE_NAME({},'1970-01-01T00:00:00',(''),(''),'','Fettle','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 "
      "}}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
      textOf(product), out.text());
}

}  // namespace fettle::app

// STL (3D Systems, "StereoLithography Interface Specification", 1989), as bytes and as text: triangles with
// three corners each, without units.

#include "engine/io/mesh/stl_file.h"

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "engine/io/files/little_endian.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kHeaderText = 80;
constexpr std::uint64_t kStlHeader = kHeaderText + 4;
constexpr std::string_view kZeroAt = ", zero at ";
constexpr std::uint64_t kTriangle = 50;
constexpr std::uint64_t kLook = 65536;

void addTriangle(TriangleMesh& mesh) {
  const auto next = static_cast<std::uint32_t>(mesh.triangles.size() * 3);
  mesh.triangles.push_back({next, next + 1, next + 2});
}

Status readBytes(const InputFile& file, std::uint64_t count, TriangleMesh& mesh, JobControl& job) {
  for (auto* axis : {&mesh.corners.x, &mesh.corners.y, &mesh.corners.z}) axis->reserve(count * 3);
  mesh.triangles.reserve(count);
  TextReader body(file, kStlHeader);
  job.begin("reading", count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* triangle = body.bytes(kTriangle);
    if (triangle == nullptr)
      return body.status()
                 ? inputError("the file ends inside a triangle", file.path(), "the file is cut short")
                 : body.status();
    // Skip the normal, which follows from the corners.
    for (std::size_t k = 12; k < 48; k += 12)
      mesh.corners.add(static_cast<double>(little<float>(triangle + k)),
                       static_cast<double>(little<float>(triangle + k + 4)),
                       static_cast<double>(little<float>(triangle + k + 8)));
    addTriangle(mesh);
    if (i % kLook == kLook - 1) {
      job.advance(kLook);
      if (job.cancelled()) return cancelled();
    }
  }
  return {};
}

// "vertex x y z" three times per facet; of the words around them only the last one counts, which
// distinguishes a complete file from the beginning of one.
Status readText(const InputFile& file, TriangleMesh& mesh, JobControl& job) {
  TextReader text(file);
  job.begin("reading", file.size());
  std::string_view word;
  std::uint64_t corners = 0, reported = 0;
  bool ended = false;
  while (text.word(word)) {
    ended = ended || word == "endsolid";
    if (word != "vertex") continue;
    std::array<double, 3> at{};
    for (double& value : at) {
      const bool there = text.word(word);
      const char* begin = there ? word.data() : nullptr;
      if (!there || !parseNumber(begin, word.data() + word.size(), value) ||
          begin != word.data() + word.size())
        return inputError(fmt::format("corner {} does not hold three numbers", corners + 1), file.path(),
                          "the file is cut short or damaged");
    }
    mesh.corners.add(at[0], at[1], at[2]);
    if (++corners % 3 == 0) addTriangle(mesh);
    if (corners % kLook == 0) {
      job.advance(text.offset() - std::exchange(reported, text.offset()));
      if (job.cancelled()) return cancelled();
    }
  }
  if (!text.status()) return text.status();
  if (corners % 3 != 0 || !ended)
    return inputError("the file ends before its endsolid", file.path(), "the file is cut short");
  return {};
}

}  // namespace

std::string stlHeader(const LengthUnit& unit, const glm::dvec2& zero) {
  // It must not begin with "solid", otherwise readers take the file for text.
  std::string text = fmt::format("field, units {}", unit.name);
  if (text.size() > kHeaderText) text = "field";
  if (zero != glm::dvec2(0.0)) {
    // The shortest digits that give the same doubles: 80 bytes hold them beside any unit of ours.
    const std::string at = fmt::format("{}{} {}", kZeroAt, zero.x, zero.y);
    if (text.size() + at.size() <= kHeaderText) text += at;
  }
  text.resize(kHeaderText, ' ');
  return text;
}

StlHeader stlHeaderOf(std::string_view bytes) {
  StlHeader header;
  bytes = bytes.substr(0, kHeaderText);
  if (!looksLikeText(bytes)) return header;
  const std::size_t at = bytes.find(kZeroAt);
  header.unit = lengthUnitFromComment(bytes.substr(0, at));
  if (at == std::string_view::npos) return header;
  const char *p = bytes.data() + at + kZeroAt.size(), *end = bytes.data() + bytes.size();
  glm::dvec2 zero{0.0};
  if (!parseNumber(p, end, zero.x) || p == end || *p++ != ' ' || !parseNumber(p, end, zero.y)) return header;
  constexpr double kFarthest = 1e15;
  if (std::abs(zero.x) <= kFarthest && std::abs(zero.y) <= kFarthest) header.zero = zero;
  return header;
}

Result<StlMesh> readStlMesh(const InputFile& file, JobControl& job) {
  StlMesh read;
  read.mesh.corners.organized = true;
  std::array<char, kStlHeader> head{};
  const Result<std::size_t> got = file.read(0, head.data(), head.size());
  if (!got) return tl::unexpected(got.error());
  // Binary files may begin with "solid" too: their size decides.
  const auto count = static_cast<std::uint64_t>(little<std::uint32_t>(&head[80]));
  const bool whole = *got == kStlHeader && file.size() - kStlHeader >= count * kTriangle;
  const bool text = std::string_view(head.data(), 5) == "solid" && looksLikeText({head.data(), *got});
  Status status;
  if (text)
    status = readText(file, read.mesh, job);
  else if (!whole)
    status = inputError(fmt::format("the file is too short for {} triangles", count), file.path(),
                        "the file is cut short or not an STL");
  else
    status = readBytes(file, count, read.mesh, job);
  if (!status) return tl::unexpected(status.error());
  if (!text) {
    read.header = stlHeaderOf({head.data(), head.size()});
    read.not_counted = (file.size() - kStlHeader - count * kTriangle) / kTriangle;
  }
  return read;
}

}  // namespace fettle::engine

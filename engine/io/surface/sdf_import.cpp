// SDF (sdf.h), text and binary.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/base/lower_case.h"
#include "engine/io/field_limits.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/rows_down.h"
#include "engine/io/surface/sdf.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

struct SdfHeader {
  std::uint64_t points = 0, profiles = 0;
  double x_scale = 0.0, y_scale = 0.0, z_scale = 0.0;  // [m]
  std::uint64_t compression = 0, type = 0, check = 0;
  std::uint64_t data = 0;  // offset of the first profile
};

bool isSdfText(std::string_view head) {
  return head.starts_with("aISO-") || head.starts_with("aBCR-");
}
bool isSdfBinary(std::string_view head) {
  return head.starts_with("bISO-") || head.starts_with("bBCR-");
}
bool looksLikeSdf(std::string_view head, std::string_view) {
  return isSdfText(head) || isSdfBinary(head);
}

tl::unexpected<Error> badHeader(const std::string& what, const std::string& path) {
  return inputError(what, path, "the file is damaged");
}

Status checkSdf(SdfHeader& h, const std::string& path) {
  if (h.compression != 0)
    return inputError(fmt::format("its data are compressed by method {}", h.compression), path,
                      "export it without compression");
  if (h.type >= kSdfTypes) return badHeader(fmt::format("data of type {}", h.type), path);
  if (h.points == 0 || h.profiles == 0)
    return badHeader(fmt::format("the header states {} profiles of {} points", h.profiles, h.points), path);
  // A single profile has no distance to the next.
  if (h.profiles == 1 && h.y_scale == 0.0) h.y_scale = h.x_scale;
  const auto usable = [](double v) { return std::isfinite(v) && v > 0.0; };
  if (!usable(h.x_scale) || !usable(h.y_scale) || !std::isfinite(h.z_scale) || h.z_scale == 0.0)
    return inputError("the header's scales are not lengths", path, "the file is damaged");
  return checkFieldSize(h.points, h.profiles, 0, path);
}

// Binary headers: version 8, ManufacID 10, CreateDate 12, ModDate 12, two counts, four doubles, three bytes.
Result<SdfHeader> readBinaryHeader(const InputFile& file) {
  std::array<char, kSdfHeader + 4> bytes{};
  const Result<std::size_t> got = file.read(0, bytes.data(), bytes.size());
  if (!got) return tl::unexpected(got.error());
  const bool second = bytes[5] == '2';
  const std::size_t size = second ? kSdfHeader + 4 : kSdfHeader;
  if (*got < size) return inputError("the header is cut short", file.path(), "the file is cut short");
  SdfHeader h;
  std::size_t at = 8 + 10 + 12 + 12;
  const auto count = [&]() -> std::uint64_t {
    const std::size_t from = at;
    at += second ? 4 : 2;
    return second ? little<std::uint32_t>(&bytes[from]) : little<std::uint16_t>(&bytes[from]);
  };
  h.points = count();
  h.profiles = count();
  h.x_scale = little<double>(&bytes[at]);
  h.y_scale = little<double>(&bytes[at + 8]);
  h.z_scale = little<double>(&bytes[at + 16]);  // Zresolution follows, which nothing depends on
  h.compression = static_cast<std::uint8_t>(bytes[at + 32]);
  h.type = static_cast<std::uint8_t>(bytes[at + 33]);
  h.check = static_cast<std::uint8_t>(bytes[at + 34]);
  h.data = size;
  return h;
}

// "key = value" line by line, up to a line that begins with a star; unknown keys are those of manufacturers.
Result<SdfHeader> readTextHeader(TextReader& text, const std::string& path) {
  SdfHeader h;
  std::string_view line;
  bool first = true, ended = false;
  int found = 0;
  while (!ended && text.line(line)) {
    if (std::exchange(first, false)) continue;  // the version
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos || line[begin] == ';') continue;
    ended = line[begin] == '*';
    const std::size_t equals = line.find('=');
    if (ended || equals == std::string_view::npos) continue;
    std::string key = lowerCase(line.substr(begin, equals - begin));
    key.resize(key.find_last_not_of(" \t") + 1);
    std::string_view value = line.substr(equals + 1);
    value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
    value = value.substr(0, value.find_last_not_of(" \t") + 1);
    const std::pair<const char*, std::uint64_t*> counts[] = {{"numpoints", &h.points},
                                                             {"numprofiles", &h.profiles},
                                                             {"compression", &h.compression},
                                                             {"datatype", &h.type},
                                                             {"checktype", &h.check}};
    const std::pair<const char*, double*> scales[] = {
        {"xscale", &h.x_scale}, {"yscale", &h.y_scale}, {"zscale", &h.z_scale}};
    const auto bad = [&] {
      return badHeader(fmt::format("\"{}\" is not a value of {}", value.substr(0, 40), key), path);
    };
    for (const auto& [name, to] : counts)
      if (key == name) {
        if (!wholeNumber(value, *to)) return bad();
        ++found;
      }
    for (const auto& [name, to] : scales)
      if (key == name) {
        const char* at = value.data();
        if (!parseNumber(at, value.data() + value.size(), *to) || at != value.data() + value.size())
          return bad();
        ++found;
      }
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  if (!ended) return inputError("the file ends inside the header", path, "the file is cut short");
  if (found < 8) return badHeader("the header lacks some of its keys", path);
  return h;
}

// The unit whose size is that of a height of 1, so that numbers stay as they are; else micrometres.
LengthUnit sdfUnit(double z_scale) {
  for (const char* name : {"um", "nm", "mm", "m", "cm", "in", "ft", "ftUS"})
    if (const auto unit = lengthUnitFromName(name);
        unit && std::abs(std::abs(z_scale) * 1000.0 / unit->mm - 1.0) < 1e-12)
      return *unit;
  return *lengthUnitFromName("um");
}

// 15 digits: 0.25 of 2.5e-4 m in millimetres.
double sdfLength(double metres, const LengthUnit& unit) {
  return std::strtod(fmt::format("{:.15g}", metres * 1000.0 / unit.mm).c_str(), nullptr);
}

// What is the same in both forms: the field, and how its numbers become heights.
struct SdfPlan {
  Grid grid;
  HeightRule rule;
  std::vector<std::string> warnings;
};

SdfPlan planOf(const SdfHeader& h, const ImportOptions& options) {
  SdfPlan plan;
  const LengthUnit unit = sdfUnit(h.z_scale);
  StatedUnits units;
  units.lateral = units.height = unit;
  units.spacing = std::pair{sdfLength(h.x_scale, unit), sdfLength(h.y_scale, unit)};
  plan.grid.width = static_cast<std::int32_t>(h.points);
  plan.grid.height = static_cast<std::int32_t>(h.profiles);
  determineUnits(plan.grid, units, options, plan.warnings);
  plan.rule.scale = options.z_scale.value_or(sdfLength(h.z_scale, unit));
  plan.rule.user_no_data = options.no_data;
  const auto type = static_cast<SdfType>(h.type);
  if (type != SdfType::kFloat && type != SdfType::kDouble)
    plan.grid.height_per_count = std::abs(plan.rule.scale);
  if (h.check != 0) plan.warnings.emplace_back("its checksum is of a kind that is not checked");
  return plan;
}

Result<Imported> finishSdf(SdfPlan plan, FieldBuilder&& builder, HeightTally tally) {
  // As long as counts stay distinct, the float of each represents it and nothing is lost.
  if (plan.grid.height_per_count > 0.0 && tally.rounding < 0.5 * plan.grid.height_per_count)
    tally.rounding = 0.0;
  tally.decimals = true;
  return finishImport(std::move(builder), plan.rule, tally, "SDF", std::move(plan.warnings));
}

template <class T>
Status readSdfRows(TextReader& bytes, SdfPlan& plan, FieldBuilder& builder, HeightTally& tally,
                   const std::string& path, JobControl& job) {
  // A hole is the number at the end of the type's range; floats also have NaN.
  constexpr bool kSigned = std::is_signed_v<T>;
  if constexpr (!std::is_floating_point_v<T> && sizeof(T) > 1)
    plan.rule.declared_no_data =
        static_cast<double>(kSigned ? std::numeric_limits<T>::min() : std::numeric_limits<T>::max());
  const auto width = static_cast<std::size_t>(builder.grid().width);
  const auto read = [&](T* numbers) -> Status {
    // A row of the longest field is longer than the reader's buffer may be asked for.
    constexpr std::size_t kPiece = TextReader::kLongest / sizeof(T);
    for (std::size_t done = 0; done < width;) {
      const std::size_t count = std::min(kPiece, width - done);
      const char* from = bytes.bytes(count * sizeof(T));
      if (from == nullptr && !bytes.status()) return bytes.status();
      if (from == nullptr)
        return inputError("the file ends before all its samples", path, "the file is cut short");
      std::memcpy(numbers + done, from, count * sizeof(T));
      done += count;
    }
    if constexpr (std::is_floating_point_v<T>)
      for (std::size_t i = 0; i < width; ++i)
        if (numbers[i] == std::numeric_limits<T>::lowest()) numbers[i] = std::numeric_limits<T>::quiet_NaN();
    return {};
  };
  return readRowsDown<T>(read, plan.rule, builder, tally, job);
}

Result<Imported> readBinarySdf(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  auto header = readBinaryHeader(file);
  if (!header) return tl::unexpected(header.error());
  if (Status ok = checkSdf(*header, path); !ok) return tl::unexpected(ok.error());
  constexpr std::uint64_t kSizes[kSdfTypes] = {1, 2, 4, 4, 1, 2, 4, 8};
  const std::uint64_t bytes = header->points * header->profiles * kSizes[header->type];
  if (file.size() - header->data < bytes)
    return inputError("the file ends before all its samples", path, "the file is cut short");
  // Software of Olympus writes two more numbers at the end of the header of version 1.0 (found by Gwyddion).
  if (header->data == kSdfHeader && file.size() == header->data + bytes + 8) header->data += 8;
  SdfPlan plan = planOf(*header, options);
  Result<FieldBuilder> builder = FieldBuilder::create(plan.grid, path);
  if (!builder) return tl::unexpected(builder.error());
  TextReader data(file, header->data);
  job.begin("reading", header->profiles);
  HeightTally tally;
  Status status;
  switch (static_cast<SdfType>(header->type)) {
    case SdfType::kUint8:
      status = readSdfRows<std::uint8_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kUint16:
      status = readSdfRows<std::uint16_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kUint32:
      status = readSdfRows<std::uint32_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kFloat:
      status = readSdfRows<float>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kInt8:
      status = readSdfRows<std::int8_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kInt16:
      status = readSdfRows<std::int16_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kInt32:
      status = readSdfRows<std::int32_t>(data, plan, *builder, tally, path, job);
      break;
    case SdfType::kDouble:
      status = readSdfRows<double>(data, plan, *builder, tally, path, job);
      break;
  }
  if (!status) return tl::unexpected(status.error());
  return finishSdf(std::move(plan), *std::move(builder), tally);
}

Result<Imported> readTextSdf(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  TextReader text(file);
  auto header = readTextHeader(text, path);
  if (!header) return tl::unexpected(header.error());
  if (Status ok = checkSdf(*header, path); !ok) return tl::unexpected(ok.error());
  // Every number takes a digit and, except for the last, a space.
  if (header->points * header->profiles * 2 - 1 > file.size())
    return inputError(
        fmt::format("the file is too short for {} x {} numbers", header->points, header->profiles), path,
        "the file is cut short");
  SdfPlan plan = planOf(*header, options);
  Result<FieldBuilder> builder = FieldBuilder::create(plan.grid, path);
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", header->profiles);
  std::uint64_t row = 0;
  const auto read = [&](double* numbers) -> Status {
    ++row;
    for (std::uint64_t c = 0; c < header->points; ++c) {
      std::string_view word;
      if (!text.word(word) || word.front() == '*') {
        if (!text.status()) return text.status();
        return inputError(fmt::format("the data end inside profile {} of {}", row, header->profiles), path,
                          "the file is cut short");
      }
      const char* at = word.data();
      if (lowerCase(word) == "bad") {
        numbers[c] = std::numeric_limits<double>::quiet_NaN();
      } else if (!parseNumber(at, word.data() + word.size(), numbers[c]) || at != word.data() + word.size()) {
        return inputError(
            fmt::format("\"{}\" in profile {}, point {} is not a number", word.substr(0, 40), row, c + 1),
            path, "the file is damaged");
      }
    }
    return {};
  };
  HeightTally tally;
  if (const Status status = readRowsDown<double>(read, plan.rule, *builder, tally, job); !status)
    return tl::unexpected(status.error());
  std::string_view rest;
  const bool more = text.word(rest);
  if (!more)
    plan.warnings.emplace_back("no star ends the data: the file may be cut short inside its last number");
  if (more && rest.front() != '*')
    plan.warnings.emplace_back("there are more numbers than the header states, the rest was left out");
  return finishSdf(std::move(plan), *std::move(builder), tally);
}

Result<Imported> readSdf(const InputFile& file, const ImportOptions& options, JobControl& job) {
  char first = 0;
  if (const auto got = file.read(0, &first, 1); !got) return tl::unexpected(got.error());
  return first == 'a' ? readTextSdf(file, options, job) : readBinarySdf(file, options, job);
}

}  // namespace

constexpr std::string_view kSdfExtensions[] = {".sdf"};
constexpr Format kSdfFormat{
    .info = {"SDF", "Surface data file (ISO 25178-71)", kSdfExtensions, true, true},
    .recognises = looksLikeSdf,
    .read = readSdf,
    .write = writeSdf,
    .ascii = true,
};

}  // namespace fettle::engine

// x3p (ISO 5436-2:2012, ISO 25178-72:2017), surfaces: a zip with main.xml, which contains the heights as text
// or names the entry with them as bytes. Everything is in metres.
//
// The standard counts rows along y without a display direction; MountainsMap, Gwyddion and x3ptools show the
// first one at the top, and so does this importer.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "engine/base/lower_case.h"
#include "engine/io/field_limits.h"
#include "engine/io/files/md5.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/files/zip_archive.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"
#include "engine/io/unit_doubt.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kMostEntries = 10000;
constexpr std::size_t kLongestXml = std::size_t{2} << 20;  // without the matrix
constexpr std::size_t kLongestDatum = 512;
constexpr std::size_t kLongestGap = std::size_t{1} << 16;  // between two heights: spaces, comments

tl::unexpected<Error> damaged(std::string what, const InputFile& file) {
  return inputError(std::move(what), file.path(), "the file is damaged");
}

// Folder of main.xml, with its slash: archives contain the files or a folder with them. The shallowest one
// counts, except folders added by macOS.
Result<std::string> folderOf(const InputFile& file) {
  ZipReader zip(file);
  std::optional<std::string> folder;
  const auto depth = [](const std::string& name) { return std::count(name.begin(), name.end(), '/'); };
  for (std::size_t entries = 0; zip.next(); ++entries) {
    if (entries == kMostEntries) return damaged(fmt::format("more than {} entries", kMostEntries), file);
    const std::string& name = zip.name();
    const std::size_t slash = name.rfind('/');
    const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
    if (lowerCase(name.substr(begin)) != "main.xml" || name.starts_with("__MACOSX/")) continue;
    if (!folder || depth(name) < depth(*folder)) folder = name.substr(0, begin);
  }
  if (!zip.status()) return tl::unexpected(zip.status().error());
  if (!folder)
    return inputError("the archive holds no main.xml", file.path(), "is this an x3p file? Unpack others");
  return *folder;
}

// Moves to an entry, ignoring case, for archives written on systems that ignore it.
bool findEntry(ZipReader& zip, const std::string& name) {
  const std::string wanted = lowerCase(name);
  while (zip.next())
    if (lowerCase(zip.name()) == wanted) return true;
  return false;
}

// Content of a small entry; empty if there is none or it is too long.
std::string smallEntry(const InputFile& file, const std::string& name) {
  ZipReader zip(file);
  if (!findEntry(zip, name)) return {};
  std::string text(std::size_t{1} << 16, '\0');
  const Result<std::size_t> got = zip.read(text.data(), text.size());
  if (!got || *got == text.size()) return {};
  text.resize(*got);
  return text;
}

// main.xml as a stream: the beginning goes to the XML parser; a matrix of text, which may be arbitrarily
// long, is read number by number.
class XmlStream {
 public:
  XmlStream(const InputFile& file, const std::string& name) : zip_(file), found_(findEntry(zip_, name)) {}

  // All up to the tag that opens the matrix, without it, or to the end.
  Result<std::string> head(const InputFile& file) {
    if (!found_) return damaged("the archive holds no main.xml", file);
    std::string text;
    std::size_t searched = 0;
    while (true) {
      if (!fill()) {
        if (!status_) return tl::unexpected(status_.error());
        break;
      }
      text.append(buffer_, begin_, end_ - begin_);
      const std::size_t at = text.find("DataList", searched > 16 ? searched - 16 : 0);
      if (at != std::string::npos) {
        const std::size_t open = text.rfind('<', at);
        const std::size_t close = text.find('>', at);
        if (open != std::string::npos && close != std::string::npos) {
          begin_ = end_ - (text.size() - close - 1);
          has_matrix_ = open > 0;
          return text.substr(0, open);
        }
      }
      if (at == std::string::npos) searched = text.size();
      begin_ = end_;
      if (text.size() > kLongestXml) return damaged("main.xml is too long", file);
    }
    return text;
  }
  [[nodiscard]] bool hasMatrix() const noexcept { return has_matrix_; }

  // The text of the next Datum, empty for one without text; false at the end of the matrix.
  bool datum(std::string& text) {
    std::string tag;
    gap_ = 0;
    while (until('<', nullptr) && until('>', &tag)) {
      const bool single = !tag.empty() && tag.back() == '/';
      if (tag.front() == '/') {
        if (tag.find("DataList") != std::string::npos) return false;
        continue;
      }
      if (tag.find("Datum") == std::string::npos) continue;  // a comment
      text.clear();
      return single || until('<', &text, true);
    }
    return false;
  }
  [[nodiscard]] const Status& status() const noexcept { return status_; }

  // MD5 of the whole entry; reads the rest of it. Nothing if the rest is more than the end of a document.
  std::optional<std::string> checksum() {
    for (std::size_t read = 0; fill(); read += end_ - std::exchange(begin_, end_))
      if (read > kLongestXml) return std::nullopt;
    return md5_.hex();
  }

 private:
  bool fill() {
    if (begin_ < end_) return true;
    const Result<std::size_t> got = zip_.read(buffer_.data(), buffer_.size());
    if (!got) status_ = tl::unexpected(got.error());
    if (!got || *got == 0) return false;
    begin_ = 0;
    end_ = *got;
    md5_.add({buffer_.data(), end_});
    return true;
  }
  // Reads up to a character, which is consumed too unless `keep`; false at the end or when it is too long.
  bool until(char wanted, std::string* text, bool keep = false) {
    if (text != nullptr) text->clear();
    while (fill()) {
      const char* const from = buffer_.data() + begin_;
      const auto* at = static_cast<const char*>(std::memchr(from, wanted, end_ - begin_));
      const std::size_t count = at != nullptr ? static_cast<std::size_t>(at - from) : end_ - begin_;
      if (text != nullptr) text->append(from, count);
      if (text != nullptr && text->size() > kLongestDatum) return false;
      begin_ += count;
      // A height's own text is at most kLongestDatum of it.
      gap_ += count + 1;
      if (gap_ > kLongestGap) return false;
      if (at != nullptr) {
        begin_ += keep ? 0 : 1;
        return text == nullptr || keep || !text->empty();
      }
    }
    return false;
  }

  ZipReader zip_;
  bool found_ = false;
  bool has_matrix_ = false;
  std::string buffer_ = std::string(std::size_t{1} << 16, '\0');
  std::size_t begin_ = 0, end_ = 0;
  std::size_t gap_ = 0;  // since the height before
  Md5 md5_;
  Status status_;
};

// A child by its name, in any name space.
pugi::xml_node child(pugi::xml_node node, std::string_view name) {
  for (const pugi::xml_node one : node.children()) {
    std::string_view own = one.name();
    if (const std::size_t colon = own.rfind(':'); colon != std::string_view::npos)
      own.remove_prefix(colon + 1);
    if (own == name) return one;
  }
  return {};
}

std::string textOf(pugi::xml_node node) {
  std::string text = node.text().get();
  const std::size_t from = text.find_first_not_of(" \t\r\n");
  if (from == std::string::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r\n") - from + 1);
}

// An optional number; an error when it is present and not finite.
Result<std::optional<double>> numberOf(pugi::xml_node node, const InputFile& file) {
  const std::string text = textOf(node);
  if (text.empty()) return std::optional<double>{};
  double value = 0.0;
  const char* at = text.data();
  if (!parseNumber(at, text.data() + text.size(), value) || at != text.data() + text.size() ||
      !std::isfinite(value)) {
    if (text.find(',') != std::string::npos)
      return damaged(fmt::format("\"{}\" in {} has a decimal comma", text.substr(0, 40), node.name()), file);
    return damaged(fmt::format("\"{}\" in {} is not a number", text.substr(0, 40), node.name()), file);
  }
  return std::optional(value);
}

struct Axis {
  char kind = 'I';  // I: evenly spaced, A: each point its own
  char type = 'D';  // I int16, L int32, F float32, D float64
  std::optional<double> increment;
  double offset = 0.0;
};

struct Surface {
  Axis x, y, z;
  std::uint64_t width = 0, height = 0;
  std::string data, data_md5, valid;  // names within the archive, without folder
  std::string checksum_file;
  bool other_parts = false;  // a mask picture or other parts that are not read
};

Result<Axis> readAxis(pugi::xml_node node, const InputFile& file) {
  Axis axis;
  const std::string kind = textOf(child(node, "AxisType")), type = textOf(child(node, "DataType"));
  if (!kind.empty()) axis.kind = kind.front();
  if (!type.empty()) axis.type = type.front();
  if (std::string_view("ILFD").find(axis.type) == std::string_view::npos)
    return damaged(fmt::format("numbers of type \"{}\" are not known", type.substr(0, 20)), file);
  const auto increment = numberOf(child(node, "Increment"), file);
  if (!increment) return tl::unexpected(increment.error());
  const auto offset = numberOf(child(node, "Offset"), file);
  if (!offset) return tl::unexpected(offset.error());
  axis.increment = *increment;
  axis.offset = offset->value_or(0.0);
  return axis;
}

Result<std::uint64_t> sizeOf(pugi::xml_node node, const InputFile& file) {
  const auto number = numberOf(node, file);
  if (!number) return tl::unexpected(number.error());
  const double value = number->value_or(0.0);
  if (!(value >= 0.0 && value < 1e18) || value != std::floor(value))
    return damaged(fmt::format("a side of {}", value), file);
  return static_cast<std::uint64_t>(value);
}

// A name as main.xml gives it: "/bindata/data.bin", ".\bindata\data.bin".
std::string linkOf(pugi::xml_node node) {
  std::string link = textOf(node);
  std::replace(link.begin(), link.end(), '\\', '/');
  while (link.starts_with("./") || link.starts_with("/")) link.erase(0, link.find('/') + 1);
  return link;
}

Result<Surface> readSurface(const pugi::xml_document& xml, const InputFile& file) {
  const pugi::xml_node root = xml.document_element();
  const pugi::xml_node record1 = child(root, "Record1"), record3 = child(root, "Record3");
  if (!record1 || !record3) return damaged("main.xml has no Record1 and Record3", file);
  if (const std::string feature = textOf(child(record1, "FeatureType")); !feature.empty() && feature != "SUR")
    return inputError(fmt::format("the file holds no surface but {}", feature.substr(0, 20)), file.path(),
                      "export a surface (SUR)");
  Surface out;
  const pugi::xml_node axes = child(record1, "Axes");
  for (const auto& [name, axis] : {std::pair{"CX", &out.x}, {"CY", &out.y}, {"CZ", &out.z}}) {
    Result<Axis> read = readAxis(child(axes, name), file);
    if (!read) return tl::unexpected(read.error());
    *axis = *read;
  }
  if (out.x.kind == 'A' || out.y.kind == 'A')
    return inputError("the points have an x and y of their own each", file.path(),
                      "export a raster, or the points as XYZ");
  for (const Axis* axis : {&out.x, &out.y})
    if (axis->increment && !(*axis->increment > 0.0))
      return damaged(fmt::format("a spacing of {}", *axis->increment), file);
  const pugi::xml_node sides = child(record3, "MatrixDimension");
  if (!sides) return damaged("main.xml has no MatrixDimension", file);
  std::uint64_t layers = 1;
  for (const auto& [name, side] :
       {std::pair{"SizeX", &out.width}, {"SizeY", &out.height}, {"SizeZ", &layers}}) {
    const Result<std::uint64_t> read = sizeOf(child(sides, name), file);
    if (!read) return tl::unexpected(read.error());
    *side = *read;
  }
  if (layers > 1)
    return inputError(fmt::format("the file holds {} layers", layers), file.path(), "export one of them");
  const pugi::xml_node link = child(record3, "DataLink");
  out.data = linkOf(child(link, "PointDataLink"));
  out.data_md5 = lowerCase(textOf(child(link, "MD5ChecksumPointData")));
  out.valid = linkOf(child(link, "ValidPointsLink"));
  out.checksum_file = linkOf(child(child(root, "Record4"), "ChecksumFile"));
  out.other_parts = static_cast<bool>(child(record3, "Mask"));
  return out;
}

std::size_t bytesOf(char type) {
  return type == 'I' ? 2 : type == 'D' ? 8 : 4;
}

// One bit per point, the lowest first; a set one is measured.
Result<std::string> readValidity(const Surface& surface, const std::string& folder, const InputFile& file) {
  ZipReader zip(file);
  if (!findEntry(zip, folder + surface.valid))
    return damaged(fmt::format("the archive holds no \"{}\"", surface.valid.substr(0, 80)), file);
  std::string bits((surface.width * surface.height + 7) / 8, '\0');
  const Result<std::size_t> got = zip.read(bits.data(), bits.size());
  if (!got) return tl::unexpected(got.error());
  if (*got != bits.size()) return damaged("the mask of valid points is too short", file);
  return bits;
}

class Rows {
 public:
  Rows(const Surface& surface, const HeightRule& rule, FieldBuilder& builder, HeightTally& tally,
       JobControl& job, const InputFile& file)
      : surface_(surface), rule_(rule), builder_(builder), tally_(tally), job_(job), file_(file) {}

  template <class T>
  Status readBytes(ZipReader& zip, const std::string& valid, std::string& md5) {
    std::vector<T> numbers(surface_.width);
    Md5 sum;
    for (std::uint64_t r = 0; r < surface_.height; ++r) {
      const std::size_t bytes = numbers.size() * sizeof(T);
      const Result<std::size_t> got = zip.read(reinterpret_cast<char*>(numbers.data()), bytes);
      if (!got) return tl::unexpected(got.error());
      if (*got != bytes)
        return inputError(fmt::format("the heights end inside row {} of {}", r + 1, surface_.height),
                          file_.path(), "the file is damaged");
      sum.add({reinterpret_cast<const char*>(numbers.data()), bytes});
      if (Status status = take(numbers, r, valid); !status) return status;
    }
    char more = 0;
    const Result<std::size_t> rest = zip.read(&more, 1);
    md5 = rest && *rest == 0 ? sum.hex() : "longer";
    return {};
  }

  Status readText(XmlStream& xml) {
    std::vector<double> numbers(surface_.width);
    std::string datum;
    for (std::uint64_t r = 0; r < surface_.height; ++r) {
      for (std::uint64_t c = 0; c < surface_.width; ++c) {
        if (!xml.datum(datum)) {
          if (!xml.status()) return xml.status();
          return damaged(fmt::format("the matrix ends inside row {} of {}", r + 1, surface_.height), file_);
        }
        if (Status status = parse(datum, numbers[c], r, c); !status) return status;
      }
      if (Status status = take(numbers, r, {}); !status) return status;
    }
    return {};
  }

 private:
  Status parse(const std::string& datum, double& out, std::uint64_t r, std::uint64_t c) const {
    out = std::numeric_limits<double>::quiet_NaN();
    const char* at = datum.data();
    const char* end = at + datum.size();
    while (at < end && std::strchr(" \t\r\n", *at) != nullptr) ++at;
    while (at < end && std::strchr(" \t\r\n", end[-1]) != nullptr) --end;
    if (at == end || (parseNumber(at, end, out) && at == end)) return {};  // an empty one was not measured
    return damaged(
        fmt::format("\"{}\" in row {}, column {} is not a number", datum.substr(0, 40), r + 1, c + 1), file_);
  }

  template <class T>
  Status take(const std::vector<T>& numbers, std::uint64_t r, const std::string& valid) {
    heights_.resize(numbers.size());
    rule_.convert(numbers.data(), heights_.data(), numbers.size(), tally_);
    for (std::uint64_t c = 0; !valid.empty() && c < numbers.size(); ++c) {
      const std::uint64_t i = r * surface_.width + c;
      if ((static_cast<unsigned char>(valid[i / 8]) >> (i % 8) & 1U) == 0)
        heights_[c] = std::numeric_limits<float>::quiet_NaN();
    }
    const std::int32_t row = builder_.grid().height - 1 - static_cast<std::int32_t>(r);
    builder_.writeHeights(0, row, builder_.grid().width, 1, heights_.data(), builder_.grid().width);
    job_.advance();
    return job_.cancelled() ? Status(cancelled()) : Status{};
  }

  const Surface& surface_;
  const HeightRule& rule_;
  FieldBuilder& builder_;
  HeightTally& tally_;
  JobControl& job_;
  const InputFile& file_;
  std::vector<float> heights_;
};

// The grid of a field that this program wrote, if main.xml still agrees with it.
std::optional<Grid> ownGrid(const Surface& surface, const std::string& folder, const InputFile& file) {
  auto grid = gridOfNotes(smallEntry(file, folder + "fettle.txt"));
  if (!grid || !surface.x.increment || !surface.y.increment) return std::nullopt;
  const double metre = grid->lateral_unit.mm / 1000.0;
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(a); };
  const bool unchanged = same(*surface.x.increment, grid->spacing_x * metre) &&
                         same(*surface.y.increment, grid->spacing_y * metre) &&
                         same(surface.x.offset, grid->origin_x * metre) &&
                         same(surface.y.offset, grid->origin_y * metre) &&
                         surface.z.increment.value_or(1.0) == 1.0 && surface.z.offset == 0.0;
  return unchanged ? grid : std::nullopt;
}

void checkMainXml(XmlStream& xml, const Surface& surface, const std::string& folder, const InputFile& file,
                  std::vector<std::string>& warnings) {
  const std::string stated =
      surface.checksum_file.empty() ? std::string() : smallEntry(file, folder + surface.checksum_file);
  if (stated.size() >= 32 && lowerCase(stated.substr(0, 32)) != xml.checksum())
    warnings.emplace_back("main.xml does not match its checksum: it was changed after it was written");
}

bool looksLikeX3p(std::string_view head, std::string_view) {
  return head.starts_with("PK\x03\x04");
}

Result<Imported> readX3p(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const Result<std::string> folder = folderOf(file);
  if (!folder) return tl::unexpected(folder.error());
  XmlStream xml(file, *folder + "main.xml");
  Result<std::string> head = xml.head(file);
  if (!head) return tl::unexpected(head.error());
  pugi::xml_document document;
  // No entity is expanded except the five of XML. Cut off before the matrix, the document has no end: what
  // was read so far is sufficient.
  const pugi::xml_parse_result parsed = document.load_buffer_inplace(
      head->data(), head->size(), pugi::parse_minimal | pugi::parse_escapes, pugi::encoding_auto);
  if (!parsed && !(xml.hasMatrix() && parsed.status == pugi::status_end_element_mismatch))
    return damaged(fmt::format("main.xml is not XML: {}", parsed.description()), file);
  const Result<Surface> surface = readSurface(document, file);
  if (!surface) return tl::unexpected(surface.error());
  if (!xml.hasMatrix() && surface->data.empty()) return damaged("main.xml names no heights", file);
  if (Status fits =
          checkFieldSize(surface->width, surface->height,
                         surface->valid.empty() ? 0 : surface->width * surface->height / 8, file.path());
      !fits)
    return tl::unexpected(fits.error());
  const std::uint64_t raw = surface->width * surface->height *
                            (xml.hasMatrix() ? sizeof("<Datum/>") - 1 : bytesOf(surface->z.type));
  if (Status fits = checkPacking(raw, file.size(), file.path()); !fits) return tl::unexpected(fits.error());

  std::vector<std::string> warnings;
  StatedUnits units;
  Grid grid;
  HeightRule rule;
  const std::optional<Grid> own = ownGrid(*surface, *folder, file);
  if (own) {
    grid = *own;
    units.lateral = own->lateral_unit;
    units.height = own->height_unit;
    units.spacing = std::pair{own->spacing_x, own->spacing_y};
    rule.scale = 1000.0 / own->height_unit.mm;
  } else {
    units.lateral = units.height = LengthUnit{"m", 1000.0};
    if (surface->x.increment && surface->y.increment)
      units.spacing = std::pair{*surface->x.increment, *surface->y.increment};
    grid.origin_x = surface->x.offset;
    grid.origin_y = surface->y.offset;
    rule.scale = surface->z.increment.value_or(1.0);
    if (rule.scale == 0.0) rule.scale = 1.0;
    rule.offset = surface->z.offset;
    if (surface->z.type == 'I' || surface->z.type == 'L') grid.height_per_count = std::abs(rule.scale);
  }
  if (options.z_scale) {
    rule.scale = *options.z_scale;
    rule.offset = 0.0;
  }
  rule.user_no_data = options.no_data;
  grid.width = static_cast<std::int32_t>(surface->width);
  grid.height = static_cast<std::int32_t>(surface->height);
  determineUnits(grid, units, options, warnings);
  if (surface->other_parts)
    warnings.emplace_back("the annotations of the file's mask picture are not imported");

  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), file.path());
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", surface->height);
  HeightTally tally;
  Rows rows(*surface, rule, *builder, tally, job, file);
  Status status;
  if (xml.hasMatrix()) {
    status = rows.readText(xml);
  } else {
    std::string valid, md5;
    if (!surface->valid.empty()) {
      Result<std::string> bits = readValidity(*surface, *folder, file);
      if (!bits) return tl::unexpected(bits.error());
      valid = *std::move(bits);
    }
    ZipReader zip(file);
    if (!findEntry(zip, *folder + surface->data))
      return damaged(fmt::format("the archive holds no \"{}\"", surface->data.substr(0, 80)), file);
    switch (surface->z.type) {
      case 'I':
        status = rows.readBytes<std::int16_t>(zip, valid, md5);
        break;
      case 'L':
        status = rows.readBytes<std::int32_t>(zip, valid, md5);
        break;
      case 'F':
        status = rows.readBytes<float>(zip, valid, md5);
        break;
      default:
        status = rows.readBytes<double>(zip, valid, md5);
    }
    // The archive's own checksums detect accidents; this one is often written wrongly.
    if (status && surface->data_md5.size() == 32 && surface->data_md5 != md5)
      warnings.emplace_back("the heights do not match their checksum: they were changed since");
  }
  if (!status) return tl::unexpected(status.error());
  checkMainXml(xml, *surface, *folder, file, warnings);
  if (own && !options.z_scale) tally.rounding = 0.0;  // rounds to exactly the float that was written
  if (surface->z.type == 'L' && tally.rounding < 0.5 * std::abs(rule.scale)) tally.rounding = 0.0;
  Result<Imported> imported = finishImport(std::move(*builder), rule, tally, "X3P", std::move(warnings));
  if (imported && !own && !options.unit) doubtTexture(*imported, "metres");
  return imported;
}

}  // namespace

constexpr std::string_view kX3pExtensions[] = {".x3p"};
constexpr Format kX3pFormat{
    .info = {"X3P", "x3p surface (ISO 25178-72)", kX3pExtensions, true, true},
    .recognises = looksLikeX3p,
    .read = readX3p,
    .write = writeX3p,
};

}  // namespace fettle::engine

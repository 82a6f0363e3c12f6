// PCD 0.7 and before (Point Cloud Library): fields of any kind in any order, as text, as records, or field by
// field and compressed with LZF. Only x, y and z are read.

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <liblzf/lzf.h>

#include "engine/base/memory.h"
#include "engine/io/field_limits.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/points/gridding.h"
#include "engine/io/points/perspective.h"

namespace fettle::engine {

namespace {

enum class PcdData { kAscii, kBinary, kPacked };

struct PcdField {
  std::string name;
  int size = 4;
  char type = 'F';
  std::uint64_t count = 1;
  std::uint64_t offset = 0;  // in a record [bytes]
  std::uint64_t column = 0;  // in a line [numbers]
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0, width = 0, height = 1;
  PcdData data = PcdData::kAscii;
  std::uint64_t record = 0;   // bytes
  std::uint64_t columns = 0;  // numbers per line
  std::uint64_t body = 0;     // offset
  std::array<std::size_t, 3> axes{};
};

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> all;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t from = line.find_first_not_of(" \t\r", at);
    if (from == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t\r", from), line.size());
    all.push_back(line.substr(from, at - from));
  }
  return all;
}

class PcdHeaderReader {
 public:
  explicit PcdHeaderReader(const InputFile& file) : file_(file), text_(file) {}

  Result<PcdHeader> read() {
    std::string_view line;
    while (text_.line(line)) {
      const auto all = words(line);
      if (all.empty() || all.front().starts_with('#')) continue;
      if (Status status = take(all); !status) return tl::unexpected(status.error());
      if (all.front() == "DATA") return finish();
    }
    if (!text_.status()) return tl::unexpected(text_.status().error());
    return damaged("the header has no DATA");
  }

 private:
  [[nodiscard]] tl::unexpected<Error> damaged(std::string what) const {
    return inputError(std::move(what), file_.path(), "the file is damaged");
  }

  // One line: a word and as many values as there are fields.
  Status take(const std::vector<std::string_view>& all) {
    const std::string_view key = all.front();
    const auto each = [&](auto&& set) -> Status {
      if (header_.fields.size() != all.size() - 1)
        return damaged(
            fmt::format("{} has {} values for {} fields", key, all.size() - 1, header_.fields.size()));
      for (std::size_t i = 0; i < header_.fields.size(); ++i)
        if (!set(header_.fields[i], all[i + 1]))
          return damaged(fmt::format("{} {} is not valid", key, all[i + 1]));
      return {};
    };
    const auto number = [&](std::uint64_t& out) -> Status {
      if (all.size() != 2 || !wholeNumber(all[1], out))
        return damaged(fmt::format("{} holds no number", key));
      return {};
    };
    if (key == "FIELDS" || key == "COLUMNS") {
      if (!header_.fields.empty() || all.size() > kMostFields) return damaged("too many fields");
      for (std::size_t i = 1; i < all.size(); ++i) header_.fields.push_back({std::string(all[i])});
      return {};
    }
    if (key == "SIZE")
      return each([](PcdField& field, std::string_view word) {
        std::uint64_t size = 0;
        if (!wholeNumber(word, size) || (size != 1 && size != 2 && size != 4 && size != 8)) return false;
        field.size = static_cast<int>(size);
        return true;
      });
    if (key == "TYPE")
      return each([](PcdField& field, std::string_view word) {
        field.type = word.front();
        return word.size() == 1 && (field.type == 'F' || field.type == 'I' || field.type == 'U');
      });
    if (key == "COUNT")
      return each([](PcdField& field, std::string_view word) {
        return wholeNumber(word, field.count) && field.count <= kMostFields;
      });
    if (key == "WIDTH") return number(header_.width);
    if (key == "HEIGHT") return number(header_.height);
    if (key == "POINTS") return number(header_.points);
    if (key == "DATA") {
      if (all.size() != 2) return damaged("DATA names no encoding");
      if (all[1] == "ascii")
        header_.data = PcdData::kAscii;
      else if (all[1] == "binary")
        header_.data = PcdData::kBinary;
      else if (all[1] == "binary_compressed")
        header_.data = PcdData::kPacked;
      else
        return inputError(fmt::format("data as {} is not known", all[1]), file_.path());
    }
    return {};  // VERSION, VIEWPOINT and words of later versions
  }

  Result<PcdHeader> finish() {
    for (PcdField& field : header_.fields) {
      if (field.type == 'F' && field.size < 4) return damaged("a float of less than 4 bytes");
      field.offset = header_.record;
      field.column = header_.columns;
      header_.record += static_cast<std::uint64_t>(field.size) * field.count;
      header_.columns += field.count;
    }
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t i = 0;
      while (i < header_.fields.size() &&
             (header_.fields[i].name != kAxes[k] || header_.fields[i].count == 0))
        ++i;
      if (i == header_.fields.size())
        return inputError(fmt::format("the points have no {}", kAxes[k]), file_.path(),
                          "give a cloud with x, y and z");
      header_.axes[k] = i;
    }
    if (header_.points == 0 && header_.width <= kMostPoints && header_.height <= kMostPoints)
      header_.points = header_.width * header_.height;
    if (header_.points == 0)
      return inputError("the file holds no points", file_.path(), "give a file with points");
    if (header_.points > kMostPoints)
      return damaged(fmt::format("{} points are not possible", header_.points));
    header_.body = text_.offset();
    const std::uint64_t left = file_.size() - header_.body;
    // The last line of a text needs no end.
    const std::uint64_t least = header_.data == PcdData::kAscii ? 2 * header_.columns : header_.record;
    if (header_.data != PcdData::kPacked && header_.points > (left + 1) / least)
      return inputError("the file ends before all that its header states", file_.path(),
                        "the file is cut short");
    return std::move(header_);
  }

  static constexpr std::uint64_t kMostFields = 4096;
  static constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 36;
  const InputFile& file_;
  TextReader text_;
  PcdHeader header_;
};

double decode(const char* bytes, const PcdField& field) {
  switch (field.type) {
    case 'F':
      return field.size == 8 ? little<double>(bytes) : static_cast<double>(little<float>(bytes));
    case 'I':
      return field.size == 1   ? little<std::int8_t>(bytes)
             : field.size == 2 ? little<std::int16_t>(bytes)
             : field.size == 4 ? little<std::int32_t>(bytes)
                               : static_cast<double>(little<std::int64_t>(bytes));
    default:
      return field.size == 1   ? little<std::uint8_t>(bytes)
             : field.size == 2 ? little<std::uint16_t>(bytes)
             : field.size == 4 ? little<std::uint32_t>(bytes)
                               : static_cast<double>(little<std::uint64_t>(bytes));
  }
}

class PcdBody {
 public:
  PcdBody(const InputFile& file, const PcdHeader& header, JobControl& job)
      : file_(file), header_(header), text_(file, header.body), job_(job) {}

  Status read(PointCloud& cloud) {
    job_.begin("reading", header_.points);
    switch (header_.data) {
      case PcdData::kAscii:
        return readText(cloud);
      case PcdData::kBinary:
        return readRecords(cloud);
      case PcdData::kPacked:
        return readPacked(cloud);
    }
    return {};
  }

 private:
  [[nodiscard]] const PcdField& axis(std::size_t k) const { return header_.fields[header_.axes[k]]; }

  Status cutShort() const {
    if (!text_.status()) return text_.status();
    return inputError("the file ends before all that its header states", file_.path(),
                      "the file is cut short");
  }

  Status step(std::uint64_t i) {
    if (i % 65536 != 65535) return {};
    job_.advance(65536);
    return job_.cancelled() ? Status(cancelled()) : Status{};
  }

  Status readText(PointCloud& cloud) {
    std::string_view line;
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      if (!text_.line(line)) return cutShort();
      const char* at = line.data();
      const char* const end = at + line.size();
      std::array<double, 3> point{};
      for (std::uint64_t c = 0; c < header_.columns; ++c) {
        while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
        double value = 0.0;
        if (!parseNumber(at, end, value))
          return inputError(fmt::format("point {} does not hold the numbers that the header states", i + 1),
                            file_.path(), "the file is damaged");
        for (std::size_t k = 0; k < 3; ++k)
          if (axis(k).column == c) point[k] = value;
      }
      cloud.add(point[0], point[1], point[2]);
      if (Status s = step(i); !s) return s;
    }
    if (text_.lastLineIsOpen()) cloud.warnings.emplace_back(kOpenLastLine);
    return {};
  }

  Status readRecords(PointCloud& cloud) {
    if (header_.record > TextReader::kLongest)
      return inputError("a point takes too many bytes", file_.path(), "the file is damaged");
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      const char* record = text_.bytes(header_.record);
      if (record == nullptr) return cutShort();
      cloud.add(decode(record + axis(0).offset, axis(0)), decode(record + axis(1).offset, axis(1)),
                decode(record + axis(2).offset, axis(2)));
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  // Two sizes, then all values of the first field, all of the second and so on, compressed as one block.
  Status readPacked(PointCloud& cloud) {
    std::array<char, 8> sizes{};
    const Result<std::size_t> got = file_.read(header_.body, sizes.data(), sizes.size());
    if (!got || *got != sizes.size()) return cutShort();
    const std::uint64_t packed = little<std::uint32_t>(sizes.data());
    const std::uint64_t bytes = little<std::uint32_t>(sizes.data() + 4);
    if (header_.points > bytes / header_.record || bytes != header_.points * header_.record)
      return inputError(fmt::format("{} bytes are stated for {} points", bytes, header_.points), file_.path(),
                        "the file is damaged");
    if (packed > file_.size() - header_.body - sizes.size()) return cutShort();
    // LZF decompresses 3 bytes to at most 264.
    if (Status fits = checkPromise(bytes, packed, 88.0, file_.path()); !fits) return fits;
    if (bytes + packed > availableMemory()) throw std::bad_alloc();
    std::string in(packed, '\0'), out(bytes, '\0');
    const Result<std::size_t> body = file_.read(header_.body + sizes.size(), in.data(), in.size());
    if (!body || *body != in.size()) return cutShort();
    if (lzf_decompress(in.data(), static_cast<unsigned>(in.size()), out.data(),
                       static_cast<unsigned>(out.size())) != bytes)
      return inputError("the packed points are damaged", file_.path(), "the file is damaged");
    std::array<const char*, 3> from{};
    for (std::size_t k = 0; k < 3; ++k) from[k] = out.data() + axis(k).offset * header_.points;
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      const auto value = [&](std::size_t k) {
        return decode(from[k] + i * static_cast<std::uint64_t>(axis(k).size) * axis(k).count, axis(k));
      };
      cloud.add(value(0), value(1), value(2));
      if (Status s = step(i); !s) return s;
    }
    return {};
  }

  const InputFile& file_;
  const PcdHeader& header_;
  TextReader text_;
  JobControl& job_;
};

bool looksLikePcd(std::string_view head, std::string_view extension) {
  return head.starts_with("# .PCD") || (extension == ".pcd" && head.find("FIELDS") != std::string_view::npos);
}

Result<Imported> readPcd(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const Result<PcdHeader> header = PcdHeaderReader(file).read();
  if (!header) return tl::unexpected(header.error());
  PointCloud cloud;
  // Sides come from the file: their product is used only where it cannot overflow.
  cloud.organized = header->width > 1 && header->height > 1 && header->width <= header->points &&
                    header->height <= header->points / header->width &&
                    header->width * header->height == header->points;
  if (Status status = PcdBody(file, *header, job).read(cloud); !status) return tl::unexpected(status.error());
  if (cloud.organized)
    return gridOrganized(std::move(cloud), header->width, header->height, options, "PCD", file.path(), job);
  return gridPoints(std::move(cloud), options, "PCD", file.path(), job);
}

}  // namespace

constexpr std::string_view kPcdExtensions[] = {".pcd"};
constexpr Format kPcdFormat{
    .info = {"PCD", "PCD point cloud", kPcdExtensions, true, false},
    .recognises = looksLikePcd,
    .read = readPcd,
};

}  // namespace fettle::engine

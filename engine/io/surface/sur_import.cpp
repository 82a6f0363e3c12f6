// Digital Surf .sur: one topography of a surface, as written by MountainsMap and many instruments. A header
// of 512 bytes, a comment, private bytes, then integers of 16 or 32 bits, line by line; "DSCOMPRESSED"
// compresses them into zlib streams. Layout: Digital Surf, "Surface data file format", as implemented by the
// readers of Gwyddion and HyperSpy.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "engine/io/field_limits.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/format.h"
#include "engine/io/rows_down.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kSurHeader = 512;
constexpr double kZlibRatio = 1032.0;  // the largest ratio of Deflate

struct SurHeader {
  bool compressed = false;
  int bits = 0;
  std::int32_t lowest = 0;
  std::int64_t width = 0, height = 0, points = 0;
  float dx = 0, dy = 0, dz = 0;
  std::string unit_x, unit_y, unit_z;
  bool holes = false;  // stored as `lowest` - 2
  float x0 = 0, y0 = 0, z0 = 0;
  std::uint64_t data = 0;  // offset of the first sample or stream
};

// A text of fixed length: up to a NUL, without trailing spaces. Mountains writes micro as Latin-1.
std::string textAt(const char* bytes, std::size_t length) {
  std::string text(bytes, length);
  text.resize(std::min(text.find('\0'), text.size()));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  if (!text.empty() && text.front() == '\xb5') text.front() = 'u';
  return text;
}

Result<SurHeader> readHeader(const InputFile& file) {
  std::array<char, kSurHeader> h{};
  const Result<std::size_t> got = file.read(0, h.data(), h.size());
  if (!got) return tl::unexpected(got.error());
  if (*got < kSurHeader) return inputError("the header is cut short", file.path(), "the file is cut short");
  const auto at16 = [&](std::size_t i) { return little<std::int16_t>(&h[i]); };
  const auto at32 = [&](std::size_t i) { return little<std::int32_t>(&h[i]); };
  const auto real = [&](std::size_t i) { return little<float>(&h[i]); };
  const std::string_view signature(h.data(), 12);
  SurHeader out;
  out.compressed = signature == "DSCOMPRESSED";
  if (at16(12) != 0)
    return inputError("the file was written on a machine of the other byte order", file.path(),
                      "export it again as a PC file");
  if (at16(14) > 1)  // series and layers
    return inputError(fmt::format("the file holds {} surfaces", at16(14)), file.path(),
                      "export only one of them");
  if (at16(18) != 2)  // 2 = surface; 1 profile, 10 picture, 12 colours ...
    return inputError(fmt::format("the file holds no surface but data of type {}", at16(18)), file.path(),
                      "export a topography");
  out.bits = at16(98);
  if (out.bits != 16 && out.bits != 32)
    return inputError(fmt::format("samples of {} bits", out.bits), file.path(), "the file is damaged");
  out.lowest = at32(100);
  out.width = at32(108);
  out.height = at32(112);
  out.points = at32(116);
  out.dx = real(120);
  out.dy = real(124);
  out.dz = real(128);
  out.unit_x = textAt(&h[180], 16);
  out.unit_y = textAt(&h[196], 16);
  out.unit_z = textAt(&h[212], 16);
  out.holes = at16(86) != 0;
  out.x0 = real(466);
  out.y0 = real(470);
  out.z0 = real(474);
  out.data = kSurHeader + static_cast<std::uint16_t>(at16(334)) + static_cast<std::uint16_t>(at16(336));
  if (out.width <= 0 || out.height <= 0 || out.points != out.width * out.height)
    return inputError(
        fmt::format("the header states {} x {} samples and {} in total", out.width, out.height, out.points),
        file.path(), "the file is damaged");
  const auto usable = [](float v) { return std::isfinite(v) && v > 0.0F; };
  if (!usable(out.dx) || !usable(out.dy) || !std::isfinite(out.dz) || out.dz == 0.0F)
    return inputError("the header's spacings are not lengths", file.path(), "give --spacing and --z-scale");
  return out;
}

// Decompresses the streams one after another; returns the bytes in pieces of any size.
class SurBytes {
 public:
  SurBytes(const InputFile& file, const SurHeader& header)
      : file_(file), at_(header.data), packed_(header.compressed) {}
  ~SurBytes() {
    if (open_) inflateEnd(&stream_);
  }
  SurBytes& operator=(SurBytes&&) = delete;

  Status begin(std::uint64_t bytes) {
    if (!packed_) {
      if (file_.size() < at_ || file_.size() - at_ < bytes) return shortFile();
      return {};
    }
    std::array<char, 8> pair{};
    if (!take(pair.data(), 4)) return shortFile();
    const auto streams = little<std::uint32_t>(pair.data());
    std::uint64_t promised = 0, stored = 0;
    if (streams > file_.size() / 8) return shortFile();
    for (std::uint32_t i = 0; i < streams; ++i) {
      if (!take(pair.data(), 8)) return shortFile();
      promised += little<std::uint32_t>(pair.data());
      sizes_.push_back(little<std::uint32_t>(pair.data() + 4));
      stored += sizes_.back();
    }
    if (promised != bytes)
      return inputError(fmt::format("the streams hold {} bytes, the surface takes {}", promised, bytes),
                        file_.path(), "the file is damaged");
    if (stored > file_.size() - at_) return shortFile();
    return {};
  }

  Status read(char* out, std::size_t bytes) {
    if (!packed_) return take(out, bytes) ? Status{} : shortFile();
    stream_.next_out = reinterpret_cast<Bytef*>(out);
    stream_.avail_out = static_cast<uInt>(bytes);
    while (stream_.avail_out > 0) {
      if (!open_) {
        if (next_ == sizes_.size()) return damaged();
        left_ = sizes_[next_++];
        Bytef* const wanted = stream_.next_out;
        const uInt room = stream_.avail_out;
        stream_ = {};
        if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
        stream_.next_out = wanted;
        stream_.avail_out = room;
        open_ = true;
      }
      if (stream_.avail_in == 0 && left_ > 0) {
        const std::size_t piece = std::min<std::size_t>(left_, buffer_.size());
        if (!take(buffer_.data(), piece)) return shortFile();
        left_ -= piece;
        stream_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
        stream_.avail_in = static_cast<uInt>(piece);
      }
      const int done = inflate(&stream_, Z_NO_FLUSH);
      if (done == Z_STREAM_END) {
        at_ += left_;  // bytes of a malformed stream after its end
        inflateEnd(&stream_);
        open_ = false;
      } else if (done != Z_OK) {
        return damaged();
      }
    }
    return {};
  }

 private:
  bool take(char* out, std::size_t bytes) {
    const Result<std::size_t> got = file_.read(at_, out, bytes);
    if (!got || *got != bytes) return false;
    at_ += bytes;
    return true;
  }
  Status shortFile() const {
    return inputError("the file ends before all its samples", file_.path(), "the file is cut short");
  }
  Status damaged() const {
    return inputError("a packed stream is damaged", file_.path(), "the file is damaged");
  }

  const InputFile& file_;
  std::uint64_t at_;
  bool packed_;
  std::vector<std::uint32_t> sizes_;
  std::size_t next_ = 0;
  std::size_t left_ = 0;  // of the open stream, not read yet
  bool open_ = false;
  z_stream stream_{};
  std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
};

bool looksLikeSur(std::string_view head, std::string_view) {
  return head.starts_with("DIGITAL SURF") || head.starts_with("DSCOMPRESSED");
}

Result<Imported> readSur(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const Result<SurHeader> header = readHeader(file);
  if (!header) return tl::unexpected(header.error());
  const std::uint64_t raw =
      static_cast<std::uint64_t>(header->points) * static_cast<std::uint64_t>(header->bits / 8);
  const auto width = static_cast<std::uint64_t>(header->width),
             height = static_cast<std::uint64_t>(header->height);
  if (Status fits = checkFieldSize(width, height, 0, file.path()); !fits) return tl::unexpected(fits.error());
  if (header->compressed)
    if (Status fits = checkPromise(raw, file.size(), kZlibRatio, file.path()); !fits)
      return tl::unexpected(fits.error());

  std::vector<std::string> warnings;
  StatedUnits units;
  units.lateral = lengthUnitFromName(header->unit_x);
  units.height = heightUnitNamed(header->unit_z, options, warnings);
  if (header->unit_x != header->unit_y)
    return inputError(fmt::format("x is in {}, y in {}", header->unit_x, header->unit_y), file.path(),
                      "export it with one unit");
  // The decimal digits of the float are the intended ones: 0.003484, not 0.0034839999862015247.
  const auto decimalOf = [](float v) { return std::strtod(fmt::format("{}", v).c_str(), nullptr); };
  units.spacing = std::pair{decimalOf(header->dx), decimalOf(header->dy)};
  Grid grid;
  grid.width = static_cast<std::int32_t>(header->width);
  grid.height = static_cast<std::int32_t>(header->height);
  grid.origin_x = std::isfinite(header->x0) ? decimalOf(header->x0) : 0.0;
  grid.origin_y = std::isfinite(header->y0) ? decimalOf(header->y0) : 0.0;
  determineUnits(grid, units, options, warnings);
  HeightRule rule;
  rule.scale = options.z_scale.value_or(decimalOf(header->dz));
  if (!options.z_scale && std::isfinite(header->z0)) rule.offset = decimalOf(header->z0);
  rule.user_no_data = options.no_data;
  if (header->holes) rule.declared_no_data = static_cast<double>(header->lowest) - 2.0;
  grid.height_per_count = std::abs(rule.scale);

  SurBytes bytes(file, *header);
  if (Status begun = bytes.begin(raw); !begun) return tl::unexpected(begun.error());
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), file.path());
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", height);
  HeightTally tally;
  const auto read = [&bytes, width = static_cast<std::size_t>(builder->grid().width)](auto* numbers) {
    return bytes.read(reinterpret_cast<char*>(numbers), width * sizeof(*numbers));
  };
  const Status status = header->bits == 16 ? readRowsDown<std::int16_t>(read, rule, *builder, tally, job)
                                           : readRowsDown<std::int32_t>(read, rule, *builder, tally, job);
  if (!status) return tl::unexpected(status.error());
  // As long as counts stay distinct, the float of each represents it and nothing is lost.
  if (tally.rounding < 0.5 * std::abs(rule.scale)) tally.rounding = 0.0;
  return finishImport(std::move(*builder), rule, tally, "SUR", std::move(warnings));
}

}  // namespace

constexpr std::string_view kSurExtensions[] = {".sur"};
constexpr Format kSurFormat{
    .info = {"SUR", "Digital Surf topography", kSurExtensions, true, false},
    .recognises = looksLikeSur,
    .read = readSur,
};

}  // namespace fettle::engine

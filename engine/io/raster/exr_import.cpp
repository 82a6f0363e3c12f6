// OpenEXR: one channel of floats, halves or integers of a flat picture, scan lines or tiles.

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr int kLargestTile = 8192;

class ExrSource : public Imf::IStream {
 public:
  explicit ExrSource(const InputFile& file) : Imf::IStream("scan"), file_(file) {}
  bool read(char out[], int n) override {
    const auto got = file_.read(at_, out, static_cast<std::size_t>(n));
    if (!got || *got != static_cast<std::size_t>(n)) throw std::runtime_error("the file is cut short");
    at_ += *got;
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  const InputFile& file_;
  std::uint64_t at_ = 0;
};

// Sizes of the header's attributes, before the library allocates memory for them: it accepts any up to 2 GB.
// Layout: "OpenEXR File Layout", https://openexr.com/en/latest/OpenEXRFileLayout.html
class HeaderCheck {
 public:
  explicit HeaderCheck(const InputFile& file) : text_(file, 4) {}

  [[nodiscard]] bool sound(std::uint64_t file_bytes) {
    const char* version = text_.bytes(4);
    if (version == nullptr) return false;
    const bool parts = (little<std::uint32_t>(version) & 0x1000U) != 0;
    for (int headers = 0; headers < kMostParts; ++headers) {
      bool empty = true;
      std::string name, type;
      while (word(name) && !name.empty()) {
        empty = false;
        const char* size = word(type) ? text_.bytes(4) : nullptr;
        if (size == nullptr) return false;
        const auto bytes = little<std::uint32_t>(size);
        if (bytes > file_bytes - text_.offset() || bytes > kLongestAttribute || !inside(type, bytes))
          return false;
      }
      if (!text_.status() || broken_) return false;
      if (empty || !parts) return true;  // an empty header ends the list of parts
    }
    return false;
  }

 private:
  static constexpr int kMostParts = 1000;
  static constexpr std::uint32_t kLongestAttribute = TextReader::kLongest;

  bool word(std::string& out) {
    out.clear();
    for (const char* c = text_.bytes(1); c != nullptr; c = text_.bytes(1)) {
      if (*c == '\0') return true;
      if (out.size() > 255) break;
      out += *c;
    }
    broken_ = true;
    return false;
  }
  // Bytes of the types whose values the library reads without checking the stated size: with another size it
  // would read the following data from a wrong offset. 0: any.
  static std::uint32_t fixedSize(std::string_view type) {
    static constexpr std::pair<std::string_view, std::uint32_t> kSizes[] = {{"box2f", 16},
                                                                            {"box2i", 16},
                                                                            {"chromaticities", 32},
                                                                            {"compression", 1},
                                                                            {"deepImageState", 1},
                                                                            {"double", 8},
                                                                            {"envmap", 1},
                                                                            {"float", 4},
                                                                            {"int", 4},
                                                                            {"keycode", 28},
                                                                            {"lineOrder", 1},
                                                                            {"m33d", 72},
                                                                            {"m33f", 36},
                                                                            {"m44d", 128},
                                                                            {"m44f", 64},
                                                                            {"rational", 8},
                                                                            {"tiledesc", 9},
                                                                            {"timecode", 8},
                                                                            {"v2d", 16},
                                                                            {"v2f", 8},
                                                                            {"v2i", 8},
                                                                            {"v3d", 24},
                                                                            {"v3f", 12},
                                                                            {"v3i", 12}};
    for (const auto& [name, size] : kSizes)
      if (name == type) return size;
    return 0;
  }
  // Channels: names, each with 16 bytes, and an empty one at the very end.
  static bool channelsFill(std::string_view value) {
    while (!value.empty() && value.front() != '\0') {
      const std::size_t name = value.find('\0');
      if (name == std::string_view::npos || value.size() - name < 17) return false;
      value.remove_prefix(name + 17);
    }
    return value.size() == 1;
  }
  // Values that contain sizes themselves.
  bool inside(const std::string& type, std::uint32_t bytes) {
    if (const std::uint32_t size = fixedSize(type); size != 0 && bytes != size) return false;
    const char* value = bytes == 0 ? nullptr : text_.bytes(bytes);
    if (bytes != 0 && value == nullptr) return false;
    if (type == "chlist") return channelsFill({value, bytes});
    if (type == "preview")
      return bytes >= 8 && (std::uint64_t{little<std::uint32_t>(value)} * little<std::uint32_t>(value + 4) <=
                            std::uint64_t{bytes - 8} / 4);
    if (type != "stringvector") return true;
    for (std::uint32_t at = 0; at < bytes;) {
      if (bytes - at < 4) return false;
      const auto length = little<std::uint32_t>(value + at);
      at += 4;
      if (length > bytes - at) return false;
      at += length;
    }
    return true;
  }

  TextReader text_;
  bool broken_ = false;
};

// The library's message: one line, no path (its own prefix names the stream).
std::string reasonOf(const std::exception& error) {
  std::string text = error.what();
  if (const std::size_t own = text.find("\"scan\". "); own != std::string::npos) text.erase(0, own + 8);
  text.erase(std::min(text.find('\n'), text.size()));
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

// The channel with the heights: by one of the names in use, or the only one.
const char* heightChannel(const Imf::ChannelList& channels) {
  for (const char* name : {"Y", "Z", "height", "Height", "elevation", "depth", "R"})
    if (channels.findChannel(name) != nullptr) return name;
  const char* only = nullptr;
  int count = 0;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    if (std::string_view(c.name()) == "A") continue;
    only = c.name();
    ++count;
  }
  return count == 1 ? only : nullptr;
}

std::string channelNames(const Imf::ChannelList& channels) {
  std::string names;
  for (auto c = channels.begin(); c != channels.end() && names.size() < 60; ++c)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", c.name());
  return names;
}

struct Plan {
  std::string channel;
  bool alpha = false;
  int left = 0, top = 0, width = 0, height = 0;
};

Result<Plan> planOf(const Imf::Header& header, const InputFile& file, std::vector<std::string>& warnings) {
  const std::string& path = file.path();
  const Imath::Box2i& window = header.dataWindow();
  // Within int by the library's check of the header; the difference may not be.
  const auto width = static_cast<std::int64_t>(window.max.x) - window.min.x + 1;
  const auto height = static_cast<std::int64_t>(window.max.y) - window.min.y + 1;
  if (width <= 0 || height <= 0) return inputError("the picture has no samples", path, "the file is damaged");
  if (Status fits =
          checkFieldSize(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 0, path);
      !fits)
    return tl::unexpected(fits.error());
  if (Status fits = checkPacking(static_cast<std::uint64_t>(width * height) * 4, file.size(), path); !fits)
    return tl::unexpected(fits.error());
  const char* const name = heightChannel(header.channels());
  if (name == nullptr)
    return inputError(
        fmt::format("none of the channels {} is known to hold heights", channelNames(header.channels())),
        path, "name the one with heights Y or Z");
  const Imf::Channel& channel = header.channels()[name];
  if (channel.xSampling != 1 || channel.ySampling != 1)
    return inputError(fmt::format("channel {} does not have every sample", name), path, "export it in full");
  if (isNoLength(name))
    warnings.push_back(
        fmt::format("the only channel is \"{}\", which is not a length: are these heights?", name));
  Plan plan{name, false, window.min.x, window.min.y, static_cast<int>(width), static_cast<int>(height)};
  const Imf::Channel* const alpha = header.channels().findChannel("A");
  plan.alpha = alpha != nullptr && alpha->xSampling == 1 && alpha->ySampling == 1;
  int others = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    others += std::string_view(c.name()) != name && std::string_view(c.name()) != "A" ? 1 : 0;
  if (others > 0)
    warnings.push_back(
        fmt::format("of the channels {} only {} was read", channelNames(header.channels()), name));
  return plan;
}

Status readRows(Imf::InputPart& part, const Plan& plan, const HeightRule& rule, FieldBuilder& builder,
                HeightTally& tally, JobControl& job) {
  const auto width = static_cast<std::size_t>(plan.width);
  // As many rows as a tile of the field: files with tiles or blocks of lines decompress them once for these.
  std::vector<float> numbers(width * kTileSide), alpha(plan.alpha ? numbers.size() : 0), heights(width);
  std::int64_t transparent = 0;
  for (int from = 0; from < plan.height; from += kTileSide) {
    const int rows = std::min<int>(kTileSide, plan.height - from);
    // Addresses are relative to the picture's corner 0, 0, at any position of its window.
    const auto slice = [&](std::vector<float>& into) {
      const std::ptrdiff_t origin = static_cast<std::ptrdiff_t>(plan.top + from) * plan.width + plan.left;
      return Imf::Slice(Imf::FLOAT,
                        reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(into.data()) -
                                                static_cast<std::uintptr_t>(origin) * sizeof(float)),
                        sizeof(float), width * sizeof(float));
    };
    Imf::FrameBuffer frame;
    frame.insert(plan.channel, slice(numbers));
    if (plan.alpha) frame.insert("A", slice(alpha));
    part.setFrameBuffer(frame);
    part.readPixels(plan.top + from, plan.top + from + rows - 1);
    for (int r = 0; r < rows; ++r) {
      float* const row = numbers.data() + static_cast<std::size_t>(r) * width;
      for (std::size_t c = 0; plan.alpha && c < width; ++c)
        if (alpha[static_cast<std::size_t>(r) * width + c] == 0.0F) {
          row[c] = std::numeric_limits<float>::quiet_NaN();
          ++transparent;
        }
      rule.convert(row, heights.data(), width, tally);
      builder.writeHeights(0, plan.height - 1 - from - r, plan.width, 1, heights.data(), plan.width);
    }
    job.advance(static_cast<std::uint64_t>(rows));
    if (job.cancelled()) return cancelled();
  }
  return {};
}

bool looksLikeExr(std::string_view head, std::string_view) {
  return head.starts_with("\x76\x2f\x31\x01");
}

Result<Imported> readExr(const InputFile& file, const ImportOptions& options, JobControl& job) try {
  const std::string& path = file.path();
  Imf::Header::setMaxImageSize(Grid::kMaxSide, Grid::kMaxSide);
  Imf::Header::setMaxTileSize(kLargestTile, kLargestTile);
  if (!HeaderCheck(file).sound(file.size()))
    return inputError("the header's attributes point outside the file", path,
                      "the file is cut short or damaged");
  ExrSource source(file);
  // A table of lines that a crash of the writer left empty is not reconstructed.
  Imf::MultiPartInputFile picture(source, 0, false);
  int index = 0;
  const auto flat = [&](int i) {
    return !picture.header(i).hasType() || Imf::isImage(picture.header(i).type());
  };
  while (index < picture.parts() && !flat(index)) ++index;
  if (index == picture.parts())
    return inputError("the picture is deep: many samples per pixel", path, "flatten it first");
  const Imf::Header& header = picture.header(index);
  std::vector<std::string> warnings;
  if (picture.parts() > 1) warnings.push_back(fmt::format("of {} pictures one was read", picture.parts()));
  const Result<Plan> plan = planOf(header, file, warnings);
  if (!plan) return tl::unexpected(plan.error());
  if (!picture.partComplete(index))
    return inputError("some lines of the picture were never written", path, "the file is cut short");

  Grid grid;
  StatedUnits units;
  if (const auto* notes = header.findTypedAttribute<Imf::StringAttribute>("fettle"); notes != nullptr)
    if (const auto own = gridOfNotes(notes->value())) {
      grid = *own;
      units.lateral = own->lateral_unit;
      units.height = own->height_unit;
      units.spacing = std::pair{own->spacing_x, own->spacing_y};
    }
  grid.width = plan->width;
  grid.height = plan->height;
  determineUnits(grid, units, options, warnings);
  HeightRule rule = HeightRule::of(options);
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), path);
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", static_cast<std::uint64_t>(plan->height));
  HeightTally tally;
  Imf::InputPart part(picture, index);
  if (Status status = readRows(part, *plan, rule, *builder, tally, job); !status)
    return tl::unexpected(status.error());
  return finishImport(std::move(*builder), rule, tally, "EXR", std::move(warnings));
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  return inputError("the picture cannot be read: " + reasonOf(error), file.path(),
                    "the file is cut short or damaged");
}

}  // namespace

constexpr std::string_view kExrExtensions[] = {".exr"};
constexpr Format kExrFormat{
    .info = {"EXR", "OpenEXR", kExrExtensions, true, true},
    .recognises = looksLikeExr,
    .read = readExr,
    .write = writeExr,
};

}  // namespace fettle::engine

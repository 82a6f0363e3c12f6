#include "haptic/base/strokes.h"

#include <sys/stat.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/io/files/atomic_file.h"

namespace fettle::haptic {

namespace {

using engine::inputError;

constexpr std::string_view kStrokesHeader = "t,x,y,z,tool";
constexpr std::string_view kForcesHeader = "t,proxy_x,proxy_y,proxy_z,fx,fy,fz,contact";

// Rows are collected to about this many bytes before they are written to the disk.
constexpr std::size_t kWriteBytes = std::size_t{1} << 20;
// Longest row: eight numbers of at most 24 characters ("-2.2250738585072014e-308") and their commas.
constexpr std::size_t kLongestRow = 8 * 25 + 16;

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

engine::Result<std::string> readWhole(const std::string& path) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  struct stat facts {};
  if (!file || ::fstat(::fileno(file.get()), &facts) != 0)
    return inputError(fmt::format("the strokes cannot be read: {}", std::strerror(errno)), path,
                      "give a readable strokes file");
  if (S_ISDIR(facts.st_mode))
    return inputError("the strokes cannot be read: it is a folder", path, "give a readable strokes file");
  std::string text;
  // The size is a hint: a pipe has none.
  text.reserve(static_cast<std::size_t>(facts.st_size) + 1);
  std::array<char, std::size_t{1} << 16> buffer;
  for (;;) {
    const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get());
    text.append(buffer.data(), n);
    if (n < buffer.size()) break;
  }
  if (std::ferror(file.get()) != 0)
    return inputError(fmt::format("the strokes cannot be read: {}", std::strerror(errno)), path);
  return text;
}

// The next line without its line end; `text` then begins after it.
std::string_view takeLine(std::string_view& text) noexcept {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// The part of an invalid field that a message shows: short, whatever the file holds.
std::string shown(std::string_view text) {
  return std::string(text.substr(0, 24)) + (text.size() > 24 ? "..." : "");
}

// What is wrong with the row, or nothing.
std::optional<std::string> parseRow(std::string_view row, StrokeSample& out) {
  constexpr std::array<const char*, 4> kColumns = {"t", "x", "y", "z"};
  std::array<double, 4> numbers{};
  const char* at = row.data();
  const char* const end = row.data() + row.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [stop, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc{} || stop == end || *stop != ',') {
      const std::string_view field(at, static_cast<std::size_t>(std::find(at, end, ',') - at));
      if (error == std::errc{} && stop == end) return "a row needs the five columns t,x,y,z,tool";
      if (error == std::errc::result_out_of_range)
        return fmt::format("{} = {} is outside the range of numbers", kColumns[i], shown(field));
      return fmt::format("{} = \"{}\" is not a number", kColumns[i], shown(field));
    }
    at = stop + 1;
  }
  const std::string_view tool(at, static_cast<std::size_t>(end - at));
  const std::optional<Tool> known = toolNamed(tool);
  if (!known)
    return fmt::format("the tool \"{}\" is not one of {}", shown(tool), fmt::join(kToolWords, ", "));
  out = {numbers[0], {numbers[1], numbers[2], numbers[3]}, *known};
  return std::nullopt;
}

// Collects rows and writes them in large pieces.
class RowWriter {
 public:
  static engine::Result<RowWriter> create(const std::string& path, std::string_view header) {
    engine::Result<engine::AtomicFile> file = engine::AtomicFile::create(path);
    if (!file) return tl::unexpected(file.error());
    return RowWriter(std::move(*file), header);
  }

  void number(double value) noexcept {
    end_ = std::to_chars(end_, buffer_.data() + buffer_.size(), value).ptr;
    *end_++ = ',';
  }
  void word(std::string_view text) noexcept {
    end_ = std::copy(text.begin(), text.end(), end_);
    *end_++ = '\n';
  }
  /// Call after each row.
  [[nodiscard]] engine::Status spill() {
    if (static_cast<std::size_t>(end_ - buffer_.data()) < kWriteBytes) return {};
    return flush();
  }
  [[nodiscard]] engine::Status commit() {
    if (engine::Status status = flush(); !status) return status;
    return file_.commit();
  }
  [[nodiscard]] engine::Status flush() {
    const std::string_view rows(buffer_.data(), static_cast<std::size_t>(end_ - buffer_.data()));
    end_ = buffer_.data();
    return file_.write(rows);
  }

 private:
  RowWriter(engine::AtomicFile file, std::string_view header)
      : file_(std::move(file)), buffer_(kWriteBytes + kLongestRow), end_(buffer_.data()) {
    word(header);
  }

  engine::AtomicFile file_;
  std::vector<char> buffer_;  // a moved vector keeps its memory, so end_ stays right
  char* end_;
};

}  // namespace

engine::Result<std::vector<StrokeSample>> readStrokes(const std::string& path) {
  const engine::Result<std::string> whole = readWhole(path);
  if (!whole) return tl::unexpected(whole.error());
  std::string_view text = *whole;
  if (const std::string_view header = takeLine(text); header != kStrokesHeader)
    return inputError(fmt::format("line 1 is not the header {}", kStrokesHeader), path,
                      "give a strokes file as docs/formats.md describes it");
  std::vector<StrokeSample> strokes;
  strokes.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1);
  for (std::int64_t line_number = 2; !text.empty(); ++line_number) {
    // Blank lines are fine where nothing follows them.
    if (text.find_first_not_of("\r\n") == std::string_view::npos) break;
    StrokeSample sample;
    if (const std::optional<std::string> problem = parseRow(takeLine(text), sample))
      return inputError(fmt::format("line {}: {}", line_number, *problem), path,
                        "correct or remove the line");
    strokes.push_back(sample);
  }
  return strokes;
}

class StrokesWriter::Rows {
 public:
  explicit Rows(RowWriter out) : out_(std::move(out)) {}
  [[nodiscard]] engine::Status append(const StrokeSample& s) {
    for (const double value : {s.t, s.tip_mm.x, s.tip_mm.y, s.tip_mm.z}) out_.number(value);
    out_.word(toolName(s.tool));
    return out_.spill();
  }
  [[nodiscard]] RowWriter& out() noexcept { return out_; }

 private:
  RowWriter out_;
};

StrokesWriter::StrokesWriter(std::unique_ptr<Rows> rows) noexcept : rows_(std::move(rows)) {}
StrokesWriter::StrokesWriter(StrokesWriter&&) noexcept = default;
StrokesWriter& StrokesWriter::operator=(StrokesWriter&&) noexcept = default;
StrokesWriter::~StrokesWriter() = default;

engine::Result<StrokesWriter> StrokesWriter::create(const std::string& path) {
  engine::Result<RowWriter> out = RowWriter::create(path, kStrokesHeader);
  if (!out) return tl::unexpected(out.error());
  return StrokesWriter(std::make_unique<Rows>(std::move(*out)));
}

engine::Status StrokesWriter::append(const StrokeSample& row) {
  return rows_->append(row);
}

engine::Status StrokesWriter::flush() {
  return rows_->out().flush();
}

engine::Status StrokesWriter::commit() {
  return rows_->out().commit();
}

engine::Status writeStrokes(const std::string& path, std::span<const StrokeSample> strokes) {
  engine::Result<StrokesWriter> out = StrokesWriter::create(path);
  if (!out) return tl::unexpected(out.error());
  for (const StrokeSample& s : strokes)
    if (engine::Status status = out->append(s); !status) return status;
  return out->commit();
}

engine::Status writeForces(const std::string& path, std::span<const ForceSample> forces) {
  engine::Result<RowWriter> out = RowWriter::create(path, kForcesHeader);
  if (!out) return tl::unexpected(out.error());
  for (const ForceSample& f : forces) {
    for (const double value :
         {f.t, f.proxy_mm.x, f.proxy_mm.y, f.proxy_mm.z, f.force_n.x, f.force_n.y, f.force_n.z})
      out->number(value);
    out->word(f.contact ? "1" : "0");
    if (engine::Status status = out->spill(); !status) return status;
  }
  return out->commit();
}

}  // namespace fettle::haptic

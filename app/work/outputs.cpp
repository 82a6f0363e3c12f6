#include "app/work/outputs.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "app/work/memory_places.h"
#include "app/work/spelling.h"
#include "app/work/streams.h"
#include "engine/base/lower_case.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"
#include "engine/io/lines/lines.h"

namespace fettle::app {

std::vector<std::string> extensionsOf(bool engine::FormatInfo::*able) {
  std::vector<std::string> all;
  for (const engine::FormatInfo& format : engine::formats())
    if (format.*able) all.insert(all.end(), format.extensions.begin(), format.extensions.end());
  return all;
}

std::vector<std::string> extensionWords(bool engine::FormatInfo::*able) {
  std::vector<std::string> words = extensionsOf(able);
  for (std::string& word : words) word.erase(0, 1);
  return words;
}

std::string withDot(const std::string& extension) {
  return engine::lowerCase(extension.starts_with('.') ? extension : "." + extension);
}

namespace {

// Formats whose files are text.
bool isText(const std::string& extension) {
  return std::ranges::any_of(engine::formats(), [&](const engine::FormatInfo& format) {
    return format.text && std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

// Extensions under which people keep scans and nothing else.
bool namesAScan(const std::string& extension) {
  if (extension == ".csv" || extension == ".txt") return false;
  return std::ranges::any_of(engine::formats(), [&](const engine::FormatInfo& format) {
    return std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

std::vector<std::string> extensionsFor(OutputKind kind) {
  if (kind == OutputKind::kMarks) return {".png", ".tif", ".tiff"};
  if (kind == OutputKind::kPicture) return {".png"};
  if (kind == OutputKind::kLines)
    return {std::begin(engine::kLineExtensions), std::end(engine::kLineExtensions)};
  if (kind == OutputKind::kPage) return {".html", ".htm", ".pdf"};
  if (kind == OutputKind::kPlot) return {".svg", ".png"};
  if (kind == OutputKind::kDrawing) return {".dxf"};
  return kind == OutputKind::kField ? extensionsOf(&engine::FormatInfo::writes) : std::vector<std::string>();
}

// A unique spelling of a path, links and dots resolved as far as the path exists.
std::filesystem::path placeOf(const std::string& path) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::weakly_canonical(path, error);
  return error ? std::filesystem::path(path) : place;
}

engine::Status checkExtension(const std::string& extension, OutputKind kind, const std::string& where) {
  if (kind == OutputKind::kText && namesAScan(extension))
    return engine::inputError(fmt::format("text under the name of a scan, {}", extension), where,
                              "take .csv or .txt, so that no scan is replaced");
  const std::vector<std::string> known = extensionsFor(kind);
  if (known.empty() || std::find(known.begin(), known.end(), extension) != known.end()) return {};
  const std::string meant = didYouMean(extension, known);
  return engine::inputError(
      extension.empty() ? "there is no extension that names the output format"
                        : fmt::format("{} is not an output format", extension),
      where, fmt::format("{}{}take one of {}", meant, meant.empty() ? "" : " ", fmt::join(known, " ")));
}

// Standard output in the place of a file.
engine::Status checkStream(const Output& output) {
  if (!output.stream)
    return engine::inputError("this cannot be written to standard output", output.path, "name a file");
  if (output.stream->empty())
    return engine::inputError("the format of standard output is not given", "--to",
                              "give it as extension: --to xyz");
  const std::string extension = withDot(*output.stream);
  if (auto known = checkExtension(extension, output.kind, "--to"); !known) return known;
  const bool text = extension == ".csv" || (output.kind == OutputKind::kField && isText(extension));
  if (!text && isatty(STDOUT_FILENO) != 0)
    return engine::inputError(fmt::format("standard output is a terminal, and {} is not text", extension),
                              "-", "send it into a file or another program, with > or |");
  return {};
}

engine::Status checkOutput(const Output& output) {
  if (isStream(output.path)) return checkStream(output);
  std::error_code error;
  if (output.path.ends_with('/') || std::filesystem::is_directory(output.path, error))
    return engine::inputError("the output is a folder", output.path, "name a file in it");
  if (auto known = checkExtension(engine::extensionOf(output.path), output.kind, output.path); !known)
    return known;
  std::filesystem::path folder = std::filesystem::path(output.path).parent_path();
  if (output.makes_folder)
    while (!folder.empty() && !std::filesystem::exists(folder, error)) folder = folder.parent_path();
  if (folder.empty()) folder = ".";
  if (!std::filesystem::is_directory(folder, error))
    return std::filesystem::exists(folder, error)
               ? engine::inputError("this is a file, not a folder", folder.string(), "name another")
               : engine::inputError("there is no such folder", folder.string(), "make it or name another");
  if (std::filesystem::exists(output.path, error) && !std::filesystem::is_regular_file(output.path, error))
    return engine::inputError("the output is not a regular file", output.path,
                              "outputs are written whole and renamed: name a file");
  if (access(folder.c_str(), W_OK) != 0)
    return engine::inputError("the folder cannot be written to", folder.string(),
                              "name another or change its rights");
  return {};
}

}  // namespace

engine::Status checkPlaces(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  enum class Use : std::uint8_t { kInput, kOutput };
  std::map<std::filesystem::path, Use> taken;
  for (const std::string& input : inputs)
    if (!input.empty() && !isStream(input) && memoryPlace(input) == nullptr)
      taken.emplace(placeOf(input), Use::kInput);
  for (const Output& output : outputs) {
    if (output.path.empty() || memoryPlace(output.path) != nullptr) continue;
    if (auto status = checkOutput(output); !status) return status;
    // A file or folder of that name is not standard output.
    const auto place = isStream(output.path) ? std::filesystem::path() : placeOf(output.path);
    const auto [earlier, fresh] = taken.emplace(place, Use::kOutput);
    if (!fresh)
      return engine::inputError(earlier->second == Use::kInput ? "the output would replace an input"
                                : isStream(output.path)        ? "two outputs are standard output"
                                                               : "two outputs are in the same place",
                                output.path, "name another file");
  }
  return {};
}

}  // namespace fettle::app

#include "engine/io/geo/sidecar.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/files/input_file.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/geo/crs_text.h"

namespace fettle::engine {

namespace {

constexpr std::uint64_t kLargest = std::uint64_t{1} << 20;  // bytes of a sidecar; statistics may be long

// Content of a small file; nothing where there is none.
std::optional<std::string> contentOf(const std::string& path) {
  const Result<InputFile> file = InputFile::open(path);
  if (!file || file->size() > kLargest) return std::nullopt;
  std::string text(file->size(), '\0');
  const Result<std::size_t> got = file->read(0, text.data(), text.size());
  if (!got) return std::nullopt;
  text.resize(*got);
  return text;
}

std::string nameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::optional<double> noDataOf(const pugi::xml_node& node) {
  const std::string_view text = node.text().get();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  double value = 0.0;
  const char* at = text.data() + (first == std::string_view::npos ? text.size() : first);
  return parseNumber(at, text.data() + text.size(), value) ? std::optional(value) : std::nullopt;
}

std::string wktOfText(const char* text) {
  const CrsPtr crs(*text == '\0' ? nullptr : gdal().OSRNewSpatialReference(text));
  return crs ? wktOf(crs.get()) : std::string();
}

}  // namespace

Sidecar readAuxXml(const std::string& path, std::vector<std::string>& warnings) {
  const std::string sidecar = path + ".aux.xml";
  Sidecar out;
  const auto text = contentOf(sidecar);
  if (!text) return out;
  const GdalSession quiet;
  pugi::xml_document document;
  const pugi::xml_node root =
      document.load_buffer(text->data(), text->size()) ? document.child("PAMDataset") : pugi::xml_node();
  if (!root) {
    warnings.push_back(fmt::format("{} next to the file cannot be parsed and was ignored", nameOf(sidecar)));
    return out;
  }
  out.crs_wkt = wktOfText(root.child_value("SRS"));
  const pugi::xml_node band = root.find_child_by_attribute("PAMRasterBand", "band", "1");
  out.no_data = noDataOf(band.child("NoDataValue"));
  out.height_unit = band.child_value("UnitType");
  const double scale = band.child("Scale").text().as_double(1.0);
  const double offset = band.child("Offset").text().as_double(0.0);
  if (scale != 1.0 || offset != 0.0)
    warnings.push_back(fmt::format("{} next to the file states height = number * {} + {}, which was ignored",
                                   nameOf(sidecar), scale, offset));
  return out;
}

std::string prjPathOf(const std::string& path) {
  const std::filesystem::path usual = std::filesystem::path(path).replace_extension(".prj");
  std::error_code error;
  for (const char* extension : {".prj", ".PRJ", ".Prj", ".pRJ", ".prJ", ".pRj", ".PRj", ".PrJ"})
    if (auto there = usual; std::filesystem::exists(there.replace_extension(extension), error))
      return there.string();
  return usual.string();
}

std::string readPrj(const std::string& path, std::vector<std::string>& warnings) {
  const std::string sidecar = prjPathOf(path);
  const auto text = contentOf(sidecar);
  if (!text) return {};
  const GdalSession quiet;
  std::string wkt = wktOfPrj(*text);
  if (wkt.empty())
    warnings.push_back(fmt::format("{} next to the file names no known coordinate system", nameOf(sidecar)));
  return wkt;
}

std::optional<double> chooseNoData(std::optional<double> own, const Sidecar& sidecar,
                                   std::vector<std::string>& warnings) {
  if (!sidecar.no_data) return own;
  const bool same = own && (*own == *sidecar.no_data || (std::isnan(*own) && std::isnan(*sidecar.no_data)));
  if (own && !same)
    warnings.push_back(fmt::format("the file states no-data {}, the .aux.xml next to it {}, which was used",
                                   *own, *sidecar.no_data));
  return sidecar.no_data;
}

}  // namespace fettle::engine

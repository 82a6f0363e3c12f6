#include "app/commands/shards/vrt_text.h"

#include <fmt/format.h>

namespace fettle::app {

namespace {

std::string xmlText(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  return out;
}

}  // namespace

std::string vrtText(const engine::Grid& grid, const std::vector<VrtPart>& parts) {
  std::string text =
      fmt::format("<VRTDataset rasterXSize=\"{}\" rasterYSize=\"{}\">\n", grid.width, grid.height);
  if (!grid.crs_wkt.empty())
    text += fmt::format("  <SRS dataAxisToSRSAxisMapping=\"1,2\">{}</SRS>\n", xmlText(grid.crs_wkt));
  // Of the corner of the upper left pixel, in whose middle a sample lies.
  text += fmt::format("  <GeoTransform>{:.17g}, {:.17g}, 0, {:.17g}, 0, {:.17g}</GeoTransform>\n",
                      grid.origin_x - 0.5 * grid.spacing_x, grid.spacing_x,
                      grid.origin_y + (grid.height - 0.5) * grid.spacing_y, -grid.spacing_y);
  text += fmt::format(
      "  <VRTRasterBand dataType=\"Float32\" band=\"1\">\n    <NoDataValue>nan</NoDataValue>\n"
      "    <UnitType>{}</UnitType>\n",
      xmlText(grid.height_unit.name));
  for (const VrtPart& part : parts) {
    const std::string size = fmt::format("xSize=\"{}\" ySize=\"{}\"", grid.width, part.rows);
    text += fmt::format(
        "    <SimpleSource>\n      <SourceFilename relativeToVRT=\"0\">{}</SourceFilename>\n"
        "      <SourceBand>1</SourceBand>\n      <SrcRect xOff=\"0\" yOff=\"0\" {}/>\n"
        "      <DstRect xOff=\"0\" yOff=\"{}\" {}/>\n    </SimpleSource>\n",
        xmlText(part.path), size, grid.height - part.row - part.rows, size);
  }
  return text + "  </VRTRasterBand>\n</VRTDataset>\n";
}

}  // namespace fettle::app

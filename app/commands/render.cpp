#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/io/raster/marks.h"
#include "render/live/live_picture.h"
#include "render/plan/picture.h"

namespace fettle::app {

namespace {

struct RenderArguments {
  std::string scan;
  std::string png;
  std::string size = "1280x800";
  render::View view;
  std::vector<double> centre;
  std::string compare;
  std::string deviation;
  std::string marks;
  std::string map = "auto";
  std::string title;
  std::string compare_title;
  std::vector<double> range;
  bool perspective = false;
  bool contours = false;
  bool dark = false;
  bool bare = false;
  bool invert = false;
  bool validate = false;
  std::string stereo = "off";
  render::Stereo eyes;
  ScanOptions reading;
};

engine::Result<render::PictureSpec> picture(const RenderArguments& options, engine::JobControl& job) {
  render::PictureSpec spec;
  spec.view = options.view;
  spec.cell_px = kStillCellPx;
  const auto size = parseSize(options.size, "--size", kPictureSides);
  if (!size) return tl::unexpected(size.error());
  std::tie(spec.view.width, spec.view.height) = *size;
  if (!options.centre.empty()) {
    if (!std::all_of(options.centre.begin(), options.centre.end(),
                     [](double c) { return c >= 0.0 && c <= 1.0; }))
      return engine::inputError("the middle of the picture lies beside the field", "--centre",
                                "give fractions from 0 to 1 of the field's width and height, e.g. 0.5,0.5");
    spec.view.centre_x = options.centre[0];
    spec.view.centre_y = options.centre[1];
  }
  if (options.perspective) spec.view.projection = render::Projection::kPerspective;
  if (options.contours) spec.contours = render::Contours::kShow;
  if (options.dark) spec.theme = render::Theme::kDark;
  if (options.bare) spec.decoration = render::Decoration::kNone;
  if (!options.range.empty()) spec.range = render::ValueRange{options.range[0], options.range[1]};
  static const std::map<std::string, render::ColourMap> kMaps{{"auto", render::ColourMap::kAuto},
                                                              {"viridis", render::ColourMap::kViridis},
                                                              {"cividis", render::ColourMap::kCividis},
                                                              {"grey", render::ColourMap::kGrey},
                                                              {"diverging", render::ColourMap::kDiverging}};
  spec.map = kMaps.at(options.map);

  const auto scan = loadScan(options.scan, options.reading, job);
  if (!scan) return tl::unexpected(scan.error());
  spec.field = scan->field;
  const auto fileName = [](const std::string& path) {
    return std::filesystem::path(shownInput(path)).filename().string();
  };
  spec.title_left = options.title.empty() ? fileName(options.scan) : options.title;
  if (!options.marks.empty()) {
    auto marked = engine::importMarks(spec.field, options.marks);
    if (!marked) return tl::unexpected(marked.error());
    spec.field = *std::move(marked);
    spec.marks = render::MarksOverlay::kShow;
  }
  if (!options.compare.empty()) {
    const auto other = loadScan(options.compare, options.reading, job);
    if (!other) return tl::unexpected(other.error());
    spec.compare = other->field;
    spec.title_right = options.compare_title.empty() ? fileName(options.compare) : options.compare_title;
  }
  if (!options.deviation.empty()) {
    const auto original = loadScan(options.deviation, options.reading, job);
    if (!original) return tl::unexpected(original.error());
    spec.deviation_from = original->field;
  }
  if (options.invert) {
    spec.field = spec.field.inverted();
    if (spec.compare) spec.compare = spec.compare->inverted();
    if (spec.deviation_from) spec.deviation_from = spec.deviation_from->inverted();
  }
  return spec;
}

engine::Status writePicture(const render::Image& image, const std::string& path, engine::JobControl& job) {
  return writeTo(path, ".png", job, [&](const std::string& file) { return render::writePng(image, file); });
}

// A picture for each eye. Drawn as the window draws it: one ray a pixel, every point within a quarter of a
// pixel.
engine::Result<Report> renderEyes(const RenderArguments& options, const render::PictureSpec& spec,
                                  engine::JobControl& job) {
  render::LiveOptions live;
  if (options.validate) live.validation = render::Validation::kOn;
  const auto picture = render::LivePicture::create(live);
  if (!picture) return tl::unexpected(picture.error());
  render::Shown shown;
  shown.versions = {spec.field};
  if (spec.compare) shown.versions.push_back(*spec.compare);
  shown.original = spec.deviation_from;
  shown.marks = spec.marks;
  if (auto status = (*picture)->update(shown); !status) return tl::unexpected(status.error());
  render::FrameInput input;
  input.view = spec.view;
  input.contours = spec.contours;
  input.marks_opacity = spec.marks_opacity;
  input.map = spec.map;
  input.theme = spec.theme;
  input.decoration = spec.decoration;
  input.titles = {spec.title_left, spec.title_right};
  input.titles.resize(shown.versions.size());
  input.range = spec.range;
  input.stereo = options.eyes;
  input.stereo.mode =
      options.stereo == "anaglyph" ? render::StereoMode::kAnaglyph : render::StereoMode::kSideBySide;
  input.error_px = 0.25;
  input.vertex_budget = std::int64_t{1} << 22;
  render::Image image;
  render::FrameStatistics frame;
  std::int64_t tiles = 0, bytes = 0;
  double upload_ms = 0.0;
  // A field that the device does not hold at once is there after some frames.
  do {
    const auto drawn = (*picture)->draw(input, image);
    if (!drawn) return tl::unexpected(drawn.error());
    frame = *drawn;
    tiles += frame.upload.tiles;
    bytes += frame.upload.bytes;
    upload_ms += frame.upload.ms;
  } while (frame.upload.pending_tiles > 0 || frame.residency.pages_loaded > 0);
  for (const std::string& message : (*picture)->validationMessages()) warn("validation: " + message);
  if (auto status = writePicture(image, options.png, job); !status) return tl::unexpected(status.error());
  return Report{{"width", image.width},
                {"height", image.height},
                {"frame_ms", frame.device_ms},
                {"upload_ms", upload_ms},
                {"device", (*picture)->device()},
                {"tiles_uploaded", tiles},
                {"bytes_uploaded", bytes},
                {"vertices", frame.vertices},
                {"range_low", frame.range.low},
                {"range_high", frame.range.high},
                {"vertical_exaggeration", frame.vertical_exaggeration},
                {"stereo", options.stereo}};
}

engine::Result<Report> render(const RenderArguments& options, engine::JobControl& job) {
  if (auto status = checkOutputs({{options.png, OutputKind::kPicture, ".png"}},
                                 {options.scan, options.compare, options.deviation, options.marks},
                                 Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  const auto spec = picture(options, job);
  if (!spec) return tl::unexpected(spec.error());
  if (options.stereo != "off") return renderEyes(options, *spec, job);
  render::RendererOptions renderer_options;
  if (options.validate) renderer_options.validation = render::Validation::kOn;
  const auto renderer = render::Renderer::create(renderer_options);
  if (!renderer) return tl::unexpected(renderer.error());
  render::Image image;
  const auto report = (*renderer)->render(*spec, image, job);
  if (!report) return tl::unexpected(report.error());
  if (job.cancelled()) return engine::cancelled();
  for (const std::string& warning : report->warnings) warn(warning);
  for (const std::string& message : report->validation_messages) warn("validation: " + message);
  if (auto status = writePicture(image, options.png, job); !status) return tl::unexpected(status.error());
  return Report{{"width", report->width},
                {"height", report->height},
                {"frame_ms", report->frame_ms},
                {"upload_ms", report->upload_ms},
                {"device", report->device},
                {"tiles_uploaded", report->tiles_uploaded},
                {"bytes_uploaded", report->bytes_uploaded},
                {"vertices", report->vertices},
                {"range_low", report->range.low},
                {"range_high", report->range.high},
                {"vertical_exaggeration", report->vertical_exaggeration}};
}

}  // namespace

void addRender(Command root, Chosen& chosen) {
  auto options = std::make_shared<RenderArguments>();
  Command command = addCommand(root, chosen, "render", "Picture of a scan, without a window",
                               [options](engine::JobControl& job) { return render(*options, job); });
  command.option("SCAN", options->scan, "The scan to draw; - for standard input").required();
  command.option("PNG", options->png, "The picture to write; - for standard output").required();
  command.option("--size", options->size, "Pixels, WIDTHxHEIGHT").showDefault();
  command.option("--azimuth", options->view.azimuth_deg, "Turn of the camera in degrees; 0 looks along +y")
      .showDefault();
  command
      .option("--elevation", options->view.elevation_deg, "Camera above the horizon in degrees; 90 = a map")
      .showDefault();
  command.option("--zoom", options->view.zoom, "1 shows the whole field").showDefault();
  command.option("--centre", options->centre, "Middle of the picture as fractions X,Y of the field")
      .delimiter(',')
      .expected(2);
  command.option("--exaggerate", options->view.vertical_exaggeration, "Factor on heights; 0 chooses one")
      .showDefault();
  command.option("--compare", options->compare, "Second scan, drawn at the right with the same camera");
  command.option("--deviation", options->deviation, "Colours show the deviation from this scan");
  command.option("--marks", options->marks, "Picture of marks to overlay").check(fileName());
  command.option("--map", options->map, "Colour map")
      .check(oneOf({"auto", "viridis", "cividis", "grey", "diverging"}))
      .showDefault();
  command.option("--range", options->range, "Heights at the ends of the colours, LOW,HIGH")
      .delimiter(',')
      .expected(2);
  command.option("--title", options->title, "Title; the file's name by default");
  command.option("--compare-title", options->compare_title, "Title of the second scan");
  command.flag("--perspective", options->perspective, "Perspective instead of parallel projection");
  command
      .option("--stereo", options->stereo, "A picture for each eye: in two halves, or for red - cyan glasses")
      .check(oneOf({"off", "side-by-side", "anaglyph"}))
      .showDefault();
  command
      .option("--eye-separation", options->eyes.eye_separation,
              "Between the eyes, as a share of their distance from the field")
      .showDefault();
  command
      .option("--screen-distance", options->eyes.screen_distance,
              "Where both eyes see the same, as a share of that distance; 0: at the middle of the picture")
      .showDefault();
  command.flag("--contours", options->contours, "Contour lines at the steps of the colour bar");
  command.flag("--dark", options->dark, "Light text on a dark ground");
  command.flag("--bare", options->bare, "The surface alone: no titles, bars or legend");
  command.flag("--invert", options->invert, "Draw the field upside down");
  command.flag("--validate", options->validate, "Load the Vulkan validation layers and show what they say");
  addScanOptions(command, options->reading);
}

}  // namespace fettle::app

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/still_picture.h"
#include "app/commands/typed_values.h"
#include "app/overlay/line_overlay.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/field/seen_field.h"
#include "render/live/live_plan.h"
#include "render/live/picture_rows.h"
#include "render/plan/material.h"

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
  std::string lines;
  std::string map = "auto";
  std::string normals = "footprint";
  std::string material = "none";
  render::FormShading form = render::kShownForm;
  std::string title;
  std::string compare_title;
  std::vector<double> range;
  bool perspective = false;
  bool contours = false;
  render::Colouring colouring;
  bool dark = false;
  bool bare = false;
  bool invert = false;
  bool validate = false;
  std::string stereo = "off";
  render::Stereo eyes;
  ScanOptions reading;
};

struct Wanted {
  render::Shown shown;
  render::FrameInput input;
};

engine::Result<Wanted> wanted(const RenderArguments& options, engine::JobControl& job) {
  Wanted w{{}, render::stillInput(options.view)};
  render::View& view = w.input.view;
  const auto size = parseSize(options.size, "--size", kPictureSides);
  if (!size) return tl::unexpected(size.error());
  std::tie(view.width, view.height) = *size;
  if (options.colouring.tolerance > 0.0 && options.deviation.empty())
    return engine::inputError("a tolerance is one of a deviation", "--tolerance",
                              "also give --deviation SCAN");
  if (!options.centre.empty()) {
    if (!std::all_of(options.centre.begin(), options.centre.end(),
                     [](double c) { return c >= 0.0 && c <= 1.0; }))
      return engine::inputError("the middle of the picture lies outside the field", "--centre",
                                "give fractions from 0 to 1 of the field's width and height, e.g. 0.5,0.5");
    view.centre_x = options.centre[0];
    view.centre_y = options.centre[1];
  }
  if (options.perspective) view.projection = render::Projection::kPerspective;
  if (options.contours || options.colouring.contour_step > 0.0) w.input.contours = render::Contours::kShow;
  w.input.colouring = options.colouring;
  w.input.form = options.form;
  w.input.form.filtered_normals = options.normals == "footprint";
  if (options.form.value_colours > 0.0 && options.material == "none")
    return engine::inputError("there is no material to have colours", "--material-colours",
                              "also give --material NAME");
  w.input.form.material =
      std::ranges::find(render::materials(), options.material, &render::MaterialRow::word)->material;
  if (options.dark) w.input.theme = render::Theme::kDark;
  if (options.bare) w.input.decoration = render::Decoration::kNone;
  if (!options.range.empty()) w.input.range = render::ValueRange{options.range[0], options.range[1]};
  static const std::map<std::string, render::ColourMap> kMaps{{"auto", render::ColourMap::kAuto},
                                                              {"viridis", render::ColourMap::kViridis},
                                                              {"cividis", render::ColourMap::kCividis},
                                                              {"grey", render::ColourMap::kGrey},
                                                              {"diverging", render::ColourMap::kDiverging}};
  w.input.colouring.map = kMaps.at(options.map);
  static const std::map<std::string, render::StereoMode> kStereo{
      {"off", render::StereoMode::kOff},
      {"side-by-side", render::StereoMode::kSideBySide},
      {"anaglyph", render::StereoMode::kAnaglyph}};
  w.input.stereo = options.eyes;
  w.input.stereo.mode = kStereo.at(options.stereo);

  const auto scan = loadScan(options.scan, options.reading, job);
  if (!scan) return tl::unexpected(scan.error());
  auto marked = withMarks(scan->field, options.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  auto lined = withLines(*marked, options.lines, job);
  if (!lined) return tl::unexpected(lined.error());
  w.shown.versions = {*std::move(lined)};
  if (!options.marks.empty()) w.shown.marks = render::MarksOverlay::kShow;
  const auto fileName = [](const std::string& path) {
    return std::filesystem::path(shownInput(path)).filename().string();
  };
  w.input.titles = {options.title.empty() ? fileName(options.scan) : options.title};
  if (!options.compare.empty()) {
    const auto other = loadScan(options.compare, options.reading, job);
    if (!other) return tl::unexpected(other.error());
    w.shown.versions.push_back(other->field);
    w.input.titles.push_back(options.compare_title.empty() ? fileName(options.compare)
                                                           : options.compare_title);
  }
  if (!options.deviation.empty()) {
    const auto original = loadScan(options.deviation, options.reading, job);
    if (!original) return tl::unexpected(original.error());
    // Deviation means the samples, whatever form lies over one of them.
    auto reference = engine::seenLike(original->field, scan->field, job);
    if (!reference) return tl::unexpected(reference.error());
    w.shown.original = *std::move(reference);
  }
  if (options.invert) {
    for (engine::Version& version : w.shown.versions) version = version.inverted();
    if (w.shown.original) w.shown.original = w.shown.original->inverted();
  }
  const auto hasLines = [](const engine::Version& version) { return version.lines() != nullptr; };
  if (!options.bare && std::ranges::any_of(w.shown.versions, hasLines)) {
    const auto plan =
        render::planFrame(w.input, w.shown, render::spansOf(w.shown.versions, w.shown.original));
    if (!plan) return tl::unexpected(plan.error());
    std::vector<render::OverlayLine>& lines = w.input.overlays.lines;
    for (std::size_t i = 0; i < w.shown.versions.size(); ++i) {
      const std::size_t before = lines.size();
      LineOverlay().append(w.shown.versions[i], {}, 1.0 / plan->panels[i].camera.pixelsPerMm(),
                           w.input.overlays);
      for (std::size_t k = before; k < lines.size(); ++k) lines[k].panel = static_cast<int>(i);
    }
  }
  return w;
}

engine::Result<Report> render(const RenderArguments& options, engine::JobControl& job) {
  if (auto status =
          checkOutputs({{options.png, OutputKind::kPicture, ".png"}},
                       {options.scan, options.compare, options.deviation, options.marks, options.lines},
                       Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  const auto what = wanted(options, job);
  if (!what) return tl::unexpected(what.error());
  render::LiveOptions live;
  if (options.validate) live.validation = render::Validation::kOn;
  const auto picture = render::LivePicture::create(live);
  if (!picture) return tl::unexpected(picture.error());
  render::FrameStatistics frame;
  const auto status = writeTo(options.png, ".png", job, [&](const std::string& file) -> engine::Status {
    const auto drawn = drawPicture(**picture, what->shown, what->input, file, job);
    if (!drawn) return tl::unexpected(drawn.error());
    frame = *drawn;
    return {};
  });
  if (!status) return tl::unexpected(status.error());
  for (const std::string& message : (*picture)->validationMessages()) warn("validation: " + message);
  Report report{{"width", what->input.view.width},
                {"height", what->input.view.height},
                {"frame_ms", frame.device_ms},
                {"upload_ms", frame.upload.ms},
                {"device", (*picture)->device()},
                {"tiles_uploaded", frame.upload.tiles},
                {"bytes_uploaded", frame.upload.bytes},
                {"vertices", frame.vertices},
                {"range_low", frame.range.low},
                {"range_high", frame.range.high},
                {"vertical_exaggeration", frame.vertical_exaggeration}};
  if (options.stereo != "off") report["stereo"] = options.stereo;
  return report;
}

std::vector<Word> materialWords() {
  std::vector<Word> words;
  for (const render::MaterialRow& row : render::materials())
    words.push_back({std::string(row.word), std::string(row.shows)});
  return words;
}

}  // namespace

void addRender(Command root, Chosen& chosen) {
  auto options = std::make_shared<RenderArguments>();
  Command command = addCommand(root, chosen, "render", "Picture of a scan, without a window",
                               [options](engine::JobControl& job) { return render(*options, job); });
  command.add({
      {.name = "SCAN",
       .to = &options->scan,
       .text = "The scan to draw; - for standard input",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "PNG",
       .to = &options->png,
       .text = "The picture to write; - for standard output",
       .kind = ValueKind::kOutput,
       .required = true},
      {.name = "--size",
       .to = &options->size,
       .text = fmt::format("Size of the picture, each side {} to {}", kPictureSides.smallest,
                           kPictureSides.largest),
       .kind = ValueKind::kSize,
       .unit = "pixels"},
      {.name = "--azimuth",
       .to = &options->view.azimuth_deg,
       .text = "Turn of the camera; 0 looks along +y",
       .unit = "degrees"},
      {.name = "--elevation",
       .to = &options->view.elevation_deg,
       .text = "Camera above the horizon; 0 = from the side, 90 = a map",
       .unit = "degrees"},
      {.name = "--zoom",
       .to = &options->view.zoom,
       .text = "1 shows the whole field",
       .range = Range{0.001, 1e6}},
      {.name = "--centre",
       .to = &options->centre,
       .text = "Middle of the picture as fractions of the field",
       .shown = "X,Y",
       .otherwise = "0.5,0.5",
       .values = 2,
       .between = ','},
      {.name = "--exaggerate",
       .to = &options->view.vertical_exaggeration,
       .text = "Factor on heights; 0 chooses one"},
      {.name = "--compare",
       .to = &options->compare,
       .text = "Second scan, drawn at the right with the same camera",
       .kind = ValueKind::kInput},
      {.name = "--deviation",
       .to = &options->deviation,
       .text = "Colours show the deviation from this scan",
       .kind = ValueKind::kInput},
      {.name = "--marks",
       .to = &options->marks,
       .text = "Picture of marks to overlay",
       .kind = ValueKind::kMarks},
      {.name = "--lines",
       .to = &options->lines,
       .text = "File of edge lines to draw instead of those of a session",
       .kind = ValueKind::kLines},
      {.name = "--map",
       .to = &options->map,
       .text = "Colour map",
       .words = {"auto", "viridis", "cividis", "grey", "diverging"}},
      {.name = "--range",
       .to = &options->range,
       .text = "Heights at the ends of the colours",
       .shown = "LOW,HIGH",
       .otherwise = "those of the field, or of the deviation",
       .values = 2,
       .between = ','},
      {.name = "--title", .to = &options->title, .text = "Title", .otherwise = "the file's name"},
      {.name = "--compare-title",
       .to = &options->compare_title,
       .text = "Title of the second scan",
       .otherwise = "the file's name"},
      {.name = "--perspective",
       .to = &options->perspective,
       .text = "Perspective instead of parallel projection"},
      {.name = "--stereo",
       .to = &options->stereo,
       .text = "A picture for each eye",
       .words = {"off", {"side-by-side", "in two halves"}, {"anaglyph", "for red - cyan glasses"}}},
      {.name = "--eye-separation",
       .to = &options->eyes.eye_separation,
       .text = "Between the eyes, as a share of their distance from the field"},
      {.name = "--screen-distance",
       .to = &options->eyes.screen_distance,
       .text = "Distance of the plane without parallax, as a share of that distance; 0: at the middle of the "
               "picture"},
      {.name = "--contours",
       .to = &options->contours,
       .text = "Contour lines at the steps of the colour bar"},
      {.name = "--contour-step",
       .to = &options->colouring.contour_step,
       .text = "Contour lines this far apart, in SCAN's height unit",
       .range = Range{0.0, 1e30},
       .shown = "D",
       .otherwise = "none, or those of --contours"},
      {.name = "--tolerance",
       .to = &options->colouring.tolerance,
       .text = "With --deviation: deviations up to this are shown as none, in SCAN's height unit",
       .range = Range{0.0, 1e30},
       .shown = "D",
       .otherwise = "none are"},
      {.name = "--steps",
       .to = &options->colouring.steps,
       .text =
           "Twelve steps of one colour each instead of a gradual change; with --tolerance five beyond it on "
           "each side"},
      {.name = "--normals",
       .to = &options->normals,
       .text = "What the light falls on where samples are smaller than pixels",
       .words = {{"sample", "the surface between the samples of a point"},
                 {"footprint", "the surface at the size of a pixel"}}},
      {.name = "--occlusion",
       .to = &options->form.occlusion,
       .text = "Share of the light that places lose at most to what stands around them",
       .range = Range{0.0, 1.0}},
      {.name = "--cavity",
       .to = &options->form.cavity,
       .text = "How much darker hollows and brighter ridges are at most",
       .range = Range{0.0, 1.0}},
      {.name = "--material",
       .to = &options->material,
       .text = "What the surface looks like to be made of",
       .words = materialWords()},
      {.name = "--material-colours",
       .to = &options->form.value_colours,
       .text = "Share of the colours of heights in that of the material; deviations keep theirs",
       .range = Range{0.0, 1.0}},
      {.name = "--dark", .to = &options->dark, .text = "Light text on a dark background"},
      {.name = "--bare",
       .to = &options->bare,
       .text = "Only the surface: no titles, bars, legend or edge lines"},
      {.name = "--invert", .to = &options->invert, .text = "Draw the field upside down"},
      {.name = "--validate",
       .to = &options->validate,
       .text = "Load the Vulkan validation layers and print their messages"},
  });
  addScanOptions(command, options->reading);
  command.examples({{"fettle render scan.tif picture.png --compare clean.tif", "Two scans side by side"},
                    {"fettle render clean.tif changed.png --deviation scan.tif --elevation 90",
                     "What a filter changed, as a map"}});
}

}  // namespace fettle::app

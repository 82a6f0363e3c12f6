#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/commands/demo/demo.h"
#include "app/commands/scan_files.h"
#include "app/work/edge_strokes.h"
#include "engine/edges/locate.h"
#include "engine/filter/noise_range.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/lines/lines.h"
#include "engine/io/raster/marks.h"
#include "engine/scanner/true_lines.h"
#include "haptic/base/strokes.h"
#include "haptic/operator/operator_strokes.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

namespace {

// The scene is written first and read back, so that the folder contains the scene that was used.
//
// The contact is certified: in noise the paper's local search stops at minima far from the tip, and marks
// would have gaps. The marks must cover every sample that some pass can reach across an edge, and the tremor
// of the hand next to it; smoothing uses the one sample of the paper.
std::string sceneText(const DemoOptions& options) {
  std::int32_t reach = 0;
  for (const engine::FilterKind kind : engine::plainFilters())
    reach = std::max(reach, engine::reachOf(demoFilter(kind, options)));
  return fmt::format(
      "# The scene of the demonstration: see assets/scenes/default.toml for every key.\n"
      "effects = [\"spring\", \"smoothing\"]\n\n"
      "[contact]\n"
      "level = \"certified\"\n"
      "certified_radius_cells = 8\n\n"
      "[brush]\n"
      "radius_samples = 0\n"
      "# {0} passes of a {1} x {1} window reach {2} samples; 3 more for the hand's tremor.\n"
      "mark_radius_samples = {3}\n",
      options.passes, options.window, reach, std::min(reach + 3, 64));
}

haptic::OperatorSpec operatorSpec(const DemoOptions& options, const engine::Grid& grid) {
  haptic::OperatorSpec spec;
  spec.seed = options.seed;
  return haptic::offTheEdges(spec, grid);
}

// A filter that keeps edges by itself, with the range of the noise that it measures.
engine::Result<engine::FilterSpec> variation(engine::FilterKind kind, const engine::Version& scan,
                                             engine::JobControl& job) {
  constexpr int kBestOfTv = 31;  // smaller ones leave more noise, larger ones nothing less
  engine::FilterSpec spec;
  spec.kind = kind;
  if (engine::filterOf(kind).window.exists()) spec.window = kBestOfTv;
  return engine::withMeasuredRange(spec, scan, job);
}

// What the marking strokes say of the edges, besides which samples to keep.
engine::Result<engine::EdgeLines> linesOf(const std::vector<haptic::StrokeSample>& strokes,
                                          const engine::Version& scan, double noise,
                                          const haptic::OperatorSpec& person, engine::JobControl& job) {
  const double off_mm = std::hypot(person.tremor_mm, person.wander_mm);
  engine::LocateOptions options;
  options.hand_deviation = std::clamp(off_mm / scan.grid().spacingXMm(), engine::LocateOptions::kLeastHand,
                                      engine::LocateOptions::kMostHand);
  auto lines =
      engine::locateEdgeLines(scan.reader(), noise, edgeStrokesOf(strokes, scan.grid()), options, job);
  if (!lines) return tl::unexpected(lines.error());
  return std::make_shared<const std::vector<engine::EdgeLine>>(*std::move(lines));
}

}  // namespace

engine::FilterSpec demoFilter(engine::FilterKind kind, const DemoOptions& options) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.window = options.window;
  spec.passes = options.passes;
  return spec;
}

engine::Result<DemoRun> runDemo(const DemoOptions& options, engine::JobControl& job) {
  const std::filesystem::path folder(options.folder);
  const auto file = [&folder](const std::string& name) { return (folder / name).string(); };

  engine::ScannerSpec scanner;
  scanner.part = options.part;
  scanner.width = scanner.height = options.side;
  scanner.noise = options.noise;
  scanner.outliers = options.outliers;
  scanner.dropouts = options.dropouts;
  scanner.seed = options.seed;
  auto scan = engine::simulateScan(scanner, job);
  if (!scan) return tl::unexpected(scan.error());
  if (auto s = saveField(scan->scan, file("scan.tif"), job); !s) return tl::unexpected(s.error());
  if (auto s = saveField(scan->truth, file("truth.tif"), job); !s) return tl::unexpected(s.error());
  if (auto s = engine::exportMarks(scan->edges, file("edges.png")); !s) return tl::unexpected(s.error());

  if (auto s = engine::writeFileAtomically(file("scene.toml"), sceneText(options)); !s)
    return tl::unexpected(s.error());
  const auto scene = haptic::loadScene(file("scene.toml"));
  if (!scene) return tl::unexpected(scene.error());
  const auto strokes =
      haptic::operatorStrokes(scan->scan, scan->edge_lines, operatorSpec(options, scan->scan.grid()));
  if (auto s = haptic::writeStrokes(file("strokes.csv"), strokes); !s) return tl::unexpected(s.error());

  auto replayed = haptic::replay(scan->scan, scan->scan, strokes, *scene, {}, job);
  if (!replayed) return tl::unexpected(replayed.error());
  DemoRun run{*std::move(scan), std::move(replayed->field), replayed->report, {}};
  if (auto s = saveField(run.touched, file("touched.tif"), job); !s) return tl::unexpected(s.error());
  if (auto s = engine::exportMarks(run.touched, file("marks.png")); !s) return tl::unexpected(s.error());

  const auto judge = [&](std::string name, std::string title,
                         const engine::Version& field) -> engine::Status {
    const auto figures = engine::compareToTruth(field, run.scan.truth, run.scan.edges, job);
    if (!figures) return tl::unexpected(figures.error());
    run.results.push_back({std::move(name), std::move(title), field, *figures});
    return {};
  };
  if (auto s = judge("noisy", "unfiltered scan", run.scan.scan); !s) return tl::unexpected(s.error());
  if (auto s = judge("touched", "after the strokes only", run.touched); !s) return tl::unexpected(s.error());
  for (const engine::FilterKind kind : engine::plainFilters()) {
    const std::string filter(engine::name(kind));
    const struct {
      std::string name, title;
      const engine::Version& input;
    } methods[] = {{filter, filter + " filter alone", run.scan.scan},
                   {"heg-" + filter, "HEG with " + filter, run.touched}};
    for (const auto& method : methods) {
      const auto filtered = engine::applyFilter(method.input, run.scan.scan, demoFilter(kind, options), job);
      if (!filtered) return tl::unexpected(filtered.error());
      if (auto s = saveField(filtered->field, file(method.name + ".tif"), job); !s)
        return tl::unexpected(s.error());
      if (auto s = judge(method.name, method.title, filtered->field); !s) return tl::unexpected(s.error());
    }
  }
  const auto tv = variation(engine::FilterKind::kTotalVariation, run.scan.scan, job);
  if (!tv) return tl::unexpected(tv.error());
  const auto planes = variation(engine::FilterKind::kPlanes, run.scan.scan, job);
  if (!planes) return tl::unexpected(planes.error());
  const auto tgv = variation(engine::FilterKind::kGeneralisedVariation, run.scan.scan, job);
  if (!tgv) return tl::unexpected(tgv.error());
  const auto lines =
      linesOf(strokes, run.scan.scan, tgv->range_sigma, operatorSpec(options, run.scan.scan.grid()), job);
  if (!lines) return tl::unexpected(lines.error());
  if (auto s = engine::exportLines(file("lines.csv"), **lines, run.scan.scan.grid()); !s)
    return tl::unexpected(s.error());
  const auto true_lines = std::make_shared<const std::vector<engine::EdgeLine>>(engine::trueLines(run.scan));
  const struct {
    std::string name, title;
    const engine::FilterSpec& spec;
    engine::EdgeLines lines;
  } variations[] = {{"tv", "tv filter alone", *tv, nullptr},
                    {"planes", "planes filter alone", *planes, nullptr},
                    {"tgv", "tgv filter alone", *tgv, nullptr},
                    {"tgv-hand", "tgv, lines of the hand", *tgv, *lines},
                    {"tgv-true", "tgv, true lines", *tgv, true_lines}};
  for (const auto& each : variations) {
    const engine::Version input = run.scan.scan.withLines(each.lines);
    const auto filtered = engine::applyFilter(input, run.scan.scan, each.spec, job);
    if (!filtered) return tl::unexpected(filtered.error());
    if (auto s = saveField(filtered->field, file(each.name + ".tif"), job); !s)
      return tl::unexpected(s.error());
    if (auto s = judge(each.name, each.title, filtered->field); !s) return tl::unexpected(s.error());
  }
  return run;
}

}  // namespace fettle::app

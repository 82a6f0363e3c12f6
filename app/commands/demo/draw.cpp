#include <algorithm>
#include <filesystem>

#include "app/commands/demo/demo.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "render/plan/picture.h"

namespace fettle::app {

namespace {

const DemoResult& result(const DemoRun& run, const std::string& name) {
  return *std::find_if(run.results.begin(), run.results.end(),
                       [&](const DemoResult& r) { return r.name == name; });
}

struct Page {
  std::string file;
  render::PictureSpec spec;
};

std::vector<Page> pages(const DemoRun& run, const DemoOptions& options) {
  std::vector<Page> all;
  const auto add = [&](std::string file) -> render::PictureSpec& {
    all.push_back({std::move(file), {}});
    all.back().spec.view.width = 1600;
    all.back().spec.view.height = 900;
    all.back().spec.cell_px = kStillCellPx;
    return all.back().spec;
  };
  {
    render::PictureSpec& p = add("1_scan_and_truth.png");
    p.field = run.scan.scan;
    p.compare = run.scan.truth;
    p.title_left = "Simulated scan";
    p.title_right = "Truth";
  }
  {
    render::PictureSpec& p = add("2_marks.png");
    p.field = run.touched;
    p.marks = render::MarksOverlay::kShow;
    p.title_left = "After the strokes: edges marked, the land beside them smoothed";
    p.view.elevation_deg = 60.0;
  }
  {
    render::PictureSpec& p = add("3_inverted.png");
    p.field = run.scan.scan;
    p.compare = run.scan.scan.inverted();
    p.title_left = "Scan";
    p.title_right = "Inverted: convex edges become grooves that guide the stylus";
  }
  const auto closeUp = [&](const std::string& file) -> render::PictureSpec& {
    render::PictureSpec& p = add(file);
    p.view.centre_x = options.look_at[0];
    p.view.centre_y = options.look_at[1];
    p.view.zoom = 3.5;
    return p;
  };
  for (const engine::FilterKind kind : engine::plainFilters()) {
    const std::string filter(engine::name(kind));
    const DemoResult& alone = result(run, filter);
    const DemoResult& heg = result(run, "heg-" + filter);
    render::PictureSpec& near = closeUp("4_" + filter + "_alone_and_heg.png");
    near.field = alone.field;
    near.compare = heg.field;
    near.title_left = alone.title;
    near.title_right = heg.title;
    near.view.azimuth_deg = 335.0;
    near.view.elevation_deg = 50.0;
    render::PictureSpec& error = closeUp("5_" + filter + "_error_alone_and_heg.png");
    error.field = alone.field;
    error.compare = heg.field;
    error.deviation_from = run.scan.truth;
    error.title_left = alone.title + ": error against the truth";
    error.title_right = heg.title + ": error against the truth";
    error.view.azimuth_deg = 0.0;
    error.view.elevation_deg = 90.0;
    error.range = render::ValueRange{-0.2, 0.2};
  }
  return all;
}

}  // namespace

engine::Result<std::vector<std::string>> drawDemo(const DemoRun& run, const DemoOptions& options,
                                                  engine::JobControl& job) {
  const auto renderer = render::Renderer::create();
  if (!renderer) return tl::unexpected(renderer.error());
  std::vector<std::string> files;
  for (const Page& page : pages(run, options)) {
    render::Image image;
    const auto report = (*renderer)->render(page.spec, image, job);
    if (!report) return tl::unexpected(report.error());
    for (const std::string& warning : report->warnings) warn(page.file + ": " + warning);
    const std::string path = (std::filesystem::path(options.folder) / page.file).string();
    if (auto status = render::writePng(image, path); !status) return tl::unexpected(status.error());
    files.push_back(page.file);
  }
  return files;
}

}  // namespace fettle::app

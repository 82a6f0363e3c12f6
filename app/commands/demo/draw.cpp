#include <algorithm>
#include <filesystem>

#include "app/commands/demo/demo.h"
#include "app/commands/still_picture.h"
#include "render/live/picture_rows.h"

namespace fettle::app {

namespace {

const DemoResult& result(const DemoRun& run, const std::string& name) {
  return *std::find_if(run.results.begin(), run.results.end(),
                       [&](const DemoResult& r) { return r.name == name; });
}

struct Page {
  std::string file;
  render::Shown shown;
  render::FrameInput input;
};

std::vector<Page> pages(const DemoRun& run, const DemoOptions& options) {
  std::vector<Page> all;
  render::View view;
  view.width = 1600;
  view.height = 900;
  const auto add = [&](std::string file) -> Page& {
    all.push_back({std::move(file), {}, render::stillInput(view)});
    return all.back();
  };
  {
    Page& p = add("1_scan_and_truth.png");
    p.shown.versions = {run.scan.scan, run.scan.truth};
    p.input.titles = {"Simulated scan", "Truth"};
  }
  {
    Page& p = add("2_marks.png");
    p.shown.versions = {run.touched};
    p.shown.marks = render::MarksOverlay::kShow;
    p.input.titles = {"After the strokes: edges marked, the surface next to them smoothed"};
    p.input.view.elevation_deg = 60.0;
  }
  {
    Page& p = add("3_inverted.png");
    p.shown.versions = {run.scan.scan, run.scan.scan.inverted()};
    p.input.titles = {"Scan", "Inverted: convex edges become grooves that guide the stylus"};
  }
  const auto closeUp = [&](const std::string& file) -> Page& {
    Page& p = add(file);
    p.input.view.centre_x = options.look_at[0];
    p.input.view.centre_y = options.look_at[1];
    p.input.view.zoom = 3.5;
    return p;
  };
  for (const engine::FilterKind kind : engine::plainFilters()) {
    const std::string filter(engine::name(kind));
    const DemoResult& alone = result(run, filter);
    const DemoResult& heg = result(run, "heg-" + filter);
    Page& near = closeUp("4_" + filter + "_alone_and_heg.png");
    near.shown.versions = {alone.field, heg.field};
    near.input.titles = {alone.title, heg.title};
    near.input.view.azimuth_deg = 335.0;
    near.input.view.elevation_deg = 50.0;
    Page& error = closeUp("5_" + filter + "_error_alone_and_heg.png");
    error.shown.versions = {alone.field, heg.field};
    error.shown.original = run.scan.truth;
    error.input.titles = {alone.title + ": error against the truth", heg.title + ": error against the truth"};
    error.input.view.azimuth_deg = 0.0;
    error.input.view.elevation_deg = 90.0;
    error.input.range = render::ValueRange{-0.2, 0.2};
  }
  const DemoResult& kept = result(run, "heg-median");
  const DemoResult& clean = result(run, "tgv-hand");
  Page& near = closeUp("6_marks_and_lines.png");
  near.shown.versions = {kept.field, clean.field};
  near.input.titles = {kept.title + ": marked samples keep their noise",
                       clean.title + ": clean up to the edge"};
  near.input.view.azimuth_deg = 335.0;
  near.input.view.elevation_deg = 50.0;
  Page& error = closeUp("7_marks_and_lines_error.png");
  error.shown.versions = {kept.field, clean.field};
  error.shown.original = run.scan.truth;
  error.input.titles = {kept.title + ": error against the truth", clean.title + ": error against the truth"};
  error.input.view.azimuth_deg = 0.0;
  error.input.view.elevation_deg = 90.0;
  error.input.range = render::ValueRange{-0.05, 0.05};
  return all;
}

}  // namespace

engine::Result<std::vector<std::string>> drawDemo(const DemoRun& run, const DemoOptions& options,
                                                  engine::JobControl& job) {
  const auto picture = render::LivePicture::create();
  if (!picture) return tl::unexpected(picture.error());
  std::vector<std::string> files;
  for (const Page& page : pages(run, options)) {
    const std::string path = (std::filesystem::path(options.folder) / page.file).string();
    const auto drawn = drawPicture(**picture, page.shown, page.input, path, job, page.file);
    if (!drawn) return tl::unexpected(drawn.error());
    files.push_back(page.file);
  }
  return files;
}

}  // namespace fettle::app

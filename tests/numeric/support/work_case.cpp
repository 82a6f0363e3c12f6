#include "tests/numeric/support/work_case.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/io/raster/marks.h"
#include "haptic/tick/replay.h"

namespace fettle::tests {

engine::Version worked(const engine::Version& start, const engine::Version& original, const WorkStep& step) {
  engine::JobControl job;
  if (step.filter) {
    engine::Result<engine::Filtered> done = engine::applyFilter(start, original, *step.filter, job);
    if (done) return std::move(done->field);
    ADD_FAILURE() << done.error().line();
    return start;
  }
  engine::Result<haptic::ReplayResult> done =
      haptic::replay(start, original, step.strokes, step.scene, {}, job);
  if (done) return std::move(done->field);
  ADD_FAILURE() << done.error().line();
  return start;
}

std::string writeCase(const std::string& name, const std::string& about, const engine::Version& start,
                      const std::vector<WorkStep>& steps) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "fettle-numeric" / name;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::create_directories(folder, ignored);
  engine::JobControl job;
  bool whole = engine::exportField(start, (folder / "scan.tif").string(), {}, job).has_value();
  const bool marked = engine::summarize(start).marked > 0;
  if (marked) whole = engine::exportMarks(start, (folder / "marks.png").string()).has_value() && whole;

  std::string lines, in = "scan.tif", marks = "marks.png";
  int number = 0;
  for (const WorkStep& step : steps) {
    const std::string out = fmt::format("step{}.tif", ++number);
    if (step.filter) {
      const engine::FilterSpec& f = *step.filter;
      lines += fmt::format("fettle filter {} {} --filter {} --window {} --passes {}", in, out,
                           engine::name(f.kind), f.window, f.passes);
      if (f.sigma > 0.0) lines += fmt::format(" --sigma {}", f.sigma);
      if (marked)
        lines += fmt::format(" --{} {}", f.scope == engine::FilterScope::kKeepMarks ? "keep" : "only", marks);
      if (f.max_change) lines += fmt::format(" --max-change {}", *f.max_change);
    } else {
      const std::string strokes = fmt::format("strokes{}.csv", number);
      const std::string scene = fmt::format("scene{}.toml", number);
      whole = haptic::writeStrokes((folder / strokes).string(), step.strokes).has_value() && whole;
      std::ofstream(folder / scene) << haptic::sceneText(step.scene);
      lines += fmt::format("fettle replay {} {} {} --scene {}", in, strokes, out, scene);
      if (marked) {
        const std::string marks_out = fmt::format("marks{}.png", number);
        lines += fmt::format(" --marks {} --marks-out {}", marks, marks_out);
        marks = marks_out;
      }
    }
    lines += '\n';
    in = out;
  }
  std::ofstream(folder / "README") << about << "\n\n" << lines;
  return fmt::format(
      "{}in {}{}:\n{}",
      steps.size() > 1 ? "max-change of each line counts from its own IN, here from scan.tif; " : "",
      folder.string(), whole ? "" : " (not all could be written)", lines);
}

}  // namespace fettle::tests

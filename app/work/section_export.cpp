#include "app/work/section_export.h"

#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "app/work/layer_over.h"
#include "app/work/section_noise.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

// What a figure measured at, as thin lines of a picture: those that the heights determine.
std::vector<SectionMark> figureMarks(const KeptSection& kept, const engine::Section& section,
                                     const engine::SectionNoise& noise) {
  const SectionWants wants = wantsOf(kept);
  std::vector<SectionMark> marks;
  for (const std::string_view key : sectionFigureKeys())
    if (wantsFigure(wants, key)) (void)sectionFigure(key, wants, section, noise, marks);
  return marks;
}

// Beside `section`: of a field without a height along this line, places without one.
engine::Result<engine::Section> sectionBeside(const engine::Version& before,
                                              std::span<const glm::dvec2> points,
                                              const engine::SectionOptions& options,
                                              const engine::Section& section, engine::JobControl& job) {
  auto beside = engine::sectionAlong(before, points, options, job);
  if (beside || beside.error().kind != engine::ErrorKind::kInput) return beside;
  engine::Section none = section;
  none.height.assign(none.size(), std::numeric_limits<double>::quiet_NaN());
  none.share.assign(none.size(), 0.0);
  return none;
}

engine::Result<std::vector<DrawnSection>> drawnSections(const SectionsToWrite& what,
                                                        engine::JobControl& job) {
  const auto noise = sectionNoiseOf(what.field, job);
  if (!noise) return tl::unexpected(noise.error());
  std::vector<DrawnSection> drawn;
  drawn.reserve(what.sections.size());
  job.begin("taking sections", what.sections.size());
  for (const KeptSection& kept : what.sections) {
    engine::SectionOptions options;
    options.width_mm = kept.width_mm;
    const glm::dvec2 points[] = {kept.from, kept.to};
    auto section = engine::sectionAlong(what.field, points, options, job);
    if (!section) {
      engine::Error error = section.error();
      if (error.kind == engine::ErrorKind::kInput) error.where = fmt::format("section {}", drawn.size() + 1);
      return tl::unexpected(std::move(error));
    }
    drawn.push_back({fmt::format("section {}", drawn.size()), *std::move(section), {}, {}, {}});
    DrawnSection& last = drawn.back();
    last.marks = figureMarks(kept, last.section, *noise);
    if (!what.before.empty()) {
      auto beside = sectionBeside(what.before, points, options, last.section, job);
      if (!beside) return tl::unexpected(beside.error());
      last.other = *std::move(beside);
    }
    job.advance();
  }
  return drawn;
}

}  // namespace

engine::Status writeSections(const SectionsToWrite& what, const std::string& path, engine::JobControl& job) {
  const auto drawn = drawnSections(what, job);
  if (!drawn) return tl::unexpected(drawn.error());
  if (job.cancelled()) return engine::cancelled();
  SectionTaking taking;
  taking.layer = layerOver(what.field);
  if (!what.before.empty()) taking.other_layer = layerOver(what.before);
  const std::string ending = engine::extensionOf(path);
  if (ending == ".csv") return engine::writeFileAtomically(path, sectionCsv(*drawn, taking));
  if (ending == ".dxf") return engine::writeFileAtomically(path, sectionDxf(*drawn));
  if (ending == ".svg" || ending == ".png") return drawSections(*drawn, taking, path);
  return engine::inputError(fmt::format("sections are not written as {}", ending), path,
                            "take .csv, .svg, .png or .dxf");
}

}  // namespace fettle::app

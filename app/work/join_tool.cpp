#include "app/work/join_tool.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/work/mosaic_form.h"
#include "app/work/read_units.h"
#include "app/work/repeat_text.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/mosaic/join.h"
#include "engine/mosaic/overlap_motions.h"

namespace fettle::app {
namespace {

engine::Result<engine::JoinOptions> joinOptionsOf(const JoinTool::Options& what,
                                                  const std::vector<engine::Version>& scans) {
  engine::JoinOptions how;
  how.align.moves = what.moves;
  how.blend = what.blend;
  if (what.columns == 0) {
    how.places = engine::statedPlaces(scans);
    return how;
  }
  const auto columns = static_cast<std::size_t>(what.columns);
  if (scans.size() % columns != 0)
    return engine::inputError(fmt::format("{} scans do not fill rows of {}", scans.size(), columns), "",
                              "add the others, or state no rows");
  how.places = engine::placesInRows(scans, columns, what.overlap / 100.0);
  return how;
}

// How well the scans fit each other.
std::string outcomeOf(const engine::JoinedScans& joined, std::size_t scans) {
  double worst = 0.0;
  for (const engine::OverlapDeviation& overlap : joined.overlaps)
    worst = std::max(worst, std::abs(overlap.median));
  const ReadAs height = readOnScreenAs(worst, 1.0, "mm");
  std::string text = fmt::format("{} scans joined by {} overlaps, one over another by {:.3g} {} at most",
                                 scans, joined.pairs.size(), worst / height.size, height.name);
  if (joined.poses.freedom > 0)
    text += fmt::format("; they agree to {:.3g} of their standard errors",
                        std::sqrt(joined.poses.misfit / joined.poses.freedom));
  if (!joined.repeated.empty()) {
    const glm::dvec2& shift = joined.repeated.front().shift;
    text += "; " + repeatText(shift, readOnScreenAs(glm::length(shift), 1.0, "mm"));
  }
  return text;
}

}  // namespace

void JoinTool::write(const LoopClient& client, std::string path) {
  working_.start([field = client.newest(), others = scans_, what = options,
                  path = std::move(path)](engine::JobControl& job) -> engine::Result<Work> {
    if (others.empty()) return engine::inputError("there is no other scan to join", "", "add one");
    std::vector<engine::FieldForm> forms;
    forms.reserve(others.size() + 1);
    forms.push_back(engine::formOfHeights(field));
    auto own = engine::withoutLayer(field, job);
    if (!own) return tl::unexpected(own.error());
    std::vector<engine::Version> scans{*std::move(own)};
    std::vector<std::string> names{"the field"};
    for (const Scan& other : others) {
      const auto import = importOptions(other.reading);
      if (!import) return tl::unexpected(import.error());
      const auto read = engine::importField(other.path, *import, job);
      if (!read) return tl::unexpected(read.error());
      forms.push_back(engine::formOfHeights(read->field));
      auto samples = engine::withoutLayer(read->field, job);
      if (!samples) return tl::unexpected(samples.error());
      scans.push_back(*std::move(samples));
      names.push_back(std::filesystem::path(other.path).filename().string());
    }
    auto how = joinOptionsOf(what, scans);
    if (!how) return tl::unexpected(how.error());
    how->names = std::move(names);
    const auto joined = engine::joinScans(scans, *how, job);
    if (!joined) return tl::unexpected(joined.error());
    const auto formed = underCommonForm(*joined, scans, forms, how->names, job);
    if (!formed) return tl::unexpected(formed.error());
    engine::ExportOptions writing;
    writing.original = formed->field;
    writing.recipe = writing.steps =
        "recipe = 1\n# Left out: what made the scan of step 0: the window joined scans\n";
    if (auto done = engine::exportField(formed->field, path, writing, job); !done)
      return tl::unexpected(done.error());
    return Work{path, outcomeOf(*joined, scans.size()), formed->left_out};
  });
}

std::optional<std::string> JoinTool::poll(std::vector<Notice>& notices) {
  const bool dropped = working_.cancelling();
  auto done = working_.take();
  if (!done || dropped) return std::nullopt;
  if (*done) {
    notices.push_back({(*done)->outcome, ""});
    if (!(*done)->left_out.empty()) notices.push_back({(*done)->left_out, ""});
    return std::move((*done)->path);
  }
  if (done->error().kind != engine::ErrorKind::kCancelled) notices.push_back(noticeOf(done->error()));
  return std::nullopt;
}

}  // namespace fettle::app

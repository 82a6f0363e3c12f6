#include "app/commands/report_draft.h"

#include <utility>

#include <fmt/format.h>

#include "app/commands/report_facts.h"
#include "app/commands/report_history.h"
#include "app/commands/report_pictures.h"
#include "app/commands/report_texture.h"
#include "app/commands/scan_files.h"
#include "app/plots/gnuplot.h"
#include "app/work/kept_sections.h"
#include "app/work/streams.h"
#include "engine/field/seen_field.h"

namespace fettle::app {

namespace {

engine::Status addAllSections(ReportDraft& draft) {
  draft.report["sections"] = draft.options.sections.lines.size();
  if (auto status = addSections(draft.page, draft.options.sections, draft.states, draft.job); !status)
    return status;
  if (draft.imported.sections.empty()) return {};
  const auto kept = sectionsOf(draft.imported.sections);
  if (!kept) return tl::unexpected(kept.error());
  draft.report["kept_sections"] = kept->size();
  if (const auto possible = plotsCanBeMade(); !possible) {
    draft.page.parts.emplace_back(
        ReportPage::Paragraph{fmt::format("{} sections that are kept with the session are not shown: {}.",
                                          kept->size(), possible.error().what)});
    return {};
  }
  return addKeptSections(draft.page, *kept, draft.states, draft.job);
}

}  // namespace

std::string fileNameOf(const std::string& path) {
  return std::filesystem::path(shownInput(path)).filename().string();
}

std::string ReportDraft::name() const {
  return options.name.empty() ? fileNameOf(options.scan) : options.name;
}

std::vector<std::string> ReportDraft::heads(std::vector<std::string> first) const {
  for (const ShownState& state : states) first.push_back(state.name);
  return first;
}

engine::Status readForReport(ReportDraft& draft) {
  auto imported = loadScan(draft.options.scan, draft.options.reading, draft.job);
  if (!imported) return tl::unexpected(imported.error());
  draft.imported = *std::move(imported);
  if (draft.options.kept) draft.imported.sections = *draft.options.kept;
  std::optional<engine::Version> original = draft.imported.original;
  if (!draft.options.original.empty()) {
    auto other = loadScan(draft.options.original, draft.options.reading, draft.job);
    if (!other) return tl::unexpected(other.error());
    auto reference = engine::seenLike(other->field, draft.imported.field, draft.job);
    if (!reference) return tl::unexpected(reference.error());
    original = *std::move(reference);
  }
  if (original && !(*original == draft.imported.field)) {
    const engine::Grid &a = original->grid(), &b = draft.imported.field.grid();
    if (a.width != b.width || a.height != b.height)
      return engine::inputError(fmt::format("the original has {} x {} samples, the scan {} x {}", a.width,
                                            a.height, b.width, b.height),
                                shownInput(draft.options.original), "give the scan that it was made from");
    draft.states.push_back({.name = "Before", .field = *std::move(original)});
  }
  draft.states.push_back({.name = draft.states.empty() ? "Value" : "After", .field = draft.imported.field});
  return {};
}

engine::Result<std::string> reportText(ReportDraft& draft, const std::string& extension) {
  draft.page.title = draft.options.title.empty() ? draft.name() : draft.options.title;
  draft.page.made_with = fmt::format("Made by fettle {} of {}, read as {}.", FETTLE_VERSION, draft.name(),
                                     draft.imported.format);
  for (const auto part :
       {compareStates, addPictures, addScanFacts, addChange, addTextureAndCurves, addAllSections, addWork})
    if (auto status = part(draft); !status) return tl::unexpected(status.error());
  return extension == kPdfExtension ? reportPdf(draft.page) : reportHtml(draft.page);
}

}  // namespace fettle::app

#include "app/commands/report_history.h"

#include <chrono>
#include <cstdint>
#include <sstream>
#include <tuple>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/commands/scan_files.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/session/session.h"

namespace fettle::app {

namespace {

// A TOML text as one line: its settings without comments.
std::string settingLine(const std::string& toml) {
  std::string line, out;
  std::istringstream in(toml);
  while (std::getline(in, line))
    if (const std::size_t at = line.find_first_not_of(" \t\r"); at != std::string::npos && line[at] != '#')
      out += (out.empty() ? "" : "; ") + line.substr(at);
  return out;
}

void addSettings(ReportDraft& draft, const std::optional<engine::Session>& session) {
  ReportPage::Table settings{"Settings", "", {"Setting", "Value"}, {}};
  const auto add = [&settings](const char* name, std::string value) {
    settings.rows.push_back({name, std::move(value)});
  };
  add("Form", draft.options.form.form + (draft.options.form.robust ? ", robust" : ""));
  add("Samples that count",
      draft.options.form.region +
          (draft.options.form.marks.empty() ? "" : " by " + fileNameOf(draft.options.form.marks)));
  for (const auto& [name, cut_off, kind] :
       {std::tuple("S-filter", &draft.options.scale.s_filter, &draft.options.scale.s_kind),
        {"L-filter", &draft.options.scale.l_filter, &draft.options.scale.l_kind}})
    add(name, cut_off->empty() ? "none" : fmt::format("{} mm, {}", *cut_off, *kind));
  add("Noise trials", fmt::format("{}", draft.noise_trials));
  if (const std::string reading = scanOptionsText(draft.options.reading); !reading.empty())
    add("Read with", reading.substr(1));
  if (session) {
    if (!session->scan.path.empty()) add("Scan of the session", fileNameOf(session->scan.path));
    if (!session->scan.format.empty()) add("Format of that scan", session->scan.format);
    for (const auto& [note, name] : {std::pair(engine::kRecipeNote, "Recipe of the scan"),
                                     {engine::kStepsNote, "Steps of commands"},
                                     {"scene", "Scene of touch"}})
      if (const auto found = session->notes.find(note); found != session->notes.end())
        add(name, settingLine(found->second));
  }
  draft.page.parts.emplace_back(std::move(settings));
}

// The session with all its steps. One from standard input is gone after it was read, and Python's scans have none.
engine::Result<std::optional<engine::Session>> sessionOf(const ReportDraft& draft) {
  if (draft.imported.format != "Fettle" || isStream(draft.options.scan) ||
      memoryPlace(draft.options.scan) != nullptr)
    return std::optional<engine::Session>();
  engine::SessionOpenOptions opening;
  opening.history_bytes = engine::History::kNoBound;
  opening.journal = engine::JournalReading::kLeave;
  auto session = loadSession(draft.options.scan, opening, draft.job);
  if (!session) return tl::unexpected(session.error());
  return std::optional(*std::move(session));
}

engine::Status addSteps(ReportDraft& draft, const std::optional<engine::Session>& session) {
  draft.report["steps"] = 0;
  if (!session) return {};
  const engine::History& history = session->history;
  ReportPage::Table steps{
      "Steps",
      "Times are UTC. A hash is that of the samples and marks after the step, as fettle info and other "
      "reports print it; samples are counted from the lower left corner.",
      {"No.", "Step", "Kind", "When", "Where", "Hash"},
      {}};
  for (std::int64_t k = history.first() + 1; k <= history.number(); ++k) {
    if (draft.job.cancelled()) return engine::cancelled();
    const engine::StepInfo& step = history.info(k);
    steps.rows.push_back({fmt::format("{}", k), step.name, std::string(engine::stepKindName(step.kind)),
                          fmt::format("{:%F %T}", std::chrono::floor<std::chrono::seconds>(step.time)),
                          fmt::format("{} x {} samples from {}, {}", step.rect.columns, step.rect.rows,
                                      step.rect.column, step.rect.row),
                          fmt::format("#{}", hashOf(history.state(k)))});
  }
  draft.report["steps"] = steps.rows.size();
  if (!steps.rows.empty()) draft.page.parts.emplace_back(std::move(steps));
  return {};
}

}  // namespace

engine::Status addWork(ReportDraft& draft) {
  const auto session = sessionOf(draft);
  if (!session) return tl::unexpected(session.error());
  addSettings(draft, *session);
  return addSteps(draft, *session);
}

}  // namespace fettle::app

#include <cstdint>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "engine/formats/formats.h"
#include "engine/session/session.h"

namespace fettle::app {

namespace {

engine::Result<Report> journal(const std::string& path, engine::JobControl& job) {
  engine::SessionOpenOptions open;
  open.history_bytes = 0;
  const auto session = loadSession(path, open, job);
  if (!session) return tl::unexpected(session.error());
  Report entries = Report::array();
  for (const engine::JournalEntry& entry : session->journal) {
    Report row{{"entry", entries.size() + 1},
               {"time", fmt::format("{:%FT%TZ}", entry.time)},
               {"state", entry.state}};
    const Report action = Report::parse(entry.action, nullptr, false);
    if (!action.is_object())
      return engine::inputError(fmt::format("entry {} of the journal is no JSON object", entries.size() + 1),
                                path, "the file is damaged: take a copy");
    row["action"] = action;
    if (!entry.data.empty()) row["data_bytes"] = entry.data.size();
    entries.push_back(std::move(row));
  }
  // Only the window keeps a journal.
  if (entries.empty())
    note(fmt::format("{}: nothing was done in the window; fettle recipe prints the steps of commands", path));
  return Report{{"session", path}, {"state", session->history.number()}, {"entries", std::move(entries)}};
}

}  // namespace

void addJournal(Command root, Chosen& chosen) {
  auto session = std::make_shared<std::string>();
  Command command = addCommand(
      root, chosen, "journal", "The journal of a session, one JSON object per line",
      [session](engine::JobControl& job) { return journal(*session, job); },
      [](const Report& report) {
        for (const Report& entry : report["entries"])
          fmt::print("{}\n", entry.dump(-1, ' ', false, Report::error_handler_t::replace));
      },
      Progress::kLine, {}, Printing::kResult);
  command.add({{.name = "SESSION",
                .to = session.get(),
                .text = "The session, NAME.fettle; - for standard input",
                .kind = ValueKind::kInput,
                .required = true}});
  command.notes(
      "Each line has the number of the entry, when it was stored (UTC) and the state that the field had "
      "then, and the "
      "action as the page File formats describes it; data_bytes is the size of larger data, such as the "
      "ticks of a "
      "stroke.");
}

}  // namespace fettle::app

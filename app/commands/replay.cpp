#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "app/command.h"
#include "app/journal/session_player.h"
#include "app/scan_options.h"
#include "app/terminal.h"
#include "app/view/open_document.h"
#include "engine/io/marks.h"
#include "engine/session/session.h"
#include "haptic/replay.h"
#include "haptic/scene.h"
#include "haptic/strokes.h"

namespace fettle::app {

namespace {

struct Options {
  std::string scan;
  std::string strokes;
  std::string out;
  std::string scene;
  std::string marks;
  std::string marks_out;
  std::string forces;
  bool certify = false;
  ScanOptions reading;
};

// The journal of a session, from the scan on.
engine::Result<Report> replayJournal(const Options& options, engine::JobControl& job) {
  if (!options.scene.empty() || !options.marks.empty() || !options.forces.empty() || options.certify)
    return engine::inputError("a session has its own scenes and marks, and its journal no forces",
                              options.scan, "leave --scene, --marks, --forces and --certify out");
  if (auto status = checkOutputs({{options.out, OutputKind::kField}, {options.marks_out, OutputKind::kMarks}},
                                 {options.scan});
      !status)
    return tl::unexpected(status.error());
  engine::SessionOpenOptions open;
  open.history_bytes = 0;
  auto session = engine::openSession(options.scan, open, job);
  if (!session) return tl::unexpected(session.error());
  if (session->journal.empty() && session->history.number() > 0)
    return engine::inputError("the session has no journal", options.scan,
                              "convert or export its present state instead");
  const auto begin = std::chrono::steady_clock::now();
  const auto played = playSession(*session, job);
  if (!played) return tl::unexpected(played.error());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const std::uint64_t made = engine::contentHash(played->field);
  const std::uint64_t stored = engine::contentHash(session->history.current());
  if (made != stored)
    return engine::failure(
        fmt::format("the journal came to another field ({:016x}) than the session holds ({:016x})", made,
                    stored),
        options.scan, "the session's state is whole: convert or export it instead");
  if (auto status = saveField(played->field, options.out, job); !status)
    return tl::unexpected(status.error());
  if (!options.marks_out.empty())
    if (auto status = engine::exportMarks(played->field, options.marks_out); !status)
      return tl::unexpected(status.error());
  return Report{{"ticks", played->ticks},     {"steps", played->steps},
                {"filters", played->filters}, {"loops", played->loops},
                {"state", played->state},     {"entries", session->journal.size()},
                {"seconds", took.count()},    {"hash", fmt::format("{:016x}", made)}};
}

engine::Result<Report> replay(const Options& given, engine::JobControl& job) {
  Options options = given;
  // Two names: a session and where its journal's result goes.
  if (options.out.empty()) std::swap(options.strokes, options.out);
  if (options.strokes.empty()) {
    if (!isSessionPath(options.scan))
      return engine::inputError("a scan needs strokes to be replayed", options.scan,
                                "give SCAN STROKES OUT, or SESSION OUT for a session's own journal");
    return replayJournal(options, job);
  }
  if (auto status = checkOutputs({{options.out, OutputKind::kField},
                                  {options.marks_out, OutputKind::kMarks},
                                  {options.forces, OutputKind::kText}},
                                 {options.scan, options.strokes, options.scene, options.marks});
      !status)
    return tl::unexpected(status.error());
  haptic::Scene scene = haptic::defaultScene();
  if (!options.scene.empty()) {
    auto loaded = haptic::loadScene(options.scene);
    if (!loaded) return tl::unexpected(loaded.error());
    scene = *std::move(loaded);
  }
  const auto strokes = haptic::readStrokes(options.strokes);
  if (!strokes) return tl::unexpected(strokes.error());
  if (strokes->empty())
    return engine::inputError("the strokes hold no row", options.strokes, "give a recorded session");
  auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  engine::Version field = imported->field;
  if (!options.marks.empty()) {
    auto marked = engine::importMarks(field, options.marks);
    if (!marked) return tl::unexpected(marked.error());
    field = *std::move(marked);
  }

  haptic::ReplayOptions replay_options;
  if (!options.forces.empty()) replay_options.record_forces = haptic::RecordForces::kYes;
  if (options.certify) replay_options.measure = haptic::MeasureContact::kYes;
  const auto result = haptic::replay(field, imported->field, *strokes, scene, replay_options, job);
  if (!result) return tl::unexpected(result.error());

  if (auto status = saveField(result->field, options.out, job); !status)
    return tl::unexpected(status.error());
  if (!options.marks_out.empty())
    if (auto status = engine::exportMarks(result->field, options.marks_out); !status)
      return tl::unexpected(status.error());
  if (!options.forces.empty())
    if (auto status = haptic::writeForces(options.forces, result->forces); !status)
      return tl::unexpected(status.error());

  const haptic::ReplayReport& r = result->report;
  if (r.counters.bad_input > 0)
    warn(fmt::format("{}: {} rows hold no usable position and were felt as no input", options.strokes,
                     r.counters.bad_input));
  Report report{{"ticks", r.ticks},
                {"contact_ticks", r.contact_ticks},
                {"max_force_n", r.max_force_n},
                {"bad_input_ticks", r.counters.bad_input},
                {"samples_changed", r.samples_changed},
                {"marked", r.marked},
                {"seconds", r.seconds},
                {"ticks_per_second", r.ticks_per_second},
                {"hash", fmt::format("{:016x}", engine::contentHash(result->field))}};
  if (options.certify) {
    report["above_certified"] = r.above_certified;
    report["worst_excess_mm"] = r.worst_excess_mm;
  }
  return report;
}

}  // namespace

void addReplay(CLI::App& root, Chosen& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(
      root, chosen, "replay",
      "Apply recorded strokes to a scan, or make a session again from its journal: the same bits every time",
      [options](engine::JobControl& job) { return replay(*options, job); });
  command->add_option("SCAN", options->scan, "The scan to touch, or a session: NAME.fettle")->required();
  command
      ->add_option(
          "STROKES", options->strokes,
          "What to do: CSV with header t,x,y,z,tool, one row a tick; left out for a session's own journal")
      ->required();
  command->add_option("OUT", options->out, "The field after it, format by extension");
  command->add_option("--scene", options->scene, "Scene file: tip, stiffness, brush, effects (TOML)");
  command->add_option("--marks", options->marks, "Picture of marks to start from");
  command->add_option("--marks-out", options->marks_out, "Write the marks afterwards, 8-bit PNG or TIFF");
  command->add_option("--forces", options->forces, "Write proxy and force of every tick as CSV");
  command->add_flag(
      "--certify", options->certify,
      "Also count the ticks in which the chosen contact level missed the true closest point (slower)");
  addScanOptions(command, options->reading);
}

}  // namespace fettle::app

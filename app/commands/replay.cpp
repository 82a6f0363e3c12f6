#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/live/placement.h"
#include "app/terminal.h"
#include "app/work/filter_compute.h"
#include "app/work/memory_places.h"
#include "app/work/open_document.h"
#include "app/work/scene_text_file.h"
#include "app/work/streams.h"
#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/session/line_codec.h"
#include "engine/session/session.h"
#include "haptic/base/strokes.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/session_player.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/scene/scene.h"
#include "haptic/sound/sound_file.h"
#include "haptic/tick/replay.h"

namespace fettle::app {

namespace {

struct ReplayArguments {
  std::string scan;
  std::string strokes;
  std::string out;
  std::string to;
  std::string scene;
  std::string marks;
  std::string marks_out;
  std::string forces;
  std::string sound;
  std::string original;
  bool certify = false;
  bool estimate = false;
  Replacing replacing = Replacing::kNoWork;
  ScanOptions reading;
};

// A step whose samples stay as they are, for the estimate of what is written.
engine::Result<engine::Version> pieceAt(const engine::Version& field, const engine::SampleRect& r) {
  return engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
}

engine::Result<Foreseen> foreseeReplay(const ReplayArguments& options, const engine::Version& field,
                                       const engine::Version& original, std::vector<PlannedStep> steps,
                                       engine::JobControl& job) {
  if (memoryPlace(options.out) != nullptr) return Foreseen{};
  const PlannedWork planned{
      .field = field,
      .original = original,
      .steps = std::move(steps),
      .out = options.out,
      .extension = isStream(options.out) ? withDot(options.to) : engine::extensionOf(options.out),
      .writing = beginningWith(original)};
  return foresee(planned, shownOutput(options.out), options.estimate, job);
}

// Of a journal its filters take long: a second of them is as long as millions of ticks.
engine::Result<Foreseen> foreseeJournal(const ReplayArguments& options, const engine::Session& session,
                                        engine::JobControl& job) {
  FilterCompute processor(Compute::kCpu, nullptr);
  std::vector<engine::FilterSpec> specs;
  for (const engine::JournalEntry& row : session.journal) {
    const auto entry = haptic::journalEntry(row.action);
    const auto* begun = entry ? std::get_if<haptic::journal::FilterBegun>(&*entry) : nullptr;
    if (begun != nullptr) specs.push_back(begun->spec);
  }
  std::vector<PlannedStep> steps;
  steps.reserve(specs.size());
  for (const engine::FilterSpec& spec : specs) steps.emplace_back(PlannedFilter{spec, processor});
  return foreseeReplay(options, session.history.current(), session.original, std::move(steps), job);
}

// The first ticks of strokes, and the others as long as these.
engine::Result<Foreseen> foreseeStrokes(const ReplayArguments& options, const engine::Version& field,
                                        const engine::Version& original,
                                        const std::vector<haptic::StrokeSample>& strokes,
                                        const haptic::Scene& scene, const haptic::ReplayOptions& how,
                                        engine::JobControl& job) {
  constexpr std::size_t kShown = 20'000;
  constexpr double kLong = 32.0;  // times as many: then what is shown is a small part
  if (!options.estimate && static_cast<double>(strokes.size()) < kLong * kShown) return Foreseen{};
  PlannedOnPieces ticking{
      .work = [&](const engine::SampleRect& r, engine::JobControl&) { return pieceAt(field, r); }};
  ticking.whole = {.seconds = [&](engine::JobControl& own) -> engine::Result<double> {
    const std::span<const haptic::StrokeSample> some =
        std::span(strokes).first(std::min(kShown, strokes.size()));
    const auto done = haptic::replay(field, original, some, scene, how, own);
    if (!done) return tl::unexpected(done.error());
    return done->report.seconds * static_cast<double>(strokes.size()) / static_cast<double>(some.size());
  }};
  return foreseeReplay(options, field, original, {std::move(ticking)}, job);
}

// What a session is heard as, with the sound of each of its scenes.
class SessionSound final : public haptic::TickListener {
 public:
  void sceneIs(const haptic::Scene& scene) override { file_.set(scene.params.sound); }
  [[nodiscard]] engine::Status tickIs(const haptic::SoundTick& heard,
                                      const haptic::StrokeSample& input) override {
    return file_.add(heard, input.t);
  }
  [[nodiscard]] const haptic::SoundFile& file() const noexcept { return file_; }

 private:
  haptic::SoundFile file_{haptic::SoundParams{}};
};

engine::Status saveSound(const haptic::SoundFile& sound, const std::string& path, Report& report) {
  if (path.empty()) return {};
  report["sound_seconds"] = sound.seconds();
  report["sound_peak"] = sound.peak();
  report["sound_hash"] = fmt::format("{:016x}", sound.hash());
  return sound.write(path);
}

// The journal of a session, from the scan on.
engine::Result<Report> replayJournal(const ReplayArguments& options, engine::JobControl& job) {
  if (!options.scene.empty() || !options.marks.empty() || !options.forces.empty() || options.certify ||
      !options.original.empty())
    return engine::inputError("a session has its own original, scenes and marks, and its journal no forces",
                              options.scan, "omit --original, --scene, --marks, --forces and --certify");
  if (auto status = checkOutputs({{options.out, OutputKind::kField, options.to},
                                  {options.marks_out, OutputKind::kMarks, kMarksStream},
                                  {options.sound, OutputKind::kText}},
                                 {options.scan}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  engine::SessionOpenOptions open;
  open.history_bytes = 0;
  auto session = loadSession(options.scan, open, job);
  if (!session) return tl::unexpected(session.error());
  if (const std::int64_t start = haptic::journalStart(*session);
      start > 0 && (session->history.first() > 1 || session->history.last() < start)) {
    open.history_bytes = engine::History::kNoBound;
    session = loadSession(options.scan, open, job);
    if (!session) return tl::unexpected(session.error());
  }
  if (session->journal.empty() && session->history.number() > 0)
    return engine::inputError("the session has no journal, which only the window keeps", options.scan,
                              session->notes.contains(engine::kStepsNote)
                                  ? "fettle recipe prints the steps of commands, and fettle apply does them "
                                    "again: the same bits"
                                  : "convert or export its present state instead");
  auto foreseen = foreseeJournal(options, *session, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const engine::Stopwatch watch;
  SessionSound sound;
  const auto played = haptic::playSession(*session, job, options.sound.empty() ? nullptr : &sound);
  if (!played) return tl::unexpected(played.error());
  const double seconds = watch.seconds();
  const std::uint64_t made = engine::contentHash(played->field);
  const std::uint64_t stored = engine::contentHash(session->history.current());
  if (made != stored)
    return engine::failure(
        fmt::format("the journal gives another field ({:016x}) than that of the session ({:016x})", made,
                    stored),
        options.scan, "the session's state is intact: convert or export it instead");
  if (engine::packLines(played->field.lines()) != engine::packLines(session->history.current().lines()))
    return engine::failure("the journal gives other edge lines than those of the session", options.scan,
                           "the session's state is intact: convert or export it instead");
  if (auto status = saveField(played->field, options.out, job, beginningWith(session->original), options.to);
      !status)
    return tl::unexpected(status.error());
  if (!options.marks_out.empty())
    if (auto status = saveMarks(played->field, options.marks_out, job); !status)
      return tl::unexpected(status.error());
  Report report{{"ticks", played->ticks},     {"steps", played->steps},
                {"filters", played->filters}, {"loops", played->loops},
                {"state", played->state},     {"entries", session->journal.size()},
                {"seconds", seconds},         {"hash", fmt::format("{:016x}", made)}};
  if (auto status = saveSound(sound.file(), options.sound, report); !status)
    return tl::unexpected(status.error());
  return report;
}

// Whether a file begins like a strokes file.
bool holdsStrokes(const std::string& path) {
  constexpr std::string_view kHead = "t,x,y,z,tool";
  std::string head(kHead.size(), '\0');
  std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head == kHead;
}

// SCAN STROKES OUT, or SESSION OUT: the first name decides. Missing names are refused with a message.
engine::Status settleNames(ReplayArguments& options) {
  constexpr const char* kUsage = "give SCAN STROKES OUT, or SESSION OUT for a session's own journal";
  if (!options.out.empty()) return {};
  const std::string named = isStream(options.scan) ? "stdin" + withDot(options.reading.from) : options.scan;
  if (!isSessionPath(named)) {
    if (!options.strokes.empty() && !holdsStrokes(options.strokes))
      return engine::inputError("a scan needs strokes to be replayed, and an output file", options.scan,
                                kUsage);
    return engine::inputError(
        options.strokes.empty() ? "no strokes are named, and no file to write" : "no file to write is named",
        "OUT", kUsage);
  }
  if (options.strokes.empty())
    return engine::inputError("no file to write is named", "OUT",
                              "give SESSION OUT, the file's extension names its format");
  // They would be replaced by the field.
  if (holdsStrokes(options.strokes))
    return engine::inputError("these are strokes, and no file to write is named", options.strokes, kUsage);
  std::swap(options.strokes, options.out);
  return {};
}

// The scene of a recording that was felt with another than the one that was given: with the default one its bits are others.
std::string sceneThatLiesBeside(const std::string& strokes) {
  std::string path = sceneBeside(strokes);
  std::error_code none;
  return std::filesystem::exists(path, none) ? path : std::string();
}

engine::Result<Report> replay(const ReplayArguments& given, engine::JobControl& job) {
  ReplayArguments options = given;
  if (auto named = settleNames(options); !named) return tl::unexpected(named.error());
  if (options.strokes.empty()) return replayJournal(options, job);
  if (isStream(options.strokes))
    return engine::inputError("STROKES takes no -, standard input", "-",
                              "name a file, ./- for one of that name");
  const std::string beside = options.scene.empty() ? sceneThatLiesBeside(options.strokes) : std::string();
  if (!beside.empty()) options.scene = beside;
  if (auto status =
          checkOutputs({{options.out, OutputKind::kField, options.to},
                        {options.marks_out, OutputKind::kMarks, kMarksStream},
                        {options.forces, OutputKind::kText},
                        {options.sound, OutputKind::kText}},
                       {options.scan, options.strokes, options.scene, options.marks, options.original},
                       options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  auto scene = haptic::loadSceneOrDefault(options.scene);
  if (!scene) return tl::unexpected(scene.error());
  if (auto status = checkOriginal(options.original, scene->max_change.has_value(), options.out); !status)
    return tl::unexpected(status.error());
  const auto strokes = haptic::readStrokes(options.strokes);
  if (!strokes) return tl::unexpected(strokes.error());
  if (strokes->empty())
    return engine::inputError("the strokes hold no row", options.strokes, "give a recorded session");
  auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto original = originalOf(*imported, options.original, options.reading, job);
  if (!original) return tl::unexpected(original.error());
  auto marked = withMarks(imported->field, options.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  const engine::Version field = *std::move(marked);

  haptic::SoundFile sound(scene->params.sound);
  if (!options.sound.empty() && !scene->lists(haptic::EffectKind::kSound))
    scene->effects.push_back(haptic::EffectKind::kSound);  // it changes no bit of the field
  haptic::ReplayOptions replay_options;
  if (!options.forces.empty()) replay_options.record_forces = haptic::RecordForces::kYes;
  if (options.certify) replay_options.measure = haptic::MeasureContact::kYes;
  // Without a device or force nothing can be unstable, and the bits do not depend on it. On a device the
  // scene would be refused, so a warning is given here first. What lies beside strokes was felt on its own.
  if (!options.scene.empty() && beside.empty())
    if (const auto problem =
            problemOnEveryDevice(*scene, field.grid(), haptic::HapticLoop::Settings{}.rate_hz))
      warn(fmt::format("{}: {}", options.scene, withoutForceText(*problem)));
  auto foreseen = foreseeStrokes(options, field, *original, *strokes, *scene, replay_options, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  if (!options.sound.empty())
    replay_options.listen = [&sound](const haptic::SoundTick* heard, const haptic::StrokeSample& input) {
      return sound.add(*heard, input.t);
    };
  const auto result = haptic::replay(field, *original, *strokes, *scene, replay_options, job);
  if (!result) return tl::unexpected(result.error());

  if (auto status = saveField(result->field, options.out, job, beginningWith(*original), options.to); !status)
    return tl::unexpected(status.error());
  if (!options.marks_out.empty())
    if (auto status = saveMarks(result->field, options.marks_out, job); !status)
      return tl::unexpected(status.error());
  if (!options.forces.empty())
    if (auto status = haptic::writeForces(options.forces, result->forces); !status)
      return tl::unexpected(status.error());

  const haptic::ReplayReport& r = result->report;
  if (r.counters.bad_input > 0)
    warn(fmt::format("{}: {} rows have no usable position and count as no input", options.strokes,
                     r.counters.bad_input));
  Report report{{"ticks", r.ticks},
                {"contact_ticks", r.contact_ticks},
                {"max_force_n", r.max_force_n},
                {"bad_input_ticks", r.counters.bad_input},
                {"samples_changed", r.samples_changed},
                {"marked", r.marked},
                {"seconds", r.seconds},
                {"ticks_per_second", r.ticks_per_second},
                {"hash", hashOf(result->field)}};
  if (!beside.empty()) report["scene"] = beside;
  if (auto status = saveSound(sound, options.sound, report); !status) return tl::unexpected(status.error());
  if (options.certify) {
    report["above_certified"] = r.above_certified;
    report["worst_excess_mm"] = r.worst_excess_mm;
  }
  return report;
}

}  // namespace

void addReplay(Command root, Chosen& chosen) {
  auto options = std::make_shared<ReplayArguments>();
  Command command = addCommand(
      root, chosen, "replay",
      "Apply recorded strokes to a scan, or recompute a session from its journal: always bit-identical",
      [options](engine::JobControl& job) { return replay(*options, job); });
  command.add({
      {.name = "SCAN",
       .to = &options->scan,
       .text =
           "The scan to touch, or a session: NAME.fettle; - for standard input, with --from fettle a session",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "STROKES",
       .to = &options->strokes,
       .text = "Strokes: CSV with header t,x,y,z,tool, one row per tick; omitted for a session's own journal",
       .kind = ValueKind::kInput},
      {.name = "OUT",
       .to = &options->out,
       .text = "The field after it, format by extension; - for standard output",
       .kind = ValueKind::kOutput},
  });
  addStreamFormat(command, options->to);
  command.add({
      {.name = "--scene",
       .to = &options->scene,
       .text = "Scene file: tip, stiffness, brush, effects (TOML)",
       .kind = ValueKind::kFile,
       .otherwise = "STROKES.scene.toml where fettle record wrote it, else the default one"},
      {.name = "--marks",
       .to = &options->marks,
       .text = "Picture of marks to start from",
       .kind = ValueKind::kMarks},
      {.name = "--marks-out",
       .to = &options->marks_out,
       .text = "Write the marks afterwards, 8-bit PNG or TIFF",
       .kind = ValueKind::kNewMarks},
      {.name = "--forces",
       .to = &options->forces,
       .text = "Write proxy and force of every tick as CSV",
       .kind = ValueKind::kNewFile},
      {.name = "--sound",
       .to = &options->sound,
       .text = "Write what the strokes are heard as, WAV, with the [sound] of the scene; bit-identical as "
               "the field is",
       .kind = ValueKind::kNewFile},
  });
  addOriginalOption(command, options->original);
  addForceOption(command, options->replacing);
  addEstimateOption(command, options->estimate);
  command.add(
      {{.name = "--certify",
        .to = &options->certify,
        .text = "Also count the ticks in which the chosen contact level missed the true closest point "
                "(slower)"}});
  addScanOptions(command, options->reading);
  command.examples({{"fettle replay scan.tif strokes.csv touched.tif --forces forces.csv",
                     "The scan after the strokes, and the force of every tick"}});
}

}  // namespace fettle::app

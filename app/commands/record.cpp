#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/value_checks.h"
#include "app/live/fitted_scene.h"
#include "app/live/live_session.h"
#include "app/live/placement.h"
#include "app/terminal.h"
#include "app/work/outputs.h"
#include "app/work/scene_text_file.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/raster/marks.h"
#include "haptic/base/strokes.h"
#include "haptic/devices/enumerate.h"
#include "haptic/devices/virtual/simulated_hand.h"
#include "haptic/devices/workspace.h"
#include "haptic/loop/pacer.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/replay.h"

namespace fettle::app {

namespace {

struct RecordArguments {
  std::string scan;
  std::string strokes;
  std::string out;
  std::string device;
  std::string scene;
  std::string scene_out;
  std::string marks;
  std::string marks_out;
  std::string tool = "feel";
  std::string tool_switch = "button";
  std::string arm;
  double rate_hz = 1000.0;
  double seconds = 0.0;
  double scale = 0.0;  // 0 = fitted
  std::optional<double> max_force_n;
  bool keys = false;
  bool fit = false;
  std::string original;
  Replacing replacing = Replacing::kNoWork;
  ScanOptions reading;
};

// The device selected by --device, and its consequences.
struct ChosenDevice {
  std::unique_ptr<haptic::Device> device;
  std::string file;    // strokes that it plays
  bool plays = false;  // simulated: ends with its strokes, and no hand holds it
  double plays_s = 0.0;
};

engine::Result<ChosenDevice> choose(const RecordArguments& options, const haptic::Scene& scene) {
  ChosenDevice chosen;
  const haptic::NamedDriver named = haptic::driverNamed(options.device);
  if (named.driver != nullptr && named.driver->needs_window)
    return engine::inputError(fmt::format("the {} needs a window", options.device),
                              "--device " + options.device, "use another device; fettle devices lists them");
  chosen.plays = named.driver != nullptr && !named.driver->argument.empty();
  if (chosen.plays) chosen.file = named.argument;
  if (chosen.plays && chosen.file.empty())
    return engine::inputError(fmt::format("the device {} needs strokes", options.device),
                              "--device " + options.device,
                              fmt::format("give --device {}:{}", options.device, named.driver->argument));
  if (chosen.plays) {
    const auto strokes = haptic::readStrokes(chosen.file);
    if (!strokes) return tl::unexpected(strokes.error());
    const auto path = haptic::handPath(*strokes);
    if (path.empty())
      return engine::inputError("the strokes contain no position", chosen.file, "give a recorded session");
    chosen.plays_s = path.back().t;
  }
  const bool holds_up = scene.lists(haptic::EffectKind::kGravity);
  if (holds_up && chosen.plays && named.driver->simulates_hand)
    warn(fmt::format(
        "the simulated hand holds no stylus, and gravity compensation for {:g} kg lifts it by {:.2g} mm",
        scene.params.gravity.stylus_kg,
        9.80665 * scene.params.gravity.stylus_kg / haptic::HandSpec{}.stiffness_n_per_mm));
  auto device = haptic::openDevice(options.device, options.rate_hz);
  if (!device) return tl::unexpected(device.error());
  chosen.device = *std::move(device);
  return chosen;
}

// The middle of the field, on its surface if there is one.
glm::dvec3 middleOf(const engine::Version& field) {
  const engine::Grid& grid = field.grid();
  const engine::FieldReader reader = field.reader();
  double height = reader.heightAt(grid.width / 2, grid.height / 2);
  if (!std::isfinite(height)) {
    const engine::HeightBounds bounds = reader.bounds();
    height = bounds.empty() ? 0.0 : 0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max));
  }
  return {0.5 * (grid.width - 1) * grid.spacingXMm(), 0.5 * (grid.height - 1) * grid.spacingYMm(),
          height * grid.height_unit.mm};
}

// Whether the lengths of the scene are fitted: those of the user, and a scale of the user, are taken as they are.
bool fits(const RecordArguments& options, const haptic::DeviceProfile& profile) {
  const bool asked = options.fit || (options.scene.empty() && options.scale == 0.0);
  return asked && profile.space == haptic::DeviceSpace::kDesk;
}

// A scene of the user keeps its effects, which the device holds with lower numbers.
haptic::Scene fittedFor(const RecordArguments& options, const haptic::DeviceProfile& profile,
                        const engine::Grid& grid, const haptic::Scene& given) {
  const double scale = options.scale > 0.0 ? options.scale : wholeFieldScale(profile, grid);
  haptic::Scene fitted = fittedScene(given, profile, grid, options.rate_hz, scale);
  if (!options.fit || !profile.gives_force) return fitted;
  const double longest_reach_mm = longestSnapMm(grid);
  if (const auto problem =
          haptic::stabilityProblem(fitted, profile, options.rate_hz, scale, longest_reach_mm)) {
    warn(fmt::format("{}: lowered to {}", problem->what, problem->remedy));
    fitted = haptic::stableScene(std::move(fitted), profile, options.rate_hz, scale, longest_reach_mm);
  }
  return fitted;
}

// Files of the scene that was felt, with which the recording is replayed.
struct SceneOutputs {
  std::string named;                 // in the report; empty: it is the one that was given
  std::vector<std::string> written;  // where another lies, or none
};

bool isSamePlace(const std::string& a, const std::string& b) {
  std::error_code none;
  return !a.empty() &&
         std::filesystem::weakly_canonical(a, none) == std::filesystem::weakly_canonical(b, none);
}

// Where it was asked for, else beside the strokes unless it is the one that was given. A replay takes whichever lies beside the
// strokes: that of the recording which is replaced goes with it; what somebody wrote there stays, unless --force.
engine::Result<SceneOutputs> sceneOutputs(const RecordArguments& options, const haptic::Scene& felt,
                                          const haptic::Scene& given) {
  SceneOutputs outputs;
  if (!options.scene_out.empty()) outputs.written.push_back(outputs.named = options.scene_out);
  const std::string beside = sceneBeside(options.strokes);
  if (isSamePlace(options.scene_out, beside)) return outputs;
  std::error_code none;
  const bool lies = std::filesystem::exists(beside, none);
  if (!lies && (felt == given || !options.scene_out.empty())) return outputs;
  if (outputs.named.empty()) outputs.named = beside;
  if (lies) {
    const auto lying = haptic::loadScene(beside);
    if (lying && *lying == felt) return outputs;
    const bool of_replaced =
        std::filesystem::exists(options.strokes, none) && lying && isAsWritten(beside, *lying);
    if (!of_replaced && options.replacing == Replacing::kNoWork)
      return engine::inputError("another scene lies there, which a replay of these strokes would take",
                                beside, "name other strokes, move it, or let --force replace it");
  }
  outputs.written.push_back(beside);
  return outputs;
}

// Placement of the device in the field: --scale, or the whole field within reach unless the device cannot
// hold that.
engine::Result<haptic::Workspace> place(const RecordArguments& options, const engine::Version& felt,
                                        const haptic::DeviceProfile& profile, const haptic::Scene& scene) {
  if (profile.space == haptic::DeviceSpace::kField) {
    if (options.scale != 0.0 || options.fit)
      return engine::inputError(fmt::format("{} moves in millimetres of the field already", profile.name),
                                options.fit ? "--fit" : "--scale", "omit it");
    return haptic::Workspace{};
  }
  const engine::Grid& grid = felt.grid();
  const double scale = options.scale > 0.0      ? options.scale
                       : fits(options, profile) ? wholeFieldScale(profile, grid)
                                                : fittedScale(profile, grid, scene, options.rate_hz);
  return haptic::Workspace(scale, middleOf(felt));
}

// A scene that the device cannot hold is refused where force acts on a hand, also a simulated one; otherwise
// a warning is given.
engine::Status checkStability(const RecordArguments& options, const engine::Version& felt,
                              const haptic::DeviceProfile& profile, const haptic::Scene& scene,
                              double scale) {
  const std::string where = options.scene.empty() ? "the default scene" : options.scene;
  if (!profile.gives_force) {
    if (const auto problem = problemOnEveryDevice(scene, felt.grid(), options.rate_hz))
      warn(fmt::format("{}: {}", where, withoutForceText(*problem)));
    return {};
  }
  const double longest_reach_mm = longestSnapMm(felt.grid());
  const auto problem = haptic::stabilityProblem(scene, profile, options.rate_hz, scale, longest_reach_mm);
  if (!problem) {
    const auto faint = fits(options, profile)
                           ? std::nullopt
                           : feltProblem(scene, profile, felt.grid(), options.rate_hz, scale);
    if (faint) warn(fmt::format("{}: {}: give --fit, or {}", where, faint->what, faint->remedy));
    return {};
  }
  // Only the requested scale may be wrong.
  const double largest = haptic::largestStableScale(scene, profile, options.rate_hz, longest_reach_mm);
  if (options.scale > 0.0 && largest > 0.0)
    return engine::inputError(
        problem->what, fmt::format("--scale {:g}", scale),
        fmt::format("take a scale of at most {:.4g}, or a scene with a softer spring: at this scale {}",
                    largest, problem->remedy));
  return engine::inputError(problem->what, where, problem->remedy);
}

// A device that no hand holds arms itself; a force device waits for the user.
engine::Result<ArmPolicy> armPolicy(const RecordArguments& options, const ChosenDevice& chosen) {
  const bool acts_on_hand = chosen.device->profile().gives_force && !chosen.plays;
  if (options.arm == "auto" && acts_on_hand)
    return engine::inputError("a device that gives force is armed by the person who holds it", "--arm auto",
                              "omit it and press a when the stylus is clear of the surface");
  if (options.arm.empty()) return acts_on_hand ? ArmPolicy::kByKey : ArmPolicy::kAuto;
  return options.arm == "auto" ? ArmPolicy::kAuto : ArmPolicy::kByKey;
}

engine::Result<LiveSettings> settingsFor(const RecordArguments& options, const ChosenDevice& chosen,
                                         const engine::Version& felt, const haptic::Scene& scene) {
  const haptic::DeviceProfile& profile = chosen.device->profile();
  LiveSettings settings;
  auto workspace = place(options, felt, profile, scene);
  if (!workspace) return tl::unexpected(workspace.error());
  auto arm = armPolicy(options, chosen);
  if (!arm) return tl::unexpected(arm.error());
  settings.arm = *arm;
  haptic::DeviceProfile limited = profile;
  // Only downwards: the limits of the device cannot be raised from the command line.
  if (options.max_force_n) limited.max_force_n = std::min(limited.max_force_n, *options.max_force_n);
  if (auto status = checkStability(options, felt, limited, scene, workspace->scale()); !status)
    return tl::unexpected(status.error());
  haptic::LoopOptions& loop = settings.loop.options;
  loop.limits = sessionLimits(limited);
  loop.workspace = *workspace;
  loop.tool = *haptic::toolNamed(options.tool);
  loop.tool_switch =
      options.tool_switch == "always" ? haptic::ToolSwitch::kAlways : haptic::ToolSwitch::kButton;
  loop.edit_rule = profile.gives_force ? haptic::EditRule::kWhileForceIsGiven : haptic::EditRule::kAnytime;
  // Eight seconds of ticks: the longest wait for a slow disk.
  loop.record_capacity = std::bit_ceil(static_cast<std::size_t>(8.0 * options.rate_hz));
  settings.loop.rate_hz = options.rate_hz;
  settings.keys = options.keys ? KeySource::kAnyInput : KeySource::kTerminal;
  settings.seconds = options.seconds;
  if (chosen.plays) {
    // The time of the simulated hand is counted in ticks, that of a replay by the clock.
    const auto ticks = static_cast<std::uint64_t>(std::ceil(chosen.plays_s * options.rate_hz)) + 1;
    if (profile.gives_force)
      settings.most_ticks = ticks;
    else
      settings.seconds = options.seconds > 0.0 ? std::min(options.seconds, chosen.plays_s) : chosen.plays_s;
  }
  return settings;
}

Report timingOf(const haptic::TimingFigures& f) {
  return {{"p50_us", haptic::microseconds(f.p50_ns)},
          {"p99_us", haptic::microseconds(f.p99_ns)},
          {"p999_us", haptic::microseconds(f.p999_ns)},
          {"p9999_us", haptic::microseconds(f.p9999_ns)},
          {"worst_us", haptic::microseconds(f.worst_ns)}};
}

Report deviceOf(const haptic::Device& device, const haptic::DeviceCounters& c) {
  return {{"name", device.profile().name},
          {"force", device.profile().gives_force},
          {"inputs", c.inputs},
          {"skipped_inputs", c.skipped},
          {"bad_inputs", c.bad_inputs},
          {"lost_inputs", c.lost_inputs},
          {"outputs", c.outputs},
          {"failed_outputs", c.failed_outputs},
          {"forced_zeros", c.forced_zeros},
          {"scaled_forces", c.scaled_forces},
          {"faults", c.faults},
          {"connects", c.connects},
          {"disconnects", c.disconnects},
          {"longest_output_us", haptic::microseconds(c.longest_output_ns)}};
}

Report safetyOf(const LiveOutcome& outcome, const GivenForce& given, const haptic::SafetyLimits& limits) {
  const haptic::SafetyCounters& c = outcome.last.safety_counters;
  return {{"limit_n", limits.peak_force_n},
          {"slew_limit_n_per_ms", limits.slew_n_per_ms},
          {"given_peak_n", given.peak_n},
          {"given_rate_n_per_ms", given.rate_n_per_ms},
          {"given_rise_n_per_ms", given.rise_n_per_ms},
          {"faults", c.faults},
          {"silences", c.silences},
          {"jumps", c.jumps},
          {"clamped", c.clamped},
          {"slewed", c.slewed},
          {"over_speed", c.over_speed},
          {"thermal", c.thermal},
          {"not_finite", c.not_finite},
          {"arms_refused", c.arms_refused}};
}

Report eventsOf(const std::vector<SessionEvent>& events) {
  Report rows = Report::array();
  for (const SessionEvent& e : events) rows.push_back({{"t", e.t}, {"what", e.what}});
  return rows;
}

struct Field {
  engine::Version original;  // reference of max_change
  engine::Version start;     // as imported, with the initial marks
};

engine::Result<Field> load(const RecordArguments& options, engine::JobControl& job) {
  const ProgressLine progress(job);
  auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto original = originalOf(*imported, options.original, options.reading, job);
  if (!original) return tl::unexpected(original.error());
  auto marked = withMarks(imported->field, options.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  return Field{*std::move(original), *std::move(marked)};
}

// The recording is stored first, regardless of other errors, and cannot be cancelled. Its scenes together with it, once all of
// its rows are written: earlier recordings and their scenes stay where it fails.
engine::Status save(const RecordArguments& options, const engine::Version& field,
                    const engine::Version& original, haptic::StrokesWriter& strokes,
                    std::vector<engine::AtomicFile>& scenes) {
  engine::JobControl job;
  if (engine::Status status = strokes.flush(); !status) return status;
  engine::Status with_scenes;
  for (engine::AtomicFile& scene : scenes)
    if (engine::Status status = scene.commit(); !status) with_scenes = std::move(status);
  if (engine::Status status = strokes.commit(); !status) return status;
  if (!with_scenes) return with_scenes;
  if (!options.out.empty())
    if (engine::Status status = saveField(field, options.out, job, beginningWith(original)); !status)
      return status;
  if (!options.marks_out.empty())
    if (engine::Status status = engine::exportMarks(field, options.marks_out); !status) return status;
  return {};
}

engine::Status checkFiles(const RecordArguments& options, const ChosenDevice& chosen,
                          const std::vector<std::string>& scenes, engine::JobControl& job) {
  std::vector<Output> outputs = {{options.strokes, OutputKind::kText},
                                 {options.out, OutputKind::kField},
                                 {options.marks_out, OutputKind::kMarks}};
  for (const std::string& scene : scenes) outputs.push_back({scene, OutputKind::kText});
  return checkOutputs(outputs, {options.scan, options.scene, options.marks, options.original, chosen.file},
                      options.replacing, job);
}

engine::Result<Report> record(const RecordArguments& options, engine::JobControl& job) {
  const auto given = haptic::loadSceneOrDefault(options.scene);
  if (!given) return tl::unexpected(given.error());
  if (auto status = checkOriginal(options.original, given->max_change.has_value(), options.out); !status)
    return tl::unexpected(status.error());
  auto chosen = choose(options, *given);
  if (!chosen) return tl::unexpected(chosen.error());
  if (auto status = checkFiles(options, *chosen, {options.scene_out}, job); !status)
    return tl::unexpected(status.error());
  const auto field = load(options, job);
  if (!field) return tl::unexpected(field.error());
  const engine::Version felt = given->invert ? field->start.inverted() : field->start;
  haptic::Scene scene = *given;
  if (const haptic::DeviceProfile& profile = chosen->device->profile(); fits(options, profile))
    scene = fittedFor(options, profile, felt.grid(), *given);
  const auto settings = settingsFor(options, *chosen, felt, scene);
  if (!settings) return tl::unexpected(settings.error());
  const auto scene_files = sceneOutputs(options, scene, *given);
  if (!scene_files) return tl::unexpected(scene_files.error());
  if (auto status = checkFiles(options, *chosen, scene_files->written, job); !status)
    return tl::unexpected(status.error());
  std::vector<engine::AtomicFile> scenes;
  for (const std::string& path : scene_files->written) {
    auto file = prepareScene(path, scene);
    if (!file) return tl::unexpected(file.error());
    scenes.push_back(*std::move(file));
  }
  auto strokes = haptic::StrokesWriter::create(options.strokes);
  if (!strokes) return tl::unexpected(strokes.error());

  haptic::Device& device = *chosen->device;
  SessionLog log(*strokes);
  auto outcome = runLive(field->start, field->original, scene, device, *settings, log, job);
  if (!outcome) return tl::unexpected(outcome.error());
  if (auto status = save(options, outcome->field, field->original, *strokes, scenes); !status)
    return tl::unexpected(status.error());

  // Verifies that the recording is complete: the file, read back and replayed, gives the same field.
  engine::JobControl unhurried;
  const auto rows = haptic::readStrokes(options.strokes);
  if (!rows) return tl::unexpected(rows.error());
  const auto again = haptic::replay(field->start, field->original, *rows, scene, {}, unhurried);
  if (!again) return tl::unexpected(again.error());
  const std::string hash = hashOf(outcome->field);
  const std::string replayed = hashOf(again->field);
  if (hash != replayed)
    warn(fmt::format(
        "{}: a replay gives another field than the session{}", options.strokes,
        outcome->last.lost_records + outcome->last.refused_edits > 0
            ? ": ticks were lost on the way to the disk, or memory for edits was not ready in time"
            : ", please report it"));

  if (device.profile().gives_force && again->report.contact_ticks > 0 && !(log.given().peak_n > 0.0))
    warn("there was no force and no edit: armed inside the surface, the stylus must first come out of it");

  const haptic::Workspace& workspace = settings->loop.options.workspace;
  const bool desk = device.profile().space == haptic::DeviceSpace::kDesk;
  Report report{{"ticks", log.rows()},
                {"contact_ticks", again->report.contact_ticks},
                {"max_force_n", again->report.max_force_n},
                {"samples_changed", again->report.samples_changed},
                {"marked", again->report.marked},
                {"strokes", outcome->last.stroke},
                {"seconds", log.seconds()},
                {"ended_by", outcome->ended_by},
                {"hash", hash},
                {"replay_hash", replayed},
                {"reproduced", hash == replayed},
                {"lost_rows", outcome->last.lost_records},
                {"refused_edits", outcome->last.refused_edits},
                {"not_near", outcome->last.not_prefetched},
                {"rate_hz", options.rate_hz},
                {"scale", desk ? Report(workspace.scale()) : Report()},
                {"felt_stiffness_n_per_mm", workspace.feltStiffness(scene.stiffness_n_per_mm)},
                {"missed", outcome->missed},
                {"over_1_ms", outcome->over_1_ms},
                {"lateness", timingOf(outcome->lateness)},
                {"compute", timingOf(outcome->compute)},
                {"not_granted", outcome->granted.missing},
                {"latency_held", outcome->granted.latency_held},
                {"safety", safetyOf(*outcome, log.given(), settings->loop.options.limits)},
                {"device", deviceOf(device, outcome->device)},
                {"events", eventsOf(outcome->events)}};
  if (!scene_files->named.empty()) report["scene"] = scene_files->named;
  return report;
}

constexpr const char* kRecordNotes =
    "Safety: a force device gives no force until the user presses a, and likewise after every fault (50 ms "
    "without "
    "input, the device unplugged, the program delayed): the force then rises within half a second. Editing "
    "tools act "
    "only while there is force. Zero force is sent at every exit of the program. A scene with more stiffness "
    "or "
    "damping than the device can hold is refused, with the largest possible value.\n"
    "Keys during the session: a arm, d disarm, c calibrate (the stylus is held in its home pose), {}, q "
    "end.\n"
    "Ctrl-C ends and stores the session. A killed program leaves the recording, except for its last second, "
    "in a "
    "temporary file next to STROKES, and its scene in another. Bit-identical: fettle replay SCAN STROKES "
    "OUT, "
    "with the same --scene "
    "and --marks.\n"
    "Without --scene and --scale the default scene is fitted to scan and device: all of the scan is within "
    "the hand's reach, and "
    "is felt as a part of ordinary size. The scene that was felt is written beside STROKES, as "
    "STROKES.scene.toml, where it is not "
    "the one that was given: fettle replay takes it by itself. A scene that somebody wrote there is replaced "
    "with --force only.";

}  // namespace

void addRecord(Command root, Chosen& chosen) {
  auto options = std::make_shared<RecordArguments>();
  Command command = addCommand(
      root, chosen, "record", "Touch a scan live with a device, and record the session for replay",
      [options](engine::JobControl& job) { return record(*options, job); }, printReport, Progress::kOwn);
  command.add({
      {.name = "SCAN",
       .to = &options->scan,
       .text = "The scan to touch",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "STROKES",
       .to = &options->strokes,
       .text = "Output of the session: CSV t,x,y,z,tool, one row per tick",
       .kind = ValueKind::kNewFile,
       .required = true},
      {.name = "OUT",
       .to = &options->out,
       .text = "The field after it, format by extension",
       .kind = ValueKind::kNewFile},
      {.name = "--device",
       .to = &options->device,
       .text = fmt::format("An id of fettle devices or one of {}", haptic::driverWords()),
       .proposed = haptic::driversAlone(),
       .required = true},
      {.name = "--scene",
       .to = &options->scene,
       .text = "Scene file: tip, stiffness, brush, effects (TOML)",
       .kind = ValueKind::kFile,
       .otherwise = "the default one, fitted to scan and device"},
      {.name = "--fit",
       .to = &options->fit,
       .text =
           "Take stiffness, damping and lengths of the scene from the default one, fitted to scan, device "
           "and --scale"},
      {.name = "--scene-out",
       .to = &options->scene_out,
       .text = "Write the scene that was felt, for fettle replay",
       .kind = ValueKind::kNewFile,
       .otherwise = "beside STROKES where it was fitted"},
      {.name = "--marks",
       .to = &options->marks,
       .text = "Picture of marks to start from",
       .kind = ValueKind::kMarks},
      {.name = "--marks-out",
       .to = &options->marks_out,
       .text = "Write the marks afterwards, 8-bit PNG or TIFF",
       .kind = ValueKind::kNewMarks,
       .problem = streamProblem},
      {.name = "--tool",
       .to = &options->tool,
       .text = "The tool at the start",
       .words = {haptic::kToolWords.begin(), haptic::kToolWords.end()}},
      {.name = "--switch",
       .to = &options->tool_switch,
       .text = "When the tool acts",
       .words = {{"button", "while the stylus' button is pressed"},
                 {"always", "always in contact, for a device without one (W8 boards)"}}},
      {.name = "--rate",
       .to = &options->rate_hz,
       .text = "Rate of the loop",
       .range = Range{haptic::Pacer::kLowestRate_hz, haptic::Pacer::kHighestRate_hz},
       .unit = "ticks per second"},
      {.name = "--seconds",
       .to = &options->seconds,
       .text = "End after this time",
       .range = Range{1e-3, 86400.0},
       .unit = "seconds",
       .otherwise = "it ends by q or Ctrl-C"},
      {.name = "--scale",
       .to = &options->scale,
       .text = "Millimetres of the field per millimetre of the hand",
       .range = Range{1e-6, 1e6},
       .otherwise = "fitted to the scan"},
      {.name = "--max-force",
       .to = &options->max_force_n,
       .text = "Largest force, below what the device's profile allows",
       .range = Range{0.0, 1000.0},
       .unit = "newtons"},
      {.name = "--arm",
       .to = &options->arm,
       .text = "How a device is given force",
       .words = {{"ask", "by the key a"},
                 {"auto", "automatically: devices without force and simulated ones, whose default it is"}}},
      {.name = "--keys",
       .to = &options->keys,
       .text = "Read keys from standard input that is not a terminal"},
  });
  addOriginalOption(command, options->original);
  addForceOption(command, options->replacing,
                 ", and a scene beside STROKES that fettle record did not write");
  addScanOptions(command, options->reading);
  command.notes(fmt::format(kRecordNotes, toolKeys(", ")));
  command.examples({{"fettle record scan.tif again.csv touched.tif --device hand:strokes.csv --seconds 1",
                     "A simulated hand that follows recorded strokes, for a second"}});
}

}  // namespace fettle::app

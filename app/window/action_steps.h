#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <glm/common.hpp>

#include "app/overlay/line_overlay.h"
#include "app/texts/texts.h"
#include "app/window/parts.h"
#include "app/window/result_files.h"
#include "app/window/scene_edits.h"
#include "app/work/filter_list.h"
#include "app/work/line_edits.h"
#include "engine/marks/change_marks.h"

/// What each action does, and its state in the menu: only for the table in actions.cpp. The document or
/// picture that an action needs exists when it is called.
namespace fettle::app::steps {

using haptic::Tool;

inline constexpr double kBrushStep = 1.0;  ///< [ and ] [samples]

inline LoopClient& clientOf(Parts& p) {
  return *p.document.client();
}
inline bool hasField(const Parts& p) {
  return p.document.isOpen();
}

// The next of `count` values of an enumeration, the first after the last.
template <class Enum>
void next(Enum& value, int count) {
  value = static_cast<Enum>((static_cast<int>(value) + 1) % count);
}

// --- File, Edit

inline void ask(Parts& p, Question::Kind kind, std::string path = {}) {
  p.feedback.questions.ask({.kind = kind, .path = std::move(path)});
}

inline void joinScan(Parts& p) {
  ask(p, Question::Kind::kJoin, p.join.scans().empty() ? p.document.path() : p.join.scans().back().path);
}
inline void quit(Parts& p) {
  if (p.document.isOpen() && p.settings.ask_before_quitting && p.scene_files.changed(clientOf(p)))
    p.feedback.questions.ask(
        {.kind = Question::Kind::kUnsavedScene, .afterwards = {.what = Afterwards::What::kQuit}});
  else if (!p.document.unsaved())
    p.quit = Quit::kDone;
  else if (p.settings.ask_before_quitting)
    p.feedback.questions.ask(
        {.kind = Question::Kind::kUnsaved, .afterwards = {.what = Afterwards::What::kQuit}});
  else
    p.quit = Quit::kKeepWork;  // nothing is lost: it is restored when the scan is opened again
}

inline void openScan(Parts& p) {
  ask(p, Question::Kind::kOpen, p.document.path());
}
// Reads the file of the scan again; a session keeps the scan that its steps were made on.
inline void readAs(Parts& p) {
  if (isSessionPath(p.document.path()))
    p.feedback.message(
        tr("the steps of a session were made on its scan as it was read"),
        tr("open the scan itself to read it in another way; `fettle recipe` takes filters and forms along"));
  else
    p.feedback.questions.ask(
        {.kind = Question::Kind::kImport, .path = p.document.path(), .reading = p.reading});
}
inline void save(Parts& p) {
  p.saving.save(p.document, p.feedback, {});
}
inline void saveAs(Parts& p) {
  ask(p, Question::Kind::kSaveAs, p.saving.suggestedPath(p.document, ".fettle"));
}
inline void openScene(Parts& p) {
  ask(p, Question::Kind::kOpenScene, p.scene_files.path());
}
inline void saveScene(Parts& p) {
  ask(p, Question::Kind::kSaveScene, p.scenePathToSave());
}
inline void exportField(Parts& p) {
  ask(p, Question::Kind::kExport, p.saving.suggestedPath(p.document, "_fettled.tif"));
}
template <Question::Kind kind>
void askForFile(Parts& p) {
  askForResult(kind, p);
}
// Whether a step is the line that took the place of the marks of the step before it.
inline bool isLineOfStroke(const engine::History& history, std::int64_t number) {
  return number - 1 > history.first() && number <= history.last() &&
         history.info(number).kind == engine::StepKind::kLines &&
         history.info(number).name == kLineOfStroke &&
         history.info(number - 1).kind == engine::StepKind::kMark;
}
inline void undo(Parts& p) {
  LoopClient& client = clientOf(p);
  const engine::History& history = client.history();
  // What is being worked out is the newest change, though it is no step yet: the line of a stroke that is one.
  client.poll();
  p.marking.lines.follow(client, p.marking.edit, p.settings.draw_lines);
  if (const auto cancelled = p.marking.edit.cancelNewest()) {
    const bool of_stroke = *cancelled == kLineOfStroke && history.canUndo() &&
                           history.info(history.number()).name == haptic::rowOf(haptic::Tool::kMark).title;
    if (of_stroke) p.document.undo();
  } else if (!client.strokeIsUnderWay() && isLineOfStroke(history, history.number())) {
    client.goTo(history.number() - 2);
  } else {
    p.document.undo();
  }
}
inline bool canUndo(const Parts& p) {
  return hasField(p) && (p.document.client()->canUndo() || p.marking.edit.busy());
}
inline void redo(Parts& p) {
  p.marking.edit.cancel();
  LoopClient& client = clientOf(p);
  const engine::History& history = client.history();
  if (isLineOfStroke(history, history.number() + 2))
    client.goTo(history.number() + 2);
  else
    client.redo();
}
inline bool canRedo(const Parts& p) {
  return hasField(p) && p.document.client()->canRedo();
}

// --- Tool

template <Tool tool>
void choose(Parts& p) {
  // Painting over a suggestion accepts it first.
  if (haptic::isMarkTool(tool)) (void)p.marking.edges.accept(clientOf(p));
  p.chooseTool(tool);
}
template <Tool tool>
bool chosen(const Parts& p) {
  return p.stylus.on() && p.document.isOpen() && p.document.client()->tool() == tool;
}

// The last one begun ends first.
inline void navigate(Parts& p) {
  if (p.plane_points.next())
    p.plane_points.leave(p.form.options);
  else if (p.marking.edit.busy())
    p.marking.edit.cancel();
  else if (p.marking.places.busy())
    p.marking.places.drop();
  else if (p.marking.edges.on())
    p.marking.edges.drop();
  else if (p.form.busy())
    p.form.cancel();
  else if (p.form.previewed())
    p.form.dropPreview();
  else if (p.heights.busy())
    p.heights.cancel();
  else if (p.heights.previewed() != nullptr)
    p.heights.dropPreview();
  else if (p.fit.busy())
    p.fit.cancel();
  else if (p.compare.busy())
    p.compare.cancel();
  else if (p.measure.busy())
    p.measure.cancel();
  else if (p.suggester.busy())
    p.suggester.cancel();
  else if (p.line_suggester.busy())
    p.line_suggester.cancel();
  else if (!p.filters.variants().empty() || p.filters.computing() || p.filters.applying())
    p.filters.cancel(clientOf(p));
  else if (p.full_screen && !p.stylus.on())
    p.setFullScreen(false);
  else
    p.chooseTool(std::nullopt);
}

inline void openRadialMenu(Parts& p) {
  p.radial.open(p.cursor, p.window.pictureArea(), p.window.scale(), RadialMenu::By::kKey);
}
template <haptic::TipShape tip>
bool hasTip(const Parts& p) {
  return hasField(p) && p.document.client()->scene().tip == tip;
}
template <haptic::TipShape tip>
void chooseTip(Parts& p) {
  setTip(clientOf(p), tip, p.feedback.notices);
}

template <BrushAdjustment::Of of>
void adjustBrush(Parts& p) {
  p.brush.begin(of, clientOf(p), p.units.height, p.cursor.x);
}
template <int by>
void resizeBrush(Parts& p) {
  setBrushRadius(clientOf(p), brushRadius(clientOf(p)) + by * kBrushStep, p.feedback.notices);
}

inline void keepWithin(Parts& p) {
  haptic::Scene scene = clientOf(p).scene();
  toggleLimit(scene.max_change, p.last_limit);
  applyScene(clientOf(p), scene, p.feedback.notices);
}
inline void invert(Parts& p) {
  haptic::Scene scene = clientOf(p).scene();
  scene.invert = !scene.invert;
  p.filters.cancel(clientOf(p));
  applyScene(clientOf(p), scene, p.feedback.notices);
}

inline bool navigates(const Parts& p) {
  return !p.stylus.on();
}
inline bool keepsWithin(const Parts& p) {
  return hasField(p) && p.document.client()->scene().max_change.has_value();
}
inline bool isInverted(const Parts& p) {
  return hasField(p) && p.document.client()->scene().invert;
}

// --- Marks

template <Lasso::Shape shape>
void lasso(Parts& p) {
  p.chooseTool(std::nullopt);
  p.marking.beginLasso(shape, p.cursor, p.window.pictureArea(), p.picture);
}
template <Lasso::Shape shape>
bool isLasso(const Parts& p) {
  return p.marking.lasso().active() && p.marking.lasso().shape() == shape;
}
inline void suggestEdges(Parts& p) {
  p.settings.display.marks = true;
  p.marking.edges.search(clientOf(p));
}
template <int steps>
void sensitivity(Parts& p) {
  p.marking.turnChoice(&engine::EdgeChoice::sensitivity, 0.05 * steps, 1.0, clientOf(p));
}
template <int steps>
void thickness(Parts& p) {
  p.marking.turnChoice(&engine::EdgeChoice::thickness, 1.0 * steps, 64.0, clientOf(p));
}

inline void invertMarks(Parts& p) {
  p.marking.edit.ask(textOf("Invert marks"), engine::invertMarks);
}
inline void clearMarks(Parts& p) {
  p.marking.edit.ask(textOf("Clear marks"), engine::clearMarks);
}
inline bool drawsLines(const Parts& p) {
  return p.settings.draw_lines;
}
inline void toggleLines(Parts& p) {
  p.settings.draw_lines = !p.settings.draw_lines;
}
inline bool hasLines(const Parts& p) {
  return hasField(p) && p.document.client()->newest().lines() != nullptr;
}
inline bool hasChosenLine(const Parts& p) {
  return hasField(p) && p.marking.lines.chosen(*p.document.client()).has_value();
}
inline void nextLine(Parts& p) {
  p.marking.lines.chooseNext(clientOf(p));
  p.picture.requestRedraw();
}
inline void removeLine(Parts& p) {
  p.marking.lines.removeChosen(clientOf(p), p.marking.edit);
}
inline void joinLine(Parts& p) {
  p.marking.lines.joinChosen(clientOf(p), p.marking.edit);
}
inline void clearLines(Parts& p) {
  p.marking.edit.ask(textOf("Remove all edge lines"),
                     [](const engine::Version& base, engine::JobControl&) -> engine::Result<engine::Version> {
                       return removeLines(base, std::nullopt);
                     });
}
inline bool hasPlaces(const Parts& p) {
  return hasField(p) && p.marking.places.on();
}
// The first time they are searched for; the view goes to one when it is come to (Workstation).
inline void nextPlace(Parts& p) {
  PlaceTool& places = p.marking.places;
  if (places.busy()) return;
  if (places.found() == nullptr)
    places.search(clientOf(p));
  else if (!places.next())
    p.feedback.notices.push_back({tr("no place is left"), tr("Shift+Z hides them; Z then looks for others")});
  p.picture.requestRedraw();
}
inline void hidePlaces(Parts& p) {
  p.marking.places.drop();
  p.picture.requestRedraw();
}
inline void coarserEdges(Parts& p) {
  p.marking.scaleEdges(1.25, clientOf(p));
}
inline void finerEdges(Parts& p) {
  p.marking.scaleEdges(0.8, clientOf(p));
}

// --- Filter

// What a preview is made with, and what it found, stands in its panel.
inline void enterPanel(Parts& p, const char* name) {
  p.settings.panels[name] = true;
  p.enter_panel = name;
}
inline void suggestFilters(Parts& p) {
  p.settings.side_panel = true;
  enterPanel(p, "Suggested filters");
  if (!p.suggester.busy()) p.suggester.search(clientOf(p));
}
inline void nextFilter(Parts& p) {
  p.filters.chooseKind(filterAfter(p.filters.spec.kind), clientOf(p).field().grid());
}
template <FilterPreview::Keep keep>
void preview(Parts& p) {
  const LoopClient& client = clientOf(p);
  p.filters.compute(clientOf(p), keep, p.picture.seenPart(client.field().grid(), p.view));
}
inline void dropPreview(Parts& p) {
  if (!p.filters.variants().empty())
    p.filters.drop(p.filters.variants().size() - 1);
  else
    p.heights.dropPreview();
  p.picture.requestRedraw();
}
template <int by>
void window(Parts& p) {
  p.filters.spec.window = std::clamp(p.filters.spec.window + by, 1, engine::FilterSpec::kMaxWindow);
}
template <int by>
void passes(Parts& p) {
  p.filters.spec.passes = std::clamp(p.filters.spec.passes + by, 1, engine::FilterSpec::kMaxPasses);
}
inline bool onlyMarks(const Parts& p) {
  return p.filters.spec.scope == engine::FilterScope::kOnlyMarks;
}
inline void changeScope(Parts& p) {
  p.filters.spec.scope = onlyMarks(p) ? engine::FilterScope::kKeepMarks : engine::FilterScope::kOnlyMarks;
}
inline void apply(Parts& p) {
  EdgeTool& edges = p.marking.edges;
  const bool taken = p.settings.draw_lines ? edges.acceptAsLines(p.marking.edit) : edges.accept(clientOf(p));
  if (taken) return;
  if (!p.filters.variants().empty())
    p.filters.apply(clientOf(p));
  else
    p.heights.applyPreview();
}
template <int steps>
void moveSplit(Parts& p) {
  double& at = p.settings.display.split_at;
  at = std::clamp(at + 0.02 * steps, 0.02, 0.98);
}

inline bool hasPreview(const Parts& p) {
  return hasField(p) && (!p.filters.variants().empty() || p.heights.previewed() != nullptr);
}
inline void limitFilter(Parts& p) {
  toggleLimit(p.filters.spec.max_change, p.last_limit);
}
inline bool filterIsLimited(const Parts& p) {
  return p.filters.spec.max_change.has_value();
}
inline bool canApply(const Parts& p) {
  return hasPreview(p) || (hasField(p) && p.marking.edges.suggestion() != nullptr);
}

// --- Form

inline bool hasForm(const Parts& p) {
  return hasField(p) && p.document.client()->newest().formOver() != nullptr;
}
inline bool formIsPreviewed(const Parts& p) {
  return p.form.previewed().has_value();
}
inline void formPreview(Parts& p) {
  if (formIsPreviewed(p))
    p.form.dropPreview();
  else
    p.form.preview(clientOf(p));
  p.picture.requestRedraw();
}
inline bool hasFits(const Parts& p) {
  return hasField(p) && p.fit.fits() != nullptr;
}
inline void fitShapes(Parts& p) {
  p.fit.fit(clientOf(p));
  p.settings.side_panel = true;
  enterPanel(p, "Fit");
  p.picture.requestRedraw();
}
inline bool hasFeatures(const Parts& p) {
  return hasField(p) && p.features.found() != nullptr;
}
inline void findFeatures(Parts& p) {
  p.features.find(clientOf(p));
  p.settings.side_panel = true;
  enterPanel(p, "Features");
  p.picture.requestRedraw();
}
inline bool expectsPlanePoint(const Parts& p) {
  return p.plane_points.next().has_value();
}
inline void beginPlanePoints(Parts& p) {
  p.chooseTool(std::nullopt);  // a click is for the points
  p.form.dropPreview();
  p.plane_points.begin(p.form.options, clientOf(p).field().grid());
  p.settings.side_panel = true;
  enterPanel(p, "Form");
  p.picture.requestRedraw();
}
// With the third the plane is previewed.
inline void setPlanePoint(Parts& p) {
  const auto at = p.picture.inside(p.cursor.x, p.cursor.y)
                      ? p.picture.fieldAt(p.cursor, clientOf(p).field(), p.view)
                      : std::nullopt;
  if (!at) return;
  if (!p.plane_points.next()) beginPlanePoints(p);
  if (p.plane_points.take(*at, p.form.options)) p.form.preview(clientOf(p));
  p.picture.requestRedraw();
}
// An end of the section at the cursor; beside the field its nearest place, outside of the picture none.
template <void (SectionTool::*set)(const glm::dvec2&)>
void sectionEnd(Parts& p) {
  if (!p.picture.inside(p.cursor.x, p.cursor.y)) return;
  const auto at = p.picture.fieldAt(p.cursor, clientOf(p).field(), p.view);
  if (!at) return;
  const engine::Grid& grid = clientOf(p).field().grid();
  (p.section.*
   set)(glm::clamp(*at, glm::dvec2(0.0),
                   glm::dvec2((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm())));
  enterPanel(p, "Section");
  p.picture.requestRedraw();
}
template <auto options>
bool heightsArePreviewed(const Parts& p) {
  return p.heights.previews(p.heights.*options);
}
template <auto options>
void previewHeights(Parts& p) {
  constexpr bool removes = std::is_same_v<decltype(options), engine::RemoveOptions HeightTool::*>;
  const char* const panel = removes ? "Remove samples" : "Holes and lines";
  if (heightsArePreviewed<options>(p)) {
    p.heights.dropPreview();
  } else {
    enterPanel(p, panel);
    p.heights.preview(p.heights.*options, p.picture.seenPart(clientOf(p).field().grid(), p.view));
  }
  p.picture.requestRedraw();
}
template <void (HeightTool::*make)()>
void computeHeights(Parts& p) {
  (p.heights.*make)();
}
// A step of its own, whatever the panel says: it is asked for by name, and undo brings heights and marks back.
inline void removeMarked(Parts& p) {
  if (clientOf(p).newest().reader().root().marked_children == 0)
    p.feedback.notices.push_back(
        {tr("nothing is marked that could be removed"), tr("mark with a box (B) or the brush (M) first")});
  else
    p.heights.removeMarked();
}
inline void openRemoval(Parts& p) {
  p.settings.side_panel = true;
  enterPanel(p, "Remove samples");
  p.picture.requestRedraw();
}
template <void (SectionTool::*act)()>
void withSection(Parts& p) {
  (p.section.*act)();
  enterPanel(p, "Section");
  p.picture.requestRedraw();
}
inline bool hasSection(const Parts& p) {
  return !p.section.sections().empty();
}
inline void formOut(Parts& p) {
  p.form.takeOut(clientOf(p));
}
inline void formBack(Parts& p) {
  if (hasForm(p)) p.form.putBack(clientOf(p));
}
inline void formHeights(Parts& p) {
  if (hasForm(p)) p.form.makeHeights(clientOf(p));
}

}  // namespace fettle::app::steps

#pragma once

#include <optional>
#include <string>

#include "app/window/axes_gizmo.h"
#include "app/window/panels/widgets.h"
#include "app/window/parts.h"
#include "haptic/scene/scene_numbers.h"

/// The panels of the window, laid out once per frame between Window::beginFrame() and present(): each
/// function is in the file of its name, shows the given parts and changes them as the user does. Actions go
/// through `act`, so that keys, menus and buttons do the same.
namespace fettle::app {

/// Data for every panel about the document.
struct PanelContext {
  LoopClient& client;
  std::vector<Notice>& notices;
  const Act& act;
  const render::FieldUnits& units;
};

void toolPanel(const PanelContext& context, const Stylus& stylus, const Marking& marking,
               const Display& display);
/// The limit of change of a brush or a filter, with its tick; true when another number was typed. `switches`: the action of the tick.
bool limitField(const PanelContext& context, std::optional<double>& limit, Action switches);
void edgePanel(const PanelContext& context, EdgeTool& edges);
/// Of the places where a line is worth most.
void placePanel(const PanelContext& context, PlaceTool& places);
/// `draws`: whether strokes of the mark tool become edge lines.
void linePanel(const PanelContext& context, LineTool& lines, bool draws);
/// Filters that were tried for the scan as it is seen; one is taken into the fields of `filters` by a click.
void suggestionPanel(const PanelContext& context, FilterSuggester& suggester, FilterPreview& filters,
                     EdgeTool& edges);
/// `heights`: whose previews its list of filters has, too.
void filterPanel(const PanelContext& context, FilterPreview& filters, const HeightTool& heights,
                 Display& display);
/// The form that lies over the field, and the one that is to.
void formPanel(const PanelContext& context, FormTool& form, PlanePicking& points);
/// Holes that are filled, lines that are levelled.
void heightsPanel(const PanelContext& context, HeightTool& heights, LineSuggester& suggester);
/// Samples that become holes; `picture`: whose colours have limits.
void removePanel(const PanelContext& context, HeightTool& heights, RemovalCount& count,
                 const WindowPicture& picture);
/// The buttons of one of these.
struct HeightButtons {
  Action preview;
  Action make;
  const char* name;
};
void heightButtons(const PanelContext& context, HeightTool& heights, const haptic::HeightsMaker& maker,
                   const HeightButtons& buttons);
/// How far the work is or what came of it, where that is `here`; as high without.
void heightOutcome(HeightTool& heights, bool here);
/// Crop, mirror, turn, resample; true when the user asks for it.
[[nodiscard]] bool transformPanel(const PanelContext& context, TransformTool& transform);
/// Other scans that are joined to this one; true when the user asks for it.
[[nodiscard]] bool joinPanel(const PanelContext& context, JoinTool& join);
/// Surface texture parameters; `picture`: what is visible.
void measurePanel(const PanelContext& context, MeasureTool& measure, const WindowPicture& picture);
/// The section along a line, and its cursors.
void sectionPanel(const PanelContext& context, SectionTool& section);
/// Shapes fitted to the field, and what lies between two of them.
void fitPanel(const PanelContext& context, FitTool& fit, WindowPicture& picture);
/// Hills or dales of the field.
void featurePanel(const PanelContext& context, FeatureTool& features, WindowPicture& picture);
/// Another scan brought onto the field, and the deviation from it.
void comparePanel(const PanelContext& context, CompareTool& compare, WindowPicture& picture);
/// `pointed` is set to the step under the cursor, if any.
void historyPanel(const PanelContext& context, MarkEdit& edit, std::optional<std::int64_t>& pointed);
void changePanel(const PanelContext& context, const ChangeFigures& change);
/// The range of the colours over a histogram, tolerance, steps and contour lines.
void colourPanel(const PanelContext& context, Display& display, ColourRange& colours, WindowPicture& picture);
void displayPanel(const PanelContext& context, Settings& settings, WindowPicture& picture, render::View& view,
                  ChoiceCosts& costs);
void statusPanel(const PanelContext& context, const WindowPicture& picture, const OpeningTimes& times);
/// What is asked of the loop, if anything.
struct LoopRequests {
  std::optional<double> rate_hz;
  std::optional<std::string> device;  ///< words of haptic::openDevice
  bool fit_scene = false;             ///< LoopClient::fitScene()
};
[[nodiscard]] LoopRequests hapticsPanel(const PanelContext& context, Parts& parts);
/// A number of the scene: what is wrong with it stands beside it while it is typed.
void sceneNumberField(const PanelContext& context, const haptic::SceneNumber& number);
/// Which effects the scene lists, and the numbers and words of those.
void effectTicks(const PanelContext& context);
void effectFields(const PanelContext& context);

/// Choice of accuracy, with the cost and the error of each choice on this scan.
void contactChooser(const PanelContext& context, ChoiceCosts& costs);
void detailChooser(const PanelContext& context, Display& display, WindowPicture& picture,
                   const render::View& view, ChoiceCosts& costs);

/// What the notices take of the window's height at its `width` [pixels]; 0: there are none.
[[nodiscard]] float noticesHeight(const std::vector<Notice>& notices, float width);
/// Beside all other windows, or over one that fills the picture: the start page.
enum class NoticesLie : std::uint8_t { kBesideTheRest, kOverTheRest };
void noticePanel(const std::vector<Notice>& notices, const Act& act, ImVec2 corner, ImVec2 size,
                 NoticesLie lie);
/// All of the panels in one window at the right. `width` is set to
/// its width [pixels]: the given one, or the one that the user dragged it to.
[[nodiscard]] LoopRequests sidePanel(Parts& parts, const Act& act, float& width);
/// The chosen recent file, if any.
[[nodiscard]] std::optional<std::string> menuBar(Parts& parts, const Act& act);
void statusBar(Parts& parts);
/// Over the picture: the axes, the handle of the split line, the lasso.
void pictureOverlay(const Parts& parts);

/// The tools around the cursor, over everything.
void radialOverlay(const Parts& parts);

void axesOverlay(const AxesGizmo& gizmo, const glm::dvec2& cursor, float scale);

/// The answer of the user to a dialog, with the question at that time.
struct Answer {
  enum class Choice : std::uint8_t {
    kConfirm,  ///< open, write, save, continue with unsaved work, replace
    kOther,    ///< discard the work, start from the scan
    kBack,     ///< no change
  };
  Choice choice = Choice::kBack;
  Question question;
};
/// The dialogs of a path and of a file's reading; kOther: another reading of the file.
[[nodiscard]] std::optional<Answer::Choice> fileDialog(Question& question, Parts& parts);
[[nodiscard]] std::optional<Answer::Choice> importPage(Question& question, Parts& parts);
/// What the device does, measured by hand, and how it is used; kConfirm: Parts::device_setup from now on.
[[nodiscard]] std::optional<Answer::Choice> devicePage(Parts& parts);
/// Lays out the current dialog, if any; returns the answer given in this frame.
[[nodiscard]] std::optional<Answer> dialog(Parts& parts);

/// Requests of the panels of a frame to the owner of the parts.
struct PanelRequests {
  std::optional<std::string> open;  ///< a recent file
  bool sample = false;              ///< the sample part
  LoopRequests loop;
  std::optional<Answer> answer;
};
/// In the middle of `width` pixels while there is no picture: the reason, or the start page.
void placeholder(Parts& parts, float width, const Act& act, PanelRequests& requests);
/// Scans opened last, and what to begin with.
void startPage(Parts& parts, const Act& act, PanelRequests& requests);
/// All of it, around the picture and over it.
[[nodiscard]] PanelRequests layOutPanels(Parts& parts);

}  // namespace fettle::app

#pragma once

#include <optional>
#include <string>

#include "app/window/panels/widgets.h"
#include "app/window/parts.h"

/// The panels of the window, laid out once a frame between Window::beginFrame() and present(): each function
/// is in the file of its name, shows the parts that it is given and changes them as the user does. What is an
/// action goes through `act`, so that keys, menus and buttons do the same.
namespace fettle::app {

/// What every panel about the document needs.
struct PanelContext {
  LoopClient& touch;
  std::vector<Notice>& notices;
  const Act& act;
};

void toolPanel(const PanelContext& context, const Stylus& stylus, const Marking& marking,
               const Display& display);
void edgePanel(const PanelContext& context, EdgeTool& edges);
void filterPanel(const PanelContext& context, FilterPreview& filters, Display& display);
void historyPanel(const PanelContext& context);
void changePanel(const PanelContext& context, const ChangeFigures& change);
void displayPanel(const PanelContext& context, Settings& settings, WindowPicture& picture, render::View& view,
                  ChoiceCosts& costs);
void statusPanel(const PanelContext& context, const WindowPicture& picture, const OpeningTimes& times);
/// The rate of the loop that was asked for [Hz], if one was.
[[nodiscard]] std::optional<double> hapticsPanel(const PanelContext& context, const StylusOverlay& stylus,
                                                 ChoiceCosts& costs);

/// Where accuracy is chosen, with what each choice costs and gives away on this very scan.
void contactChooser(const PanelContext& context, ChoiceCosts& costs);
void detailChooser(const PanelContext& context, Display& display, WindowPicture& picture,
                   const render::View& view, ChoiceCosts& costs);

/// All of the above in one window at the right, notices on top; the rate that was asked for. Returns in `width`
/// how wide it is [pixels]: what it was given, or what the user drew it to.
[[nodiscard]] std::optional<double> sidePanel(Parts& parts, const Act& act, float& width);
/// The recent file that was chosen, if one was.
[[nodiscard]] std::optional<std::string> menuBar(Parts& parts, const Act& act);
void statusBar(Parts& parts);
/// In the middle of `width` pixels, where there is no picture yet: why.
void placeholder(Parts& parts, float width);
/// Over the picture: the grip of the split line, the lasso.
void pictureOverlay(const Parts& parts);

/// What the user answered to a dialog, with the question as it was then.
struct Answer {
  enum class Choice : std::uint8_t {
    kConfirm,  ///< open, write, save, go on with unsaved work, replace
    kOther,    ///< discard the work, start from the scan
    kBack,     ///< nothing is to be done
  };
  Choice choice = Choice::kBack;
  Question question;
};
/// The dialog that is asked for, if one is; what was answered with this frame.
[[nodiscard]] std::optional<Answer> dialog(Parts& parts);

/// What the panels of a frame ask of the owner of the parts.
struct PanelRequests {
  std::optional<std::string> open;  ///< a recent file
  std::optional<double> rate_hz;
  std::optional<Answer> answer;
};
/// All of it, around the place of the picture and over it.
[[nodiscard]] PanelRequests layOutPanels(Parts& parts);

}  // namespace fettle::app

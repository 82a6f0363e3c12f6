#include "app/window/panels/widgets.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/printf.h>
#include <imgui_internal.h>  // stops of Tab
#include <imgui_stdlib.h>

#include "app/texts/texts.h"
#include "app/window/action_tips.h"
#include "app/window/broken_text.h"
#include "app/window/screen_text.h"
#include "app/work/typed_number.h"

namespace fettle::app {

constexpr float kTip = 24.0F;    // of a tip's width, in heights of a letter
constexpr float kNames = 0.36F;  // of a panel's width, for the names of fields and figures

namespace {
render::Theme& themeNow() {
  static render::Theme theme = render::Theme::kDark;
  return theme;
}
}  // namespace

void usePanelTheme(render::Theme theme) {
  themeNow() = theme;
}

ImU32 colourOf(render::PanelColour colour) {
  return render::panelColour(colour, themeNow());
}

void textIn(render::PanelColour colour, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, colourOf(colour));
  ImGui::TextUnformatted(screenText(text).c_str());
  ImGui::PopStyleColor();
}

void writeIn(render::PanelColour colour, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, colourOf(colour));
  writeWrapped(text);
  ImGui::PopStyleColor();
}

void writeIn(render::PanelColour colour, const char* text) {
  writeIn(colour, std::string(tr(text)));
}

void figure(const char* source_name, const std::string& ascii) {
  const std::string value = screenText(ascii);
  const char* const name = tr(source_name);
  const float left = ImGui::GetCursorPosX(), width = ImGui::GetContentRegionAvail().x;
  ImGui::TextDisabled("%s", name);
  const float column = left + kNames * width;
  ImGui::SameLine(std::max(column, left + ImGui::CalcTextSize(name).x + ImGui::GetStyle().ItemSpacing.x));
  const float room = ImGui::GetContentRegionAvail().x;
  if (ImGui::CalcTextSize(value.c_str()).x <= room) {
    ImGui::TextUnformatted(value.c_str());
    return;
  }
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

void workBar(const WorkProgress& progress, float width, const char* what) {
  const std::string text =
      progress.left ? trFormat("{}, {} left", tr(what), durationText(*progress.left)) : tr(what);
  ImGui::ProgressBar(static_cast<float>(progress.share), ImVec2(width, 0.0F), text.c_str());
}

bool cancelledBar(const WorkProgress& progress, const char* what, const char* cancel_id) {
  workBar(progress, -ImGui::GetFontSize() * 5.0F, what);
  ImGui::SameLine();
  return ImGui::Button(labelOf(cancel_id));
}

bool workRow(const std::optional<WorkProgress>& progress, const char* what, const char* cancel_id) {
  if (progress) return cancelledBar(*progress, what, cancel_id);
  ImGui::Dummy(ImVec2(0.0F, ImGui::GetFrameHeight()));
  return false;
}

void beginPlace(const char* id, int lines) {
  // What can be pressed there is reached by arrow keys as the rest is.
  ImGui::BeginChild(id, ImVec2(0.0F, static_cast<float>(lines) * ImGui::GetTextLineHeightWithSpacing()),
                    false, ImGuiWindowFlags_NavFlattened);
}

void endPlace() {
  const float wheel = wheelPastEnd();
  ImGui::EndChild();
  scrollOn(wheel);
}

float wheelPastEnd() {
  const ImGuiIO& io = ImGui::GetIO();
  // Where it was a frame ago: what the wheel does to the list itself is done by now.
  ImGuiStorage& kept = *ImGui::GetStateStorage();
  const ImGuiID id = ImGui::GetID("##scrolled");
  const float before = kept.GetFloat(id, ImGui::GetScrollY());
  kept.SetFloat(id, ImGui::GetScrollY());
  if (io.MouseWheel == 0.0F || io.KeyCtrl || io.KeyShift || !ImGui::IsWindowHovered()) return 0.0F;
  // A list without an end to scroll to is passed over by ImGui itself.
  if (!(ImGui::GetScrollMaxY() > 0.0F)) return 0.0F;
  const bool ended = io.MouseWheel < 0.0F ? before >= ImGui::GetScrollMaxY() : before <= 0.0F;
  return ended ? io.MouseWheel : 0.0F;
}

void scrollOn(float wheel) {
  if (wheel == 0.0F) return;
  // As far as ImGui goes for a notch.
  constexpr float kLines = 5.0F, kMostOfHeight = 0.67F;
  const float step =
      std::floor(std::min(kLines * ImGui::GetFontSize(), kMostOfHeight * ImGui::GetWindowHeight()));
  ImGui::SetScrollY(std::clamp(ImGui::GetScrollY() - wheel * step, 0.0F, ImGui::GetScrollMaxY()));
}

namespace {

// A tip has its size before its first frame: no frame follows one in which nothing moves, and a tip next to another would keep
// the size of that one. `wrap`: 0: lines as they are.
void writeTip(std::string_view ascii, float wrap) {
  const std::string says = screenText(ascii);
  const char *const begin = says.data(), *const end = begin + says.size();
  const ImVec2 text = ImGui::CalcTextSize(begin, end, false, wrap > 0.0F ? wrap : -1.0F),
               around = ImGui::GetStyle().WindowPadding;
  ImGui::SetNextWindowSize(ImVec2(std::ceil(text.x) + 2.0F * around.x, std::ceil(text.y) + 2.0F * around.y));
  ImGui::BeginTooltip();
  if (wrap > 0.0F) ImGui::PushTextWrapPos(around.x + wrap);
  ImGui::TextUnformatted(begin, end);
  if (wrap > 0.0F) ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace

void explain(std::string_view source) {
  if (source.empty() || !ImGui::IsItemHovered()) return;
  const std::string_view says = tr(source);
  // Beside a panel: over it the tip would hide what the field below says.
  const float beside = ImGui::GetWindowPos().x - ImGui::GetStyle().ItemSpacing.x;
  if (beside > (kTip + 2.0F) * ImGui::GetFontSize())
    ImGui::SetNextWindowPos(ImVec2(beside, ImGui::GetItemRectMin().y), ImGuiCond_Always, ImVec2(1.0F, 0.0F));
  writeTip(says, kTip * ImGui::GetFontSize());
}

void problemBeside(std::string_view says) {
  const float wrap = kTip * ImGui::GetFontSize();
  const std::string lines = inLines(std::string(says), wrap);
  const ImVec2 text = ImGui::CalcTextSize(lines.c_str()), around = ImGui::GetStyle().WindowPadding;
  const ImVec2 size(std::ceil(text.x) + 2.0F * around.x, std::ceil(text.y) + 2.0F * around.y);
  const float left = ImGui::GetWindowPos().x - ImGui::GetStyle().ItemSpacing.x - size.x;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  ImGui::SetNextWindowPos(left > 0.0F ? ImVec2(left, low.y) : ImVec2(ImGui::GetWindowPos().x, high.y));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("##problem", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoSavedSettings);
  textIn(render::PanelColour::kProblem, lines);
  ImGui::End();
}

void valueTip(std::string_view says) {
  writeTip(says, 0.0F);
}

void tip(Action action) {
  const ActionRow& s = rowOf(action);
  if (!ImGui::IsItemHovered()) return;
  const std::string_view says = tr(tipOf(action));
  explain(fmt::format("{}: {}{}{}", tr(s.name), keyText(s.key, s.modifiers), says.empty() ? "" : "\n", says));
}

void actionButton(const char* name, Action action, const Act& act, float width) {
  if (ImGui::Button(labelOf(name), ImVec2(width, 0.0F))) act(action);
  tip(action);
}

bool pressButton(const char* name, std::string_view says) {
  const bool pressed = ImGui::Button(labelOf(name));
  explain(says);
  return pressed;
}

namespace {

// Of what was just laid out and is no stop of Tab.
bool stopless(bool pressed) {
  tabGoesOn();
  return pressed;
}

// A label that is wider than the room behind its box goes on in the line below: another language needs more of it.
bool boxWithLabel(const char* name, bool& on) {
  const std::string_view label = labelOf(name), shown = label.substr(0, label.find("##"));
  const float room =
      ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemInnerSpacing.x;
  if (shown.empty() || ImGui::CalcTextSize(shown.data(), shown.data() + shown.size()).x <= room)
    return stopless(ImGui::Checkbox(label.data(), &on));
  const std::size_t id = label.find("###");
  const std::string lines =
      inLines(std::string(shown), room) +
      (id == std::string_view::npos ? "###" + std::string(name) : std::string(label.substr(id)));
  return stopless(ImGui::Checkbox(lines.c_str(), &on));
}

}  // namespace

void tabGoesOn() {
  ImGuiContext& g = *ImGui::GetCurrentContext();
  const bool asks = g.NavMoveScoringItems && (g.NavMoveFlags & ImGuiNavMoveFlags_Tabbing) != 0;
  if (!asks || g.NavId == 0 || g.LastItemData.ID != g.NavId ||
      (g.LastItemData.InFlags & ImGuiItemFlags_Inputable) != 0)
    return;
  if (g.NavTabbingDir > 0) {
    g.NavTabbingCounter = 1;  // the next stop
  } else if (g.NavTabbingDir < 0 && g.NavMoveResultLocal.ID != 0) {
    g.NavMoveScoringItems = false;  // the last stop before
    g.NavAnyRequest = g.NavInitRequest;
  }
}

bool beginList(const char* id, const char* now, ImGuiComboFlags flags) {
  ImGuiContext& g = *ImGui::GetCurrentContext();
  const ImGuiItemFlags before = g.CurrentItemFlags;
  // Without navigation the keys that open a list do other work.
  if ((g.IO.ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) != 0)
    g.CurrentItemFlags |= ImGuiItemFlags_Inputable;
  const ImGuiID self = ImGui::GetID(id);
  const bool open = ImGui::BeginCombo(id, now, flags);
  g.CurrentItemFlags = before;
  // Where it has the focus is seen: no cursor blinks in it.
  if (g.NavActivateInputId == self) g.NavDisableHighlight = false;
  return open;
}

bool tickBox(const char* name, bool& on, std::string_view says) {
  const bool changed = boxWithLabel(name, on);
  explain(says);
  return changed;
}

bool chooseWord(const char* id, int& chosen, std::initializer_list<const char*> words) {
  const char* const now = *(words.begin() + std::clamp(chosen, 0, static_cast<int>(words.size()) - 1));
  if (!beginList(id, screenText(tr(now)).c_str())) return false;
  bool changed = false;
  int i = 0;
  for (const char* word : words) {
    const bool is = i == chosen;
    if (ImGui::Selectable(screenText(labelOf(word)).c_str(), is) && !is) {
      chosen = i;
      changed = true;
    }
    if (is) ImGui::SetItemDefaultFocus();
    ++i;
  }
  ImGui::EndCombo();
  return changed;
}

bool chooseRegion(const char* id, int& chosen) {
  return chooseWord(id, chosen, {"all samples", "marked samples", "samples not marked"});
}

void previewButton(PreviewWord word, const char* id, Action action, const Act& act) {
  const char* const words[] = {tr("Preview"), tr("Drop preview"), tr("Show it")};
  float wide = 0.0F;
  for (const char* each : words) wide = std::max(wide, ImGui::CalcTextSize(each).x);
  wide += 2.0F * ImGui::GetStyle().FramePadding.x;
  const bool behind = word == PreviewWord::kBehind;
  if (behind) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  actionButton(fmt::format("{}###preview {}", words[static_cast<std::size_t>(word)], id).c_str(), action, act,
               wide);
  if (behind) ImGui::PopStyleColor();
}

std::string inLines(const std::string& text, float width) {
  return brokenText(screenText(text), width, [](std::string_view part) {
    return ImGui::CalcTextSize(part.data(), part.data() + part.size()).x;
  });
}

void writeWrapped(const std::string& text) {
  const std::string lines = inLines(text, ImGui::GetContentRegionAvail().x);
  ImGui::PushTextWrapPos(0.0F);  // of words that are wider than the panel
  ImGui::TextUnformatted(lines.c_str());
  ImGui::PopTextWrapPos();
}

void writeWrapped(const char* text) {
  writeWrapped(std::string(tr(text)));
}

void actionTick(const char* name, bool ticked, Action action, const Act& act) {
  if (boxWithLabel(name, ticked)) act(action);
  tip(action);
}

void sameLineIfFits(const char* source, ItemKind what) {
  const char* const text = tr(source);
  const ImGuiStyle& style = ImGui::GetStyle();
  const float needed = what == ItemKind::kButton ? style.FramePadding.x * 2.0F
                                                 : ImGui::GetFrameHeight() + style.ItemInnerSpacing.x;
  ImGui::SameLine();
  if (ImGui::GetContentRegionAvail().x < ImGui::CalcTextSize(text).x + needed) ImGui::NewLine();
}

void beginFields() {
  ImGui::PushItemWidth(-1.0F);
}

void endFields() {
  ImGui::PopItemWidth();
}

void fieldName(const char* source, std::string_view says) {
  const char* const name = tr(source);
  const float left = ImGui::GetCursorPosX(), width = ImGui::GetContentRegionAvail().x;
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", name);
  explain(says);
  const float room = kNames * width - ImGui::GetStyle().ItemInnerSpacing.x;
  if (ImGui::CalcTextSize(name).x <= room) ImGui::SameLine(left + kNames * width);
}

void restOfLine() {
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
}

void noField(const char* says) {
  ImGui::BeginDisabled();
  std::string text(tr(says));
  ImGui::InputText(fmt::format("##no field, {}", says).c_str(), &text, ImGuiInputTextFlags_ReadOnly);
  ImGui::EndDisabled();
}

namespace {

// What is said of a number that was typed, beside its panel, so that no row moves: until something else is typed or clicked on.
struct SaidOfField {
  ImGuiID field = 0;
  std::string text;
  int frame = 0;  // the last one in which the field was laid out
};

SaidOfField& saidOfField() {
  static SaidOfField said;
  return said;
}

void sayOfField(const char* id, std::string text) {
  saidOfField() = {ImGui::GetID(id), std::move(text), ImGui::GetFrameCount()};
}

// Beside the panel of the last item; where there is no room, below the item, or above it at the end of the window.
void showSaidOfField() {
  SaidOfField& said = saidOfField();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const int frame = ImGui::GetFrameCount();
  const bool passed = frame - said.frame > 1 || (frame != said.frame && ImGui::IsMouseClicked(0));
  said.frame = frame;
  if (passed || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) said = {};
  if (said.field == 0 || !ImGui::IsItemVisible()) return;
  // Beside the panel, above a tip; over it the text would lie on a field that is typed into next.
  const float beside = ImGui::GetWindowPos().x - ImGui::GetStyle().ItemSpacing.x;
  const float wide = ImGui::CalcTextSize(said.text.c_str()).x + 2.0F * ImGui::GetFrameHeight();
  const bool room = beside > wide;
  const bool below = high.y + 2.0F * ImGui::GetFrameHeight() < ImGui::GetIO().DisplaySize.y;
  ImGui::SetNextWindowPos(room ? ImVec2(beside, low.y) : ImVec2(high.x, below ? high.y : low.y),
                          ImGuiCond_Always, ImVec2(1.0F, below && !room ? 0.0F : 1.0F));
  ImGui::Begin("##said of a field", nullptr,
               ImGuiWindowFlags_Tooltip | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoDecoration |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_AlwaysAutoResize);
  textIn(render::PanelColour::kWarning, said.text);
  ImGui::End();
}

// A field for a number and its unit: what was typed when it is left by Enter, Tab or a click elsewhere; nothing by Escape, or
// where it reads as before: the number has digits that are not shown.
std::optional<std::string> typedText(const char* id, const std::string& reads,
                                     std::string* so_far = nullptr) {
  static ImGuiID edited = 0;  // one at a time
  static std::string text;
  const ImGuiID self = ImGui::GetID(id);
  std::string now = edited == self ? text : reads;
  if (ImGui::InputText(id, &now, ImGuiInputTextFlags_AutoSelectAll)) saidOfField() = {};
  if (ImGui::IsItemActive()) {
    edited = self;
    text = now;
    if (so_far != nullptr && now != reads) *so_far = now;
  }
  const bool left = ImGui::IsItemDeactivated();
  if (saidOfField().field == self) showSaidOfField();
  if (!left) return std::nullopt;
  edited = 0;
  const bool empty = now.find_first_not_of(' ') == std::string::npos;
  return now == reads || empty ? std::nullopt : std::optional(now);
}

// Sets it within the range; that it was not is said. Whether it is another.
bool take(const char* id, double typed, double low, double high, double& value) {
  if (typed > high) sayOfField(id, tr("at its largest"));
  if (typed < low) sayOfField(id, tr("at its smallest"));
  const double before = std::exchange(value, std::clamp(typed, low, high));
  return value != before;
}

std::nullopt_t notUnderstood(const char* id, const std::string& text) {
  sayOfField(id, trFormat("not understood: {}", text));
  return std::nullopt;
}

}  // namespace

NumberInField typingNumber(const char* id, double value, const std::string& format) {
  const std::string reads = fmt::sprintf(trPrintf(format.c_str()), value);
  std::string so_far;
  const auto text = typedText(id, reads, &so_far);
  const auto before = readTypedNumber(reads);
  const auto taken = [&](const std::string& of) -> std::optional<TypedNumber> {
    auto typed = readTypedNumber(of);
    if (!typed || (!typed->unit.empty() && before && typed->unit != before->unit)) return std::nullopt;
    return typed;
  };
  const auto other = [&](const std::optional<TypedNumber>& typed) {
    return typed && typed->number != value ? std::optional(typed->number) : std::nullopt;
  };
  if (!text) return {other(taken(so_far)), std::nullopt};
  const auto done = taken(*text);
  if (!done) return {std::nullopt, notUnderstood(id, *text)};
  return {std::nullopt, other(done)};
}

std::optional<double> typedNumber(const char* id, double value, const std::string& format) {
  return typingNumber(id, value, format).done;
}

bool typeNumber(const char* id, double& value, double low, double high, const std::string& format) {
  const auto typed = typedNumber(id, value, format);
  if (!typed) return false;
  return take(id, *typed, low, high, value);
}

bool typeCount(const char* id, int& value, int low, int high, int step) {
  const int before = value;
  const bool edited = ImGui::InputInt(id, &value, step, 5 * step);
  if (edited) {
    double within = before;
    saidOfField() = {};
    (void)take(id, value, low, high, within);
    value = static_cast<int>(within);
  }
  if (saidOfField().field == ImGui::GetID(id)) showSaidOfField();
  return edited;
}

bool typeLength(const char* id, double& value, double low, double high, const render::ShownUnit& unit,
                const std::string& when_zero) {
  const auto text = typedText(id, value == 0.0 && !when_zero.empty()
                                      ? "0: " + std::string(tr(std::string_view(when_zero)))
                                      : fmt::sprintf("%.4g " + unit.name, value * unit.per_unit));
  if (!text) return false;
  const auto typed = readTypedLength(*text, unit.name);
  if (!typed) {
    (void)notUnderstood(id, *text);
    return false;
  }
  return take(id, *typed / unit.per_unit, low, high, value);
}

std::string lengthText(double value, const render::ShownUnit& unit, int digits) {
  const double shown = value * unit.per_unit;
  // No exponents where a person reads a plain number sooner.
  const double size = std::abs(shown);
  if (!(size >= std::pow(10.0, digits) && size < 1e7))
    return fmt::format("{:.{}g} {}", shown, digits, unit.name);
  const double step = std::pow(10.0, std::floor(std::log10(size)) + 1.0 - digits);
  return fmt::format("{:.0f} {}", std::round(shown / step) * step, unit.name);
}

std::string bytesText(double bytes) {
  if (bytes < 1e4) return fmt::format("{:.0f} B", bytes);
  if (bytes < 1e7) return fmt::format("{:.1f} kB", bytes * 1e-3);
  if (bytes < 1e10) return fmt::format("{:.1f} MB", bytes * 1e-6);
  return fmt::format("{:.1f} GB", bytes * 1e-9);
}

}  // namespace fettle::app

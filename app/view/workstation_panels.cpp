#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <glm/geometric.hpp>

#include "app/view/workstation.h"
#include "render/overlay.h"

namespace fettle::app {
namespace {

using haptic::Tool;

constexpr float kSide_px = 320.0F;
constexpr ImGuiTreeNodeFlags kOpen = ImGuiTreeNodeFlags_DefaultOpen;

void line(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine(0.5F * ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(value.c_str());
}

double us(std::int64_t ns) {
  return 1e-3 * static_cast<double>(ns);
}

std::string bytesText(double bytes) {
  if (bytes < 1e4) return fmt::format("{:.0f} B", bytes);
  if (bytes < 1e7) return fmt::format("{:.1f} kB", bytes * 1e-3);
  return fmt::format("{:.1f} MB", bytes * 1e-6);
}

}  // namespace

void Workstation::menuItem(Action action, bool enabled, bool ticked) {
  const Shortcut& s = shortcutOf(action);
  if (ImGui::MenuItem(std::string(s.name).c_str(), keyText(s.key, s.modifiers).c_str(), ticked, enabled))
    act(action);
}

void Workstation::menuBar() {
  if (!ImGui::BeginMainMenuBar()) return;
  const bool field = touch_ != nullptr;
  if (ImGui::BeginMenu("File")) {
    menuItem(Action::kOpen);
    if (ImGui::BeginMenu("Recent files", !recent_.paths().empty())) {
      const std::vector<std::string> paths = recent_.paths();
      for (std::size_t i = 0; i < paths.size(); ++i)
        if (ImGui::MenuItem(paths[i].c_str(), fmt::format("Ctrl+{}", i + 1).c_str())) askToOpen(paths[i]);
      ImGui::EndMenu();
    }
    menuItem(Action::kSave, field);
    menuItem(Action::kSaveAs, field);
    menuItem(Action::kExport, field);
    menuItem(Action::kQuit);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Edit")) {
    menuItem(Action::kUndo, field && touch_->canUndo());
    menuItem(Action::kRedo, field && touch_->canRedo());
    ImGui::Separator();
    menuItem(Action::kFilterNext, field);
    menuItem(Action::kFilterPreview, field);
    menuItem(Action::kFilterApply, field && !filters_.variants().empty());
    menuItem(Action::kSplitPreview, field, display_.split);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Tool")) {
    const auto on = [&](Tool tool) { return tool_on_ && touch_ && touch_->tool() == tool; };
    menuItem(Action::kNavigate, field, !tool_on_);
    menuItem(Action::kFeel, field, on(Tool::kFeel));
    menuItem(Action::kSmooth, field, on(Tool::kSmooth));
    menuItem(Action::kMark, field, on(Tool::kMark));
    menuItem(Action::kUnmark, field, on(Tool::kUnmark));
    ImGui::Separator();
    for (const Action a : {Action::kBrushRadius, Action::kBrushStrength, Action::kBrushSmaller,
                           Action::kBrushLarger, Action::kClearMarks})
      menuItem(a, field);
    menuItem(Action::kShowMarks, field, display_.marks);
    menuItem(Action::kInvert, field, field && touch_->scene().invert);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View")) {
    menuItem(Action::kDeviation, field, display_.deviation);
    menuItem(Action::kContours, field, display_.contours);
    menuItem(Action::kNextMap, field);
    ImGui::Separator();
    for (const Action a : {Action::kViewAll, Action::kViewLastStroke, Action::kViewFront, Action::kViewBack,
                           Action::kViewRight, Action::kViewLeft, Action::kViewTop, Action::kProjection,
                           Action::kZoomIn, Action::kZoomOut})
      menuItem(a, field);
    ImGui::Separator();
    if (ImGui::BeginMenu("Mouse")) {
      const auto choice = [&](const char* name, Habits habits) {
        if (ImGui::MenuItem(name, nullptr, habits_ == habits)) habits_ = habits;
      };
      choice("Blender: middle turns, Shift+middle moves", Habits::kBlender);
      choice("CloudCompare: left turns, right moves", Habits::kCloudCompare);
      choice("MeshLab: middle turns, right moves", Habits::kMeshLab);
      ImGui::EndMenu();
    }
    menuItem(Action::kSidePanel, true, side_panel_);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Device")) {
    for (const Action a : {Action::kArm, Action::kDisarm, Action::kCalibrate}) menuItem(a, field);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Help")) {
    menuItem(Action::kShortcuts);
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

void Workstation::panels() {
  menuBar();
  const float scale = static_cast<float>(window_->scale());
  const float top = ImGui::GetFrameHeight();
  const float bottom = ImGui::GetFrameHeight();
  const float width = ImGui::GetIO().DisplaySize.x, height = ImGui::GetIO().DisplaySize.y;
  if (side_width_ <= 0.0F) side_width_ = kSide_px * scale;
  side_width_ = std::clamp(side_width_, 160.0F * scale, std::max(0.6F * width, 161.0F * scale));
  const float side = side_panel_ && touch_ ? side_width_ : 0.0F;
  if (side > 0.0F) {
    ImGui::SetNextWindowPos(ImVec2(width - side, top));
    ImGui::SetNextWindowSize(ImVec2(side, height - top - bottom));
    ImGui::SetNextWindowSizeConstraints(ImVec2(160.0F * scale, 0.0F), ImVec2(width, height));
    sidePanel();
  }
  statusBar();
  window_->setPictureArea(
      {0, static_cast<int>(top), static_cast<int>(width - side), static_cast<int>(height - top - bottom)});
  if (!touch_) {
    ImGui::SetNextWindowPos(ImVec2(0.5F * width, 0.45F * height), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::Begin("##empty", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoSavedSettings);
    if (loading_.busy()) {
      ImGui::Text("%s: %s", std::filesystem::path(loading_path_).filename().c_str(), loading_.stage());
      ImGui::ProgressBar(static_cast<float>(loading_.progress()), ImVec2(360.0F * scale, 0.0F));
      if (ImGui::Button("Cancel")) loading_.cancel();
    } else {
      ImGui::TextUnformatted("Drop a scan here, or press Ctrl+O");
    }
    ImGui::End();
  }
  splitLine();
  dialogs();
}

render::Rectangle Workstation::plot() const {
  const render::Rectangle& area = window_->pictureArea();
  const auto layout =
      render::layOut(view_, display_.furniture ? render::Decoration::kFull : render::Decoration::kNone, 1,
                     shown_.versions.size() > 1 ? render::Titles::kAbove : render::Titles::kNone);
  render::Rectangle rectangle = layout.plots.front();
  rectangle.x += area.x;
  rectangle.y += area.y;
  return rectangle;
}

void Workstation::splitLine() {
  if (!display_.split || shown_.versions.size() != 2) return;
  const render::Rectangle area = plot();
  const auto x = static_cast<float>(area.x + display_.split_at * area.width);
  const auto y = static_cast<float>(area.y + area.height / 2);
  ImGui::GetBackgroundDrawList()->AddCircleFilled(ImVec2(x, y), 7.0F * static_cast<float>(window_->scale()),
                                                  IM_COL32(255, 255, 255, 220));
}

void Workstation::statusBar() {
  const float height = ImGui::GetFrameHeight();
  ImGui::SetNextWindowPos(ImVec2(0.0F, ImGui::GetIO().DisplaySize.y - height));
  ImGui::SetNextWindowSize(ImVec2(ImGui::GetIO().DisplaySize.x, height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8.0F, 2.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0F, 1.0F));
  ImGui::Begin("##status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
  if (adjusting_ != Adjusting::kNothing) {
    const haptic::Scene& scene = touch_->scene();
    const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
    const std::string now =
        adjusting_ == Adjusting::kRadius
            ? fmt::format("brush radius {:.3g} samples",
                          marking ? scene.mark_radius_samples : scene.brush_radius_samples)
            : fmt::format("press depth {:.4g} mm", touch_->mouse()->pressMm());
    ImGui::TextUnformatted(
        fmt::format("{} {}: move or type, Enter or left button keeps it, Esc or right button leaves it", now,
                    typed_.empty() ? "" : "[" + typed_ + "]")
            .c_str());
  } else if (saving_.busy()) {
    ImGui::ProgressBar(static_cast<float>(saving_.progress()), ImVec2(240.0F, 0.0F), "saving");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) saving_.cancel();
  } else if (touch_ && loading_.busy()) {
    ImGui::ProgressBar(static_cast<float>(loading_.progress()), ImVec2(240.0F, 0.0F), "opening");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) loading_.cancel();
  } else {
    std::string text = status_text_;
    if (touch_) {
      if (unsaved()) text += "  (changed)";
      if (tool_on_ && under_cursor_) {
        const engine::Grid& grid = touch_->field().grid();
        text += fmt::format("   x {:.4f}  y {:.4f}  z {:.5g} {}",
                            grid.origin_x + under_cursor_->position_mm.x / grid.lateral_unit.mm,
                            grid.origin_y + under_cursor_->position_mm.y / grid.lateral_unit.mm,
                            under_cursor_->position_mm.z / grid.height_unit.mm, grid.height_unit.name);
      }
    }
    ImGui::TextUnformatted(text.c_str());
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void Workstation::sidePanel() {
  ImGui::Begin("Panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  side_width_ = ImGui::GetWindowSize().x;
  for (const Notice& notice : notices_) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextColored(ImVec4(1.0F, 0.75F, 0.3F, 1.0F), "%s%s%s", notice.what.c_str(),
                       notice.remedy.empty() ? "" : ": ", notice.remedy.c_str());
    ImGui::PopTextWrapPos();
  }
  if (!notices_.empty() && ImGui::SmallButton("Understood")) notices_.clear();
  if (ImGui::CollapsingHeader("Tool", kOpen)) toolPanel();
  if (ImGui::CollapsingHeader("Status", kOpen)) statusPanel();
  if (ImGui::CollapsingHeader("Filters", kOpen)) filterPanel();
  if (ImGui::CollapsingHeader("Steps", kOpen)) historyPanel();
  if (ImGui::CollapsingHeader("Display")) displayPanel();
  if (ImGui::CollapsingHeader("Change since the scan", kOpen)) deviationPanel();
  if (ImGui::CollapsingHeader("Haptics")) hapticsPanel();
  ImGui::End();
}

void Workstation::toolPanel() {
  const auto button = [&](const char* name, Action action, bool on) {
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name)) act(action);
    if (on) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", keyText(shortcutOf(action).key, shortcutOf(action).modifiers).c_str());
    ImGui::SameLine();
  };
  const Tool tool = touch_->tool();
  button("View", Action::kNavigate, !tool_on_);
  button("Feel", Action::kFeel, tool_on_ && tool == Tool::kFeel);
  button("Smooth", Action::kSmooth, tool_on_ && tool == Tool::kSmooth);
  button("Mark", Action::kMark, tool_on_ && tool == Tool::kMark);
  button("Unmark", Action::kUnmark, tool_on_ && tool == Tool::kUnmark);
  ImGui::NewLine();
  const bool marking = tool == Tool::kMark || tool == Tool::kUnmark;
  auto radius = static_cast<float>(marking ? touch_->scene().mark_radius_samples
                                           : touch_->scene().brush_radius_samples);
  if (ImGui::SliderFloat("radius", &radius, 0.0F, 64.0F, "%.0f samples")) setBrushRadius(std::round(radius));
  if (touch_->mouse() != nullptr) {
    const engine::Grid& grid = touch_->field().grid();
    const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
    auto depth = static_cast<float>(touch_->mouse()->pressMm() / cell);
    if (ImGui::SliderFloat("depth", &depth, 0.0F, 4.0F, "%.2f cells")) setPressDepth(depth * cell);
  }
  bool limited = touch_->scene().max_change.has_value();
  haptic::Scene scene = touch_->scene();
  if (ImGui::Checkbox("keep within", &limited)) {
    scene.max_change = limited ? std::optional<double>(0.05) : std::nullopt;
    touch_->setScene(scene);
  }
  if (limited && scene.max_change) {
    ImGui::SameLine();
    double most = *scene.max_change;
    const std::string unit = "%.4g " + touch_->field().grid().height_unit.name;
    if (ImGui::InputDouble("##most", &most, 0.0, 0.0, unit.c_str(), ImGuiInputTextFlags_EnterReturnsTrue) &&
        most >= 0.0) {
      scene.max_change = most;
      touch_->setScene(scene);
    }
  }
  bool marks = display_.marks, inverted = touch_->scene().invert;
  if (ImGui::Checkbox("marks", &marks)) act(Action::kShowMarks);
  ImGui::SameLine();
  if (ImGui::Checkbox("upside down", &inverted)) act(Action::kInvert);
  ImGui::SameLine();
  if (ImGui::SmallButton("Clear marks")) act(Action::kClearMarks);
}

void Workstation::statusPanel() {
  const haptic::TimingFigures late = touch_->timing().lateness.figures();
  const haptic::LoopState state = touch_->state();
  const haptic::TimingFigures edit = touch_->latency().figures();
  line("loop", fmt::format("{:.0f} of {:.0f} Hz", touch_->measuredRate(), touch_->rate()));
  line("lateness p50, p99", fmt::format("{:.0f}, {:.0f} us", us(late.p50_ns), us(late.p99_ns)));
  line("missed ticks", fmt::format("{}", touch_->timing().missed.load(std::memory_order_relaxed)));
  line("force", fmt::format("{:.2f} N{}", glm::length(state.force_n), state.contact ? ", touching" : ""));
  line("frame", fmt::format("{:.1f} ms on the GPU, {:.1f} ms", figures_.device_ms, frame_ms_));
  line("surface", fmt::format("{} triangles, error {:.2f} px", figures_.triangles, figures_.bound_px));
  line("uploaded",
       fmt::format("{} tiles, {}", tiles_uploaded_, bytesText(static_cast<double>(bytes_uploaded_))));
  line("last upload", fmt::format("{} tiles, {}, {:.2f} ms", figures_.upload.tiles,
                                  bytesText(static_cast<double>(figures_.upload.bytes)), figures_.upload.ms));
  line("edit to pixel", edit.count == 0
                            ? std::string("-")
                            : fmt::format("{:.0f} ms; p50 {:.0f}, p99 {:.0f}", touch_->lastLatencyMs(),
                                          1e-3 * us(edit.p50_ns), 1e-3 * us(edit.p99_ns)));
}

void Workstation::historyPanel() {
  const engine::History& history = touch_->history();
  if (ImGui::Button("Undo")) act(Action::kUndo);
  ImGui::SameLine();
  if (ImGui::Button("Redo")) act(Action::kRedo);
  ImGui::SameLine();
  ImGui::TextDisabled(
      "%s",
      fmt::format("{} steps, {}", history.last(), bytesText(static_cast<double>(history.bytes()))).c_str());
  const float lines = static_cast<float>(std::clamp<std::int64_t>(history.last() + 1, 3, 8));
  if (ImGui::BeginChild("steps", ImVec2(0.0F, lines * ImGui::GetTextLineHeightWithSpacing() + 8.0F), true)) {
    std::int64_t wanted = -1;
    if (history.first() == 0 && ImGui::Selectable("0  the scan", history.number() == 0)) wanted = 0;
    for (std::int64_t i = history.first() + 1; i <= history.last(); ++i) {
      const engine::StepInfo& info = history.info(i);
      const std::string text =
          fmt::format("{}  {}   {}##{}", i, info.name, bytesText(static_cast<double>(info.bytes)), i);
      if (i > history.number())
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
      if (ImGui::Selectable(text.c_str(), i == history.number())) wanted = i;
      if (i > history.number()) ImGui::PopStyleColor();
    }
    if (wanted >= 0) touch_->goTo(wanted);
  }
  ImGui::EndChild();
}

void Workstation::filterPanel() {
  engine::FilterSpec& spec = filters_.spec;
  const char* names[] = {"Box", "Gaussian", "Median"};
  int kind = static_cast<int>(spec.kind);
  if (ImGui::Combo("filter", &kind, names, 3)) spec.kind = static_cast<engine::FilterKind>(kind);
  if (ImGui::InputInt("window", &spec.window, 2, 10))
    spec.window = std::clamp(spec.window | 1, 1, engine::FilterSpec::kMaxWindow);
  if (ImGui::InputInt("passes", &spec.passes, 1, 5))
    spec.passes = std::clamp(spec.passes, 1, engine::FilterSpec::kMaxPasses);
  if (spec.kind == engine::FilterKind::kGaussian)
    if (ImGui::InputDouble("sigma", &spec.sigma, 0.1, 1.0, spec.sigma > 0.0 ? "%.2f samples" : "binomial"))
      spec.sigma = std::clamp(spec.sigma, 0.0, 1000.0);
  const engine::Grid& grid = touch_->field().grid();
  ImGui::TextDisabled("%s", fmt::format("= {:.4g} x {:.4g} mm", spec.window * grid.spacingXMm(),
                                        spec.window * grid.spacingYMm())
                                .c_str());
  int scope = static_cast<int>(spec.scope);
  ImGui::RadioButton("keep marks", &scope, 0);
  ImGui::SameLine();
  ImGui::RadioButton("only marks", &scope, 1);
  spec.scope = static_cast<engine::FilterScope>(scope);
  bool limited = spec.max_change.has_value();
  if (ImGui::Checkbox("max change", &limited)) spec.max_change = limited ? std::optional(0.05) : std::nullopt;
  if (spec.max_change) {
    ImGui::SameLine();
    const std::string unit = "%.4g " + grid.height_unit.name;
    ImGui::InputDouble("##maxchange", &*spec.max_change, 0.0, 0.0, unit.c_str());
    spec.max_change = std::isfinite(*spec.max_change) ? std::max(*spec.max_change, 0.0) : 0.0;
  }
  if (filters_.computing() || filters_.applying()) {
    ImGui::ProgressBar(static_cast<float>(filters_.progress()), ImVec2(-80.0F, 0.0F),
                       filters_.applying() ? "applying" : "filtering");
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) filters_.cancel(*touch_);
  } else {
    if (ImGui::Button("Preview")) act(Action::kFilterPreview);
    ImGui::SameLine();
    if (ImGui::Button("Add variant")) filters_.compute(*touch_, FilterPreview::Keep::kBeside);
    ImGui::SameLine();
    if (ImGui::Button("Apply")) filters_.apply(*touch_);
  }
  std::optional<std::size_t> dropped;
  for (std::size_t i = 0; i < filters_.variants().size(); ++i) {
    const FilterPreview::Variant& v = filters_.variants()[i];
    if (ImGui::SmallButton(fmt::format("x##{}", i).c_str())) dropped = i;
    ImGui::SameLine();
    ImGui::TextUnformatted(fmt::format("{}: {} changed, max {:.3g} {}", filterName(v.spec),
                                       v.result.report.changed, v.result.report.max_change,
                                       grid.height_unit.name)
                               .c_str());
  }
  if (dropped) filters_.drop(*dropped);
  if (!filters_.variants().empty()) ImGui::Checkbox("split line", &display_.split);
}

void Workstation::displayPanel() {
  const char* maps[] = {"automatic", "viridis", "cividis", "grey", "diverging"};
  int map = static_cast<int>(display_.map);
  if (ImGui::Combo("colours", &map, maps, 5)) display_.map = static_cast<render::ColourMap>(map);
  bool deviation = display_.deviation;
  if (ImGui::Checkbox("change since the scan", &deviation)) act(Action::kDeviation);
  ImGui::Checkbox("contour lines", &display_.contours);
  ImGui::SameLine();
  ImGui::Checkbox("scale and colour bar", &display_.furniture);
  bool light = display_.theme == render::Theme::kLight;
  if (ImGui::Checkbox("light background", &light))
    display_.theme = light ? render::Theme::kLight : render::Theme::kDark;
  ImGui::SliderFloat("marks' opacity", &display_.marks_opacity, 0.0F, 1.0F, "%.2f");
  ImGui::SliderFloat("light from", &display_.light_azimuth_deg, 0.0F, 360.0F, "%.0f deg");
  ImGui::SliderFloat("light above", &display_.light_elevation_deg, 5.0F, 90.0F, "%.0f deg");
  auto exaggeration = static_cast<float>(view_.vertical_exaggeration);
  if (ImGui::InputFloat("exaggeration", &exaggeration, 0.0F, 0.0F,
                        exaggeration > 0.0F ? "%.3g x" : "automatic"))
    view_.vertical_exaggeration = exaggeration > 1e-6F ? std::min(exaggeration, 1e6F) : 0.0;
}

void Workstation::hapticsPanel() {
  const haptic::LoopState state = touch_->state();
  const haptic::DeviceProfile& profile = touch_->device().profile();
  line("device", profile.name + (profile.gives_force ? "" : ", no force"));
  line("link", state.link == haptic::LinkState::kConnected      ? "connected"
               : state.link == haptic::LinkState::kUncalibrated ? "not calibrated"
                                                                : "not plugged in");
  line("safety", std::string(haptic::name(state.safety)));
  if (ImGui::Button("Arm")) act(Action::kArm);
  ImGui::SameLine();
  if (ImGui::Button("Disarm")) act(Action::kDisarm);
  ImGui::SameLine();
  if (ImGui::Button("Calibrate")) act(Action::kCalibrate);
  if (!force_plot_.empty())
    ImGui::PlotLines("##force", force_plot_.data(), static_cast<int>(force_plot_.size()), 0, "force [N]",
                     0.0F, static_cast<float>(touch_->scene().force_limit_n), ImVec2(-1.0F, 60.0F));
  // Lateness in octaves: how many ticks came that late.
  std::array<float, 12> classes{};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const std::int64_t low = std::int64_t{1000} << i;
    const auto above = touch_->timing().lateness.countAbove(low);
    const auto far = touch_->timing().lateness.countAbove(2 * low);
    classes[i] = std::log10(1.0F + static_cast<float>(above - far));
  }
  ImGui::PlotHistogram("##late", classes.data(), static_cast<int>(classes.size()), 0,
                       "lateness 1 us .. 4 ms, by octaves, log count", 0.0F, 6.0F, ImVec2(-1.0F, 60.0F));
  const haptic::TimingFigures compute = touch_->timing().compute.figures();
  line("a tick takes p50, p99", fmt::format("{:.1f}, {:.1f} us", us(compute.p50_ns), us(compute.p99_ns)));
  line("stiffness", fmt::format("{:.3g} N/mm", touch_->scene().stiffness_n_per_mm));
  std::string effects;
  for (const haptic::EffectKind kind : touch_->scene().effects)
    effects += (effects.empty() ? "" : ", ") + std::string(haptic::effectName(kind));
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextDisabled("%s", effects.c_str());
  for (const std::string& missing : touch_->realTime().missing)
    ImGui::TextColored(ImVec4(1.0F, 0.75F, 0.3F, 1.0F), "%s", missing.c_str());
  ImGui::PopTextWrapPos();
}

void Workstation::deviationPanel() {
  if (measuring_.busy()) ImGui::TextDisabled("measuring ...");
  if (!deviation_) {
    ImGui::TextDisabled("nothing changed yet");
    return;
  }
  const std::string& unit = touch_->field().grid().height_unit.name;
  line("largest", fmt::format("{:.4g} {}", deviation_->max_abs, unit));
  line("rms", fmt::format("{:.4g} {}", deviation_->rms, unit));
  line("99 % within", fmt::format("{:.4g} {}", deviation_->p99, unit));
  line("Sq before, now", fmt::format("{:.4g}, {:.4g} {}", deviation_->sq_a, deviation_->sq_b, unit));
  line("Sa before, now", fmt::format("{:.4g}, {:.4g} {}", deviation_->sa_a, deviation_->sa_b, unit));
}

}  // namespace fettle::app

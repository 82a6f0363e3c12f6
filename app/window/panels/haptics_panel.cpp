#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/slider.h"

namespace fettle::app {
namespace {

using render::PanelColour;

// Histogram of late ticks: octaves from a microsecond to four milliseconds, bars by the logarithm of the
// count.
void drawLateness(const haptic::TimingHistogram& lateness) {
  constexpr int kOctaves = 12;
  std::array<std::uint64_t, kOctaves> counts{};
  std::uint64_t most = 1;
  for (int i = 0; i < kOctaves; ++i) {
    const std::int64_t low = std::int64_t{1000} << i;
    const std::uint64_t above = lateness.countAbove(low), far = lateness.countAbove(2 * low);
    counts[static_cast<std::size_t>(i)] = above > far ? above - far : 0;
    most = std::max(most, counts[static_cast<std::size_t>(i)]);
  }
  const float height = 4.0F * ImGui::GetTextLineHeight();
  const float width = std::max(ImGui::GetContentRegionAvail().x, 64.0F), bar = width / kOctaves;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("##lateness", ImVec2(width, height));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + height), colourOf(PanelColour::kField),
                     3.0F);
  for (int i = 0; i < kOctaves; ++i) {
    const auto n = static_cast<double>(counts[static_cast<std::size_t>(i)]);
    const auto share = static_cast<float>(std::log1p(n) / std::log1p(static_cast<double>(most)));
    const float x = corner.x + static_cast<float>(i) * bar;
    list.AddRectFilled(ImVec2(x, corner.y + height * (1.0F - share)),
                       ImVec2(x + bar - 2.0F, corner.y + height), colourOf(PanelColour::kProgress));
  }
  const int pointed = static_cast<int>((ImGui::GetIO().MousePos.x - corner.x) / bar);
  if (ImGui::IsItemHovered() && pointed >= 0 && pointed < kOctaves)
    valueTip(trFormat("{} to {} us late: {} ticks", 1 << pointed, 2 << pointed,
                      counts[static_cast<std::size_t>(pointed)]));
  const float left = ImGui::GetStyle().WindowPadding.x;
  const auto mark = [&](int octave, const char* text) {
    if (octave > 0) ImGui::SameLine(left + bar * static_cast<float>(octave));
    ImGui::TextDisabled("%s", text);
  };
  mark(0, "1 \u00b5s");
  mark(3, "8");
  mark(6, "64");
  mark(9, "0.5 ms");
}

std::string rateText(double hz) {
  return trFormat("{:g} kHz", 1e-3 * hz);
}

// Their numbers, as the documentation of devices names them.
std::string heldButtons(std::uint32_t buttons) {
  std::string text;
  for (int i = 0; i < 32; ++i)
    if ((buttons >> i & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : ", ", i + 1);
  return text.empty() ? tr("none") : text;
}

// Of all names of devices this one is Fettle's own.
[[maybe_unused]] constexpr const char* kMouseName = textOf("mouse");

// The device in a list of those there are; returns the words of another one that was chosen.
std::optional<std::string> deviceField(const LoopClient& client, DeviceLister& devices) {
  constexpr const char* kSays = textOf(
      "Another device takes the place of this one: the force fades first, and it gives none until A is "
      "pressed.");
  const haptic::DeviceProfile& profile = client.device().profile();
  const std::string name(tr(std::string_view(profile.name)));
  std::optional<std::string> chosen;
  beginFields();
  fieldName("device", kSays);
  if (beginList("##device", (profile.gives_force ? name : trFormat("{}, no force", name)).c_str(),
                ImGuiComboFlags_HeightLargest)) {
    if (ImGui::IsWindowAppearing()) devices.list(client.deviceWords());
    for (const DeviceChoice& each : devices.all()) {
      const std::string text = each.problem.empty() ? std::string(tr(std::string_view(each.title)))
                                                    : fmt::format("{}: {}", each.title, each.problem);
      ImGui::BeginDisabled(!each.problem.empty());
      if (ImGui::Selectable(fmt::format("{}##{}", text, each.words).c_str(),
                            each.words == client.deviceWords()))
        chosen = each.words;
      ImGui::EndDisabled();
      explain(each.remedy);
    }
    if (devices.busy()) ImGui::TextDisabled("%s", tr("looking for devices"));
    ImGui::EndCombo();
  } else {
    explain(kSays);
  }
  endFields();
  return chosen;
}

void deviceFigures(const PanelContext& context) {
  const haptic::LoopState state = context.client.state();
  // A mouse cannot be unplugged and gives no force.
  const bool mouse = context.client.mouse() != nullptr;
  figure("link", mouse ? (state.link == haptic::LinkState::kConnected ? tr("on the surface")
                                                                      : tr("no tool on the surface"))
                 : state.link == haptic::LinkState::kConnected    ? tr("connected")
                 : state.link == haptic::LinkState::kUncalibrated ? tr("not calibrated")
                                                                  : tr("not plugged in"));
  if (!mouse) figure("buttons held", heldButtons(state.buttons));
  figure("safety",
         mouse ? std::string(tr("no force to limit")) : std::string(tr(haptic::name(state.safety))));
  ImGui::BeginDisabled(mouse);
  actionButton("Arm", Action::kArm, context.act);
  sameLineIfFits("Disarm");
  actionButton("Disarm", Action::kDisarm, context.act);
  sameLineIfFits("Calibrate");
  actionButton("Calibrate", Action::kCalibrate, context.act);
  sameLineIfFits("Set up...");
  actionButton("Set up...", Action::kSetUpDevice, context.act);
  ImGui::EndDisabled();
}

void loopFigures(LoopClient& client, const std::vector<float>& forces) {
  const auto limit = static_cast<float>(client.scene().force_limit_n);
  if (!forces.empty())
    ImGui::PlotLines("##force", forces.data(), static_cast<int>(forces.size()), 0,
                     trFormat("force, 0 to {:.3g} N", limit).c_str(), 0.0F, limit,
                     ImVec2(ImGui::GetContentRegionAvail().x, 4.0F * ImGui::GetTextLineHeight()));
  const haptic::TimingFigures compute = client.timing().compute.figures();
  const haptic::TimingFigures late = client.timing().lateness.figures();
  figure("ticks", trFormat("{:.0f} of {:.0f} per second", client.measuredRate(), client.rate()));
  figure("tick takes", trFormat("{:.1f} us, p99 {:.1f}", haptic::microseconds(compute.p50_ns),
                                haptic::microseconds(compute.p99_ns)));
  figure("ticks late by", trFormat("{:.0f} us, p99 {:.0f}", haptic::microseconds(late.p50_ns),
                                   haptic::microseconds(late.p99_ns)));
  drawLateness(client.timing().lateness);
}

std::optional<double> rateField(double now_hz) {
  std::optional<double> chosen;
  constexpr const char* kSays = textOf(
      "How often a second the force is computed: more feels harder surfaces, if the machine keeps up.");
  fieldName("rate", kSays);
  if (!beginList("##rate", rateText(now_hz).c_str())) {
    explain(kSays);
    return chosen;
  }
  for (int khz = 1; khz <= 10; ++khz)
    if (const double hz = 1000.0 * khz; ImGui::Selectable(rateText(hz).c_str(), hz == now_hz)) chosen = hz;
  ImGui::EndCombo();
  return chosen;
}

// Beside what is wrong with a scene that was not fitted.
bool fitButton(const LoopClient& client) {
  const auto problem = client.feltProblem();
  if (!problem) return false;
  writeIn(PanelColour::kWarning, problem->what);
  return pressButton(
      "Fit to the scan",
      "Takes the default stiffness and lengths, so that all of the scan is within the hand's reach "
      "and felt as a part of ordinary size is. Force, brush and effects stay.");
}

// Of a scene with sound alone.
void soundControls(LoopClient& client, Loudness& loudness) {
  if (!client.scene().lists(haptic::EffectKind::kSound)) return;
  const SoundPlayer* const player = client.soundPlayer();
  figure("plays on", player != nullptr ? player->driver() : tr("no audio device"));
  if (player == nullptr) return;
  const Loudness before = loudness;
  int percent = static_cast<int>(std::lround(100.0F * loudness.volume));
  beginFields();
  constexpr const char* kSays = textOf("How loud the surface is; kept for the next start.");
  fieldName("volume", kSays);
  if (slider("##volume", percent, 0, 100, "%d %%")) loudness.volume = 0.01F * static_cast<float>(percent);
  explain(kSays);
  endFields();
  tickBox("mute", loudness.muted, "Silent without changing the scene or the volume.");
  if (loudness != before) client.setLoudness(loudness);
}

}  // namespace

LoopRequests hapticsPanel(const PanelContext& context, Parts& parts) {
  LoopClient& client = context.client;
  LoopRequests requests;
  requests.device = deviceField(client, parts.devices);
  deviceFigures(context);
  loopFigures(client, parts.stylus_overlay.forces());
  figure("scene", parts.scene_files.title(client));
  actionButton("Open scene ...", Action::kOpenScene, context.act);
  sameLineIfFits("Save scene ...");
  actionButton("Save scene ...", Action::kSaveScene, context.act);
  beginFields();
  requests.rate_hz = rateField(client.rate());
  contactChooser(context, parts.costs);
  sceneNumberField(context, haptic::sceneNumber("force", "stiffness_n_per_mm"));
  sceneNumberField(context, haptic::sceneNumber("force", "limit_n"));
  endFields();
  if (const auto largest = client.largestStiffness())
    figure("it can hold", trFormat("{:.4g} N/mm at most", *largest));
  requests.fit_scene = fitButton(client);
  effectTicks(context);
  effectFields(context);
  soundControls(client, parts.settings.loudness);
  for (const std::string& missing : client.realTime().missing) writeIn(PanelColour::kWarning, missing);
  return requests;
}

}  // namespace fettle::app

#include "render/window/ui_layer.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <utility>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <imgui_internal.h>  // windows and their rectangles

#include "render/plan/font_data.h"
#include "render/plan/panel_colours.h"
#include "render/vulkan/barrier.h"

namespace fettle::render {
namespace {

constexpr float kText_px = 15.0F;

// ImGui's back end reports errors through a function without a context argument; this room throws.
void check(VkResult result) {
  if (result < 0) throw vk::SystemError(vk::make_error_code(static_cast<vk::Result>(result)), "ImGui");
}

struct StyleRow {
  ImGuiCol of;
  PanelColour colour;
};
// What is not named here is not drawn in this window.
constexpr StyleRow kStyle[] = {
    {ImGuiCol_Text, PanelColour::kText},
    {ImGuiCol_TextDisabled, PanelColour::kMuted},
    {ImGuiCol_WindowBg, PanelColour::kPanel},
    {ImGuiCol_PopupBg, PanelColour::kPopup},
    {ImGuiCol_Border, PanelColour::kBorder},
    {ImGuiCol_FrameBg, PanelColour::kField},
    {ImGuiCol_FrameBgHovered, PanelColour::kFieldPointed},
    {ImGuiCol_FrameBgActive, PanelColour::kFieldHeld},
    {ImGuiCol_TitleBg, PanelColour::kTitle},
    {ImGuiCol_TitleBgActive, PanelColour::kTitle},
    {ImGuiCol_TitleBgCollapsed, PanelColour::kTitle},
    {ImGuiCol_MenuBarBg, PanelColour::kBar},
    {ImGuiCol_ScrollbarBg, PanelColour::kScrollTrack},
    {ImGuiCol_ScrollbarGrab, PanelColour::kScrollGrab},
    {ImGuiCol_ScrollbarGrabHovered, PanelColour::kScrollGrab},
    {ImGuiCol_ScrollbarGrabActive, PanelColour::kScrollGrab},
    {ImGuiCol_CheckMark, PanelColour::kTick},
    {ImGuiCol_SliderGrab, PanelColour::kGrab},
    {ImGuiCol_SliderGrabActive, PanelColour::kGrabHeld},
    {ImGuiCol_Button, PanelColour::kButton},
    {ImGuiCol_ButtonHovered, PanelColour::kButtonPointed},
    {ImGuiCol_ButtonActive, PanelColour::kButtonHeld},
    {ImGuiCol_Header, PanelColour::kRow},
    {ImGuiCol_HeaderHovered, PanelColour::kRowPointed},
    {ImGuiCol_HeaderActive, PanelColour::kRowHeld},
    {ImGuiCol_Separator, PanelColour::kBorder},
    {ImGuiCol_SeparatorHovered, PanelColour::kTick},
    {ImGuiCol_SeparatorActive, PanelColour::kTick},
    {ImGuiCol_ResizeGrip, PanelColour::kBorder},
    {ImGuiCol_ResizeGripHovered, PanelColour::kTick},
    {ImGuiCol_ResizeGripActive, PanelColour::kTick},
    {ImGuiCol_PlotLines, PanelColour::kCurve},
    {ImGuiCol_PlotLinesHovered, PanelColour::kTick},
    {ImGuiCol_PlotHistogram, PanelColour::kProgress},
    {ImGuiCol_PlotHistogramHovered, PanelColour::kTick},
    {ImGuiCol_TableHeaderBg, PanelColour::kTableHead},
    {ImGuiCol_TableBorderStrong, PanelColour::kBorder},
    {ImGuiCol_TableBorderLight, PanelColour::kBorder},
    {ImGuiCol_TableRowBgAlt, PanelColour::kOtherRow},
    {ImGuiCol_TextSelectedBg, PanelColour::kSelection},
    {ImGuiCol_NavHighlight, PanelColour::kTick},
    {ImGuiCol_ModalWindowDimBg, PanelColour::kShade},
};

// One pass over the image that already contains the picture.
vk::raii::RenderPass makePass(const vk::raii::Device& device) {
  vk::AttachmentDescription colour;
  colour.setFormat(UiLayer::kFormat)
      .setLoadOp(vk::AttachmentLoadOp::eLoad)
      .setStoreOp(vk::AttachmentStoreOp::eStore)
      .setStencilLoadOp(vk::AttachmentLoadOp::eDontCare)
      .setStencilStoreOp(vk::AttachmentStoreOp::eDontCare)
      .setInitialLayout(ImageLayout::eColorAttachmentOptimal)
      .setFinalLayout(ImageLayout::eColorAttachmentOptimal);
  const vk::AttachmentReference reference{0, ImageLayout::eColorAttachmentOptimal};
  vk::SubpassDescription subpass;
  subpass.setPipelineBindPoint(vk::PipelineBindPoint::eGraphics).setColorAttachments(reference);
  vk::RenderPassCreateInfo info;
  return {device, info.setAttachments(colour).setSubpasses(subpass)};
}

// What of a place lies outside another: four rectangles at most.
std::vector<Rectangle> outside(const Rectangle& place, const Rectangle& other) {
  const Rectangle common = cut(place, other);
  if (empty(common)) return {place};
  const int right = common.x + common.width, bottom = common.y + common.height;
  std::vector<Rectangle> parts{
      {place.x, place.y, place.width, common.y - place.y},
      {place.x, bottom, place.width, place.y + place.height - bottom},
      {place.x, common.y, common.x - place.x, common.height},
      {right, common.y, place.x + place.width - right, common.height},
  };
  std::erase_if(parts, [](const Rectangle& part) { return empty(part); });
  return parts;
}

}  // namespace

UiLayer::UiLayer(GLFWwindow* window, double scale, const std::string& layout_file)
    : window_(window), layout_file_(layout_file) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = layout_file_.empty() ? nullptr : layout_file_.c_str();
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  io.MouseDoubleClickTime = 0.5F;  // as desktops have it; ImGui's 0.3 s are three frames of a busy machine
  makeStyle(scale);
  ImGui_ImplGlfw_InitForVulkan(window, true);
  frame_ = std::make_unique<UiFrame>(window);
}

UiLayer::~UiLayer() {
  leave();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void UiLayer::enter(Context& context) {
  const vk::raii::Device& device = context.device();
  const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 4};
  vk::DescriptorPoolCreateInfo pool{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 4};
  descriptors_ = vk::raii::DescriptorPool(device, pool.setPoolSizes(size));
  pass_ = makePass(device);
  ImGui_ImplVulkan_InitInfo init{};
  init.Instance = *context.instance();
  init.PhysicalDevice = *context.physical();
  init.Device = *device;
  init.QueueFamily = context.queueFamily();
  init.Queue = *context.queue();
  init.DescriptorPool = *descriptors_;
  init.MinImageCount = 2;
  init.ImageCount = 2;
  init.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  init.CheckVkResultFn = &check;
  context_ = &context;  // from here on leave() has something to release, whatever of it succeeds
  ImGui_ImplVulkan_Init(&init, *pass_);
  context.run(
      [](const vk::raii::CommandBuffer& commands) { ImGui_ImplVulkan_CreateFontsTexture(*commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void UiLayer::leave() noexcept {
  if (context_ == nullptr) return;
  try {
    context_->device().waitIdle();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
  ImGui_ImplVulkan_Shutdown();
  framebuffer_ = nullptr;
  damage_.forget();
  image_ = GpuImage();
  pass_ = nullptr;
  descriptors_ = nullptr;
  context_ = nullptr;
}

void UiLayer::setScale(double scale) {
  makeStyle(scale);
  // The back end keeps the picture of the letters with everything else of a device.
  if (Context* const context = context_) {
    leave();
    enter(*context);
  }
}

void UiLayer::makeStyle(double scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  style.WindowRounding = 0.0F;
  style.FrameRounding = 3.0F;
  style.GrabRounding = 3.0F;
  style.WindowBorderSize = 0.0F;
  style.FrameBorderSize = 1.0F;  // an empty tick box is nothing but its edge
  style.ScaleAllSizes(static_cast<float>(scale));
  setTheme(theme_);
  ImFontConfig font;
  font.FontDataOwnedByAtlas = false;
  // Latin, Greek, arrows, and the few signs that numbers need.
  static constexpr std::array<ImWchar, 9> kLetters{0x20,   0x17F,  0x370,  0x3FF, 0x2010,
                                                   0x2122, 0x2190, 0x22FF, 0};
  const std::span<const std::uint8_t> regular = regularFont();
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  // ImGui takes a non-const pointer but does not write to data it does not own.
  fonts.AddFontFromMemoryTTF(const_cast<std::uint8_t*>(regular.data()), static_cast<int>(regular.size()),
                             std::round(kText_px * static_cast<float>(scale)), &font, kLetters.data());
}

void UiLayer::setTheme(Theme theme) {
  if (std::exchange(theme_, theme) != theme)
    damage_.forget();  // what lies behind the panels has another colour
  ImVec4* const colours = ImGui::GetStyle().Colors;
  for (const StyleRow& row : kStyle)
    colours[row.of] = ImGui::ColorConvertU32ToFloat4(panelColour(row.colour, theme));
}

void UiLayer::fit(vk::Extent2D extent, const ImageMaker& make) {
  if (image_.extent() == extent) return;
  using Usage = vk::ImageUsageFlagBits;
  context_->device().waitIdle();
  framebuffer_.clear();
  damage_.forget();
  image_ = GpuImage();  // its memory may be used again
  image_ = make(kFormat, Usage::eColorAttachment | Usage::eTransferDst | Usage::eTransferSrc);
  const vk::ImageView view = image_.view();
  vk::FramebufferCreateInfo info;
  info.setRenderPass(*pass_)
      .setAttachments(view)
      .setWidth(extent.width)
      .setHeight(extent.height)
      .setLayers(1);
  framebuffer_ = vk::raii::Framebuffer(context_->device(), info);
}

// Whether a field, a dialog, a menu or the panels have the keyboard. What is pressed elsewhere must not wait for a frame of
// theirs: a dialog that opens meanwhile would be left by an Escape that was pressed before it.
bool UiLayer::wantsKeys() const noexcept {
  return entered_ || ImGui::GetIO().WantTextInput ||
         ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

void UiLayer::notePress(int key, int modifiers) {
  if (!wantsKeys()) return;
  // Return chooses in a list, which ImGui takes the space bar for.
  if ((key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) && listIsOpen()) key = GLFW_KEY_SPACE;
  // Characters come by themselves; of their keys the panels know those with Ctrl alone.
  const bool types = key > GLFW_KEY_SPACE && key < GLFW_KEY_ESCAPE;
  if (types && (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) == 0) return;
  pressed_.push_back(
      {key, modifiers, waiting_.size() + static_cast<std::size_t>(ImGui::GetIO().InputQueueCharacters.Size)});
}

// Sets all keys pressed since the last frame as held at this frame's beginning; returns those whose state is to be read
// again afterwards. ImGui sees a press only where the key was up in the frame before: a second press of a key that it saw
// held waits for the next frame, and the key is up in this one.
//
// In a frame with Ctrl it drops what was typed. So characters before a press with Ctrl have a frame without it, and that press
// and what follows the next; what was typed after one waits, too. A slow frame else loses the beginning of a path that is
// typed after Ctrl+A.
std::vector<int> UiLayer::holdShortPresses() {
  ImGuiIO& io = ImGui::GetIO();
  std::vector<int> changed;
  if (!wantsKeys()) pressed_.clear();
  const auto held = [&](int a, int b) {
    return glfwGetKey(window_, a) == GLFW_PRESS || glfwGetKey(window_, b) == GLFW_PRESS;
  };
  io.KeyCtrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
  io.KeyShift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
  io.KeyAlt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
  std::vector<ImWchar> typed = std::exchange(waiting_, {});
  typed.insert(typed.end(), io.InputQueueCharacters.begin(), io.InputQueueCharacters.end());
  std::size_t now = typed.size();  // of these characters, in this frame
  bool with_ctrl = false, ends = false;
  for (const Press& press : std::exchange(pressed_, {})) {
    const int key = press.key;
    if (key < 0 || key >= IM_ARRAYSIZE(io.KeysDown)) continue;
    const bool ctrl = (press.modifiers & GLFW_MOD_CONTROL) != 0 && (press.modifiers & GLFW_MOD_ALT) == 0;
    const bool seen =
        io.KeysDownDuration[key] >= 0.0F || std::find(changed.begin(), changed.end(), key) != changed.end();
    if (ctrl && (seen || press.typed_before > 0)) {
      now = ends ? now : std::min(now, press.typed_before);
      ends = true;
    }
    if (ends || seen) {
      io.KeysDown[key] = false;
      pressed_.push_back(press);
      changed.push_back(key);
      continue;
    }
    with_ctrl = with_ctrl || ctrl;
    io.KeyCtrl = io.KeyCtrl || (press.modifiers & GLFW_MOD_CONTROL) != 0;
    io.KeyShift = io.KeyShift || (press.modifiers & GLFW_MOD_SHIFT) != 0;
    io.KeyAlt = io.KeyAlt || (press.modifiers & GLFW_MOD_ALT) != 0;
    // A key that is still held may have lost its modifiers already.
    io.KeysDown[key] = true;
    changed.push_back(key);
  }
  if (with_ctrl) now = 0;
  // Typed before Ctrl went down.
  if (now > 0 && !io.KeyAlt) io.KeyCtrl = false;
  const auto next = typed.begin() + static_cast<std::ptrdiff_t>(now);
  waiting_.assign(next, typed.end());
  io.InputQueueCharacters.resize(0);
  for (auto c = typed.begin(); c != next; ++c) io.InputQueueCharacters.push_back(*c);
  for (Press& press : pressed_) press.typed_before -= std::min(press.typed_before, now);
  return changed;
}

void UiLayer::noteButton(int button, bool down, float x, float y) {
  leaving_ = 0;  // a click may enter another field
  if (button < 0 || button >= static_cast<int>(down_.size())) return;
  // What is dragged follows to where it is let go, before it is let go.
  const ImVec2 last = clicks_.empty() ? ImGui::GetIO().MousePos : ImVec2(clicks_.back().x, clicks_.back().y);
  const bool held = clicks_.empty() ? down_[static_cast<std::size_t>(button)] : clicks_.back().down;
  if (!down && held && (last.x != x || last.y != y)) clicks_.push_back({button, true, x, y});
  clicks_.push_back({button, down, x, y});
}

// A click that came and went in one slow frame, its cursor somewhere else by now, is a press in this frame and a release in
// the next, both at their place. What waits when a dialog opens was meant for what it covers.
bool UiLayer::holdClick() {
  ImGuiIO& io = ImGui::GetIO();
  const bool dialog = ImGui::GetTopMostPopupModal() != nullptr;
  if (dialog && !std::exchange(dialog_, dialog)) {
    for (const Click& click : clicks_) down_[static_cast<std::size_t>(click.button)] = false;
    clicks_.clear();
    // What waits was pressed before it could be seen.
    for (std::optional<Pointed>& next : pointed_)
      if (next && next->down) next->down = false;
  }
  dialog_ = dialog;
  const bool acts = !clicks_.empty();
  // What the pointer holds it lets go first: two hands never move one thing.
  if (!clicks_.empty() && !pointerIsDown()) {
    const Click click = clicks_.front();
    clicks_.erase(clicks_.begin());
    down_[static_cast<std::size_t>(click.button)] = click.down;
    io.MousePos = ImVec2(click.x, click.y);
  }
  std::copy(down_.begin(), down_.end(), std::begin(io.MouseDown));
  return acts || std::any_of(down_.begin(), down_.end(), [](bool down) { return down; });
}

void UiLayer::point(const Pointed& at) {
  const bool moves = !at.down && !pointed_.empty() && pointed_.back() && !pointed_.back()->down;
  if (!moves) {
    pointed_.push_back(at);
    return;
  }
  // Positions between others are not needed, steps of a wheel are.
  const double wheel = pointed_.back()->wheel + at.wheel;
  pointed_.back() = at;
  pointed_.back()->wheel = wheel;
}

// After ImGui's back end, which sets position and buttons from the window's cursor.
void UiLayer::followPointer(bool mouse_acts) {
  ImGuiIO& io = ImGui::GetIO();
  const bool was_down = pointerIsDown();
  // The mouse goes first, unless the pointer is at something.
  if (mouse_acts && !was_down) return;
  bool edge = false;
  while (!pointed_.empty() && !edge) {
    const std::optional<Pointed> next = pointed_.front();
    pointed_.pop_front();
    if (!next) {
      pointer_.reset();
      // A button that was down goes up in a frame of its own.
      edge = was_down;
      continue;
    }
    const bool down = next->down.value_or(pointer_ && pointer_->down.value_or(false));
    edge = down != was_down;
    io.MouseWheel += static_cast<float>(next->wheel);
    pointer_ = Pointed{next->x, next->y, down, 0.0};
  }
  if (!pointer_) return;
  io.MousePos = ImVec2(static_cast<float>(pointer_->x), static_cast<float>(pointer_->y));
  io.MouseDown[0] = io.MouseDown[0] || pointer_->down.value_or(false);
}

void UiLayer::beginFrame(const WindowShape& shape) {
  // In dialogs and menus the arrow keys move between fields; elsewhere they turn the view, and must not
  // navigate in the panels.
  ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsMouseClicked(0) && !io.WantCaptureMouse) leavePanels();
  if (entered_ || ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel))
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  else
    io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
  ImGui_ImplVulkan_NewFrame();
  frame_->begin(shape);
  followPointer(holdClick());
  const std::vector<int> changed = holdShortPresses();
  ImGui::NewFrame();
  for (const int key : changed) io.KeysDown[key] = glfwGetKey(window_, key) == GLFW_PRESS;
  if (leaving_ > 0 && pressed_.empty()) --leaving_;
}

bool UiLayer::listIsOpen() {
  return ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel) &&
         ImGui::GetTopMostPopupModal() == nullptr;
}

bool UiLayer::typing() const noexcept {
  return leaving_ == 0 && ImGui::GetIO().WantTextInput;
}

// ImGui gets the press in the next frame and says in the one after it that no field has the keyboard.
void UiLayer::leaveField() noexcept {
  if (ImGui::GetIO().WantTextInput) leaving_ = 2;
}

void UiLayer::leavePanels() noexcept {
  if (std::exchange(entered_, false)) ImGui::SetWindowFocus(nullptr);
}

bool UiLayer::panelsHaveMouse(double x, double y) const noexcept {
  // What was pressed in a panel stays its own wherever it is dragged.
  if (ImGui::IsAnyMouseDown() && ImGui::GetIO().WantCaptureMouse) return true;
  if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return true;
  const ImVec2 at(static_cast<float>(x), static_cast<float>(y));
  const ImVector<ImGuiWindow*>& windows = ImGui::GetCurrentContext()->Windows;
  return std::any_of(windows.begin(), windows.end(), [&](const ImGuiWindow* window) {
    return window->Active && !window->Hidden && (window->Flags & ImGuiWindowFlags_NoMouseInputs) == 0 &&
           window->OuterRectClipped.Contains(at);
  });
}

std::string UiLayer::fieldText() const {
  const ImGuiInputTextState* const field = ImGui::GetInputTextState(ImGui::GetActiveID());
  if (field == nullptr || !ImGui::GetIO().WantTextInput) return {};
  const ImWchar* const first = field->TextW.Data;
  const ImWchar* const end = first + field->CurLenW;
  std::string text(static_cast<std::size_t>(ImTextCountUtf8BytesFromStr(first, end)) + 1, ' ');
  text.resize(
      static_cast<std::size_t>(ImTextStrToUtf8(text.data(), static_cast<int>(text.size()), first, end)));
  return text;
}

void UiLayer::endFrame() {
  ImGui::Render();
  const ImVector<ImGuiWindow*>& windows = ImGui::GetCurrentContext()->Windows;
  opens_ = std::any_of(windows.begin(), windows.end(), [](const ImGuiWindow* window) {
    const bool scrolls = window->ScrollTarget.x < FLT_MAX || window->ScrollTarget.y < FLT_MAX;
    return window->Active && (window->Appearing || scrolls);
  });
}

// The pixels to be drawn again.
std::vector<Rectangle> UiLayer::changedPlaces(const ImDrawData& panels, const Below& below) {
  const vk::Extent2D extent = image_.extent();
  const Rectangle frame{0, 0, static_cast<int>(extent.width), static_cast<int>(extent.height)};
  const Rectangle picture = below.picture != nullptr ? cut(below.place, frame) : Rectangle{};
  Places places;
  const bool moved = std::exchange(below_, picture) != picture;
  const bool known = damage_.next(panels, places);
  // Panels in other units than pixels are not cut to pixels.
  const bool pixels = panels.FramebufferScale.x == 1.0F && panels.FramebufferScale.y == 1.0F &&
                      panels.DisplayPos.x == 0.0F && panels.DisplayPos.y == 0.0F;
  if (!known || moved || !pixels) return {frame};
  for (const Rectangle& place : below.changed)
    places.add(cut({place.x + below.place.x, place.y + below.place.y, place.width, place.height}, picture));
  std::vector<Rectangle> all = places.take();
  for (Rectangle& place : all) place = cut(place, frame);
  std::erase_if(all, [](const Rectangle& place) { return empty(place); });
  return all;
}

std::vector<Rectangle> UiLayer::draw(const vk::raii::CommandBuffer& commands, const Below& below) {
  ImDrawData& panels = *ImGui::GetDrawData();
  const bool first = !damage_.known();
  std::vector<Rectangle> places = changedPlaces(panels, below);
  if (places.empty()) return places;
  std::vector<vk::ImageCopy> copies;
  for (const Rectangle& place : places) {
    const Rectangle part = cut(place, below_);
    if (empty(part)) continue;
    // A copy of code values: sRGB is reinterpreted as UNORM without a change.
    vk::ImageCopy copy;
    copy.setSrcSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setDstSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setSrcOffset({part.x - below.place.x, part.y - below.place.y, 0})
        .setDstOffset({part.x, part.y, 0})
        .setExtent({static_cast<std::uint32_t>(part.width), static_cast<std::uint32_t>(part.height), 1});
    copies.push_back(copy);
  }
  const Barriers::Access panels_drawn{ImageLayout::eColorAttachmentOptimal, Stage::eColorAttachmentOutput,
                                      Access::eColorAttachmentRead | Access::eColorAttachmentWrite};
  const Barriers::Access shown{first ? ImageLayout::eUndefined : ImageLayout::eTransferSrcOptimal,
                               Stage::eAllTransfer, Access::eTransferRead};
  if (copies.empty()) {
    Barriers begin;
    begin.add(image_.image(), image_.range(), shown, panels_drawn);
    begin.record(commands);
  } else {
    const Barriers::Access written{ImageLayout::eTransferDstOptimal, Stage::eAllTransfer,
                                   Access::eTransferWrite};
    Barriers begin;
    begin.add(image_.image(), image_.range(), shown, written);
    // The picture was drawn by an earlier submission of this queue, whose last barrier does not include this copy.
    begin.add(below.picture->image(), below.picture->range(),
              {ImageLayout::eTransferSrcOptimal, Stage::eAllCommands, Access::eMemoryWrite},
              {ImageLayout::eTransferSrcOptimal, Stage::eAllTransfer, Access::eTransferRead});
    begin.record(commands);
    commands.copyImage(below.picture->image(), ImageLayout::eTransferSrcOptimal, image_.image(),
                       ImageLayout::eTransferDstOptimal, copies);
    Barriers copied;
    copied.add(image_.image(), image_.range(), written, panels_drawn);
    copied.record(commands);
  }
  drawPanels(commands, panels, places, below_);
  change(commands, image_, ImageLayout::eColorAttachmentOptimal, ImageLayout::eTransferSrcOptimal,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, Stage::eAllTransfer,
         Access::eTransferRead);
  return places;
}

void UiLayer::drawPanels(const vk::raii::CommandBuffer& commands, ImDrawData& panels,
                         const std::vector<Rectangle>& places, const Rectangle& picture) const {
  vk::RenderPassBeginInfo begin;
  begin.setRenderPass(*pass_).setFramebuffer(*framebuffer_).setRenderArea({{0, 0}, image_.extent()});
  commands.beginRenderPass(begin, vk::SubpassContents::eInline);
  std::vector<vk::ClearRect> beside;
  for (const Rectangle& place : places)
    for (const Rectangle& part : outside(place, picture))
      beside.push_back({{{part.x, part.y},
                         {static_cast<std::uint32_t>(part.width), static_cast<std::uint32_t>(part.height)}},
                        0,
                        1});
  if (!beside.empty()) {
    const ImVec4 behind = ImGui::ColorConvertU32ToFloat4(panelColour(PanelColour::kBehind, theme_));
    const vk::ClearAttachment ground(
        vk::ImageAspectFlagBits::eColor, 0,
        vk::ClearColorValue(std::array<float, 4>{behind.x, behind.y, behind.z, behind.w}));
    commands.clearAttachments(ground, beside);
  }
  std::vector<ImVector<ImDrawCmd>> whole;
  for (int i = 0; i < panels.CmdListsCount; ++i) {
    ImVector<ImDrawCmd>& list = panels.CmdLists[i]->CmdBuffer;
    whole.push_back(list);
    list = cutTo(list, places);
  }
  ImGui_ImplVulkan_RenderDrawData(&panels, *commands);
  for (int i = 0; i < panels.CmdListsCount; ++i)
    panels.CmdLists[i]->CmdBuffer = whole[static_cast<std::size_t>(i)];
  commands.endRenderPass();
}

}  // namespace fettle::render

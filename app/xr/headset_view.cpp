#include "app/xr/headset_view.h"

#include <cmath>
#include <utility>

namespace fettle::app {
namespace {

// A runtime that does not end the session when asked has this long.
constexpr auto kEnding = std::chrono::seconds(2);
constexpr std::uint8_t kRayOpacity = 150;

// A ray's picture, the same all over.
render::Image rayPicture() {
  render::Image image{4, 4, {}};
  for (int i = 0; i < 16; ++i)
    for (const std::uint8_t value : {std::uint8_t{120}, std::uint8_t{190}, std::uint8_t{255}, kRayOpacity})
      image.rgba.push_back(value);
  return image;
}

// A disc with a dark rim, clear around it.
render::Image spotPicture() {
  constexpr int kSide = 32;
  render::Image image{kSide, kSide, {}};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double radius = std::hypot(x + 0.5 - 0.5 * kSide, y + 0.5 - 0.5 * kSide) / (0.5 * kSide);
      const bool inner = radius < 0.65;
      const std::uint8_t opacity = radius < 0.95 ? 255 : 0;
      for (const int value : {inner ? 120 : 10, inner ? 190 : 10, inner ? 255 : 20})
        image.rgba.push_back(static_cast<std::uint8_t>(value));
      image.rgba.push_back(opacity);
    }
  return image;
}

}  // namespace

HeadsetView::HeadsetView(std::unique_ptr<render::Headset> headset,
                         std::unique_ptr<render::LivePicture> picture, Options options)
    : headset_(std::move(headset)),
      picture_(std::move(picture)),
      wake_(std::move(options.wake)),
      table_(options.scale),
      tip_(std::move(options.tip)) {
  state_.headset = headset_->name();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

HeadsetView::~HeadsetView() {
  finish();
}

engine::Result<std::unique_ptr<HeadsetView>> HeadsetView::start(Options options) {
  auto headset = render::Headset::create(options.headset);
  if (!headset) return tl::unexpected(headset.error());
  auto picture = render::LivePicture::create((*headset)->context(), (*headset)->colourFormat());
  if (!picture) return tl::unexpected(picture.error());
  return std::unique_ptr<HeadsetView>(
      new HeadsetView(*std::move(headset), *std::move(picture), std::move(options)));
}

void HeadsetView::show(Picture picture) {
  const std::lock_guard lock(mutex_);
  next_ = std::move(picture);
}

void HeadsetView::showWindow(render::Image frame) {
  const std::lock_guard lock(mutex_);
  next_window_ = std::move(frame);
}

std::vector<ScreenInput> HeadsetView::takeInput() {
  const std::lock_guard lock(mutex_);
  return std::exchange(input_, {});
}

void HeadsetView::finish() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

HeadsetView::State HeadsetView::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

engine::Status HeadsetView::takePicture() {
  std::optional<Picture> next;
  {
    const std::lock_guard lock(mutex_);
    next.swap(next_);
  }
  if (!next) return {};
  if (auto updated = picture_->update(next->shown); !updated) return updated;
  if (!has_picture_ || next->field != now_.field) table_.remove();
  now_ = *std::move(next);
  now_.shown = {};  // the picture holds it
  has_picture_ = true;
  return {};
}

engine::Status HeadsetView::takeWindow() {
  using render::RoomPicture;
  std::optional<render::Image> next;
  {
    const std::lock_guard lock(mutex_);
    next.swap(next_window_);
  }
  if (!next) return {};
  screen_.setShape(next->width, next->height);
  engine::Status set = headset_->setPicture(RoomPicture::kWindow, *next);
  if (set && !screen_shown_) set = headset_->setPicture(RoomPicture::kRay, rayPicture());
  if (set && !screen_shown_) set = headset_->setPicture(RoomPicture::kSpot, spotPicture());
  screen_shown_ = set.has_value();
  return set;
}

void HeadsetView::follow(const render::RoomHands& hands) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last_frame_).count();
  last_frame_ = now;
  hands_ = ending_ ? render::RoomHands{} : hands;
  uses_.follow(hands_, seconds, screen_);
  table_.follow(uses_.holding());
  tip_.follow(hands_, uses_, table_, framing_, now_.reader);
  for (std::size_t i = 0; i < hands_.size(); ++i) headset_->vibrate(i, tip_.vibration(i));
  if (uses_.input().empty() && !tip_.works()) return;
  {
    const std::lock_guard lock(mutex_);
    for (const ScreenInput& input : uses_.input()) appendInput(input, input_);
  }
  if (wake_) wake_();
}

engine::Status HeadsetView::draw(render::LiveTarget& target) {
  if (auto shown = takeWindow(); !shown) return shown;
  render::FrameInput input = now_.input;
  input.view.width = headset_->width();
  input.view.height = headset_->height();
  input.view.projection = render::Projection::kPerspective;
  input.arrangement = render::Arrangement::kSideBySide;
  input.decoration = render::Decoration::kNone;
  input.titles.clear();
  input.panel_vertices.clear();
  input.stereo.mode = render::StereoMode::kOff;
  input.sharpness = render::Sharpness::kFull;
  if (table_.scale() == RoomScale::kTrue) input.view.vertical_exaggeration = 1.0;
  if (table_.placed()) tip_.append(hands_, table_, framing_, now_.tip, input.overlays);
  input.eyes = [this](const render::Framing& framing) {
    framing_ = framing;
    const auto eyes = headset_->eyes();
    render::RoomPose head = eyes[0].pose;
    head.position_m = 0.5 * (eyes[0].pose.position_m + eyes[1].pose.position_m);
    head_m_ = head.position_m;
    if (!table_.placed()) table_.place(framing, head, headset_->floor());
    if (!screen_.placed()) screen_.place(head);
    return std::array<render::EyeView, 2>{table_.eyeOf(eyes[0]), table_.eyeOf(eyes[1])};
  };
  const auto drawn = picture_->draw(input, target);
  if (!drawn) return tl::unexpected(drawn.error());
  return {};
}

std::vector<render::RoomPanel> HeadsetView::panels() const {
  if (!screen_shown_ || !screen_.placed()) return {};
  std::vector<render::RoomPanel> panels{screen_.panel()};
  if (const auto& pointing = uses_.pointing()) {
    const glm::dvec3& at = pointing->point.at_m;
    panels.push_back(RoomScreen::ray(hands_[pointing->hand].aim.position_m, at, head_m_));
    panels.push_back(screen_.spot(at));
  }
  return panels;
}

void HeadsetView::note() {
  const std::lock_guard lock(mutex_);
  state_.frames = headset_->framesDrawn();
  state_.scale = table_.scale();
  state_.metres_per_mm = table_.placed() ? table_.metresPerMm() : 0.0;
  state_.tip = tip_.hand();
  state_.points = uses_.pointing().has_value();
}

void HeadsetView::run(const std::stop_token& stop) {
  engine::Status status;
  std::optional<std::chrono::steady_clock::time_point> until;
  while (status && !headset_->ended()) {
    if (stop.stop_requested() && !until) {
      until = std::chrono::steady_clock::now() + kEnding;
      ending_ = true;
      tip_.leave();
      for (std::size_t i = 0; i < hands_.size(); ++i) headset_->vibrate(i, 0.0);
      headset_->requestEnd();
    }
    if (until && std::chrono::steady_clock::now() > *until) break;
    status = takePicture();
    if (!status) break;
    render::HeadsetFrame frame;
    frame.hands = [this](const render::RoomHands& hands) { follow(hands); };
    if (has_picture_) frame.draw = [this](render::LiveTarget& target) { return draw(target); };
    frame.panels = [this] { return panels(); };
    status = headset_->frame(frame);
    note();
  }
  // What hands hold ends with it.
  follow({});
  // The runtime and its device end here, where they were used.
  picture_.reset();
  std::vector<std::string> messages = headset_->validationMessages();
  headset_.reset();
  const std::lock_guard lock(mutex_);
  state_.over = true;
  state_.tip.reset();
  state_.points = false;
  state_.validation = std::move(messages);
  if (!status) state_.error = status.error();
}

}  // namespace fettle::app

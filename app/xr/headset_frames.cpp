#include "app/xr/headset_frames.h"

#include <cmath>
#include <utility>

#include "haptic/devices/virtual/controller_stylus.h"

namespace fettle::app {
namespace {

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

HeadsetFrames::HeadsetFrames(std::unique_ptr<render::Headset> headset,
                             std::unique_ptr<render::LivePicture> picture, const HeadsetViewOptions& options,
                             std::shared_ptr<HeadsetExchange> exchange)
    : headset_(std::move(headset)),
      picture_(std::move(picture)),
      exchange_(std::move(exchange)),
      table_(options.scale),
      tip_(options.tip) {
  state_.headset = headset_->name();
}

engine::Result<std::unique_ptr<HeadsetFrames>> HeadsetFrames::create(
    const HeadsetViewOptions& options, std::shared_ptr<HeadsetExchange> exchange) {
  auto headset = render::Headset::create(options.headset);
  if (!headset) return tl::unexpected(headset.error());
  auto picture = render::LivePicture::create((*headset)->context(), (*headset)->colourFormat());
  if (!picture) return tl::unexpected(picture.error());
  return std::unique_ptr<HeadsetFrames>(
      new HeadsetFrames(*std::move(headset), *std::move(picture), options, std::move(exchange)));
}

engine::Status HeadsetFrames::takePicture() {
  std::optional<HeadsetPicture> next = exchange_->takePicture();
  if (!next) return {};
  if (auto updated = picture_->update(next->shown); !updated) return updated;
  if (!has_picture_ || next->field != now_.field) table_.remove();
  now_ = *std::move(next);
  now_.shown = {};  // the picture holds it
  has_picture_ = true;
  return {};
}

engine::Status HeadsetFrames::takeWindow() {
  using render::RoomPicture;
  const std::optional<render::Image> next = exchange_->takeWindow();
  if (!next) return {};
  screen_.setShape(next->width, next->height);
  engine::Status set = headset_->setPicture(RoomPicture::kWindow, *next);
  if (set && !screen_shown_) set = headset_->setPicture(RoomPicture::kRay, rayPicture());
  if (set && !screen_shown_) set = headset_->setPicture(RoomPicture::kSpot, spotPicture());
  screen_shown_ = set.has_value();
  return set;
}

void HeadsetFrames::follow(const render::RoomHands& hands) {
  const auto now = HeadsetExchange::Clock::now();
  const auto passed = now - std::exchange(last_frame_, now);
  exchange_->noteFrame(now);
  // What they held was let go meanwhile (HeadsetView::takeInput): they have to press again.
  if (passed > haptic::kFramesStayAway) {
    uses_.follow({}, 0.0, screen_);
    exchange_->give(uses_.input());
  }
  hands_ = ends_by_ ? render::RoomHands{} : hands;
  uses_.follow(hands_, std::chrono::duration<double>(passed).count(), screen_);
  table_.follow(uses_.holding());
  tip_.follow(hands_, uses_, table_, framing_, now_.reader);
  for (std::size_t i = 0; i < hands_.size(); ++i) headset_->vibrate(i, tip_.vibration(i));
  if (!uses_.input().empty() || tip_.works()) exchange_->give(uses_.input());
}

engine::Status HeadsetFrames::draw(render::LiveTarget& target) {
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

std::vector<render::RoomPanel> HeadsetFrames::panels() const {
  if (!screen_shown_ || !screen_.placed()) return {};
  std::vector<render::RoomPanel> panels{screen_.panel()};
  if (const auto& pointing = uses_.pointing()) {
    const glm::dvec3& at = pointing->point.at_m;
    panels.push_back(RoomScreen::ray(hands_[pointing->hand].aim.position_m, at, head_m_));
    panels.push_back(screen_.spot(at));
  }
  return panels;
}

void HeadsetFrames::note() {
  state_.frames = headset_->framesDrawn();
  state_.scale = table_.scale();
  state_.metres_per_mm = table_.placed() ? table_.metresPerMm() : 0.0;
  state_.tip = tip_.hand();
  state_.points = uses_.pointing().has_value();
  exchange_->note(state_);
}

void HeadsetFrames::beginEnd() {
  ends_by_ = HeadsetExchange::Clock::now() + kLongestEnd;
  tip_.leave();
  for (std::size_t i = 0; i < hands_.size(); ++i) headset_->vibrate(i, 0.0);
  headset_->requestEnd();
}

engine::Status HeadsetFrames::frame() {
  if (auto taken = takePicture(); !taken) return taken;
  render::HeadsetFrame frame;
  frame.hands = [this](const render::RoomHands& hands) { follow(hands); };
  if (has_picture_) frame.draw = [this](render::LiveTarget& target) { return draw(target); };
  frame.panels = [this] { return panels(); };
  engine::Status made = headset_->frame(frame);
  note();
  return made;
}

void HeadsetFrames::run() {
  engine::Status status;
  while (status) {
    if (!ends_by_ && exchange_->stopped()) beginEnd();
    if (headset_->ended() || (ends_by_ && HeadsetExchange::Clock::now() > *ends_by_)) break;
    status = frame();
  }
  // What hands hold ends with it.
  follow({});
  // The runtime and its device end here, where they were used.
  picture_.reset();
  std::vector<std::string> messages = headset_->validationMessages();
  headset_.reset();
  exchange_->noteEnd(std::move(status), std::move(messages));
}

}  // namespace fettle::app

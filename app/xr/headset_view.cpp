#include "app/xr/headset_view.h"

#include <chrono>
#include <utility>

namespace fettle::app {
namespace {

// A runtime that does not end the session when asked has this long.
constexpr auto kEnding = std::chrono::seconds(2);

}  // namespace

HeadsetView::HeadsetView(std::unique_ptr<render::Headset> headset,
                         std::unique_ptr<render::LivePicture> picture, RoomScale scale)
    : headset_(std::move(headset)), picture_(std::move(picture)), table_(scale) {
  state_.headset = headset_->name();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

HeadsetView::~HeadsetView() {
  finish();
}

engine::Result<std::unique_ptr<HeadsetView>> HeadsetView::start(const render::HeadsetOptions& options,
                                                                RoomScale scale) {
  auto headset = render::Headset::create(options);
  if (!headset) return tl::unexpected(headset.error());
  auto picture = render::LivePicture::create((*headset)->context(), (*headset)->colourFormat());
  if (!picture) return tl::unexpected(picture.error());
  return std::unique_ptr<HeadsetView>(new HeadsetView(*std::move(headset), *std::move(picture), scale));
}

void HeadsetView::show(Picture picture) {
  const std::lock_guard lock(mutex_);
  next_ = std::move(picture);
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
  if (!has_picture_ || next->field != now_.field) table_ = RoomTable(table_.scale());
  now_ = *std::move(next);
  now_.shown = {};  // the picture holds it
  has_picture_ = true;
  return {};
}

engine::Status HeadsetView::draw(render::LiveTarget& target) {
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
  input.eyes = [this](const render::Framing& framing) {
    const auto eyes = headset_->eyes();
    if (!table_.placed()) {
      render::RoomPose head = eyes[0].pose;
      head.position_m = 0.5 * (eyes[0].pose.position_m + eyes[1].pose.position_m);
      table_.place(framing, head, headset_->floor());
    }
    return std::array<render::EyeView, 2>{table_.eyeOf(eyes[0]), table_.eyeOf(eyes[1])};
  };
  const auto drawn = picture_->draw(input, target);
  if (!drawn) return tl::unexpected(drawn.error());
  return {};
}

void HeadsetView::run(const std::stop_token& stop) {
  engine::Status status;
  std::optional<std::chrono::steady_clock::time_point> until;
  while (status && !headset_->ended()) {
    if (stop.stop_requested() && !until) {
      until = std::chrono::steady_clock::now() + kEnding;
      headset_->requestEnd();
    }
    if (until && std::chrono::steady_clock::now() > *until) break;
    status = takePicture();
    if (!status) break;
    render::HeadsetFrame frame;
    frame.hands = [this](const render::RoomHands& hands) { table_.follow(hands); };
    if (has_picture_) frame.draw = [this](render::LiveTarget& target) { return draw(target); };
    status = headset_->frame(frame);
    const std::lock_guard lock(mutex_);
    state_.frames = headset_->framesDrawn();
  }
  // The runtime and its device end here, where they were used.
  picture_.reset();
  std::vector<std::string> messages = headset_->validationMessages();
  headset_.reset();
  const std::lock_guard lock(mutex_);
  state_.over = true;
  state_.validation = std::move(messages);
  if (!status) state_.error = status.error();
}

}  // namespace fettle::app

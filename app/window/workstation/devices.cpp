// The devices of hand and picture: what becomes of the work when one changes or is lost.
#include "app/texts/texts.h"
#include "app/window/workstation/workstation.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace fettle::app {
namespace {

constexpr auto kWithoutPicture = std::chrono::milliseconds(5);  // between two polls of the loop

}  // namespace

// For this device from now on, and when it is opened again.
void Workstation::setUpDevice(const DeviceSetup& setup) {
  LoopClient& client = *parts_.document.client();
  parts_.filters.cancel(client);  // as in setRate()
  const engine::Status set = client.setDeviceSetup(setup);
  if (client.finished()) {
    end_ = set;
  } else if (!set) {
    parts_.feedback.message(set.error().line(), tr("the device is used as before"));
  } else {
    parts_.settings.devices[setupKey(client.device().profile())] = setup;
    saveSettingsNow();  // nobody measures twice because the program was ended
    parts_.feedback.status = tr("the device is set up, and will be when it is opened again");
  }
  parts_.picture.requestRedraw();
}

void Workstation::setRate(double hz) {
  LoopClient& client = *parts_.document.client();
  // Previews in progress belong to the loop that ends (LoopClient::setRate).
  parts_.filters.cancel(client);
  const engine::Status set = client.setRate(hz);
  options_.client.rate_hz = client.rate();
  // Without a loop no work is possible; the work is stored as at every end.
  if (client.finished())
    end_ = set;
  else if (!set)
    parts_.feedback.message(set.error().line(), tr("the loop continues as before"));
  parts_.picture.requestRedraw();
}

// As setRate(); for the next scan as well.
void Workstation::setDevice(const std::string& words) {
  LoopClient& client = *parts_.document.client();
  parts_.releaseHands();
  parts_.filters.cancel(client);
  const engine::Status set = client.setDevice(words);
  options_.client.device = client.deviceWords();
  if (client.finished())
    end_ = set;
  else if (!set)
    parts_.feedback.message(set.error().line(), tr("the device is used as before"));
  else
    parts_.feedback.status = trFormat("the device is the {} now", client.device().profile().name);
  parts_.picture.requestRedraw();
}

// As setRate().
void Workstation::fitScene() {
  LoopClient& client = *parts_.document.client();
  parts_.releaseHands();
  parts_.filters.cancel(client);
  const engine::Status set = client.fitScene();
  if (client.finished())
    end_ = set;
  else if (!set)
    parts_.feedback.message(set.error().line(), tr("the scene stays as it is"));
  else
    parts_.feedback.status = tr("the scene is fitted to the scan");
  parts_.picture.requestRedraw();
}

// A lost graphics device - its driver restarted, it hung, it was unplugged, its memory ran out - loses only
// the picture: field, history, marks and camera belong to the document.
void Workstation::losePicture(const engine::Error& why) {
  parts_.picture.lose();
  parts_.drag.stop();
  const bool again = renewal_.lost(frames_, DeviceRenewal::Clock::now()) && !window_->displayLost();
  if (again) return;
  engine::Error end = why;
  if (parts_.document.isOpen()) {
    parts_.filters.finish(*parts_.document.client());
    end.remedy = parts_.document.rescue() + end.remedy;
  }
  end_ = tl::unexpected(std::move(end));
}

void Workstation::renewPicture() {
  if (window_->displayLost()) {
    losePicture(
        engine::failure("the connection to the display was lost", "window", "open the window again").value());
    return;
  }
  if (!renewal_.due(DeviceRenewal::Clock::now())) {
    std::this_thread::sleep_for(kWithoutPicture);
    return;
  }
  const std::string before = window_->device();
  renewal_.begin(frames_);
  engine::Status done = window_->renew();
  if (done) done = parts_.picture.make();
  if (!done) {
    losePicture(done.error());
    return;
  }
  std::vector<Notice>& notices = parts_.feedback.notices;
  std::erase_if(notices, [](const Notice& n) { return n.what.find(tr(kDeviceLost)) != std::string::npos; });
  notices.push_back({before == window_->device()
                         ? trFormat("{} and works again", tr(kDeviceLost))
                         : trFormat("{}; {} is used now", tr(kDeviceLost), window_->device()),
                     tr("the field, its marks and its steps are unchanged")});
}

}  // namespace fettle::app

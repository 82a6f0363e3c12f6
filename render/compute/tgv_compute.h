#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/filter/tgv_device.h"
#include "render/plan/picture.h"

namespace fettle::render {

/// The steps of generalised variation on a Vulkan device: kTgvTogether steps per dispatch in the memory of a workgroup
/// (shaders/tgv_steps.comp), many dispatches per submission, two submissions and two batches in flight, all arrays on
/// the device from the upload of a batch to the download of its result. Takes 103 MB there and 56 MB of transfer
/// buffers.
///
/// Submissions are kept short, 25 to 50 ms each from what the last ones took, so that a display that the device drives
/// goes on, and a cancel is seen.
///
/// Threading: one thread at a time, any.
class TgvCompute final : public engine::TgvDevice {
 public:
  /// On the best device. Null where `options` asks for hardware and none starts. Errors (kFailed): as Context::create;
  /// the device has too little memory or too small workgroups.
  [[nodiscard]] static engine::Result<std::unique_ptr<TgvCompute>> create(const DeviceOptions& options);
  ~TgvCompute() override;

  /// What the validation layers reported.
  [[nodiscard]] std::vector<std::string> messages() const;

  [[nodiscard]] const std::string& name() const noexcept override;
  [[nodiscard]] std::size_t mostTogether() const noexcept override;
  [[nodiscard]] int underWay() const noexcept override;
  [[nodiscard]] engine::Status start(std::span<engine::TgvSquare* const> squares) override;
  [[nodiscard]] engine::Status proceed(std::vector<engine::TgvSquare*>& finished) override;
  void drop() noexcept override;

 private:
  class Impl;
  explicit TgvCompute(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render

#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <initializer_list>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "engine/filter/tgv_device.h"
#include "engine/filter/tgv_schedule.h"

namespace fettle::engine::tests {

/// A device that is this processor: the same kernels row by row, a batch per proceed(). What is called in an order that
/// TgvDevice forbids is counted.
class CpuTgvDevice final : public TgvDevice {
 public:
  explicit CpuTgvDevice(std::size_t together = 2) : together_(together) {}

  // By how many units in the last place its divisions and roots are off at most, at random.
  float off_ulps = 0.0F;
  // What it shall do, before or instead of the rest of it.
  std::function<Status()> at_start, at_proceed;

  // What it did.
  std::size_t batches = 0, squares = 0, largest = 0, misused = 0, dropped = 0;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::size_t mostTogether() const noexcept override { return together_; }
  [[nodiscard]] int underWay() const noexcept override { return static_cast<int>(batches_.size()); }

  [[nodiscard]] Status start(std::span<TgvSquare* const> batch) override {
    misused += failed_ || batch.empty() || batch.size() > together_ || underWay() >= kMostBatches ? 1 : 0;
    for (const TgvSquare* square : batch)
      misused +=
          square->columns() > tgv::kSide + 2 * tgv::kHalo || square->rows() > tgv::kSide + 2 * tgv::kHalo;
    ++batches;
    squares += batch.size();
    largest = std::max(largest, batch.size());
    if (at_start)
      if (Status status = at_start(); !status) return fail(std::move(status));
    batches_.emplace_back(batch.begin(), batch.end());
    return {};
  }

  [[nodiscard]] Status proceed(std::vector<TgvSquare*>& finished) override {
    misused += failed_ || batches_.empty() ? 1 : 0;
    if (at_proceed)
      if (Status status = at_proceed(); !status) return fail(std::move(status));
    for (TgvSquare* square : batches_.front()) takeSteps(*square);
    finished.insert(finished.end(), batches_.front().begin(), batches_.front().end());
    batches_.pop_front();
    return {};
  }

  void drop() noexcept override {
    ++dropped;
    batches_.clear();
    failed_ = false;
  }

 private:
  Status fail(Status status) {
    failed_ = true;
    return status;
  }

  void roughen(int columns, std::initializer_list<float*> rows) {
    if (off_ulps == 0.0F) return;
    // A unit in the last place is 2^-23 of the value at most.
    std::uniform_real_distribution<float> off(-off_ulps * 0x1p-23F, off_ulps * 0x1p-23F);
    for (int c = 0; c < columns; ++c) {
      const float factor = 1.0F + off(random_);
      for (float* row : rows)
        if (row[c] != tgv::kCut) row[c] *= factor;
    }
  }

  void takeSteps(TgvSquare& square) {
    const int columns = square.columns();
    const auto steps = [&](int count) {
      for (int k = 0; k < count; ++k) {
        for (int r = 0; r < square.rows(); ++r) {
          const tgv::Row row = square.row(r);
          tgv::stepDuals(bestCpuLevel(), row, square.row(r + 1), columns, tgv::kStep.dual);
          roughen(columns, {row.xx, row.yy, row.xy});  // one quotient scales all three
        }
        for (int r = 0; r < square.rows(); ++r)
          tgv::stepSurface(bestCpuLevel(), square.row(r), square.row(r - 1), columns, tgv::kStep.primal);
      }
    };
    steps(tgv::kFirstSteps);
    for (int round = 0; round < tgv::kRounds; ++round) {
      for (int r = 0; r < square.rows(); ++r) {
        const tgv::Row row = square.row(r);
        tgv::reweight(bestCpuLevel(), row, square.row(r + 1), columns, tgv::kWeights);
        for (float* weights : {row.wp, row.wq, row.wv}) roughen(columns, {weights});
      }
      steps(tgv::kRoundSteps);
    }
  }

  std::mt19937 random_{5};
  std::string name_ = "this processor";
  std::size_t together_;
  std::deque<std::vector<TgvSquare*>> batches_;
  bool failed_ = false;
};

}  // namespace fettle::engine::tests

// Second-order total generalised variation with jumps kept: of all surfaces u with slopes v = (x, y) the one of least
//
//    sum  wp |du/dcolumn - x| + wq |du/drow - y| + wv |E v| + (u - f)^2 / 2,     E v = symmetrised gradient of v,
//
// in units of the noise (K. Bredies, K. Kunisch and T. Pock, Total generalized variation, 2010), by the primal-dual
// steps of A. Chambolle and T. Pock, A first-order primal-dual algorithm for convex problems (2011). A jump costs as
// much as it is high, so it is rounded; the weights are therefore lowered in rounds where the surface jumps or is
// creased (E. Candes, M. Wakin and S. Boyd, Enhancing sparsity by reweighted l1 minimization, 2008).
//
// The schedule (tgv_schedule.h) is part of what the filter is, as is the square that it is worked out in: each square
// of kSide samples, on a grid that begins at the field's first sample, with kHalo samples around it.

#include <algorithm>
#include <memory>

#include "engine/filter/block.h"
#include "engine/filter/tgv_rows.h"
#include "engine/filter/tgv_schedule.h"
#include "engine/filter/tgv_square.h"

namespace fettle::engine {

namespace {

constexpr int kStepsTogether = 10;  // steps that follow each other row by row while the rows are in the cache

class TgvFilter final : public BlockFilter {
 public:
  TgvFilter(const FilterSpec& spec, CpuLevel level) : level_(level), square_(spec.range_sigma, level) {}

  bool run(const Block& block, const JobControl& job) override {
    square_.prepare(block);
    if (!steps(tgv::kFirstSteps, job)) return false;
    for (int round = 0; round < tgv::kRounds; ++round) {
      for (int r = 0; r < square_.rows(); ++r)
        tgv::reweight(level_, square_.row(r), square_.row(r + 1), square_.columns(), tgv::kWeights);
      if (!steps(tgv::kRoundSteps, job)) return false;
    }
    square_.write(block);
    return true;
  }

 private:
  // Step k works two rows behind step k - 1: what it reads of the rows after its own has been through that.
  bool steps(int count, const JobControl& job) {
    const int rows = square_.rows();
    for (int done = 0; done < count; done += kStepsTogether) {
      const int together = std::min(kStepsTogether, count - done);
      for (int front = 0; front < rows + 2 * (together - 1); ++front) {
        if (job.cancelled()) return false;
        for (int k = 0; k < together; ++k) {
          const int r = front - 2 * k;
          if (r < 0 || r >= rows) continue;
          tgv::stepDuals(level_, square_.row(r), square_.row(r + 1), square_.columns(), tgv::kStep.dual);
          tgv::stepSurface(level_, square_.row(r), square_.row(r - 1), square_.columns(), tgv::kStep.primal);
        }
      }
    }
    return true;
  }

  CpuLevel level_;
  TgvSquare square_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeTgvFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<TgvFilter>(spec, level);
}

}  // namespace fettle::engine

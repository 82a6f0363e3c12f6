#include "engine/field/line_cuts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

// The places, counted in whole numbers of `across`, at which the segment from a to b passes; a whole number belongs to
// what lies below it, so that of two segments that meet there one passes.
template <class Visit>
void forEachPassage(glm::dvec2 a, glm::dvec2 b, int across, std::int32_t end, Visit&& visit) {
  const int along = 1 - across;
  const double from = std::min(a[across], b[across]), to = std::max(a[across], b[across]);
  const auto first = static_cast<std::int32_t>(std::clamp(std::floor(from) + 1.0, 0.0, 1.0 * end));
  const auto last = static_cast<std::int32_t>(std::clamp(std::floor(to), -1.0, end - 1.0));
  for (std::int32_t at = first; at <= last; ++at) {
    const double place = a[along] + (at - a[across]) / (b[across] - a[across]) * (b[along] - a[along]);
    visit(at, place);
  }
}

struct Passage {
  LineCut cut;
  std::int64_t id = 0;  // of the line
};

void addPassages(const EdgeLine& line, std::int32_t columns, std::int32_t rows, std::vector<Passage>& out,
                 std::vector<LineSample>& samples) {
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
    const EdgePoint &a = line.points[i], &b = line.points[(i + 1) % n];
    if (!a.located || !b.located) continue;
    // Where two surfaces meet without a step, their heights are held together there.
    const bool crease = a.kind == LineKind::kCrease || b.kind == LineKind::kCrease;
    const auto deviation = static_cast<float>(std::max(a.deviation, b.deviation));
    forEachPassage(a.position, b.position, 1, rows, [&](std::int32_t row, double place) {
      if (!(place >= 0.0 && place < columns - 1)) return;
      const auto column = static_cast<std::int32_t>(place);
      samples.push_back({row, static_cast<std::int32_t>(place + 0.5)});
      if (crease) return;
      out.push_back(
          {{row, column, LineCut::kRight, static_cast<float>(place - column), 0.0F, deviation}, line.id});
    });
    forEachPassage(a.position, b.position, 0, columns, [&](std::int32_t column, double place) {
      if (!(place >= 0.0 && place < rows - 1)) return;
      const auto row = static_cast<std::int32_t>(place);
      samples.push_back({static_cast<std::int32_t>(place + 0.5), column});
      if (crease) return;
      out.push_back({{row, column, LineCut::kUp, 0.0F, static_cast<float>(place - row), deviation}, line.id});
    });
  }
}

std::pair<std::int32_t, std::int32_t> tileOfSample(const LineSample& sample) noexcept {
  return {sample.row >> kTileShift, sample.column >> kTileShift};
}

std::tuple<std::pair<std::int32_t, std::int32_t>, std::int32_t, std::int32_t> orderOfSample(
    const LineSample& sample) noexcept {
  return {tileOfSample(sample), sample.row, sample.column};
}

}  // namespace

LineCuts::LineCuts(std::span<const EdgeLine> lines, std::int32_t columns, std::int32_t rows) {
  std::vector<Passage> passages;
  for (const EdgeLine& line : lines) addPassages(line, columns, rows, passages, samples_);
  std::ranges::sort(passages, {}, [](const Passage& p) { return std::tuple(p.cut.row, p.cut.column, p.id); });
  for (std::size_t i = 0; i < passages.size();) {
    const Passage& first = passages[i];
    LineCut cut{first.cut.row, first.cut.column};
    while (i < passages.size() && passages[i].cut.row == cut.row && passages[i].cut.column == cut.column) {
      const std::int64_t id = passages[i].id;
      std::uint8_t of_line = 0;
      for (; i < passages.size() && passages[i].id == id && passages[i].cut.row == cut.row &&
             passages[i].cut.column == cut.column;
           ++i) {
        const LineCut& passed = passages[i].cut;
        of_line ^= passed.links;
        (passed.links == LineCut::kRight ? cut.right_at : cut.up_at) =
            passed.links == LineCut::kRight ? passed.right_at : passed.up_at;
        cut.deviation = std::max(cut.deviation, passed.deviation);
      }
      cut.links |= of_line;
    }
    if (cut.links != 0) cuts_.push_back(cut);
  }
  std::ranges::sort(samples_, {}, orderOfSample);
  samples_.erase(std::unique(samples_.begin(), samples_.end()), samples_.end());
  samples_.shrink_to_fit();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto [row, column] = tileOfSample(samples_[i]);
    if (tiles_.empty() || tiles_.back().row != row || tiles_.back().column != column)
      tiles_.push_back({row, column, static_cast<std::uint32_t>(i), 0, 0xcbf29ce484222325ULL});
    TilePart& tile = tiles_.back();
    ++tile.count;
    // FNV-1a, word by word.
    tile.print = (tile.print ^ (static_cast<std::uint64_t>(samples_[i].row) << 32U |
                                static_cast<std::uint64_t>(samples_[i].column))) *
                 0x100000001b3ULL;
    tile.print ^= tile.print >> 32U;
  }
}

LineCuts::TileSamples LineCuts::samplesOf(std::int32_t tile_column, std::int32_t tile_row) const noexcept {
  const auto tile = std::ranges::lower_bound(tiles_, std::pair(tile_row, tile_column), {},
                                             [](const TilePart& t) { return std::pair(t.row, t.column); });
  if (tile == tiles_.end() || tile->row != tile_row || tile->column != tile_column) return {};
  return {{samples_.data() + tile->first, tile->count}, tile->print};
}

std::span<const LineCut> LineCuts::row(std::int32_t row) const noexcept {
  const auto first = std::ranges::lower_bound(cuts_, row, {}, &LineCut::row);
  const auto last = std::ranges::upper_bound(cuts_, row, {}, &LineCut::row);
  return {cuts_.data() + (first - cuts_.begin()), static_cast<std::size_t>(last - first)};
}

}  // namespace fettle::engine

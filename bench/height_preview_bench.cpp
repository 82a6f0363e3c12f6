#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bench/holed_field.h"
#include "bench/preview_bench.h"
#include "bench/repeats.h"
#include "engine/base/stopwatch.h"
#include "engine/field/means.h"
#include "engine/measure/lowered.h"
#include "haptic/journal/computed_heights.h"
#include "haptic/journal/early_heights.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

// Of a picture off the whole, and of what changed, where the whole is other than what was before, in view.
void measureOff(const engine::EarlyPicture& picture, const engine::Version& before,
                const engine::Version& whole, const engine::FieldView& seen, HeightPreviewRow& row) {
  const engine::Grid& grid = before.grid();
  const engine::SampleRect all{0, 0, grid.width, grid.height};
  const auto likePicture = [&](const engine::Version& field) {
    return picture.step > 1 ? engine::meansOf(field, all, picture.step) : field;
  };
  const engine::Version was = likePicture(before), is = likePicture(whole);
  const std::int32_t side = engine::kTileSide, step = picture.step;
  const engine::FieldReader a = picture.field.reader(), b = was.reader(), c = is.reader();
  double squares = 0.0, changes = 0.0;
  std::int64_t compared = 0, changed = 0;
  for (std::int32_t y = seen.tiles.row * side / step;
       y < std::min((seen.tiles.row + seen.tiles.rows) * side / step, a.height()); ++y)
    for (std::int32_t x = seen.tiles.column * side / step;
         x < std::min((seen.tiles.column + seen.tiles.columns) * side / step, a.width()); ++x) {
      const auto shown = static_cast<double>(a.heightAt(x, y));
      const auto old = static_cast<double>(b.heightAt(x, y)), now = static_cast<double>(c.heightAt(x, y));
      if (std::isnan(now) || now == old) continue;
      if (!std::isnan(old)) {
        changes += (now - old) * (now - old);
        ++changed;
      }
      if (std::isnan(shown)) continue;
      squares += (shown - now) * (shown - now);
      ++compared;
    }
  if (compared > 0) row.off_whole = std::sqrt(squares / static_cast<double>(compared));
  if (changed > 0) row.change_rms = std::sqrt(changes / static_cast<double>(changed));
}

engine::Status previewHeights(const engine::Version& field, const haptic::HeightsMaker& maker,
                              const std::string& what, std::vector<HeightPreviewRow>& rows,
                              engine::JobControl& job) {
  engine::Result<haptic::ComputedHeights> alone;
  const double seconds = secondsOf([&] { alone = haptic::computeHeights(field, maker, job); });
  if (!alone) return tl::unexpected(alone.error());
  const std::uint64_t hash = engine::contentHash(alone->field);
  const std::int32_t side = field.grid().width;
  for (const engine::FieldView& seen :
       {middleView(field.grid(), side, side), middleView(field.grid(), 1280, 800)}) {
    HeightPreviewRow row;
    row.what = what;
    row.side = side;
    row.seen = seen.tiles.tiles() * engine::kTileSamples;
    row.alone = seconds;
    row.hash = hash;
    std::optional<engine::EarlyPicture> last;
    const engine::Stopwatch watch;
    const auto show = [&](engine::EarlyPicture picture) {
      if (!last) row.first = watch.seconds();
      last = std::move(picture);
    };
    haptic::EarlyHeights early(field, maker);
    (void)early.see(seen, show, job);  // its errors are those of the whole
    const auto whole = haptic::computeHeights(field, maker, job);
    row.whole = watch.seconds();
    if (!whole) return tl::unexpected(whole.error());
    if (engine::contentHash(whole->field) != hash)
      return engine::failure("a previewed result differs from the one without a preview", "bench previews");
    if (last) {
      row.step = last->step;
      row.exact = last->exact;
      if (last->off) {
        row.off_said = last->off->rms;
        row.estimated = last->off->estimated;
      }
      measureOff(*last, field, whole->field, seen, row);
    }
    rows.push_back(std::move(row));
  }
  return {};
}

}  // namespace

engine::Status benchHeightPreviews(std::int32_t side, bool fill, bool level,
                                   std::vector<HeightPreviewRow>& rows, engine::JobControl& job) {
  for (const HoleKind& kind : holeKinds()) {
    if (!fill || std::string_view(kind.name) == "scratches") continue;
    const auto field = holedField(side, kind);
    if (!field) return tl::unexpected(field.error());
    if (auto done =
            previewHeights(*field, engine::FillOptions{}, std::string("fill ") + kind.name, rows, job);
        !done)
      return done;
  }
  if (!level) return {};
  // Rows some hundredths of a millimetre off each other.
  const auto striped = engine::lowered(
      trials::workpiece(side, kSpacingMm), "stripes",
      [](const engine::SampleRect& rect, double* out) {
        for (std::int32_t r = 0; r < rect.rows; ++r)
          std::fill_n(out + r * engine::kTileSide, rect.columns,
                      0.05 * (randomBits(1, rect.row + r) * 0x1p-32 - 0.5));
      },
      job);
  if (!striped) return tl::unexpected(striped.error());
  for (const auto& [method, name] : {std::pair{engine::LineMethod::kMedian, "level median"},
                                     {engine::LineMethod::kMatching, "level matching"}}) {
    engine::LineOptions lines;
    lines.method = method;
    if (auto done = previewHeights(*striped, lines, name, rows, job); !done) return done;
  }
  return {};
}

}  // namespace fettle::bench

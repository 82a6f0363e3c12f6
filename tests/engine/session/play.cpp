#include "tests/engine/session/play.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"
#include "engine/formats/formats.h"
#include "engine/session/form_codec.h"
#include "engine/session/line_codec.h"
#include "engine/session/tile_codec.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {

namespace {

using Random = std::mt19937_64;

int below(Random& random, int n) {
  return static_cast<int>(random() % static_cast<std::uint64_t>(n));
}

void stroke(LiveField& live, Random& random) {
  const Grid& grid = live.grid();
  int c = below(random, grid.width);
  int r = below(random, grid.height);
  for (int tick = 0; tick < 40; ++tick) {
    c = std::clamp(c + below(random, 15) - 7, 0, grid.width - 1);
    r = std::clamp(r + below(random, 15) - 7, 0, grid.height - 1);
    const int w = std::min(3, grid.width - c);
    const int h = std::min(3, grid.height - r);
    std::vector<float> z(static_cast<std::size_t>(w * h));
    for (float& value : z) value = static_cast<float>(below(random, 1 << 20)) * 1e-4F - 3.0F;
    if (random() % 50 == 0) z[0] = std::numeric_limits<float>::quiet_NaN();
    if (random() % 50 == 0) z[0] = -0.0F;
    (void)live.writeHeights(c, r, w, h, z.data(), w);
  }
}

void filter(LiveField& live, Random& random) {
  const Grid& grid = live.grid();
  std::vector<float> row(static_cast<std::size_t>(grid.width));
  const float shift = static_cast<float>(below(random, 100)) * 0.001F;
  for (int r = 0; r < grid.height; ++r) {
    live.reader().readHeights(0, r, grid.width, 1, row.data(), grid.width);
    for (float& z : row) z = z * 0.5F + shift;
    (void)live.writeHeights(0, r, grid.width, 1, row.data(), grid.width);
  }
}

void mark(LiveField& live, Random& random) {
  const int c = below(random, live.grid().width);
  const int r = below(random, live.grid().height);
  const bool on = random() % 3 != 0;
  for (int k = 0; k < 100; ++k) (void)live.setMark(std::min(c + k, live.grid().width - 1), r, on);
}

// Any bits a line can have; sometimes none.
EdgeLines someLines(Random& random) {
  std::vector<EdgeLine> lines(static_cast<std::size_t>(below(random, 4)));
  const auto real = [&] { return std::ldexp(static_cast<double>(random()), below(random, 200) - 150); };
  for (EdgeLine& line : lines) {
    line.id = static_cast<std::int64_t>(random());
    line.closed = random() % 3 == 0;
    line.points.resize(static_cast<std::size_t>(below(random, 200)));
    for (EdgePoint& point : line.points) {
      point.position = {below(random, 1000) / 7.0, -below(random, 1000) * 0x1p-20};
      point.kind = random() % 2 == 0 ? LineKind::kStep : LineKind::kCrease;
      point.located = random() % 4 != 0;
      if (point.located) {
        point.deviation = real();
        point.step = -real();
        point.step_deviation = real();
        point.slope_change = real();
        point.slope_deviation = real();
      }
    }
  }
  return lines.empty() ? EdgeLines() : std::make_shared<const std::vector<EdgeLine>>(std::move(lines));
}

// Of any degree, or a shape; sometimes none.
FieldForm someForm(Random& random, const Version& field) {
  const int degree = below(random, PolynomialForm::kMostDegree + 5) - 1;
  if (degree < 0) return nullptr;
  if (degree > PolynomialForm::kMostDegree)
    return std::make_shared<const NominalForm>(
        someShape(field.grid(), static_cast<FormShape>(degree - PolynomialForm::kMostDegree - 1), 1.0,
                  static_cast<unsigned>(random())));
  const auto real = [&] { return std::ldexp(static_cast<double>(random()), below(random, 100) - 100); };
  PolynomialForm form{degree, field.grid().width, field.grid().height, -real(), {}};
  for (int k = 0; k < PolynomialForm::terms(degree); ++k) form.coefficients.push_back(real());
  return std::make_shared<const NominalForm>(std::move(form));
}

}  // namespace

Version strangeField(std::uint64_t seed, std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.1;
  grid.spacing_y = 1.0 / 3.0;
  grid.origin_x = 5.0e6 + 1.0 / 7.0;
  grid.origin_y = -4.25e6;
  grid.lateral_unit = {"m", 1000.0};
  grid.height_unit = {"ftUS", 1200.0 / 3937.0 * 1000.0};
  grid.crs_wkt = "LOCAL_CS[\"somewhere 'quoted' \xc3\xa9\"]";
  grid.height_per_count = 1e-3;
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "play");
  if (!builder) std::abort();
  Random random(seed);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      std::uint32_t bits = std::bit_cast<std::uint32_t>(std::sin(static_cast<float>(c) * 0.05F) +
                                                        static_cast<float>(below(random, 1000)) * 1e-3F);
      switch (below(random, 200)) {
        case 0:
          bits = 0x7fc00000U | static_cast<std::uint32_t>(random() & 0x3fffff);  // a payload
          break;
        case 1:
          bits = 0xff800001U | static_cast<std::uint32_t>(random() & 0x3fffff);  // negative, signalling
          break;
        case 2:
          bits = random() % 2 == 0 ? 0x80000000U : 0U;
          break;
        case 3:
          bits = static_cast<std::uint32_t>(random() & 0x807fffff);  // denormal
          break;
        case 4:
          bits = random() % 2 == 0 ? 0x7f7fffffU : 0xff7fffffU;  // the largest there are
          break;
        default:
          break;
      }
      Tile& tile = builder->tile(c / kTileSide, r / kTileSide);
      tile.samples[static_cast<std::size_t>(r % kTileSide * kTileSide + c % kTileSide)] =
          std::bit_cast<float>(bits);
      if (random() % 300 == 0)
        tile.marks[static_cast<std::size_t>(r % kTileSide)] |= std::uint64_t{1} << (c % kTileSide);
    }
  return std::move(*builder).build();
}

Play::Play(std::uint64_t seed, std::int32_t width, std::int32_t height) : seed_(seed) {
  session.original = strangeField(seed, width, height);
  session.history = History(session.original);
  session.scan.format = "none";
}

Play::Play(std::uint64_t seed, const Session& start) : session(start), seed_(seed) {}

void Play::act(SessionWriter* writer) {
  const std::int64_t n = actions() + 1;
  Random random(seed_ * 1000003 + static_cast<std::uint64_t>(n));
  History& history = session.history;
  JournalEntry entry{
      fmt::format("{{\"action\":{}}}", n), {}, StepTime(std::chrono::milliseconds(1000 * n)), 0};
  const int what = below(random, 100);
  if (what < 12 || (what < 20 && history.canRedo())) {
    const auto to = what < 12
                        ? std::max<std::int64_t>(history.first(), history.number() - 1 - below(random, 3))
                        : history.number() + 1;
    if (history.goTo(to)) {
      entry.state = to;
      session.journal.push_back(entry);
      if (writer != nullptr) writer->moveTo(to, {entry});
      return;
    }
  }
  if (what >= 95) {
    const std::string text(static_cast<std::size_t>(below(random, 300)), static_cast<char>('a' + n % 26));
    session.notes[what < 98 ? "camera" : fmt::format("note {}", n)] = text;
    entry.state = history.number();
    session.journal.push_back(entry);
    if (writer != nullptr) writer->setNote(what < 98 ? "camera" : fmt::format("note {}", n), text, {entry});
    return;
  }
  LiveField live(history.current(), Growth::kAllowed);
  StepInfo info{fmt::format("action {}", n), StepKind::kStroke, entry.time, {}, 0};
  if (what < 80) {
    stroke(live, random);
    entry.data = std::string(static_cast<std::size_t>(below(random, 4000)), 'x');
  } else if (what < 85) {
    filter(live, random);
    info.kind = StepKind::kFilter;
  } else if (what < 89) {
    mark(live, random);
    info.kind = StepKind::kMark;
  } else if (what < 92) {
    mark(live, random);
    const EdgeLines lines = someLines(random);
    info.kind = lines == live.snapshot().lines() ? StepKind::kMark : StepKind::kLines;
    static_cast<void>(live.adopt(live.snapshot().withLines(lines)));
  } else if (what < 94) {
    live.invert();
    info.kind = StepKind::kInvert;
  } else {
    static_cast<void>(live.adopt(live.snapshot().withForm(someForm(random, live.snapshot()))));
    info.kind = StepKind::kForm;
  }
  const bool changed = history.push(info, live.snapshot());
  entry.state = history.number();
  session.journal.push_back(entry);
  if (writer == nullptr) return;
  if (changed)
    writer->commit(history.number(), history.step(history.number()), {entry});
  else
    writer->addJournal(entry);
}

std::string difference(const Version& a, const Version& b) {
  if (!(a.grid() == b.grid())) return "the grids differ";
  if (a.reader().sign() != b.reader().sign()) return "the signs differ";
  for (int tr = 0; tr < a.reader().tileRows(); ++tr)
    for (int tc = 0; tc < a.reader().tileColumns(); ++tc) {
      const Tile& x = a.reader().tile(tc, tr);
      const Tile& y = b.reader().tile(tc, tr);
      if (!sameBits(x, y)) return fmt::format("tile {}, {} differs", tc, tr);
      if (x.block_min != y.block_min || x.block_max != y.block_max || !(x.bounds == y.bounds) ||
          x.nan_samples != y.nan_samples || x.marked_samples != y.marked_samples)
        return fmt::format("bounds or counts of tile {}, {} differ", tc, tr);
    }
  const Node& m = a.reader().root();
  const Node& n = b.reader().root();
  if (m.child_min != n.child_min || m.child_max != n.child_max || m.marked_children != n.marked_children ||
      m.holed_children != n.holed_children)
    return "the roots differ";
  if (packLines(a.lines()) != packLines(b.lines())) return "the edge lines differ";
  if (packForm(a.form()) != packForm(b.form())) return "the forms differ";
  return {};
}

std::string difference(const Session& a, const Session& b, Compare compare) {
  if (const std::string d = difference(a.original, b.original); !d.empty()) return "original: " + d;
  if (a.history.number() != b.history.number())
    return fmt::format("state {} against {}", a.history.number(), b.history.number());
  if (a.history.last() != b.history.last())
    return fmt::format("last state {} against {}", a.history.last(), b.history.last());
  if (compare == Compare::kWhole && a.history.first() != b.history.first())
    return fmt::format("first state {} against {}", a.history.first(), b.history.first());
  const std::int64_t first = std::max(a.history.first(), b.history.first());
  for (std::int64_t k = first; k <= a.history.last(); ++k) {
    if (const std::string d = difference(a.history.state(k), b.history.state(k)); !d.empty())
      return fmt::format("state {}: {}", k, d);
    if (k == first) continue;
    const StepInfo& x = a.history.info(k);
    const StepInfo& y = b.history.info(k);
    if (x.name != y.name || x.kind != y.kind || x.time != y.time || !(x.rect == y.rect))
      return fmt::format("step {} differs: {} against {}", k, x.name, y.name);
  }
  if (a.notes != b.notes) return "the notes differ";
  if (a.journal != b.journal)
    return fmt::format("the journals differ: {} against {} entries", a.journal.size(), b.journal.size());
  return {};
}

std::string differenceOnDisk(const Session& session, const std::string& path) {
  JobControl job;
  const auto back = openSession(path, {}, importField, job);
  if (!back) return back.error().line();
  if (const auto whole = verifySession(path, job); !whole) return whole.error().line();
  return difference(session, *back, Compare::kWhole);
}

}  // namespace fettle::engine

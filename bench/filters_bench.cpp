#include "bench/filters_bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <thread>
#include <utility>

#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"

namespace fettle::bench {

namespace {

constexpr std::int32_t kProbeSide = 512;
constexpr double kSpacing = 0.05;    // [mm]
constexpr double kNoiseWidth = 0.3;  // of the rectangle that the noise is spread over

/// Wall time and processor time of this process [s].
struct Seconds {
  double wall = 0.0;
  double cpu = 0.0;
};

Seconds timed(auto&& work) {
  const double cpu = processorSeconds();
  const engine::Stopwatch watch;
  work();
  return {watch.seconds(), processorSeconds() - cpu};
}

// Steele, Lea, Flood 2014, SplitMix64: a good hash of a counter, so that any sample can be made by itself.
std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

// A dropout of 3 to 18 samples radius in every third tile or so, and one lost sample in two thousand.
bool dropped(std::int32_t column, std::int32_t row) noexcept {
  const auto tile =
      mixed((static_cast<std::uint64_t>(row >> 6) << 32) | static_cast<std::uint32_t>(column >> 6));
  const auto x = static_cast<int>(tile % 64) - (column & 63);
  const auto y = static_cast<int>(tile / 64 % 64) - (row & 63);
  const auto radius = static_cast<int>(tile / 4096 % 16) + 3;
  if ((tile >> 32) % 4 != 0) return false;
  if (x * x + y * y < radius * radius) return true;
  return mixed((static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint32_t>(column)) % 2000 == 0;
}

engine::Result<engine::Version> ground(std::int32_t side, FilterGround kind,
                                       const std::shared_ptr<engine::FieldMemory>& memory) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = kSpacing;
  auto builder = engine::FieldBuilder::create(grid, memory, "bench filters");
  if (!builder) return tl::unexpected(builder.error());
  const auto samples = static_cast<std::size_t>(side);
  std::vector<double> along(samples);
  std::vector<float> heights(samples);
  for (std::size_t c = 0; c < samples; ++c) along[c] = std::sin(static_cast<double>(c) * 0.013);
  for (std::int32_t r = 0; r < side; ++r) {
    const double across = std::cos(r * 0.011);
    for (std::int32_t c = 0; c < side; ++c) {
      const auto at = static_cast<std::size_t>(c);
      const std::uint64_t bits = mixed((static_cast<std::uint64_t>(r) << 32) | static_cast<std::uint32_t>(c));
      const double noise = static_cast<double>(bits >> 11) * 0x1p-53 - 0.5;
      heights[at] = static_cast<float>(2.0 * across * along[at] + kNoiseWidth * noise);
      if (kind == FilterGround::kHoles && dropped(c, r))
        heights[at] = std::numeric_limits<float>::quiet_NaN();
    }
    builder->writeHeights(0, r, side, 1, heights.data(), side);
    if (kind == FilterGround::kMarks && r % engine::kTileSide == engine::kTileSide / 2) {
      const std::vector<std::uint8_t> line(samples, 1);
      builder->writeMarks(0, r, side, 1, line.data(), side);
    }
  }
  return std::move(*builder).build();
}

/// Fields made on first use, all in one memory.
class Grounds {
 public:
  engine::Result<engine::Version> get(std::int32_t side, FilterGround kind) {
    const auto key = std::pair(side, kind);
    if (const auto at = made_.find(key); at != made_.end()) return at->second;
    auto field = ground(side, kind, memory_);
    if (field) made_.emplace(key, *field);
    return field;
  }

 private:
  std::shared_ptr<engine::FieldMemory> memory_ = std::make_shared<engine::FieldMemory>();
  std::map<std::pair<std::int32_t, FilterGround>, engine::Version> made_;
};

/// The memory's rate: floats copied from one array to another, each thread its own part.
class Copy {
 public:
  explicit Copy(std::size_t samples) : from_(samples, 1.0F), to_(samples, 0.0F) {}

  Seconds run(int threads) {
    const auto parts = static_cast<std::size_t>(threads);
    const auto part = [&](std::size_t i) {
      const std::size_t begin = from_.size() * i / parts;
      const std::size_t end = from_.size() * (i + 1) / parts;
      std::memcpy(to_.data() + begin, from_.data() + begin, (end - begin) * sizeof(float));
    };
    return timed([&] {
      std::vector<std::jthread> others;
      for (std::size_t i = 1; i < parts; ++i) others.emplace_back(part, i);
      part(0);
    });
  }

  [[nodiscard]] double samples() const noexcept { return static_cast<double>(from_.size()); }

 private:
  std::vector<float> from_, to_;
};

engine::FilterSpec specOf(const FiltersBenchRow& row) {
  engine::FilterSpec spec;
  spec.kind = row.kind;
  const engine::Filter& filter = engine::filterOf(row.kind);
  // The weights of a nesting index reach as far as a window of this side.
  const int radius = row.window / 2;
  if (filter.nesting.exists())
    spec.nesting_mm =
        kSpacing * std::max(filter.has_element ? 1.0 * radius : 0.5 * row.window, filter.least_nesting);
  else
    spec.window = row.window;
  spec.element = row.element;
  spec.threads = row.threads;
  spec.range_sigma = kNoiseWidth / std::sqrt(12.0) * filter.noises;
  return spec;
}

struct Run {
  Seconds seconds;
  std::uint64_t hash = 0;
};

engine::Result<engine::Filtered> filteredBy(const FiltersBenchRow& row, const engine::Version& field,
                                            engine::TgvDevice* device) {
  engine::JobControl own;  // applyFilter begins its own stage
  const engine::FilterSpec spec = specOf(row);
  return row.on_device ? engine::applyFilter(field, field, spec, *device, own)
                       : engine::applyFilter(field, field, spec, own);
}

engine::Result<Run> runOnce(const FiltersBenchRow& row, const engine::Version& field,
                            engine::TgvDevice* device, engine::JobControl& job) {
  engine::Result<engine::Filtered> result;
  if (job.cancelled()) return engine::cancelled();
  Run run;
  run.seconds = timed([&] { result = filteredBy(row, field, device); });
  if (!result) return tl::unexpected(result.error());
  run.hash = engine::contentHash(result->field);
  return run;
}

// Largest difference of two fields with holes at the same places.
double mostOff(const engine::Version& a, const engine::Version& b) {
  const engine::Grid& grid = a.grid();
  std::vector<float> one(static_cast<std::size_t>(grid.width)), other(one.size());
  double most = 0.0;
  for (std::int32_t r = 0; r < grid.height; ++r) {
    a.reader().readHeights(0, r, grid.width, 1, one.data(), grid.width);
    b.reader().readHeights(0, r, grid.width, 1, other.data(), grid.width);
    for (std::size_t c = 0; c < one.size(); ++c)
      if (one[c] == one[c])
        most = std::max(most, std::fabs(static_cast<double>(one[c]) - static_cast<double>(other[c])));
  }
  return most;
}

// What a device makes of a row's field against what the processor does.
engine::Result<double> offTheProcessor(FiltersBenchRow row, const engine::Version& field,
                                       engine::TgvDevice* device) {
  const auto there = filteredBy(row, field, device);
  if (!there) return tl::unexpected(there.error());
  row.on_device = false;
  const auto here = filteredBy(row, field, nullptr);
  if (!here) return tl::unexpected(here.error());
  return mostOff(there->field, here->field) / specOf(row).range_sigma;
}

engine::Status checked(const FiltersBenchOptions& options) {
  const auto within = [](const auto& values, int low, int high) {
    return !values.empty() &&
           std::ranges::all_of(values, [&](int value) { return value >= low && value <= high; });
  };
  const bool odd = std::ranges::all_of(options.windows, [](int window) { return window % 2 == 1; });
  if (options.side < 64 || options.side > 32768 || options.repeats < 1 || options.repeats > 100 || !odd ||
      !within(options.windows, 3, engine::FilterSpec::kMaxWindow) ||
      !within(options.threads, 1, engine::FilterSpec::kMaxThreads) || options.kinds.empty() ||
      options.elements.empty() || options.grounds.empty() ||
      !(options.limit_s > 0.0 && options.limit_s <= 1e6))
    return engine::inputError("an option of the benchmark is out of range", "bench filters",
                              "side 64 to 32768, windows odd and 3 to 1001, threads 1 to 1024, repeats 1 to "
                              "100, limit above 0");
  return {};
}

// The largest side, by halving, with which all repeats take no longer than the limit.
engine::Result<std::int32_t> sideFor(const FiltersBenchRow& row, const FiltersBenchOptions& options,
                                     Grounds& grounds, engine::JobControl& job) {
  const std::int32_t probe = std::min(options.side, kProbeSide);
  const auto field = grounds.get(probe, row.ground);
  if (!field) return tl::unexpected(field.error());
  const auto run = runOnce(row, *field, options.device, job);
  if (!run) return tl::unexpected(run.error());
  std::int32_t side = options.side;
  const auto estimate = [&] {
    const double ratio = static_cast<double>(side) / probe;
    return run->seconds.wall * ratio * ratio * (options.repeats + 1);
  };
  while (side > probe && estimate() > options.limit_s) side /= 2;
  return std::max(side, probe);
}

}  // namespace

std::string groundName(FilterGround ground) {
  switch (ground) {
    case FilterGround::kPlain:
      return "plain";
    case FilterGround::kHoles:
      return "holes";
    case FilterGround::kMarks:
      return "marks";
  }
  return {};
}

double suggestedCost(const FiltersBenchRow& row) noexcept {
  if (row.threads != 1 || row.on_device) return 0.0;
  for (const engine::FilterTrial& trial : engine::filterOf(row.kind).trials)
    if (trial.window == row.window) return trial.cost;
  return 0.0;
}

FilterTarget targetOf(const FiltersBenchRow& row) noexcept {
  using engine::FilterKind;
  struct Share {
    FilterKind kind;
    int window;
    double share;
  };
  constexpr Share kShares[] = {
      {FilterKind::kBox, 3, 0.34},        {FilterKind::kBox, 5, 0.34},
      {FilterKind::kBox, 11, 0.34},       {FilterKind::kBox, 31, 0.34},
      {FilterKind::kBox, 101, 0.34},      {FilterKind::kGaussian, 3, 0.34},
      {FilterKind::kGaussian, 5, 0.34},   {FilterKind::kGaussian, 11, 0.34},
      {FilterKind::kGaussian, 101, 0.13}, {FilterKind::kMedian, 3, 0.50},
      {FilterKind::kMedian, 5, 0.29},     {FilterKind::kMedian, 11, 0.057},
      {FilterKind::kMedian, 31, 0.0067},  {FilterKind::kMedian, 101, 0.0067},
  };
  FilterTarget target;
  if (row.ground != FilterGround::kPlain) return target;
  if (row.threads == 2) target.over_one = 1.8;
  if (row.threads == 1)
    for (const Share& each : kShares)
      if (each.kind == row.kind && each.window == row.window) target.share = each.share;
  return target;
}

engine::Result<FiltersBenchReport> benchFilters(const FiltersBenchOptions& options, engine::JobControl& job) {
  if (engine::Status valid = checked(options); !valid) return tl::unexpected(valid.error());
  FiltersBenchReport report;
  report.machine = machine();
  if (options.device != nullptr) report.device = options.device->name();
  for (const engine::FilterKind kind : options.kinds) {
    const engine::Filter& filter = engine::filterOf(kind);
    const std::vector<int> no_window{engine::FilterSpec{}.window};
    const std::vector<engine::Element> no_element{engine::FilterSpec{}.element};
    for (const int window :
         filter.window.exists() || engine::separatesScales(filter) ? options.windows : no_window)
      for (const engine::Element element : filter.has_element ? options.elements : no_element)
        for (const FilterGround ground : options.grounds)
          for (const int threads : options.threads) {
            FiltersBenchRow row;
            row.kind = kind;
            row.element = element;
            row.window = window;
            row.threads = threads;
            row.ground = ground;
            report.rows.push_back(row);
            row.on_device = true;
            if (options.device != nullptr && engine::runsOnDevices(filter)) report.rows.push_back(row);
          }
  }
  job.begin("measuring", report.rows.size() * (static_cast<std::size_t>(options.repeats) + 1));

  Grounds grounds;
  std::vector<engine::Version> fields;
  for (std::size_t k = 0; k < report.rows.size(); ++k) {
    FiltersBenchRow& row = report.rows[k];
    if (row.on_device) {
      row.side = report.rows[k - 1].side;
    } else {
      const auto side = sideFor(row, options, grounds, job);
      if (!side) return tl::unexpected(side.error());
      row.side = *side;
    }
    const auto field = grounds.get(row.side, row.ground);
    if (!field) return tl::unexpected(field.error());
    fields.push_back(*field);
    const auto warm_up = runOnce(row, *field, options.device, job);
    if (!warm_up) return tl::unexpected(warm_up.error());
    row.hash = warm_up->hash;
    if (row.on_device) {
      const auto off = offTheProcessor(row, *field, options.device);
      if (!off) return tl::unexpected(off.error());
      row.most_off = *off;
    }
    job.advance(1);
  }

  for (std::size_t k = 0; options.bounds && k < report.rows.size(); ++k) {
    FiltersBenchRow& row = report.rows[k];
    if (row.on_device || row.threads != 1) continue;
    const auto bound = filterBound(fields[k], specOf(row), options.repeats, job);
    if (!bound) return tl::unexpected(bound.error());
    row.bound = *bound;
  }

  std::vector<std::vector<double>> wall(report.rows.size());
  std::vector<std::vector<double>> cpu(report.rows.size());
  std::map<int, std::vector<double>> copy_wall, copy_cpu;
  Copy copy(static_cast<std::size_t>(options.side) * static_cast<std::size_t>(options.side));
  for (int i = 0; i < options.repeats; ++i) {
    for (const int threads : options.threads) {
      const Seconds seconds = copy.run(threads);
      copy_wall[threads].push_back(copy.samples() / seconds.wall);
      copy_cpu[threads].push_back(copy.samples() / std::max(seconds.cpu, 1e-9));
    }
    for (std::size_t k = 0; k < report.rows.size(); ++k) {
      const FiltersBenchRow& row = report.rows[k];
      const auto run = runOnce(row, fields[k], options.device, job);
      if (!run) return tl::unexpected(run.error());
      if (run->hash != row.hash)
        return engine::failure("two runs of the same filter differ",
                               std::string(engine::name(row.kind)) + " " + std::to_string(row.window),
                               "please report this");
      const double samples = static_cast<double>(row.side) * row.side;
      wall[k].push_back(samples / run->seconds.wall);
      cpu[k].push_back(samples / std::max(run->seconds.cpu, 1e-9));
      job.advance(1);
    }
  }
  for (std::size_t k = 0; k < report.rows.size(); ++k) {
    FiltersBenchRow& row = report.rows[k];
    row.median = median(wall[k]);
    row.slowest = *std::ranges::min_element(wall[k]);
    row.fastest = *std::ranges::max_element(wall[k]);
    row.cpu = median(cpu[k]);
    row.copy = median(copy_wall[row.threads]);
    row.copy_cpu = median(copy_cpu[row.threads]);
    const auto over = [&](std::size_t other) {
      std::vector<double> ratios(wall[k].size());
      for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] = wall[k][i] / wall[other][i];
      return median(std::move(ratios));
    };
    if (row.on_device) row.over_processor = over(k - 1);
    for (std::size_t one = 0; one < report.rows.size(); ++one) {
      const FiltersBenchRow& alone = report.rows[one];
      if (alone.threads == 1 && alone.kind == row.kind && alone.window == row.window &&
          alone.element == row.element && alone.ground == row.ground && alone.on_device == row.on_device)
        row.over_one = over(one);
    }
  }
  return report;
}

}  // namespace fettle::bench

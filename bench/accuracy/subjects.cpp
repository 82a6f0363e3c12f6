#include "bench/accuracy/subjects.h"

#include <cmath>

#include "engine/field/builder.h"
#include "engine/scanner/counter_random.h"

namespace fettle::bench {

double whiteNoise(std::uint64_t seed, int column, int row) {
  return engine::CounterRandom(seed, 0).normal(column, row);
}

engine::Result<engine::Version> fieldOf(std::int32_t side, double spacing_mm,
                                        const std::function<double(int, int)>& height, double spacing_y_mm) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = spacing_mm;
  grid.spacing_y = spacing_y_mm > 0.0 ? spacing_y_mm : spacing_mm;
  auto builder = engine::FieldBuilder::create(grid, "accuracy study");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> line(static_cast<std::size_t>(side));
  for (std::int32_t row = 0; row < side; ++row) {
    for (std::int32_t column = 0; column < side; ++column)
      line[static_cast<std::size_t>(column)] = static_cast<float>(height(column, row));
    builder->writeHeights(0, row, side, 1, line.data(), side);
  }
  return (*std::move(builder)).build();
}

engine::Result<std::vector<Subject>> hardSubjects(std::int32_t side) {
  constexpr double kSpacingMm = 0.05;
  const std::pair<const char*, std::function<double(int, int)>> shapes[] = {
      {"flat", [](int, int) { return 0.0; }},
      {"step", [side](int c, int r) { return 3 * c + r > 2 * side ? 1.0 : 0.0; }},
      {"ridge", [](int c, int) { return c % 16 == 8 ? 0.5 : 0.0; }},
      {"groove", [](int c, int) { return kSpacingMm * std::abs(c % 32 - 16); }},
      {"noise", [](int c, int r) { return 0.02 * whiteNoise(1, c, r); }},
  };
  std::vector<Subject> subjects;
  for (const auto& [name, height] : shapes) {
    auto field = fieldOf(side, kSpacingMm, height);
    if (!field) return tl::unexpected(field.error());
    subjects.push_back({name, *std::move(field)});
  }
  return subjects;
}

engine::Result<std::vector<Subject>> searchGrounds(std::int32_t side) {
  const auto noise = [](int c, int r) { return 0.02 * whiteNoise(1, c, r); };
  const auto chosen = [](int c, int r, double sigmas) { return whiteNoise(2, c, r) > sigmas; };
  const auto wave = [](int i) { return std::abs(i % 16 - 8) / 8.0; };
  const struct {
    const char* name;
    double spacing_x_mm, spacing_y_mm;
    std::function<double(int, int)> height;
  } grounds[] = {
      {"noise", 0.05, 0.05, noise},
      {"anisotropic noise", 0.03, 0.12, noise},
      {"steps", 0.05, 0.05, [](int c, int r) { return 0.5 * ((3 * c + r) / 40 % 2); }},
      {"saddles", 0.05, 0.05, [wave](int c, int r) { return 0.4 * wave(c) * wave(r); }},
      {"ridges", 0.05, 0.05, [](int c, int) { return c % 16 == 8 ? 0.5 : 0.0; }},
      {"holes", 0.05, 0.05, [=](int c, int r) { return chosen(c, r, 1.64) ? std::nan("") : noise(c, r); }},
      {"spikes", 0.05, 0.05, [=](int c, int r) { return chosen(c, r, 2.33) ? 5.0 : noise(c, r); }},
  };
  std::vector<Subject> subjects;
  for (const auto& ground : grounds) {
    auto field = fieldOf(side, ground.spacing_x_mm, ground.height, ground.spacing_y_mm);
    if (!field) return tl::unexpected(field.error());
    subjects.push_back({ground.name, *std::move(field)});
  }
  return subjects;
}

}  // namespace fettle::bench

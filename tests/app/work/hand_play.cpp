#include "tests/app/work/hand_play.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine/field/live_field.h"
#include "engine/field/seen_field.h"

namespace fettle::tests {

using haptic::Tool;

std::uint64_t storedHash(const engine::Version& state) {
  engine::JobControl job;
  return engine::contentHash(*engine::restored(state, job));
}

void HandPlay::wait(std::uint64_t ticks) {
  const std::uint64_t until = client_.state().tick + ticks;
  while (client_.state().tick < until) {
    client_.poll();
    keeper_.poll();
    static_cast<void>(filters_.poll(client_, notices_));
    if (!filters_.applying()) {
      static_cast<void>(form_.poll(client_, notices_));
      static_cast<void>(heights_.poll(client_, notices_));
    }
    // A window's frames look at the loop about as often while it draws.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void HandPlay::press(double u, double v, bool held) {
  u_ = std::clamp(u, 0.02, 0.98);
  v_ = std::clamp(v, 0.02, 0.98);
  const engine::Version& field = client_.field();
  const engine::Grid& grid = field.grid();
  const auto column = static_cast<std::int32_t>(u_ * (grid.width - 1));
  const auto row = static_cast<std::int32_t>(v_ * (grid.height - 1));
  float height = 0.0F;
  field.reader().readHeights(column, row, 1, 1, &height, 1);
  client_.mouse()->setCursor({column * grid.spacingXMm(), row * grid.spacingYMm(),
                              std::isfinite(height) ? height * grid.height_unit.mm : 0.0});
  if (held)
    client_.mouse()->press(client_.tool());
  else
    client_.mouse()->release();
}

std::string HandPlay::stroke(bool ends) {
  const Tool tools[] = {Tool::kSmooth, Tool::kSmooth, Tool::kMark, Tool::kUnmark, Tool::kFeel};
  client_.setTool(tools[random_() % 5]);
  press(uniform(0, 1), uniform(0, 1), false);
  wait(30);
  const double du = uniform(-0.02, 0.02), dv = uniform(-0.02, 0.02);
  const int moves = static_cast<int>(uniform(4, 25));
  for (int i = 0; i < moves; ++i) {
    press(u_ + du, v_ + dv, true);
    wait(static_cast<std::uint64_t>(uniform(1, 6)));
  }
  if (ends) {
    press(u_, v_, false);
    wait(static_cast<std::uint64_t>(uniform(0, 60)));
  }
  return ends ? "stroke" : "stroke continues";
}

std::string HandPlay::filter(bool under_a_stroke) {
  engine::FilterSpec& spec = filters_.spec;
  spec.kind = engine::filters()[random_() % engine::filters().size()].kind;
  // Given here, or left to the noise of the field then.
  spec.range_sigma = engine::hasRange(spec.kind) && random_() % 2 == 0 ? 0.02 : 0.0;
  spec.nesting_mm = engine::usualNesting(engine::filterOf(spec.kind), client_.field().grid());
  spec.element = engine::filterOf(spec.kind).has_element
                     ? static_cast<engine::Element>(random_() % engine::kElementWords.size())
                     : engine::Element::kBall;
  spec.window = 3 + 2 * static_cast<int>(random_() % 3);
  spec.passes = 1 + static_cast<int>(random_() % 2);
  spec.scope = random_() % 4 == 0 ? engine::FilterScope::kOnlyMarks : engine::FilterScope::kKeepMarks;
  spec.max_change = random_() % 3 == 0 ? std::optional<double>(0.05) : std::nullopt;
  filters_.apply(client_);
  const bool leaves = random_() % 6 == 0;
  if (under_a_stroke) static_cast<void>(stroke(random_() % 2 == 0));
  if (leaves) {
    wait(random_() % 10);
    filters_.cancel(client_);
  }
  while (filters_.computing() || filters_.applying()) wait(1);
  press(u_, v_, false);
  return leaves ? "filter, cancelled" : "filter";
}

void HandPlay::apply(const engine::FilterSpec& spec) {
  filters_.spec = spec;
  filters_.apply(client_);
  static_cast<void>(stroke(true));
  while (filters_.computing() || filters_.applying()) wait(1);
}

std::string HandPlay::marks() {
  client_.poll();
  const engine::Version base = client_.upright();
  const engine::Grid& grid = base.grid();
  engine::LiveField field(base, engine::Growth::kAllowed);
  const bool marked = random_() % 3 != 0;
  const auto c0 = static_cast<std::int32_t>(uniform(0, grid.width - 1));
  const auto r0 = static_cast<std::int32_t>(uniform(0, grid.height - 1));
  for (std::int32_t r = r0; r < std::min(r0 + 40, grid.height); ++r)
    for (std::int32_t c = c0; c < std::min(c0 + 30, grid.width); ++c)
      static_cast<void>(field.setMark(c, r, marked));
  // A hand may have worked on meanwhile.
  if (random_() % 2 == 0) wait(5);
  static_cast<void>(client_.change(base, field.snapshot(), marked ? "Lasso" : "Clear"));
  return "marks";
}

std::string HandPlay::lines() {
  client_.poll();
  const engine::Version base = client_.upright();
  const engine::Grid& grid = base.grid();
  engine::EdgeLine line;
  line.id = static_cast<std::int64_t>(random_() % 1000);
  glm::dvec2 at{uniform(0, grid.width - 1), uniform(0, grid.height - 1)};
  for (int i = 0; i < 40; ++i) {
    engine::EdgePoint point;
    point.position = at;
    point.located = i % 5 != 0;
    if (point.located) point.deviation = uniform(0.0, 1.0);
    line.points.push_back(point);
    at += glm::dvec2(uniform(-0.5, 0.9), uniform(-0.2, 1.0));
  }
  const engine::Version changed = base.withLines(
      random_() % 4 == 0 ? nullptr : std::make_shared<const std::vector<engine::EdgeLine>>(1, line));
  if (random_() % 2 == 0) wait(5);
  static_cast<void>(client_.change(base, changed, "Edge line"));
  return "lines";
}

std::string HandPlay::scene() {
  haptic::Scene scene = client_.scene();
  switch (random_() % 5) {
    case 0:
      scene.brush_radius_samples = static_cast<double>(random_() % 9);
      break;
    case 1:
      scene.invert = !scene.invert;
      filters_.cancel(client_);
      break;
    case 2:
      scene.max_change = random_() % 2 == 0 ? std::optional<double>(uniform(0.0, 0.2)) : std::nullopt;
      break;
    case 3:
      scene.effects = {haptic::EffectKind::kSpring, haptic::EffectKind::kSmoothing,
                       haptic::EffectKind::kFriction, haptic::EffectKind::kViscosity};
      break;
    default:
      scene.effects = {haptic::EffectKind::kSpring, haptic::EffectKind::kSmoothing};
      scene.mark_radius_samples = static_cast<double>(random_() % 5);
  }
  static_cast<void>(client_.setScene(scene));  // in range, and a mouse holds anything
  return "scene";
}

std::string HandPlay::form() {
  std::string what = "form put back";
  const auto choice = random_() % 4;
  if (client_.newest().formOver() == nullptr || choice == 0) {
    constexpr engine::FormKind kKinds[] = {engine::FormKind::kPlane,       engine::FormKind::kPolynomial2,
                                           engine::FormKind::kPolynomial3, engine::FormKind::kSphere,
                                           engine::FormKind::kPolynomial5, engine::FormKind::kMean};
    form_.options.kind = kKinds[random_() % std::size(kKinds)];
    form_.options.robust = random_() % 4 == 0;
    form_.options.region = random_() % 4 == 0 ? engine::Region::kUnmarked : engine::Region::kAll;
    // Looked at before: only a step leaves a trace.
    if (form_.options.robust) {
      form_.preview(client_);
      while (form_.busy()) wait(1);
    }
    form_.takeOut(client_);
    what = "form taken out";
  } else if (choice == 1) {
    form_.makeHeights(client_);
    what = "heights made";
  } else {
    form_.putBack(client_);
  }
  // A hand may work on meanwhile.
  if (random_() % 2 == 0) static_cast<void>(stroke(random_() % 2 == 0));
  while (form_.busy()) wait(1);
  form_.dropPreview();
  return what;
}

std::string HandPlay::heights() {
  const bool fills = random_() % 2 == 0, removes = random_() % 4 == 0;
  heights_.fill.method = random_() % 2 == 0 ? engine::FillMethod::kMembrane : engine::FillMethod::kCurvature;
  heights_.lines.method = static_cast<engine::LineMethod>(random_() % 4);
  heights_.lines.degree = heights_.lines.method == engine::LineMethod::kPolynomial ? 1 : 0;
  heights_.lines.axis = random_() % 2 == 0 ? engine::ScanAxis::kX : engine::ScanAxis::kY;
  // Some of the surface, so that holes come and go; or what is marked.
  const engine::HeightBounds bounds = client_.newest().reader().bounds();
  heights_.remove = {.low = bounds.min, .high = bounds.min + 0.02 * (bounds.max - bounds.min)};
  if (removes && random_() % 2 == 0)
    heights_.removeSamples();
  else if (removes)
    heights_.removeMarked();
  else if (fills)
    heights_.fillHoles();
  else
    heights_.levelLines();
  wait(1);
  // A hand may work on meanwhile; what it left open would be waited for.
  if (random_() % 2 == 0) static_cast<void>(stroke(true));
  press(u_, v_, false);
  while (heights_.busy()) wait(1);
  return removes ? "samples removed" : fills ? "holes filled" : "lines levelled";
}

void HandPlay::make(const haptic::HeightsMaker& maker) {
  if (const auto* fill = std::get_if<engine::FillOptions>(&maker)) {
    heights_.fill = *fill;
    heights_.fillHoles();
  } else if (const auto* remove = std::get_if<engine::RemoveOptions>(&maker)) {
    heights_.remove = *remove;
    heights_.removeSamples();
  } else {
    heights_.lines = std::get<engine::LineOptions>(maker);
    heights_.levelLines();
  }
  while (heights_.busy()) wait(1);
}

void HandPlay::takeOutPlane() {
  form_.options = {};
  form_.takeOut(client_);
  while (form_.busy()) wait(1);
}

void HandPlay::makeHeights() {
  form_.makeHeights(client_);
  while (form_.busy()) wait(1);
}

std::string HandPlay::act() {
  if (random_() % 8 == 0) return form();
  if (random_() % 12 == 0) return heights();
  const auto what = random_() % 16;
  if (what < 6) return stroke(true);
  if (what < 7) return stroke(false);
  if (what < 9) return filter(false);
  if (what < 10) return filter(true);
  if (what < 11) return random_() % 2 == 0 ? marks() : lines();
  if (what < 12) return scene();
  if (what < 14) {
    client_.undo();
    if (random_() % 2 == 0) wait(random_() % 4);
    return "undo";
  }
  if (what < 15) {
    client_.redo();
    return "redo";
  }
  const engine::History& history = client_.history();
  client_.goTo(std::uniform_int_distribution<std::int64_t>(history.first(), history.last())(random_));
  return "go to a state";
}

void HandPlay::untilKept() {
  while (keeper_.waiting() != 0) wait(1);
}

void HandPlay::settle() {
  press(u_, v_, false);
  while (filters_.computing() || filters_.applying()) wait(1);
  client_.setTool(Tool::kFeel);
  wait(20);
}

}  // namespace fettle::tests

// record_session FILE [large]
// Two loops of a session: a stroke that smooths at level paper, then two with a ball among needles, with their journal as a window
// keeps it. Of each contact revision one is in sessions/. With "large", two strokes with the largest ball over needles on every
// second sample, whose searches are the dearest; sessions/ has it of revision 4, whose ticks were bounded by searches alone.
// Prints the revision, ticks and steps, and the hash of the field.

#include <cmath>
#include <cstdio>
#include <string>

#include "engine/session/session.h"
#include "haptic/journal/recorder.h"
#include "haptic/loop/loop_player.h"
#include "tests/haptic/support/fields.h"

using namespace fettle;

namespace {

constexpr double kSpacingMm = 0.1;
constexpr double kRadiusMm = 2.0 * kSpacingMm;

// Noise on steps, and needles 120 cells high, from which a ball of contact revision 3 does not come down in a tick.
engine::Version needles() {
  std::mt19937_64 random(7);
  return tests::fieldOf(
      56, 40,
      [&](int c, int r) {
        const double needle = c % 7 == 3 && r % 5 == 2 ? 120.0 * kSpacingMm : 0.0;
        return needle + 0.2 * ((c / 14) % 2) + 0.02 * tests::uniform(random, -1.0, 1.0);
      },
      kSpacingMm, kSpacingMm);
}

engine::Version needlesClose() {
  std::mt19937_64 random(8);
  return tests::fieldOf(
      72, 64,
      [&](int c, int r) {
        const double needle =
            c % 2 == 1 && r % 2 == 1 ? tests::uniform(random, 20.0, 120.0) * kSpacingMm : 0.0;
        return needle + 0.02 * tests::uniform(random, -1.0, 1.0);
      },
      kSpacingMm, kSpacingMm);
}

class Recording {
 public:
  explicit Recording(engine::Version original) {
    session_.original = std::move(original);
    session_.history = engine::History(session_.original);
  }

  // A loop with this scene, from the state at which the one before ended.
  void begin(const haptic::Scene& scene) {
    auto loop = haptic::LoopPlayer::create(session_.history.current(), session_.original, scene);
    if (!loop) return fail(loop.error());
    loop_ = *std::move(loop);
    haptic::journal::Begin entry;
    entry.state = session_.history.number();
    entry.scene = scene;
    recorder_.add(entry);
    session_.notes = {{"scene", haptic::sceneText(scene)},
                      {"contact", std::to_string(haptic::kContactRevision)}};
  }

  // From one place to another, at a height below the surface, above it at both ends.
  void stroke(glm::dvec2 from, glm::dvec2 to, double z_mm, int ticks) {
    constexpr int kAway = 20;
    for (int i = -kAway; i < ticks + kAway; ++i) {
      const double t = std::clamp(static_cast<double>(i) / ticks, 0.0, 1.0);
      const bool away = i < 0 || i >= ticks;
      const glm::dvec2 at = from + t * (to - from) + glm::dvec2(0.0, kSpacingMm * std::sin(9.0 * t));
      tick({at.x, at.y, z_mm + (away ? 20.0 : 0.0)}, away ? haptic::Tool::kFeel : haptic::Tool::kSmooth);
    }
    if (failed_) return;
    engine::StepInfo info;
    info.name = "Smooth";
    static_cast<void>(session_.history.push(info, loop_->field()));
    haptic::journal::StepMade step;
    step.state = session_.history.number();
    step.name = info.name;
    step.at.tick = loop_->ticks();
    recorder_.add(step);
  }

  int save(const std::string& path) {
    session_.journal = recorder_.take();
    for (engine::JournalEntry& entry : session_.journal) entry.state = session_.history.number();
    engine::JobControl job;
    if (!failed_)
      if (auto saved = engine::saveSession(session_, path, job); !saved) fail(saved.error());
    std::printf("contact revision %d, %d ticks, %d steps, %016llx\n", haptic::kContactRevision, ticks_,
                static_cast<int>(session_.history.number()),
                static_cast<unsigned long long>(engine::contentHash(session_.history.current())));
    return failed_ ? 1 : 0;
  }

 private:
  void tick(const glm::dvec3& tip_mm, haptic::Tool tool) {
    if (failed_) return;
    const haptic::StrokeSample input{1e-3 * static_cast<double>(loop_->ticks()), tip_mm, tool};
    recorder_.tick(input);
    ++ticks_;
    if (auto run = loop_->run(input); !run) fail(run.error());
  }
  void fail(const engine::Error& error) {
    std::fprintf(stderr, "%s\n", error.line().c_str());
    failed_ = true;
  }

  engine::Session session_;
  haptic::Recorder recorder_;
  std::unique_ptr<haptic::LoopPlayer> loop_;
  int ticks_ = 0;
  bool failed_ = false;
};

}  // namespace

int main(int count, char** arguments) {
  const bool large = count == 3 && std::string(arguments[2]) == "large";
  if (count != 2 && !large) return 2;
  Recording recording(large ? needlesClose() : needles());
  haptic::Scene scene = haptic::defaultScene();
  if (large) {
    scene.tip = haptic::TipShape::kSphere;
    scene.tip_radius_mm = 16.0 * kSpacingMm;
    recording.begin(scene);
    recording.stroke({2.0, 2.2}, {5.1, 3.4}, 5.0, 60);
    recording.stroke({4.9, 2.7}, {2.0, 2.9}, 5.0, 30);
    return recording.save(arguments[1]);
  }
  recording.begin(scene);
  recording.stroke({0.3, 0.5}, {4.9, 1.5}, -0.05, 200);
  scene.tip = haptic::TipShape::kSphere;
  scene.tip_radius_mm = kRadiusMm;
  recording.begin(scene);
  recording.stroke({0.3, 2.2}, {5.1, 3.4}, 0.1, 400);
  recording.stroke({4.9, 2.7}, {1.0, 2.9}, 0.1, 160);
  return recording.save(arguments[1]);
}

// What a tick is heard as. Follows van den Doel, Kry, Pai, "FoleyAutomatic: physically-based sound effects for interactive simulation
// and animation" (2001): contact as a source of three sounds - the profile of the surface passed at the speed of the contact, impacts,
// and friction that slips - which haptic/sound makes audible. Here the tick only measures them.
// Cost per tick in contact: 16 bilinear heights while the contact point moves; with texture as many of its relief. It gives no force.
#include <algorithm>
#include <cmath>
#include <memory>

#include <glm/geometric.hpp>

#include "haptic/effects/effect.h"
#include "haptic/effects/texture.h"

namespace fettle::haptic {

namespace {

// A way that is longer in one tick is a jump of the contact point. Above it no rise is read, so that a tick is bounded to samples near the
// proxy, which those of a field in a store are (TilePrefetcher).
constexpr double kLongestWay_cells = 64.0;
constexpr double kSteepest =
    1e6;  // cells of rise or per second: far beyond what is heard as full, and a float

class SoundSource {
 public:
  SoundSource(double cell_mm, const TextureTable* relief) noexcept : cell_mm_(cell_mm), relief_(relief) {}

  void run(const TickState& state) noexcept {
    tick_ = {};
    const double dt_s = state.t_s - t_s_;
    const bool steady = dt_s > 0.0 && dt_s <= VelocityFilter::kLongestGap_s;
    if (state.contact.touching) {
      touch(state, steady ? dt_s : 0.0);
    } else {
      known_ = false;
    }
    touching_ = state.contact.touching;
    t_s_ = state.t_s;
    endpoint_mm_ = state.endpoint_mm;
    moved_ = true;
  }

  void reset(ResetCause why) noexcept {
    known_ = false;
    if (why != ResetCause::kInputLost) return;
    // Such a tick calls no effect.
    tick_ = {};
    touching_ = false;
    moved_ = false;
  }

  [[nodiscard]] const SoundTick& tick() const noexcept { return tick_; }

 private:
  void touch(const TickState& state, double dt_s) noexcept {
    tick_.contact = true;
    const double press_n = glm::length(state.press_n);
    tick_.strength = part(press_n, state.force_limit_n);
    tick_.slipping = state.slipping;
    tick_.released = part(state.released_n, state.force_limit_n);
    if (!touching_ && moved_ && dt_s > 0.0)
      tick_.approach_cells_s = towards(state.endpoint_mm, state.contact.penetration_mm, dt_s);
    const glm::dvec3& proxy = state.contact.proxy.position_mm;
    if (known_ && dt_s > 0.0) passOver(state.surface, proxy, dt_s);
    proxy_mm_ = proxy;
    known_ = true;
  }

  // Negated comparisons: NaN counts as none.
  [[nodiscard]] static float part(double value, double of) noexcept {
    return !(value > 0.0) ? 0.0F : static_cast<float>(std::min(value / of, 1.0));
  }

  [[nodiscard]] float towards(const glm::dvec3& endpoint_mm, const glm::dvec3& penetration_mm,
                              double dt_s) const noexcept {
    const double depth_mm = glm::length(penetration_mm);
    if (!(depth_mm > 0.0)) return 0.0F;
    const double speed_mm_s = glm::dot(endpoint_mm_ - endpoint_mm, penetration_mm) / (depth_mm * dt_s);
    return speed_mm_s > 0.0 ? static_cast<float>(std::min(speed_mm_s / cell_mm_, kSteepest)) : 0.0F;
  }

  void passOver(Surface& surface, const glm::dvec3& proxy, double dt_s) noexcept {
    const glm::dvec3 way = proxy - proxy_mm_;
    const double cells = std::sqrt(way.x * way.x + way.y * way.y) / cell_mm_;
    // Down a vertical wall the point moves without a way in plan, and makes no sound.
    if (!(cells > 0.0 && cells <= kLongestWay_cells)) return;
    tick_.speed_cells_s = static_cast<float>(cells / dt_s);
    double before = heightAt(surface, proxy_mm_);
    for (int i = 0; i < SoundTick::kPieces; ++i) {
      const double now = heightAt(surface, proxy_mm_ + (i + 1.0) / SoundTick::kPieces * way);
      const double rise = (now - before) / cell_mm_;
      // Over a hole nothing is known.
      if (std::isfinite(rise))
        tick_.rise_cells[static_cast<std::size_t>(i)] =
            static_cast<float>(std::clamp(rise, -kSteepest, kSteepest));
      before = now;
    }
  }

  [[nodiscard]] double heightAt(Surface& surface, const glm::dvec3& at) const noexcept {
    CellIndex cell;
    Patch patch;
    if (!surface.cellUnder(at, cell) || !surface.patch(cell, patch)) return NAN;
    const double height = patch.heightAt((at.x - patch.x0) / patch.sx, (at.y - patch.y0) / patch.sy);
    return relief_ == nullptr ? height : height + relief_->at(at.x, at.y).height_mm;
  }

  double cell_mm_;
  const TextureTable* relief_;
  SoundTick tick_;
  bool touching_ = false;  // in the last tick
  bool known_ = false;     // proxy_mm_ is that of the last tick, on the same field
  bool moved_ = false;     // t_s_ and endpoint_mm_ are those of the last tick
  double t_s_ = 0.0;
  glm::dvec3 endpoint_mm_{0.0};
  glm::dvec3 proxy_mm_{0.0};
};

void runSound(void* data, TickState& state) noexcept {
  static_cast<SoundSource*>(data)->run(state);
}
void resetSound(void* data, ResetCause why) noexcept {
  static_cast<SoundSource*>(data)->reset(why);
}

}  // namespace

void addSound(EffectList& list, const EffectSource& from) {
  const engine::Grid& grid = from.now.grid();
  SoundSource& sound =
      addData(list, EffectKind::kSound,
              std::make_shared<SoundSource>(
                  std::max(grid.spacingXMm(), grid.spacingYMm()),
                  from.scene.lists(EffectKind::kTexture) ? &needRelief(list, from.scene) : nullptr));
  // After everything that a tick does, in free space too.
  list.upkeep.push_back({&runSound, &sound});
  list.resets.push_back({&resetSound, &sound});
  list.sound = &sound.tick();
}

}  // namespace fettle::haptic

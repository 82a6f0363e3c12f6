#include <algorithm>
#include <array>
#include <cmath>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

namespace {

// IEC 61966-2-1.
double linearOf(std::uint8_t code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
std::uint8_t codeOf(double linear) {
  const double c = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(c, 0.0, 1.0)));
}

}  // namespace

// A quad's picture is upright in its x and y, it is seen from +z alone, and its opacity counts where its flags say so
// (specification 1.0, 10.6.4 and 10.6.7). What lies in front of it in an earlier layer does not hide it.
void composeQuad(const XrCompositionLayerQuad& quad, const XrPosef& pose, const Pixels& picture,
                 const XrPosef& eye, const XrFovf& fov, Pixels& seen) {
  const XrPosef eye_in_quad = times(inverse(pose), eye);
  const bool blends = (quad.layerFlags & XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT) != 0;
  const bool plain = (quad.layerFlags & XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT) != 0;
  const XrVector3f from = eye_in_quad.position;
  if (from.z <= 0.0F || picture.rgba.empty()) return;
  const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
  const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
  for (int y = 0; y < seen.height; ++y)
    for (int x = 0; x < seen.width; ++x) {
      const float across =
          left + (right - left) * (static_cast<float>(x) + 0.5F) / static_cast<float>(seen.width);
      const float upwards =
          up + (down - up) * (static_cast<float>(y) + 0.5F) / static_cast<float>(seen.height);
      const XrVector3f along = turned(eye_in_quad.orientation, {across, upwards, -1.0F});
      if (along.z >= 0.0F) continue;
      const float times = -from.z / along.z;
      const float u = (from.x + times * along.x) / quad.size.width + 0.5F;
      const float v = 0.5F - (from.y + times * along.y) / quad.size.height;
      if (!(u >= 0.0F && u < 1.0F && v >= 0.0F && v < 1.0F)) continue;
      const auto column = static_cast<std::size_t>(u * static_cast<float>(picture.width));
      const auto row = static_cast<std::size_t>(v * static_cast<float>(picture.height));
      const std::uint8_t* of = &picture.rgba[4 * (row * static_cast<std::size_t>(picture.width) + column)];
      std::uint8_t* to = &seen.rgba[4 * static_cast<std::size_t>(y * seen.width + x)];
      const double opacity = blends ? of[3] / 255.0 : 1.0;
      for (int c = 0; c < 3; ++c)
        to[c] =
            codeOf((blends && !plain ? 1.0 : opacity) * linearOf(of[c]) + (1.0 - opacity) * linearOf(to[c]));
    }
}

}  // namespace fettle::tests::xr

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/field/version.h"

namespace fettle::render {

/// The projection of space to the picture.
enum class Projection {
  kOrthographic,  ///< parallel lines stay parallel; lengths can be measured with the scale bar
  kPerspective,   ///< 35 degrees up and down; the scale bar then holds at the middle of the field
};

/// View point and scale.
struct View {
  int width = 1280;  ///< picture, pixels, kSmallestPicture .. kLargestPicture
  int height = 800;  ///< picture, pixels, kSmallestPicture .. kLargestPicture
  /// Turn of the camera about the vertical [degree], any finite value. 0 is at the low-y side and looks along
  /// +y, so that x runs to the right as on a map; positive turns the camera counter-clockwise seen from above
  /// (90 is at the high-x side). 315 is at the corner x, y lowest.
  double azimuth_deg = 315.0;
  /// Height of the camera above the horizon [degree], 0 .. 90; 0 looks from the side, along the horizon, 90
  /// straight down, like a map.
  double elevation_deg = 45.0;
  /// 1 shows the whole field; 2 shows it twice as large, and so on; > 0, finite.
  double zoom = 1.0;
  /// Centre of the picture, as a fraction of the field's extent from its first column and row: 0.5, 0.5 is
  /// the middle of the field. Finite; at most a hundred times the longer side of the field away from there.
  double centre_x = 0.5;
  double centre_y = 0.5;
  /// Its height above the middle of the block that is drawn, exaggeration included, as a share of the field's
  /// longer side: a flat field has no height of its own to count in. -100 .. 100.
  double centre_z = 0.0;
  Projection projection = Projection::kOrthographic;
  /// Factor on heights in the picture (never on the numbers); > 0, or 0 to choose a round factor that makes
  /// the relief readable. The factor used is written into the picture unless it is 1.
  double vertical_exaggeration = 0.0;
  friend bool operator==(const View&, const View&) = default;
};

/// Colours of heights or deviations. Every map states its source in render/plan/colour_map.h.
enum class ColourMap {
  kAuto,       ///< viridis for heights, diverging for deviations
  kViridis,    ///< perceptually even, safe for colour-blind eyes
  kCividis,    ///< the same, and nearly identical to all kinds of colour vision
  kGrey,       ///< even steps of lightness
  kDiverging,  ///< blue - white - red, white at the middle of the range
};

enum class MarksOverlay {
  kHide,
  kShow,  ///< marked samples tinted, the tint's opacity in PictureSpec::marks_opacity
};

/// How marked samples are shown.
enum class MarksLook {
  kTint,     ///< all of them, over the colours of the values
  kOutline,  ///< those with a neighbour that is not marked: inside, colours say what they say without marks
};

enum class Contours {
  kHide,
  kShow,  ///< lines of equal height, or deviation
};

/// What the surface looks like to be made of.
enum class Material {
  kNone,  ///< matt and in the colours of its values
  kClay,
  kPorcelain,
  kMetal,
  kWax,
};

/// How shading shows the form of the surface. What is off is not in the shader.
struct FormShading {
  /// Normals over the footprint of a pixel (shaders/footprint.glsl) where cells are smaller than one and a
  /// half: otherwise the noise of single samples is what a large scan shows.
  bool filtered_normals = false;
  /// Share of the light that a place loses at most to what stands around it, within some pixels
  /// (shaders/surroundings.glsl), 0 .. 1; 0: off.
  double occlusion = 0.0;
  /// How much darker hollows and brighter ridges are at most, of a few pixels, 0 .. 1; 0: off.
  double cavity = 0.0;
  /// Lit from beside the viewer (shaders/material.glsl), whatever the direction of FrameInput's light.
  Material material = Material::kNone;
  /// Share of the colours of values in that of the material, 0 .. 1. Deviations keep theirs.
  double value_colours = 0.0;
  friend bool operator==(const FormShading&, const FormShading&) = default;
};
/// What the window and pictures for files use unless told otherwise.
inline constexpr FormShading kShownForm{true, 0.7, 0.0};

/// What is drawn around the surface.
enum class Decoration {
  kNone,  ///< surface on its background, nothing else
  kFull,  ///< titles, colour bar, scale bar, legend
};

enum class Theme {
  kLight,  ///< dark text on a light ground
  kDark,   ///< light text on a dark ground
};

/// Highest and lowest value of the colours, in the field's height unit.
struct ValueRange {
  double low = 0.0;
  double high = 0.0;
  friend bool operator==(const ValueRange&, const ValueRange&) = default;
};

/// How values become colours.
struct Colouring {
  ColourMap map = ColourMap::kAuto;
  /// The values in equal steps of one colour each, kColourSteps (render/config.h) from end to end; of deviations with the
  /// middle colour at zero, and beyond a tolerance with one step less on each side.
  bool steps = false;
  /// Deviations of at most this have the middle colour, larger ones differ from it visibly; >= 0 [height_unit];
  /// 0: none do. No effect on heights.
  double tolerance = 0.0;
  /// Between two contour lines, >= 0, finite [height_unit]; 0: at the steps of the colour bar.
  double contour_step = 0.0;
  friend bool operator==(const Colouring&, const Colouring&) = default;
};

/// What the difference of a field from another one is.
struct Difference {
  std::string name = "deviation";  ///< over the colour bar
  /// All of it lies on one side of zero: colours begin there and end at the farthest value, and the map is that of heights.
  bool one_sign = false;
  /// What a sample is that the other field has no height for, in the legend; empty: it is not named there. Such samples are
  /// grey, darker where they are lower.
  std::string without = {};
  friend bool operator==(const Difference&, const Difference&) = default;
};

/// What a picture shows of its fields, and how.
struct PictureSpec {
  View view;
  /// Colours show (field - this) instead of the height, symmetric about zero. Must have the width and height
  /// of all fields. A sample that is a hole in the other alone is grey (Difference::without).
  std::optional<engine::Version> deviation_from;
  Difference difference{};  ///< of the field from that
  /// Range of the colours. Empty: robust, so that single spikes do not use up the colours
  /// (render/plan/value_range.h). For a deviation the larger absolute value of the two ends counts, on both
  /// sides.
  std::optional<ValueRange> range;
  MarksOverlay marks = MarksOverlay::kHide;
  MarksLook marks_look = MarksLook::kTint;
  double marks_opacity = 0.65;  ///< of a tint, 0 .. 1
  Colouring colouring{};
  Contours contours = Contours::kHide;
  Decoration decoration = Decoration::kFull;
  Theme theme = Theme::kLight;
};

/// 8 bits per channel, sRGB-encoded, row 0 on top, no padding; 4 * width * height bytes, alpha 255.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

enum class Validation {
  kOff,
  kOn,  ///< load VK_LAYER_KHRONOS_validation and collect its messages; an error when it is not installed
};

enum class DriverKind {
  kAny,
  kHardware,  ///< none that runs on the processor itself, as lavapipe does
};

/// Which Vulkan device draws or computes.
struct DeviceOptions {
  Validation validation = Validation::kOff;
  /// Use the device whose name, with that of its driver, contains this text (upper and lower case alike); empty: the best suitable one.
  std::string device{};
  DriverKind kind = DriverKind::kAny;
};

}  // namespace fettle::render

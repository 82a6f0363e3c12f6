#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::render {

/// How space is laid on the picture.
enum class Projection {
  kOrthographic,  ///< parallel lines stay parallel; lengths can be read off with the scale bar
  kPerspective,   ///< 35 degrees up and down; the scale bar then holds at the middle of the field
};

/// From where, and how large.
struct View {
  int width = 1280;  ///< picture, pixels, 16 .. 16384
  int height = 800;  ///< picture, pixels, 16 .. 16384
  /// Turn of the camera about the vertical [degree], any finite value. 0 stands at the low-y side and looks
  /// along +y, so that x runs to the right as on a map; positive turns the camera counter-clockwise seen from
  /// above (90 stands at the high-x side). 315 stands at the corner x, y lowest.
  double azimuth_deg = 315.0;
  /// Height of the camera above the horizon [degree], > 0 .. 90; 90 looks straight down, like a map.
  double elevation_deg = 45.0;
  /// 1 shows the whole field; 2 shows it twice as large, and so on; > 0, finite.
  double zoom = 1.0;
  /// What the middle of the picture shows, as a fraction of the field's extent from its first column and row:
  /// 0.5, 0.5 is the middle of the field. Finite.
  double centre_x = 0.5;
  double centre_y = 0.5;
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

enum class Contours {
  kHide,
  kShow,  ///< lines of equal height at the steps of the colour bar
};

/// The furniture around the surface.
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

/// Everything a picture depends on. The same spec gives the same picture.
struct PictureSpec {
  View view;
  engine::Version field;  ///< not empty
  /// Drawn to the right of `field` with the same camera and the same colours. Its grid may differ.
  std::optional<engine::Version> compare;
  /// Colours show (field - this) instead of the height, symmetric about zero, for `field` and for `compare`.
  /// Must have the width and height of both. A sample that is a hole in either is drawn as no-data.
  std::optional<engine::Version> deviation_from;
  /// Colours' range. Empty: robust, so that single spikes do not eat the colours (render/plan/value_range.h).
  /// For a deviation the larger absolute value of the two counts, on both sides.
  std::optional<ValueRange> range;
  MarksOverlay marks = MarksOverlay::kHide;
  double marks_opacity = 0.65;  ///< 0 .. 1
  ColourMap map = ColourMap::kAuto;
  Contours contours = Contours::kHide;
  Decoration decoration = Decoration::kFull;
  Theme theme = Theme::kLight;
  std::string title_left;   ///< above the field; UTF-8; cut with an ellipsis when too long
  std::string title_right;  ///< above `compare`
  /// Rays per pixel along each side, 1 .. 4: 2 smooths edges and speckle at four times the fragment work.
  int samples_per_side = 2;
  /// Smallest cell drawn as geometry [ray spacings], 0.5 .. 64. Cells smaller than that are skipped over by a
  /// power of two in each direction; colours, marks, holes and shading still come from the exact samples.
  double cell_px = 2.0;
};

/// What making a picture took.
struct PictureReport {
  int width = 0;
  int height = 0;
  std::string device;               ///< name of the Vulkan device and its driver
  double frame_ms = 0.0;            ///< drawing alone: record, draw, wait; uploads and read-back not counted
  double upload_ms = 0.0;           ///< bringing changed tiles to the device
  double read_ms = 0.0;             ///< bringing the picture back
  std::int64_t tiles_uploaded = 0;  ///< 64 x 64 tiles of heights, plus tiles of marks
  std::int64_t bytes_uploaded = 0;  ///< samples and marks, not the few bytes of parameters
  std::int64_t patches = 0;         ///< surface patches drawn
  std::int64_t vertices = 0;        ///< vertices the device was asked for
  ValueRange range;                 ///< colours' range used [height_unit]
  double vertical_exaggeration = 1.0;
  /// What the validation layers said since the renderer was made; empty when silent or not asked for.
  std::vector<std::string> validation_messages;
  std::vector<std::string> warnings;  ///< e.g. text that had no room
};

/// 8 bits a channel, sRGB-encoded, row 0 on top, no padding; 4 * width * height bytes, alpha 255.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

enum class Validation {
  kOff,
  kOn,  ///< load VK_LAYER_KHRONOS_validation and collect what it says; an error when it is not installed
};

struct RendererOptions {
  Validation validation = Validation::kOff;
  /// Use the device whose name holds this text (upper and lower case alike); empty: the best that will do.
  std::string device;
  /// Longest side of one image in samples, rounded up to a tile; 0: what the device offers. Fields past it
  /// are spread over the layers of an image array. For tests of exactly that.
  int max_image_side = 0;
  /// How long one piece of drawing should take [ms], > 0: cancelling is seen, and progress told, between two
  /// of them. Pieces adapt to it and may take a few times as long; infinity draws each kind of thing at once.
  /// The pixels do not depend on it.
  double piece_ms = 50.0;
};

/// Draws height fields off-screen. Keeps the fields it drew on the device, so that the next picture of a
/// later version uploads only the tiles in which the two differ.
///
/// Threading: one thread at a time. Determinism: on one machine with one driver, the same spec gives the same
/// bits whatever was drawn before (measured on Mesa lavapipe 22.3.6); between drivers, pictures differ.
class Renderer {
 public:
  /// Errors (ErrorKind::kFailed): no Vulkan loader, driver or suitable device - the line says why each device
  /// found was rejected and what to install; validation layers asked for but not installed.
  [[nodiscard]] static engine::Result<std::unique_ptr<Renderer>> create(const RendererOptions& options = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws `spec` into `out` (resized). Progress counts tiles uploaded, then pieces of drawing. On an error
  /// `out` is unchanged. Cancelling stops a drawing under way after the piece at work (RendererOptions).
  /// Errors: kInput for a spec outside the ranges stated above or grids that do not fit each
  /// other; kFailed for a field larger than the device can hold, memory exhausted, a lost device; kCancelled.
  [[nodiscard]] engine::Result<PictureReport> render(const PictureSpec& spec, Image& out,
                                                     engine::JobControl& job);

  /// Name of the device and its driver, as in the report.
  [[nodiscard]] const std::string& device() const noexcept;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Writes 8-bit RGBA PNG with an sRGB chunk: whole or not at all (temporary file, fsync, rename).
/// Errors: kInput when the path cannot be written, kFailed when the disk is full.
[[nodiscard]] engine::Status writePng(const Image& image, const std::string& path);

/// Reads any PNG as 8-bit RGBA. Errors: kInput for a file that cannot be read, is no PNG, is cut short, or
/// has more than 2^28 pixels.
[[nodiscard]] engine::Result<Image> readPng(const std::string& path);

}  // namespace fettle::render

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/config.h"
#include "render/plan/camera.h"
#include "render/plan/picture.h"
#include "render/plan/stereo.h"
#include "render/residency/upload_statistics.h"

namespace fettle::render {

class Context;
struct LiveTarget;  // render/vulkan/live_target.h: an image to draw to and who waits for whom

/// How several versions share the picture. One camera serves them all.
enum class Arrangement {
  kSideBySide,  ///< each in a plot of its own: a row of up to three, or two rows
  kSplit,       ///< the first two in one plot, a line between them: the first to the left of it
};

/// A straight piece of an overlay, in field millimetres (heights times the height unit, without exaggeration,
/// sign of the version applied). The same point twice is a disc.
struct OverlayLine {
  glm::dvec3 from_mm{0.0};
  glm::dvec3 to_mm{0.0};
  glm::vec3 colour{1.0F, 1.0F, 1.0F};  ///< linear red, green, blue
  float opacity = 1.0F;                ///< 0 .. 1
  float width_px = 2.0F;               ///< > 0; ends are round
  enum class Depth {
    kOnTop,    ///< seen through the surface
    kInScene,  ///< hidden by what lies before it
  } depth = Depth::kOnTop;
};

/// What is drawn over every panel.
struct Overlays {
  std::vector<OverlayLine> lines;
  /// A circle on the first version's surface: where the brush will work. Follows the heights; parts over
  /// holes or beside the field are left out.
  struct Ring {
    double x_mm = 0.0, y_mm = 0.0;  ///< field coordinates
    double radius_mm = 1.0;
    glm::vec3 colour{1.0F, 1.0F, 1.0F};
    float width_px = 2.0F;
  };
  std::vector<Ring> rings;
};

/// What a haptic device does, as overlay lines: endpoint (disc), proxy (disc), the line between them (tip),
/// force (arrow from the proxy, `mm_per_newton` long a newton).
struct StylusState {
  glm::dvec3 endpoint_mm{0.0};
  glm::dvec3 proxy_mm{0.0};
  glm::dvec3 force_n{0.0};
  bool contact = false;
  double tip_radius_mm = 0.0;  ///< of a ball tip; 0 for a point
};
void appendStylus(const StylusState& state, double mm_per_newton, std::vector<OverlayLine>& out);

/// What the panels show. A version that grew out of the one shown before costs only what differs.
struct Shown {
  std::vector<engine::Version> versions;    ///< 1 .. 5, not empty; their grids may differ
  std::optional<engine::Version> original;  ///< colours show version - original; width and height of all
  MarksOverlay marks = MarksOverlay::kHide;
  /// Of the first version's marks those that this state of the same field lacks are only suggested, and drawn
  /// in a colour of their own.
  std::optional<engine::Version> accepted{};
};

/// How finely the surface is drawn.
enum class Sharpness {
  kFull,  ///< every pixel
  kHalf,  ///< every second pixel each way, in between interpolated: while the camera moves. Decorations and
          ///< overlay lines on top are as sharp as ever, and the next frame of kFull is bit-identical to what
          ///< it would be without this one
  kFine,  ///< four rays a pixel, of which it takes the mean light: for pictures that are drawn once.
          ///< Decorations and overlay lines on top as ever
};

/// What may change every frame without anything being uploaded.
struct FrameInput {
  View view;  ///< width and height are the target's, unless `part` says which part of the picture that is
  /// Draws this part of the picture alone, of which `view` has the size [px]: the target is as large as the
  /// part. Of whole squares of 2 x 2 pixels, except where the picture ends: fragments compare themselves with
  /// their neighbours in those. Such a part equals that of the picture drawn as one but for the rounding of
  /// single precision about another middle. Side by side in stereo: of either eye's picture, of which `view`
  /// has the size; the target is twice as wide as the part.
  std::optional<Rectangle> part;
  Arrangement arrangement = Arrangement::kSideBySide;
  double split = 0.5;  ///< of kSplit: where the line stands, as a fraction of the plot's width, 0 .. 1
  Contours contours = Contours::kHide;
  double marks_opacity = 0.65;
  ColourMap map = ColourMap::kAuto;
  Theme theme = Theme::kDark;
  Decoration decoration = Decoration::kFull;
  double furniture_scale = 0.0;     ///< of its text and bars, see layOut; 0: by the picture's size
  std::vector<std::string> titles;  ///< one a version, or none
  /// Colours' range [height_unit]; empty: robust, worked out when a field or an original is first shown and
  /// kept until refreshRanges(), so that colours do not swim while a brush works.
  std::optional<ValueRange> range;
  /// Where the light comes from, relative to the picture: azimuth counter-clockwise from the picture's right
  /// [degree], and height above the field [degree, 5 .. 90]. 135, 45 = upper left.
  double light_azimuth_deg = 135.0;
  double light_elevation_deg = 45.0;
  Overlays overlays;
  /// A picture for each eye. Off: nothing of it is made. Bounds hold for each eye's picture.
  Stereo stereo;
  /// Screen error wanted [px], > 0. What is reached is in FrameStatistics::bound_px.
  double error_px = kFrameErrorPx;
  Sharpness sharpness = Sharpness::kFull;
  /// Whether what cannot have changed since the last frame is left as it is: the picture is the same either
  /// way, to the bit.
  enum class Redraw { kChanged, kAll } redraw = Redraw::kChanged;
  /// Of a field by need: whether the frame is drawn with the pages that are there, or waits for all that it
  /// asks for and that the memory holds.
  enum class Pages { kAsTheyCome, kAll } pages = Pages::kAsTheyCome;
  /// Vertices a frame may cost, all panels together, kFewestFrameVertices .. kMostFrameVertices.
  std::int64_t vertex_budget = kFrameVertices;
  /// Vertices that each panel may take, 1 .. kMostFrameVertices, one number a panel; empty: equal shares of vertex_budget.
  std::vector<std::int64_t> panel_vertices;
};

/// A field of which the finer samples are on the device by need: any of more than a few million samples.
struct ResidencyStatistics {
  bool by_need = false;            ///< false: all is there, and the rest of this stays zero
  std::int64_t device_bytes = 0;   ///< of the pool of pages, full or not
  std::int64_t pages = 0;          ///< that the pool holds
  std::int64_t pages_used = 0;     ///< with something in them
  std::int64_t pages_asked = 0;    ///< this frame asked for, of levels that come by need
  std::int64_t pages_loaded = 0;   ///< brought with this frame
  std::int64_t pages_waiting = 0;  ///< come with the next ones; drawn coarser meanwhile, as bound_px says
  std::int64_t pages_beyond = 0;   ///< do not fit while the others are asked for; drawn coarser
};

/// What keeps a panel from being drawn within FrameInput::error_px.
enum class DetailLimit {
  kNone,      ///< nothing: it is
  kUnderWay,  ///< pages that come with the next frames
  kMemory,    ///< pages that do not fit into the device memory allowed
  kVertices,  ///< the number of vertices allowed
};

/// How near the surface drawn in a panel lies to the one at full resolution.
struct PanelDetail {
  double bound_px = 0.0;  ///< as FrameStatistics::bound_px, of this panel
  DetailLimit limit = DetailLimit::kNone;
};

struct FrameStatistics {
  std::int64_t patches = 0;
  std::int64_t vertices = 0;   ///< surface, skirts, walls
  std::int64_t triangles = 0;  ///< without the joints of area zero
  /// On the screen, no point of the surface at full resolution lies farther than this from the surface drawn,
  /// nor the other way round [px]. At most error_px where the budget allowed it. See render/detail/detail.h.
  double bound_px = 0.0;
  std::vector<PanelDetail> panels;  ///< of each panel; bound_px is the largest of theirs
  double redrawn = 1.0;             ///< share of the plots that was drawn anew, 0 .. 1
  /// Went on from the frame before and drew what differs, which may be everything.
  bool continued = false;
  bool within_budget =
      true;                 ///< false: refining stopped because of the vertices allowed, bound_px > error_px
  UploadStatistics upload;  ///< since the last frame
  ResidencyStatistics residency;
  double select_ms = 0.0;   ///< choosing the patches
  double record_ms = 0.0;   ///< everything else on this thread, waiting not counted
  double wait_ms = 0.0;     ///< waiting for the frame before the last one: the device is behind
  double device_ms = -1.0;  ///< from submission to done, of the last frame known to be done; -1: none yet
  ValueRange range;
  double vertical_exaggeration = 1.0;
  double pixels_per_mm = 1.0;         ///< at the middle of the picture
  std::vector<std::string> warnings;  ///< e.g. text that had no room
};

/// A point of the surface under a place of the picture.
struct Picked {
  int panel = 0;
  glm::dvec3 position_mm{0.0};  ///< field coordinates; z on the bilinear surface, as contact feels it
  std::int32_t column = 0;      ///< cell, by its lower-left sample
  std::int32_t row = 0;
};

struct LiveOptions {
  Validation validation = Validation::kOff;
  std::string device;  ///< as DeviceOptions
  /// Longest side of one image in samples, rounded up to a tile; 0: what the device offers. Fields past it
  /// are spread over the layers of an image array. For tests of exactly that.
  int max_image_side = 0;
  /// Bytes moved a frame at most while an edit or a filter result comes over; the rest waits for the next
  /// one.
  std::int64_t upload_bytes_a_frame = kUploadBytesAFrame;
  /// Device memory that the samples of all versions, of the original and their marks may take [bytes]; 0:
  /// half of the largest heap of the device's own memory. What takes more than that or than kWholeBytes
  /// (render/config.h), or is larger than the device's images, is there by need: coarse copies
  /// always, finer samples in pages where the view asks for them, within upload_bytes_a_frame. Frames after a
  /// move may be coarser then than error_px; FrameStatistics says so. Once by need, versions of the same
  /// field stay so.
  std::int64_t memory_budget_bytes = 0;
};

/// A field that changes, drawn many times a second.
///
/// Cost follows the screen. Each frame chooses square patches of kPatchCells x kPatchCells cells, each with
/// its own stride, coarse where that shows less than `error_px`, by measured deviations
/// (render/detail/detail.h). Where patches of different strides meet, a seam closes the gap: a strip between
/// the two edges that overlaps both by a quarter of a pixel on the screen, so that no ray passes between,
/// straight down included. A coarse cell that stands in for a wall takes colour and light from the height it
/// is drawn at.
///
/// Uploads go through a persistently mapped ring and wait for nothing: the frames in flight read the image as
/// it was, the next one as it is. Only the rectangle of each changed tile moves, with copies of every 4th,
/// 16th and 64th sample (7 % more) that far views are drawn from, so that memory traffic follows the screen
/// as well.
///
/// While camera and options stand still, a frame draws anew only the rectangle of each panel that what
/// changed in the field can be seen in (render/detail/damage.h), and overlays alone move over the shaded
/// surface for nothing.
///
/// Threading: one thread at a time, the same as whoever presents. Determinism: on one machine with one
/// driver, the same input gives the same bits whatever was drawn before (measured on Mesa lavapipe 22.3.6);
/// between drivers, pictures differ.
class LivePicture {
 public:
  /// Off-screen, with a context of its own. Errors (kFailed) as Context::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<LivePicture>> create(const LiveOptions& options = {});
  /// Draws to images of somebody's own (a window): `colour_format` is a VkFormat, and `context` outlives
  /// this.
  [[nodiscard]] static engine::Result<std::unique_ptr<LivePicture>> create(Context& context,
                                                                           std::uint32_t colour_format,
                                                                           const LiveOptions& options = {});
  ~LivePicture();
  LivePicture(const LivePicture&) = delete;
  LivePicture& operator=(const LivePicture&) = delete;

  /// From now on frames show this. The first time, or when the field is not related to the one before, its
  /// coarse copies (8 MiB) are moved before this returns, of a small field all of it; else what differs is
  /// queued and moved with the next frames, within LiveOptions::upload_bytes_a_frame each. Errors: kInput
  /// when versions do not fit each other; kFailed when the device cannot hold them.
  [[nodiscard]] engine::Status update(const Shown& shown);
  /// One version, no original, marks as before.
  [[nodiscard]] engine::Status update(const engine::Version& version);

  /// Uploads what is pending and measures all tiles, however long it takes; pages come with the frames. `job`
  /// advances by uploads. Errors: kCancelled; kFailed as draw().
  [[nodiscard]] engine::Result<UploadStatistics> settle(engine::JobControl& job);

  /// Draws the next frame and returns without waiting for it (two may be in flight). Errors: kInput for an
  /// input out of range; kFailed for a lost device: make a new LivePicture, the field is not touched.
  [[nodiscard]] engine::Result<FrameStatistics> draw(const FrameInput& input, LiveTarget& target);
  /// The same to memory: draws, waits and copies out.
  [[nodiscard]] engine::Result<FrameStatistics> draw(const FrameInput& input, Image& out);
  /// Draws to memory, waits, copies nothing: for measuring.
  [[nodiscard]] engine::Result<FrameStatistics> drawAndWait(const FrameInput& input);

  /// What lies under pixel (x, y) of the last frame: (0, 0) is the top left corner of the picture. By walking
  /// the min/max pyramid along the ray and meeting the bilinear patches exactly, in double precision; works
  /// on the versions given to update(), not on what is uploaded. Empty: ground, hole, or no frame yet. Side
  /// by side, each half is its own eye's; in an anaglyph the place is that on the window, as seen from
  /// between the eyes.
  [[nodiscard]] std::optional<Picked> pick(double x, double y) const;
  /// Where a point of the field is seen in panel `panel` of the last frame [px]; the inverse of pick but for
  /// what hides it. Empty: no such panel. In stereo: as the left eye's picture shows it.
  [[nodiscard]] std::optional<std::pair<double, double>> pixelOf(int panel, const glm::dvec3& field_mm,
                                                                 Eye eye = Eye::kLeft) const;

  /// Works out the colours' and the camera's ranges anew at the next frame.
  void refreshRanges();

  /// Waits until all frames are done.
  void finish();

  [[nodiscard]] const std::string& device() const noexcept;
  /// What the validation layers said so far; only with a context of its own.
  [[nodiscard]] std::vector<std::string> validationMessages() const;

 private:
  struct Impl;
  explicit LivePicture(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render

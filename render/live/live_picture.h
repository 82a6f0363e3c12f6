#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/config.h"
#include "render/plan/camera.h"
#include "render/plan/framing.h"
#include "render/plan/overlay.h"
#include "render/plan/picture.h"
#include "render/plan/stereo.h"
#include "render/plan/stylus_body.h"
#include "render/residency/upload_statistics.h"

namespace fettle::render {

class Context;
struct LiveTarget;  // render/vulkan/live_target.h: an image to draw to, and semaphores

/// How several versions share the picture. All of them use one camera.
enum class Arrangement {
  kSideBySide,  ///< each in a plot of its own: a row of up to three, or two rows
  kSplit,       ///< the first two in one plot, a line between them: the first to the left of it
};

/// A straight piece of an overlay, in field millimetres (heights times the height unit, without exaggeration,
/// sign of the version applied). Two equal points give a disc.
struct OverlayLine {
  glm::dvec3 from_mm{0.0};
  glm::dvec3 to_mm{0.0};
  glm::vec3 colour{1.0F, 1.0F, 1.0F};  ///< linear red, green, blue
  float opacity = 1.0F;                ///< 0 .. 1
  float width_px = 2.0F;               ///< > 0; ends are round
  enum class Depth {
    kOnTop,    ///< visible through the surface
    kInScene,  ///< hidden by the surface in front of it
  } depth = Depth::kOnTop;
  int panel = -1;  ///< the only one that shows it; -1: all do
};

/// What is drawn over every panel.
struct Overlays {
  std::vector<OverlayLine> lines;
  /// A circle on the first version's surface: the area of the brush. Follows the heights; parts over holes or
  /// outside the field are left out.
  struct Ring {
    double x_mm = 0.0, y_mm = 0.0;  ///< field coordinates
    double radius_mm = 1.0;
    glm::vec3 colour{1.0F, 1.0F, 1.0F};
    float width_px = 2.0F;
  };
  std::vector<Ring> rings;
  /// Drawn over lines that the surface hides, under those on top. Costs nothing where there is none.
  std::optional<StylusBody> stylus{};
  /// What the colours of the lines mean: the legend names them. The same one twice is named once.
  std::vector<LineMeaning> meanings{};
};

/// State of a haptic device as overlay lines: the line between endpoint and proxy (tip); where nothing else
/// shows the stylus (Overlays::stylus) a disc at both and a ball's outline; force (arrow from the proxy,
/// `mm_per_newton` long per newton).
struct StylusState {
  glm::dvec3 endpoint_mm{0.0};
  glm::dvec3 proxy_mm{0.0};
  glm::dvec3 force_n{0.0};
  bool contact = false;
  double tip_radius_mm = 0.0;  ///< of a ball tip; 0 for a point
  bool discs = true;           ///< and the ball's outline
  bool arrow = true;
};
void appendStylus(const StylusState& state, double mm_per_newton, std::vector<OverlayLine>& out);

/// What the panels show. For a version derived from the one shown before, only the difference is uploaded.
struct Shown {
  std::vector<engine::Version> versions;  ///< 1 .. 5, not empty; their grids may differ
  std::optional<engine::Version>
      original;             ///< colours show version - original; all must have its width and height
  Difference difference{};  ///< what that is
  MarksOverlay marks = MarksOverlay::kHide;
  /// Marks of the first version that this state of the same field lacks are suggested ones, and are drawn in
  /// another colour.
  std::optional<engine::Version> accepted{};
};

/// Resolution at which the surface is drawn.
enum class Sharpness {
  kFull,  ///< every pixel
  kHalf,  ///< every second pixel in each direction, interpolated in between: while the camera moves. Decorations and overlay lines on top stay at full resolution, and the next frame of kFull is bit-identical to one without this frame before it
  kQuarter,  ///< every fourth pixel in each direction, otherwise as kHalf: while the camera moves and frames of kHalf take too long
  kFine,  ///< four rays per pixel, averaged in linear light: for pictures that are drawn once. Decorations and overlay lines on top as usual
  /// kFull as long as something changes, then kFine, without a long frame: each frame in which nothing of the surface changed
  /// draws one of kRestBands bands of it, and the last one shows it. Lines hidden by the surface are drawn over it as at kFull.
  /// What was drawn at kFull stays, so that an edit still draws only the part that it changes. In stereo: kFull.
  kRest,
};

/// What may change every frame without an upload.
struct FrameInput {
  View view;  ///< width and height are the target's, unless `part` selects a part of the picture
  /// Draws only this part of the picture, of which `view` has the size [px]: the target is as large as the
  /// part. Consists of whole squares of 2 x 2 pixels, except at the end of the picture: fragments compare
  /// themselves with their neighbours in those. Such a part equals that of the picture drawn as one, except
  /// for the rounding of single precision about another middle. Side by side in stereo: of each eye's
  /// picture, of which `view` has the size; the target is twice as wide as the part.
  std::optional<Rectangle> part;
  Arrangement arrangement = Arrangement::kSideBySide;
  double split = 0.5;  ///< of kSplit: position of the line, as a fraction of the plot's width, 0 .. 1
  Contours contours = Contours::kHide;
  FormShading form;
  MarksLook marks_look = MarksLook::kTint;
  double marks_opacity = 0.65;
  Colouring colouring{};
  Theme theme = Theme::kDark;
  Decoration decoration = Decoration::kFull;
  double decoration_scale = 0.0;    ///< of text and bars, see layOut; 0: by the picture's size
  std::vector<std::string> titles;  ///< one per version, or none
  bool titles_in_margin = false;    ///< smaller, in the room that is there without titles
  /// Range of the colours [height_unit]; empty: robust, computed when a field or an original is first shown
  /// and kept until refreshRanges(), so that colours do not change while a brush works.
  std::optional<ValueRange> range;
  /// Direction of the light, relative to the picture: azimuth counter-clockwise from the picture's right
  /// [degree], and height above the field [degree, 5 .. 90]. 135, 45 = upper left.
  double light_azimuth_deg = 135.0;
  double light_elevation_deg = 45.0;
  Overlays overlays;
  /// A picture for each eye; no cost when off. Bounds hold for each eye's picture.
  Stereo stereo;
  /// Of a headset: where the eyes are, left and right, and what they see. Called once a frame, when the device
  /// is free for it, so that the head's place is the latest. The target then has two layers, one for each eye; one version is shown. `view`
  /// gives size, exaggeration and light, and is in perspective. Not together with stereo, part or decorations.
  std::function<std::array<EyeView, 2>(const Framing&)> eyes;
  /// Requested screen error [px], > 0. FrameStatistics::bound_px reports what was reached.
  double error_px = kFrameErrorPx;
  Sharpness sharpness = Sharpness::kFull;
  /// Whether parts that cannot have changed since the last frame are reused; the picture is bit-identical
  /// either way.
  /// kInBands: as kChanged, but where a frame would only show the same more finely it draws one of kDetailBands bands of rows, of
  /// kSharpBands after a frame of kHalf or kQuarter, the frames after it the others, and none of them takes long. An edit in between is
  /// drawn at once; before a first sharp picture is there, together with all that is left of it. Only at kFull and kRest.
  enum class Redraw { kChanged, kInBands, kAll } redraw = Redraw::kChanged;
  /// Of a field on demand: whether the frame is drawn with the pages that are on the device, or waits for all
  /// requested pages that the memory holds.
  enum class Pages { kAvailable, kAll } pages = Pages::kAvailable;
  /// Most vertices of a frame, all panels together, kFewestFrameVertices .. kMostFrameVertices.
  std::int64_t vertex_budget = kFrameVertices;
  /// Most vertices of each panel, 1 .. kMostFrameVertices, one number per panel; empty: equal shares of
  /// vertex_budget.
  std::vector<std::int64_t> panel_vertices;
};

/// State of a field whose finer samples are loaded on demand: any of more than a few million samples.
struct ResidencyStatistics {
  bool on_demand = false;         ///< false: all samples are on the device, and the rest of this stays zero
  std::int64_t device_bytes = 0;  ///< of the pool of pages, whether used or not
  std::int64_t pages = 0;         ///< in the pool
  std::int64_t pages_used = 0;    ///< with content
  std::int64_t pages_requested = 0;  ///< requested by this frame, of levels on demand
  std::int64_t pages_loaded = 0;     ///< uploaded with this frame
  std::int64_t pages_waiting =
      0;  ///< will be uploaded with the next frames; drawn coarser until then, as bound_px reports
  std::int64_t pages_over_budget = 0;  ///< do not fit with the other requested ones; drawn coarser
};

/// What prevents a panel from being drawn within FrameInput::error_px.
enum class DetailLimit {
  kNone,      ///< nothing: it is within it
  kLoading,   ///< pages that will be uploaded with the next frames
  kMemory,    ///< pages that do not fit into the allowed device memory
  kVertices,  ///< the allowed number of vertices
};

/// How close the surface drawn in a panel is to the one at full resolution.
struct PanelDetail {
  double bound_px = 0.0;  ///< as FrameStatistics::bound_px, of this panel
  DetailLimit limit = DetailLimit::kNone;
};

struct FrameStatistics {
  std::int64_t patches = 0;
  std::int64_t vertices = 0;   ///< surface, skirts, walls
  std::int64_t triangles = 0;  ///< without seam triangles of area zero
  /// Upper limit of the distance on the screen between the surface at full resolution and the drawn one, in
  /// both directions (Hausdorff) [px]. At most error_px where the budget allowed it. See
  /// render/detail/detail.h.
  double bound_px = 0.0;
  std::vector<PanelDetail> panels;  ///< of each panel; bound_px is the largest of theirs
  double redrawn = 1.0;             ///< share of the plots that was drawn again, 0 .. 1
  std::vector<Rectangle>
      changed;  ///< places of the target that were written: disjoint; all of it unless LiveTarget::kept
  /// Whether the frame reused the one before and drew only what differs, which may be everything.
  bool continued = false;
  bool band = false;  ///< it drew one of the bands of Redraw::kInBands
  int bands_left =
      0;  ///< of Redraw::kInBands: frames that must follow until all of the picture is as fine as this one
  /// At Sharpness::kRest: frames that must follow until the picture has four rays per pixel. 0: it has, or the device has no memory
  /// for the pages that it would need.
  int rest_left = 0;
  bool rests = false;  ///< the picture has four rays per pixel by Sharpness::kRest
  bool within_budget =
      true;                 ///< false: refining stopped because of the vertices allowed, bound_px > error_px
  UploadStatistics upload;  ///< since the last frame
  ResidencyStatistics residency;
  double select_ms = 0.0;   ///< choosing the patches
  double record_ms = 0.0;   ///< everything else on this thread, without waiting
  double wait_ms = 0.0;     ///< waiting for the frame before the last one: the device is behind
  double device_ms = -1.0;  ///< from submission to completion, of the last completed frame; -1: none yet
  ValueRange range;
  double contour_step = 0.0;  ///< between two contour lines [height_unit]
  double vertical_exaggeration = 1.0;
  double pixels_per_mm = 1.0;         ///< at the middle of the picture
  std::vector<std::string> warnings;  ///< e.g. text that did not fit
};

/// A point of the surface under a position in the picture.
struct Picked {
  int panel = 0;
  glm::dvec3 position_mm{0.0};  ///< field coordinates; z on the bilinear surface, as contact feels it
  std::int32_t column = 0;      ///< cell, by its lower-left sample
  std::int32_t row = 0;
};

/// What a hand takes hold of at a position in the picture, to turn or move the view by it.
struct Grip {
  Framing framing;          ///< of the panel there
  glm::dvec3 point{0.0};    ///< scene [mm]; seen by `framing` at `pixel`
  glm::dvec2 pixel{0.0};    ///< as Framing::camera counts them: in stereo of the camera between the eyes
  bool on_surface = false;  ///< of the field, or of the block's side
};

struct LiveOptions {
  Validation validation = Validation::kOff;
  std::string device;  ///< as DeviceOptions
  /// Of pictures that are drawn off-screen and not read back, a VkFormat; 0: that of an Image.
  std::uint32_t colour_format = 0;
  /// Longest side of one image in samples, rounded up to a tile; 0: the device's limit. Larger fields are
  /// spread over the layers of an image array. For tests of that case.
  int max_image_side = 0;
  /// Time after which a frame measures no more tiles than kMeasuredAtOnce of each version [ms]. Without a limit the number of tiles
  /// that frames measure does not depend on how busy the machine is.
  double measuring_ms = std::numeric_limits<double>::infinity();
  /// The same of what it uploads, of changed tiles and of pages each, whatever upload_bytes_per_frame leaves [ms]: one of each at least.
  double uploading_ms = std::numeric_limits<double>::infinity();
  /// Most bytes uploaded per frame while an edit or a filter result is pending; the rest follows with the
  /// next frames.
  std::int64_t upload_bytes_per_frame = kUploadBytesPerFrame;
  /// Device memory that the samples of all versions, of the original and their marks may take [bytes]; 0:
  /// half of the largest heap of the device's own memory. Fields that take more than that or than kWholeBytes
  /// (render/config.h), or are larger than the device's images, are loaded on demand: coarse copies
  /// permanently, finer samples in pages where the view requests them, within upload_bytes_per_frame. Frames
  /// after a camera move may then be coarser than error_px, as FrameStatistics reports. Once on demand,
  /// versions of the same field stay so.
  std::int64_t memory_budget_bytes = 0;
};

/// A changing field, drawn many times per second.
///
/// Cost depends on the screen. Each frame chooses square patches of kPatchCells x kPatchCells cells, each
/// with its own stride, coarse where that shows less than `error_px`, by measured deviations
/// (render/detail/detail.h). Where patches of different strides meet, a seam closes the gap: a strip between
/// the two edges that overlaps both by a quarter of a pixel on the screen, so that no ray passes between,
/// also straight from above. A coarse cell drawn in place of a steep wall takes colour and light from the
/// height at which it is drawn.
///
/// Uploads use a persistently mapped ring and never wait: frames in flight read the image before the upload,
/// the next frame reads it after. Only the rectangle of each changed tile is uploaded, with copies of every
/// 4th, 16th and 64th sample (7 % more) for distant views, so that memory traffic depends on the screen as
/// well.
///
/// While camera and options stay the same, a frame draws only the rectangle of each panel in which the
/// changes of the field are visible (render/detail/damage.h); overlays move without drawing the surface
/// again.
///
/// Threading: one thread at a time, the same as the presenting one. Determinism: on one machine with one
/// driver, the same input gives the same bits whatever was drawn before (measured on Mesa lavapipe 22.3.6);
/// between drivers, pictures differ.
class LivePicture {
 public:
  /// Off-screen, with a context of its own. Errors (kFailed) as Context::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<LivePicture>> create(const LiveOptions& options = {});
  /// Draws to images of the caller (a window): `colour_format` is a VkFormat, and `context` must outlive
  /// this.
  [[nodiscard]] static engine::Result<std::unique_ptr<LivePicture>> create(Context& context,
                                                                           std::uint32_t colour_format,
                                                                           const LiveOptions& options = {});
  /// The same format on the same device as `other`, and with its programs: what one of them has drawn with the other one finds
  /// made, and loaded by the driver. For the thread that draws `other`, which outlives this.
  [[nodiscard]] static engine::Result<std::unique_ptr<LivePicture>> createBeside(
      const LivePicture& other, const LiveOptions& options = {});
  ~LivePicture();
  LivePicture& operator=(LivePicture&&) = delete;

  /// Sets what the next frames show. The first time, or when the field is not related to the one before, a small field is uploaded
  /// before this returns, and of one on demand the coarse copies with the next frame (8 MiB, 1 MiB of further versions);
  /// otherwise the difference is queued and uploaded with the next frames, within LiveOptions::upload_bytes_per_frame each.
  /// Errors: kInput when versions do not fit each other; kFailed when the device cannot hold them.
  [[nodiscard]] engine::Status update(const Shown& shown);
  /// One version, no original, marks as before.
  [[nodiscard]] engine::Status update(const engine::Version& version);

  /// Uploads what is pending and measures all tiles, however long it takes; pages are uploaded with the
  /// frames. `job` advances by uploads. Errors: kCancelled; kFailed as draw().
  [[nodiscard]] engine::Result<UploadStatistics> uploadAll(engine::JobControl& job);

  /// Measures tiles of which the detail is not known yet (UploadStatistics::unmeasured_tiles), for about so long, on all
  /// cores. Returns how many are left; the next frame shows what came of it. For times in which nothing else
  /// changes: a frame measures kMeasuredPerFrame tiles itself, and takes longer than they do.
  [[nodiscard]] std::int64_t measureFor(double ms);

  /// Draws the next frame and returns without waiting for it (two may be in flight). Errors: kInput for an
  /// input out of range; kFailed for a lost device: create another LivePicture, the field is not affected.
  [[nodiscard]] engine::Result<FrameStatistics> draw(const FrameInput& input, LiveTarget& target);
  /// The same to memory: draws, waits and copies out. Not with a colour format of its own.
  [[nodiscard]] engine::Result<FrameStatistics> draw(const FrameInput& input, Image& out);
  /// Draws to memory, waits, copies nothing: for measurements and rehearsals.
  [[nodiscard]] engine::Result<FrameStatistics> drawAndWait(const FrameInput& input);

  /// The surface point under pixel (x, y) of the last frame: (0, 0) is the top left corner of the picture.
  /// Traverses the min/max pyramid along the ray and intersects the bilinear patches exactly, in double
  /// precision; uses the versions given to update(), not what is uploaded. Empty: background, hole, or no
  /// frame yet. Side by side, each half belongs to its own eye; in an anaglyph the position is that on the
  /// window, seen from between the eyes.
  [[nodiscard]] std::optional<Picked> pick(double x, double y) const;
  /// The position of a field point in panel `panel` of the last frame [px]; the inverse of pick except for
  /// hidden points. Empty: no such panel. In stereo: in the left eye's picture.
  [[nodiscard]] std::optional<std::pair<double, double>> pixelOf(int panel, const glm::dvec3& field_mm,
                                                                 Eye eye = Eye::kLeft) const;

  /// What a hand takes hold of at pixel (x, y) of the last frame: the surface or the side of the block there;
  /// over a hole the plane at half the relief, and beside the field what is as far away as the block's
  /// middle. Empty: no frame yet.
  [[nodiscard]] std::optional<Grip> grip(double x, double y) const;
  /// How the first panel of the last frame becomes a camera. Empty: no frame yet.
  [[nodiscard]] std::optional<Framing> framing() const;

  /// The next frame computes the ranges of colours and camera again.
  void refreshRanges();
  /// The same of colours alone: the surface stays where it is.
  void refreshColours();

  /// Waits until all frames are completed.
  void finish();

  /// Makes one thing for the device that `rehearsed`, a picture on a device of the same kind, has drawn with and this one has
  /// not: so the first frame that needs it does not wait for that, some tens of milliseconds on a processor. Returns whether
  /// there was one. For any thread, also while this picture draws; not while `rehearsed` does. Both must live meanwhile.
  bool prepareNextOf(const LivePicture& rehearsed) noexcept;

  [[nodiscard]] const std::string& device() const noexcept;
  /// The messages of the validation layers so far; only with a context of its own.
  [[nodiscard]] std::vector<std::string> validationMessages() const;

 private:
  struct Impl;
  explicit LivePicture(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render

// Included by C++ and by every shader, so that the two sides always agree. Only types whose std140, std430
// and C++ layouts are equal are used: 4-component vectors, matrices of them and arrays of them.
#ifndef FETTLE_SHADERS_LAYOUT_H
#define FETTLE_SHADERS_LAYOUT_H

#ifdef __cplusplus
#include <array>
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace fettle::render::gpu {
using glm::ivec4;
using glm::mat4;
using glm::vec4;
#define FETTLE_CONST inline constexpr int
#else
#define FETTLE_CONST const int
#endif

// Cells along one side of a patch, the unit in which the surface is drawn; a power of two, 8 .. 32. 16: a
// patch is one instance of kPatchVertices vertices, enough to make the cost per instance negligible, and
// small enough to follow a wall without spending many fine cells next to it.
FETTLE_CONST kPatchCells = 16;
// One strip row: left and right vertex of every column, first and last doubled to connect to the next row.
FETTLE_CONST kStripVertices = 2 * (kPatchCells + 1) + 2;
FETTLE_CONST kPatchVertices = kStripVertices * kPatchCells;
// A wall: top and bottom vertex of every column of a patch along one edge of the field.
FETTLE_CONST kWallVertices = 2 * (kPatchCells + 1);
// A seam is drawn as two strips: the vertices of a patch's edge, and next to each the edge of the coarser
// patch beyond it.
FETTLE_CONST kSeamStripVertices = 2 * (kPatchCells + 1);
FETTLE_CONST kSeamVertices = 2 * kSeamStripVertices;

FETTLE_CONST kColours = 256;
// Levels of a field on the device: every sample, every 4th, 16th and 64th.
FETTLE_CONST kDataLevels = 4;

// Bindings of descriptor set 0 of the surface.
FETTLE_CONST kBindPanel = 0;     // uniform PanelUniforms
FETTLE_CONST kBindHeights = 1;   // utexture2DArray, bits of a float; a hole is any NaN
FETTLE_CONST kBindMarks = 2;     // utexture2DArray, non-zero = marked
FETTLE_CONST kBindOriginal = 3;  // utexture2DArray, heights from which the deviation is computed
FETTLE_CONST kBindPatches = 4;   // buffer of Patch
// utexture2DArray, every 2^shade.x-th sample of the heights; marks and original likewise.
FETTLE_CONST kBindShade = 5;
FETTLE_CONST kBindLines = 6;    // buffer of Line
FETTLE_CONST kBindPages = 7;    // utextureBuffer, entries of the page table: which pages are on the device
FETTLE_CONST kBindDepth = 8;    // texture2D, depth of the surface, in the pixels of the picture
FETTLE_CONST kBindNearest = 9;  // sampler that returns the nearest texel
FETTLE_CONST kBindStylus = 10;  // buffer of one Stylus

// Bindings of descriptor set 0 of the picture.
FETTLE_CONST kBindGlyphs = 1;  // texture2D, coverage
FETTLE_CONST kBindQuads = 2;   // buffer of Quad
FETTLE_CONST kBindMap = 3;     // uniform PanelUniforms, for its colours

// Bindings of descriptor set 0 of the pass that combines the pictures of two eyes, and its one constant.
FETTLE_CONST kBindLeftEye = 0;   // texture2D
FETTLE_CONST kBindRightEye = 1;  // texture2D
FETTLE_CONST kSpecAnaglyph = 0;

// Specialisation constants of the surface: features that a picture does not use are not in its code.
FETTLE_CONST kSpecPaged = 0;
FETTLE_CONST kSpecMarks = 1;
FETTLE_CONST kSpecDeviation = 2;
FETTLE_CONST kSpecContours = 3;
// Normals interpolated inside a cell: useful only where cells are larger than rays.
FETTLE_CONST kSpecSmooth = 4;
FETTLE_CONST kSpecHoles = 5;  // there may be holes
// For speed: slopes of the cell only where kSpecSmooth is off, the nearest of 256 colours.
FETTLE_CONST kSpecCell = 6;
// Samples lie in pages that are on the device on demand: heights_image, marks_image and original_image are
// pools of them.
FETTLE_CONST kSpecOnDemand = 7;
// The samples that colours come from are in one image layer, two or more in each direction: the four of a
// cell are read in one look-up.
FETTLE_CONST kSpecGather = 8;
FETTLE_CONST kSpecPerspective = 9;  // distances of points from the viewer differ
// Of the hatch of samples that are not compared: out of kHatchStripes parts of its period one is dark, with 1 / kHatchShade of the
// grey.
FETTLE_CONST kHatchStripes = 4;
FETTLE_CONST kHatchShade = 4;
// Normals are those of the plane through the samples in the footprint of a ray (footprint.glsl).
FETTLE_CONST kSpecFootprint = 10;
// Light that is hidden by what stands around; brighter ridges and darker hollows (surroundings.glsl).
FETTLE_CONST kSpecOcclusion = 11;
FETTLE_CONST kSpecCavity = 12;
FETTLE_CONST kSpecFaint = 13;     // of the stylus: what the surface hides
FETTLE_CONST kSpecMaterial = 14;  // shaded as a material (material.glsl)
FETTLE_CONST kSpecCount = 15;

// What a Quad is filled with.
FETTLE_CONST kFillSolid = 0;
FETTLE_CONST kFillGlyph = 1;    // uv: texel of the glyph image
FETTLE_CONST kFillColours = 2;  // uv.y: position in the colour map, 0 .. 1
FETTLE_CONST kFillUp = 3;       // triangle on the quad's lower edge, colour as kFillColours
FETTLE_CONST kFillDown = 4;     // triangle at the quad's upper edge

// Layout of a page table (render/residency/page_table.h): one entry per page, the field's, then the
// original's.
struct PageHead {
  ivec4 level[kDataLevels];  // entry of a level's first page; pages across; columns, rows of samples
  ivec4 pool;  // log2 of a page's side; the rim's first entry; number of its row's first sample; entries of a
               // field
};

// Views that one panel may be drawn for. Everything that differs between two of them is in ViewUniforms.
FETTLE_CONST kMostViews = 2;
FETTLE_CONST kBothViews = 3;  // mask of them

// One eye. A pass that draws for several at once reads the one of its gl_ViewIndex (viewUniforms() in
// field.glsl).
struct ViewUniforms {
  mat4 clip_from_scene;  // bytes  0 ..  63
  // (x, y of gl_FragCoord, depth, 1) to homogeneous (samples from `origin` in x, in y, scene z, 1). Computed
  // in double precision about a sample near the middle of the visible part, so that no fraction is lost far
  // from the field's origin.
  mat4 field_from_pixel;  //  64 .. 127
  ivec4 origin;           // 128: virtual sample; -; -
};

// What the surface looks like to be made of (material.glsl). Colours are linear red, green, blue.
struct Material {
  vec4 body;    // its colour in full light; how far the light reaches behind the edge of its shadow, 0 .. 1
  vec4 shadow;  // factor of that in the shadow; share of a mirror, 0 .. 1
  vec4 gloss;   // strength and exponent of a small highlight; of a broad one
  vec4 rim;     // added where the surface turns away from the viewer; exponent
};

// Scene coordinates: millimetres from the middle of what is shown, x and y as in the field, z up,
// exaggeration included. "Virtual" samples: a field of one row or column is drawn as two equal ones.
struct PanelUniforms {
  ViewUniforms views[kMostViews];  // bytes   0 .. 287
  vec4 placing;                    // 288: x, y of virtual sample (0, 0) [scene mm]; spacing x, y [mm]
  vec4 relief;      // 304: sign of heights; height at scene z 0; scene mm per height unit; floor's scene z
  vec4 limits;      // 320: lowest and highest height drawn; others are clipped; sign of the original; -
  vec4 colouring;   // 336: value of the first colour; 1 / range; contour step (value); -
  vec4 light;       // 352: unit vector to the light; share of light without direction
  vec4 marks_tint;  // 368: linear red, green, blue; opacity, -1: an outline alone
  vec4 no_data;     // 384: linear red, green, blue; period of the hatch of what is not compared [mm]
  vec4 wall;        // 400: linear red, green, blue
  vec4 ground;      // 416: linear red, green, blue: background
  ivec4 size;       // 432: virtual columns, rows; true columns, rows
  ivec4 paging;  // 448: log2 of a page's columns, rows; pages across; step of differences [2^shade.x samples]
  ivec4 shade;   // 464: log2 of the step between samples that colours come from; -; columns, rows of those
  // Seam: how far seams overlap [px]; from this distance between drawn and exact position on, a point counts
  // as displaced [scene mm]. Half the side of the square that decides on contour lines, in x, y [steps].
  vec4 seam;            // 480
  vec4 suggested_tint;  // 496: of marks that are suggested: linear red, green, blue; opacity
  // Samples of a footprint: how many steps in x, y they lie outside a cell, 1 or 2. How many steps before a cell the
  // samples lie that its colour may depend on, and one more after it; -.
  ivec4 footprint;  // 512
  // Distances of the samples that surroundings are taken from [steps]: along x, along y; on the lines between: x, y.
  vec4 around;  // 528
  vec4 form;    // 544: strength of occlusion, of cavity, 0 .. 1; -; -
  // Unit vectors in the scene to the picture's right, its top, the viewer; share of the colours of values in that of the
  // material, 0 .. 1; -; strength of its light, 0 .. 1.
  vec4 to_right, to_top, to_viewer;  // 560
  Material material;                 // 608
  vec4 of_level;                     // 672: 1 / the light on its body where the surface is level; -
  vec4 colours[kColours];            // 688: linear red, green, blue
  PageHead pages;                    // where samples are on the device on demand
};

// Values of the image of marks per sample; 0 is no mark.
FETTLE_CONST kMarked = 1;
FETTLE_CONST kSuggested = 2;

struct Patch {
  ivec4 place;  // first column, first row; log2 of the stride in columns, in rows
};

// An entry: the page's position in a layer of the pool [pages], and the layer; and whether colours must not
// be read there.
FETTLE_CONST kEntryUpShift = 8;
FETTLE_CONST kEntryLayerShift = 16;
FETTLE_CONST kEntrySideMask = 0xff;
FETTLE_CONST kEntryLayerMask = 0x3fff;
FETTLE_CONST kEntryAwayShift = 31;

// A line over the surface, with round ends.
struct Line {
  vec4 from;    // scene mm; width [px]
  vec4 to;      // scene mm; -
  vec4 colour;  // linear red, green, blue; opacity
};

// A pen, with a ball at its point or without, and its shadow (render/plan/stylus_body.h). Lengths in scene mm.
struct Stylus {
  vec4 point;   // height of the plate, below which nothing is drawn
  vec4 tail;    // its other end; its radius
  vec4 ball;    // centre; radius along z
  vec4 colour;  // of its point and its ball: linear red, green, blue; 1: the ball is nearer to the viewer
  vec4
      shadow;  // how dark, 0: none; distance at which it ends; a pixel; the ball's radius along x and y, 0: none
};
// Its parts are drawn as bands of rings from one end to the other.
FETTLE_CONST kStylusBands = 16;
FETTLE_CONST kStylusSides = 32;
FETTLE_CONST kStylusVertices = 6 * kStylusBands * kStylusSides;

// A filled rectangle of the finished picture.
struct Quad {
  vec4 pixels;  // left, top, right, bottom
  vec4 uv;      // the same corners in the source of the fill
  vec4 colour;  // linear red, green, blue; opacity (kFillColours: opacity only)
  ivec4 fill;   // one of kFill..; -; -; -
};

#ifdef __cplusplus
static_assert(sizeof(ViewUniforms) == 144);
static_assert(offsetof(ViewUniforms, field_from_pixel) == 64);
static_assert(offsetof(ViewUniforms, origin) == 128);
static_assert(sizeof(PanelUniforms) == 688 + 16 * kColours + sizeof(PageHead));
static_assert(offsetof(PanelUniforms, placing) == 288);
static_assert(offsetof(PanelUniforms, limits) == 320);
static_assert(offsetof(PanelUniforms, size) == 432);
static_assert(offsetof(PanelUniforms, shade) == 464);
static_assert(offsetof(PanelUniforms, suggested_tint) == 496);
static_assert(offsetof(PanelUniforms, footprint) == 512);
static_assert(offsetof(PanelUniforms, around) == 528);
static_assert(offsetof(PanelUniforms, material) == 608);
static_assert(offsetof(PanelUniforms, colours) == 688);
static_assert(sizeof(Patch) == 16);
static_assert(sizeof(PageHead) == 80);
static_assert(sizeof(Line) == 48);
static_assert(sizeof(Stylus) == 80);
static_assert(sizeof(Quad) == 64);
}  // namespace fettle::render::gpu
#endif
#undef FETTLE_CONST

#endif

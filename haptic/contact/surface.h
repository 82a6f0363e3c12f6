#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

#include "engine/field/reader.h"
#include "haptic/contact/pair.h"

namespace fettle::haptic {

/// A cell by its lower-left sample: 0 <= column < width - 1, 0 <= row < height - 1.
struct CellIndex {
  std::int32_t column = 0;
  std::int32_t row = 0;

  friend bool operator==(const CellIndex&, const CellIndex&) = default;
};

/// The bilinear patch over one cell, in field millimetres, double precision:
///   S(u, v) = (x0 + u sx, y0 + v sy, a + b u + c v + d u v),   0 <= u, v <= 1.
/// d is the twist; 0 makes the patch a plane. Its four edges are straight.
struct Patch {
  double x0, y0;      ///< lower-left sample [mm]
  double sx, sy;      ///< spacing [mm], > 0
  double a, b, c, d;  ///< [mm]

  [[nodiscard]] double heightAt(double u, double v) const noexcept { return a + b * u + (c + d * u) * v; }
  [[nodiscard]] glm::dvec3 at(double u, double v) const noexcept {
    return {x0 + u * sx, y0 + v * sy, heightAt(u, v)};
  }
  /// A bilinear function takes its extremes at the corners.
  [[nodiscard]] double highest() const noexcept { return std::max({a, a + b, a + c, a + b + c + d}); }
  [[nodiscard]] double lowest() const noexcept { return std::min({a, a + b, a + c, a + b + c + d}); }
};

/// A point of the surface, by cell and parameters; u or v is exactly 0 or 1 on an edge.
struct SurfacePoint {
  CellIndex cell;
  double u = 0.0, v = 0.0;
  glm::dvec3 position_mm{0.0};
  double distance2_mm2 = 0.0;  ///< squared distance to the endpoint it was searched for [mm^2]
};

/// One state of a field as the bilinear surface that is felt: cells in millimetres. Caches the last tile it
/// read, because a hand stays within one tile for thousands of ticks.
///
/// A cell exists where all four corners are samples of the field that are not holes. A field of one row or
/// one column has no cells.
///
/// Threading: one thread; nothing allocates, locks or throws. Call refresh() after every write to the field:
/// a write may move tiles.
class Surface {
 public:
  explicit Surface(const engine::FieldReader& reader) noexcept
      : reader_(reader),
        sx_(reader.grid().spacingXMm()),
        sy_(reader.grid().spacingYMm()),
        factor_(reader.grid().height_unit.mm * static_cast<double>(reader.sign())) {}

  void refresh(const engine::FieldReader& reader) noexcept {
    reader_ = reader;
    factor_ = reader.grid().height_unit.mm * static_cast<double>(reader.sign());
    tile_ = nullptr;
    ++refreshes_;
  }
  /// How often refresh() was called: values read at the same number are still valid.
  [[nodiscard]] std::uint64_t refreshes() const noexcept { return refreshes_; }

  [[nodiscard]] const engine::FieldReader& reader() const noexcept { return reader_; }
  [[nodiscard]] double spacingX() const noexcept { return sx_; }
  [[nodiscard]] double spacingY() const noexcept { return sy_; }
  /// Millimetres per height unit of the reader's heights.
  [[nodiscard]] double heightUnit() const noexcept { return reader_.grid().height_unit.mm; }
  [[nodiscard]] std::int32_t cellColumns() const noexcept { return reader_.width() - 1; }
  [[nodiscard]] std::int32_t cellRows() const noexcept { return reader_.height() - 1; }
  [[nodiscard]] bool hasCell(CellIndex cell) const noexcept {
    return cell.column >= 0 && cell.row >= 0 && cell.column < cellColumns() && cell.row < cellRows();
  }

  /// The cell below or above a point, whether or not it has a hole; false outside the field. A point on a
  /// line between cells belongs to the upper one, on the field's own far edge to the last.
  [[nodiscard]] bool cellUnder(const glm::dvec3& point, CellIndex& cell) const noexcept {
    const Pair at = Pair{point.x, point.y} / Pair{sx_, sy_};
    const double x = at[0];
    const double y = at[1];
    // Negated so that NaN is outside; a field without cells has nothing inside.
    if (!(x >= 0.0 && y >= 0.0 && x <= cellColumns() && y <= cellRows())) return false;
    if (cellColumns() < 1 || cellRows() < 1) return false;
    cell = {std::min(static_cast<std::int32_t>(x), cellColumns() - 1),
            std::min(static_cast<std::int32_t>(y), cellRows() - 1)};
    return true;
  }

  /// The patch of a cell of the field; false when a corner is a hole.
  [[nodiscard, gnu::always_inline]] bool patch(CellIndex cell, Patch& out) noexcept {
    using engine::kTileShift;
    using engine::kTileSide;
    const int c = cell.column & (kTileSide - 1);
    const int r = cell.row & (kTileSide - 1);
    float z00, z10, z01, z11;
    if (c != kTileSide - 1 && r != kTileSide - 1) [[likely]] {
      const float* s =
          tileAt(cell.column >> kTileShift, cell.row >> kTileShift).samples.data() + r * kTileSide + c;
      z00 = s[0];
      z10 = s[1];
      z01 = s[kTileSide];
      z11 = s[kTileSide + 1];
    } else {
      const Corners across = cornersAcrossTiles(cell);
      z00 = across.z00;
      z10 = across.z10;
      z01 = across.z01;
      z11 = across.z11;
    }
    const double a = factor_ * static_cast<double>(z00);
    const double b = factor_ * static_cast<double>(z10) - a;
    const double z01_mm = factor_ * static_cast<double>(z01);
    const double c_mm = z01_mm - a;
    const double d = (factor_ * static_cast<double>(z11) - z01_mm) - b;
    out = {cell.column * sx_, cell.row * sy_, sx_, sy_, a, b, c_mm, d};
    // Samples are finite or NaN, so one NaN among the corners, and nothing else, makes d NaN.
    return !std::isnan(d);
  }

  /// The five samples around a vertex that one of its four cells lacks, as heights [mm]; NaN in holes and
  /// outside the field.
  struct Star {
    double across_u;    ///< next sample along x, away from that cell
    double across_v;    ///< next sample along y, likewise
    double corners[3];  ///< the far corners of the three other cells
    [[nodiscard]] bool complete() const noexcept {
      return !std::isnan(across_u + across_v + corners[0] + corners[1] + corners[2]);
    }
  };
  /// `column`, `row`: the vertex, a sample of the field; `dc`, `dr`: 1 or -1, the direction from the cell
  /// across it.
  [[nodiscard, gnu::always_inline]] Star star(std::int32_t column, std::int32_t row, int dc,
                                              int dr) noexcept {
    using engine::kTileShift;
    using engine::kTileSide;
    const int c = column & (kTileSide - 1);
    const int r = row & (kTileSide - 1);
    const bool within = c != 0 && r != 0 && c != kTileSide - 1 && r != kTileSide - 1 &&
                        column < cellColumns() && row < cellRows();
    float h[5];
    if (within) [[likely]] {
      const float* s = tileAt(column >> kTileShift, row >> kTileShift).samples.data() + r * kTileSide + c;
      const int dv = dr * kTileSide;
      h[0] = s[dc];
      h[1] = s[dv];
      h[2] = s[dc - dv];
      h[3] = s[dv - dc];
      h[4] = s[dc + dv];
    } else {
      h[0] = sampleOrHole(column + dc, row);
      h[1] = sampleOrHole(column, row + dr);
      h[2] = sampleOrHole(column + dc, row - dr);
      h[3] = sampleOrHole(column - dc, row + dr);
      h[4] = sampleOrHole(column + dc, row + dr);
    }
    const auto mm = [&](float height) { return factor_ * static_cast<double>(height); };
    return {mm(h[0]), mm(h[1]), {mm(h[2]), mm(h[3]), mm(h[4])}};
  }

 private:
  struct Corners {
    float z00, z10, z01, z11;
  };
  // Out of line: one cell in 32, and patch() is inlined in all hot loops.
  [[nodiscard, gnu::noinline]] Corners cornersAcrossTiles(CellIndex cell) const noexcept {
    return {sample(cell.column, cell.row), sample(cell.column + 1, cell.row),
            sample(cell.column, cell.row + 1), sample(cell.column + 1, cell.row + 1)};
  }
  [[nodiscard]] const engine::Tile& tileAt(std::int32_t tc, std::int32_t tr) noexcept {
    if (tile_ == nullptr || tc != tile_column_ || tr != tile_row_) [[unlikely]]
      findTile(tc, tr);
    return *tile_;
  }
  [[gnu::noinline]] void findTile(std::int32_t tc, std::int32_t tr) noexcept {
    tile_ = &reader_.tile(tc, tr);
    tile_column_ = tc;
    tile_row_ = tr;
  }
  // Without the sign, which factor_ holds. Bypasses the cached tile: a cell on a tile's edge would evict it
  // four times.
  [[nodiscard]] float sample(std::int32_t column, std::int32_t row) const noexcept {
    using engine::kTileShift;
    using engine::kTileSide;
    const std::int32_t tc = column >> kTileShift;
    const std::int32_t tr = row >> kTileShift;
    const engine::Tile& t =
        tile_ != nullptr && tc == tile_column_ && tr == tile_row_ ? *tile_ : reader_.tile(tc, tr);
    return t
        .samples[static_cast<std::size_t>((row & (kTileSide - 1)) * kTileSide + (column & (kTileSide - 1)))];
  }

  [[nodiscard, gnu::noinline]] float sampleOrHole(std::int32_t column, std::int32_t row) const noexcept {
    const bool there = column >= 0 && row >= 0 && column < reader_.width() && row < reader_.height();
    return there ? sample(column, row) : NAN;
  }

  engine::FieldReader reader_;
  double sx_, sy_;
  double factor_;
  std::uint64_t refreshes_ = 0;
  const engine::Tile* tile_ = nullptr;
  std::int32_t tile_column_ = 0;
  std::int32_t tile_row_ = 0;
};

/// Whether a point lies strictly below the patch of the cell under it.
[[nodiscard]] inline bool belowPatch(const Patch& patch, const glm::dvec3& point) noexcept {
  const Pair at = unit((Pair{point.x, point.y} - Pair{patch.x0, patch.y0}) / Pair{patch.sx, patch.sy});
  return point.z < patch.heightAt(at[0], at[1]);
}

}  // namespace fettle::haptic

// compare_gwyddion SCAN...: parameters of scans by Fettle and by Gwyddion's library, each with its own plane taken out,
// as rows of a Markdown table with relative differences. Where Gwyddion defines a parameter in another way, its
// definition is worked out here, too, so that the rest of the difference is seen. Exit status 1 when a difference that no
// definition explains is above 1e-6.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <libprocess/gwyprocess.h>

#include "engine/formats/formats.h"
#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section.h"
#include "engine/measure/spatial.h"
#include "engine/measure/surface.h"

namespace {

using namespace fettle::engine;

// A field of Gwyddion's with its mask, about its plane; holes are 0 there, as Gwyddion needs a number. Its rows are the
// scan's from the lowest on, which no parameter minds.
struct PeerField {
  GwyDataField* data = nullptr;
  GwyDataField* mask = nullptr;
  int width = 0, height = 0;
  double dx = 1.0, dy = 1.0;

  [[nodiscard]] double at(int c, int r) const {
    return gwy_data_field_get_val(data, std::clamp(c, 0, width - 1), std::clamp(r, 0, height - 1));
  }
  [[nodiscard]] bool there(int c, int r) const {
    return c >= 0 && r >= 0 && c < width && r < height && gwy_data_field_get_val(mask, c, r) > 0.0;
  }
};

// Heights in millimetres, as slopes and areas need them.
PeerField peerFieldOf(const Version& field) {
  const FieldReader reader = field.reader();
  const Grid& grid = reader.grid();
  PeerField peer;
  peer.width = grid.width;
  peer.height = grid.height;
  peer.dx = grid.spacingXMm();
  peer.dy = grid.spacingYMm();
  peer.data = gwy_data_field_new(grid.width, grid.height, grid.width * peer.dx, grid.height * peer.dy, TRUE);
  peer.mask = gwy_data_field_new_alike(peer.data, TRUE);
  double first = std::numeric_limits<double>::quiet_NaN();
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double z = reader.heightAt(c, r);
      if (std::isnan(z)) continue;
      if (std::isnan(first)) first = z;
      gwy_data_field_set_val(peer.data, c, r, (z - first) * grid.height_unit.mm);
      gwy_data_field_set_val(peer.mask, c, r, 1.0);
    }
  double a = 0.0, bx = 0.0, by = 0.0;
  gwy_data_field_area_fit_plane_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0, peer.width, peer.height,
                                     &a, &bx, &by);
  gwy_data_field_plane_level(peer.data, a, bx, by);
  const double mean =
      gwy_data_field_area_get_avg_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0, peer.width, peer.height);
  gwy_data_field_add(peer.data, -mean);
  for (int r = 0; r < peer.height; ++r)
    for (int c = 0; c < peer.width; ++c)
      if (!peer.there(c, r)) gwy_data_field_set_val(peer.data, c, r, 0.0);
  return peer;
}

// Gwyddion's Sdq: twice the mean square of the slopes of all links between neighbours, rows and columns together.
double slopeOfLinks(const PeerField& peer) {
  long double sum = 0;
  std::int64_t links = 0;
  for (int r = 0; r < peer.height; ++r)
    for (int c = 0; c < peer.width; ++c) {
      if (!peer.there(c, r)) continue;
      const long double z = peer.at(c, r);
      if (peer.there(c + 1, r)) sum += std::pow((peer.at(c + 1, r) - z) / peer.dx, 2), ++links;
      if (peer.there(c, r + 1)) sum += std::pow((peer.at(c, r + 1) - z) / peer.dy, 2), ++links;
    }
  return static_cast<double>(std::sqrt(2 * sum / links));
}

// Gwyddion's area ratio: a sample's share of each cell around it are halves of the two triangles at its sides, whose tip
// is the mean of the corners; cells beyond the border repeat its samples, holes have the height 0.
double areaOfTriangles(const PeerField& peer) {
  long double sum = 0;
  std::int64_t samples = 0;
  for (int r = -1; r < peer.height; ++r)
    for (int c = -1; c < peer.width; ++c) {
      if (peer.there(c, r)) ++samples;
      const int columns[] = {c, c + 1, c + 1, c}, rows[] = {r, r, r + 1, r + 1};
      double z[4], middle = 0.0;
      for (int k = 0; k < 4; ++k) middle += 0.25 * (z[k] = peer.at(columns[k], rows[k]));
      for (int k = 0; k < 4; ++k) {
        const int next = (k + 1) % 4;
        const double along = k % 2 == 0 ? peer.dx : peer.dy, across = k % 2 == 0 ? peer.dy : peer.dx;
        const double slope = (z[next] - z[k]) / along;
        const double rise = (middle - 0.5 * (z[k] + z[next])) / (0.5 * across);
        const long double excess = std::sqrt(1.0L + slope * slope + rise * rise) - 1.0L;
        const int owners =
            (peer.there(columns[k], rows[k]) ? 1 : 0) + (peer.there(columns[next], rows[next]) ? 1 : 0);
        sum += excess * owners / 8;
      }
    }
  return static_cast<double>(sum / samples);
}

// Gwyddion's autocorrelation in Fettle's structure: its values over that without a lag.
Autocorrelation peerCorrelation(const PeerField& peer, const Surface& surface) {
  Autocorrelation result;
  result.lags_x = surface.width / 2;
  result.lags_y = surface.height / 2;
  result.spacing_x = surface.spacing_x;
  result.spacing_y = surface.spacing_y;
  GwyDataField* const target = gwy_data_field_new(1, 1, 1.0, 1.0, FALSE);
  gwy_data_field_area_2dacf_mask(peer.data, target, peer.mask, GWY_MASK_INCLUDE, 0, 0, peer.width,
                                 peer.height, result.lags_x + 1, result.lags_y + 1, nullptr);
  const int middle_x = gwy_data_field_get_xres(target) / 2, middle_y = gwy_data_field_get_yres(target) / 2;
  const double whole = gwy_data_field_get_val(target, middle_x, middle_y);
  for (int ty = 0; ty <= result.lags_y; ++ty)
    for (int tx = -result.lags_x; tx <= result.lags_x; ++tx)
      result.values.push_back(gwy_data_field_get_val(target, middle_x + tx, middle_y + ty) / whole);
  g_object_unref(target);
  return result;
}

double shortestDecay(const Autocorrelation& correlation) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1440; ++i) least = std::min(least, correlation.decay(3.14159265358979 * i / 1440, 0.2));
  return least;
}

class Table {
 public:
  explicit Table(std::string scan) : scan_(std::move(scan)) {}

  // `own` is Gwyddion's definition worked out here, NaN where it is Fettle's.
  void row(const char* parameter, double fettle, double gwyddion,
           double own = std::numeric_limits<double>::quiet_NaN()) {
    if (std::isnan(fettle)) {
      // As Rsk of a profile that is flat, for which Gwyddion has 0.
      fmt::print("| {} | {} | not stated | {:.9g} | | |\n", scan_, parameter, gwyddion);
      if (gwyddion == 0.0 || std::isnan(gwyddion)) return;
      fmt::print(stderr, "{}: {} is not stated\n", scan_, parameter);
      failed_ = true;
      return;
    }
    const auto relative = [&](double value) {
      const double size = std::max(std::abs(value), std::abs(gwyddion));
      return size > 0.0 ? (value - gwyddion) / size : 0.0;
    };
    const double rest = std::isnan(own) ? relative(fettle) : relative(own);
    fmt::print("| {} | {} | {:.9g} | {:.9g} | {:.1e} | {} |\n", scan_, parameter, fettle, gwyddion,
               relative(fettle), std::isnan(own) ? "" : fmt::format("{:.1e}", rest));
    if (!(std::abs(rest) <= 1e-6)) {
      fmt::print(stderr, "{}: {} differs by {:.1e}, which no definition explains\n", scan_, parameter, rest);
      failed_ = true;
    }
  }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  std::string scan_;
  bool failed_ = false;
};

// Gwyddion's Rtm: m sampling lengths of n / m samples each, none of them in two, where ISO 21920-2 has lengths whose ends are those of
// their neighbours; samples that are left over at the end are in none; and of a length that lies above the mean line alone it counts
// no valley, of one below it no peak: each mean is of the lengths that have one.
double heightOfSamplings(const std::vector<double>& profile, int m) {
  const std::size_t n = profile.size(), lengths = static_cast<std::size_t>(m);
  double up = 0.0, down = 0.0;
  int peaks = 0, valleys = 0;
  for (std::size_t k = 0; k < lengths; ++k) {
    const auto from = profile.begin() + static_cast<std::ptrdiff_t>(k * n / lengths),
               to = profile.begin() + static_cast<std::ptrdiff_t>((k + 1) * n / lengths);
    const auto [low, high] = std::minmax_element(from, to);
    up += std::max(*high, 0.0);
    peaks += *high > 0.0;
    down += std::max(-*low, 0.0);
    valleys += *low < 0.0;
  }
  return up / std::max(peaks, 1) + down / std::max(valleys, 1);
}

// The row with the longest part without a hole, filtered by Fettle: Gwyddion's library has the parameters of a profile, its
// filter is one of the program.
void compareProfile(const Version& field, Table& table) {
  const Grid& grid = field.grid();
  std::int32_t row = 0, longest = 0;
  for (std::int32_t r = 0; r < grid.height; ++r) {
    std::int32_t run = 0;
    for (std::int32_t c = 0; c < grid.width; ++c) {
      run = std::isnan(field.reader().heightAt(c, r)) ? 0 : run + 1;
      if (run <= longest) continue;
      longest = run;
      row = r;
    }
  }
  if (longest < 60) return;
  JobControl job;
  const double y = row * grid.spacingYMm();
  const std::vector<glm::dvec2> line{{0.0, y}, {(grid.width - 1) * grid.spacingXMm(), y}};
  const auto section = sectionAlong(field, line, {}, job);
  if (!section) return;
  const double cutoff = longest * section->step_mm / 7.0;
  const ProfileFilters filters{cutoff, 4.0 * section->step_mm};
  const Stretch all{0.0, section->lengthMm()};
  const auto profile = roughnessProfile(*section, all, filters);
  const auto rough = roughnessOf(*section, all, filters);
  if (!profile || !rough) return;
  // There and back again, which gives the ends half the weight of the others, as the integrals of ISO 21920-2 do: Gwyddion counts
  // all places alike.
  const auto places = profile->heights.size();
  const auto n = static_cast<int>(2 * places - 2);
  GwyDataLine* const data = gwy_data_line_new(n, n * section->step_mm, TRUE);
  std::ranges::copy(profile->heights, gwy_data_line_get_data(data));
  std::copy(profile->heights.rbegin() + 1, profile->heights.rend() - 1,
            gwy_data_line_get_data(data) + static_cast<std::ptrdiff_t>(places));
  table.row("Ra", rough->ra, gwy_data_line_get_ra(data));
  table.row("Rq", rough->rq, gwy_data_line_get_rms(data));
  // Its moments of lines are of n + 1 samples' worth for each square of Rq, those of fields are not.
  const double more = (n + 1.0) / n;
  table.row("Rsk", rough->rsk, gwy_data_line_get_skew(data), std::sqrt(more) * rough->rsk);
  table.row("Rku", rough->rku, gwy_data_line_get_kurtosis(data), more * rough->rku - 3.0);
  table.row("Rt", rough->rt, gwy_data_line_get_max(data) - gwy_data_line_get_min(data));
  g_object_unref(data);
  GwyDataLine* const once =
      gwy_data_line_new(static_cast<int>(places), static_cast<double>(places) * section->step_mm, TRUE);
  std::ranges::copy(profile->heights, gwy_data_line_get_data(once));
  table.row("Rz", rough->rz, gwy_data_line_get_xtm(once, profile->lengths, 1),
            heightOfSamplings(profile->heights, profile->lengths));
  g_object_unref(once);
}

bool compare(const std::string& path) {
  JobControl job;
  const auto imported = importField(path, {}, job);
  if (!imported) {
    fmt::print(stderr, "{}\n", imported.error().line());
    return false;
  }
  const Version& field = imported->field;
  const double mm = field.grid().height_unit.mm;
  const auto fit = fitForm(field, {.degree = 1, .region = Region::kAll, .robust = false}, job);
  if (!fit) return false;
  const auto measured = measureAreal(field, fit->form, {}, job);
  if (!measured) return false;
  const auto surface = surfaceOf(field, fit->form, measured->mean, Region::kAll, job);
  if (!surface) return false;
  const PeerField peer = peerFieldOf(field);
  double average = 0.0, sa = 0.0, sq = 0.0, skew = 0.0, kurtosis = 0.0, low = 0.0, high = 0.0;
  gwy_data_field_area_get_stats_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0, peer.width, peer.height,
                                     &average, &sa, &sq, &skew, &kurtosis);
  gwy_data_field_area_get_min_max_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0, peer.width, peer.height,
                                       &low, &high);
  Table table(path.substr(path.rfind('/') + 1));
  table.row("Sq", measured->sq * mm, sq);
  table.row("Sa", measured->sa * mm, sa);
  table.row("Ssk", measured->ssk, skew);
  table.row("Sku", measured->sku, kurtosis, measured->sku - 3.0);
  table.row("Sp", measured->sp * mm, high - average);
  table.row("Sv", measured->sv * mm, average - low);
  table.row("Sz", measured->sz * mm, high - low);
  table.row("Sdq", measured->sdq,
            gwy_data_field_area_get_surface_slope_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0,
                                                       peer.width, peer.height),
            slopeOfLinks(peer));
  // As an area: its excess has the rounding of the whole.
  const double area = gwy_data_field_area_get_surface_area_mask(peer.data, peer.mask, GWY_MASK_INCLUDE, 0, 0,
                                                                peer.width, peer.height);
  const double projected = static_cast<double>(measured->samples) * peer.dx * peer.dy;
  table.row("1 + Sdr", 1.0 + measured->sdr, area / projected, 1.0 + areaOfTriangles(peer));
  const auto correlated = correlate(*surface, job);
  if (!correlated) return false;
  const Autocorrelation other = peerCorrelation(peer, *surface);
  double difference = 0.0;
  for (std::size_t i = 0; i < other.values.size(); ++i)
    if (!std::isnan(correlated->correlation.values[i]))
      difference = std::max(difference, std::abs(other.values[i] - correlated->correlation.values[i]));
  table.row("autocorrelation, 1 + largest difference", 1.0 + difference, 1.0);
  if (!std::isnan(correlated->parameters.sal))
    table.row("Sal of it [mm]", shortestDecay(correlated->correlation), shortestDecay(other));
  compareProfile(field, table);
  g_object_unref(peer.data);
  g_object_unref(peer.mask);
  return !table.failed();
}

}  // namespace

int main(int count, char** arguments) {
  gwy_process_type_init();
  fmt::print(
      "| scan | parameter | Fettle | Gwyddion | relative difference | with Gwyddion's definition |\n"
      "|---|---|---|---|---|---|\n");
  bool agree = count > 1;
  for (int i = 1; i < count; ++i) agree = compare(arguments[i]) && agree;
  return agree ? 0 : 1;
}

#include "render/plan/overlay.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/plan/colour_map.h"
#include "render/plan/number_text.h"

namespace fettle::render {
namespace {

glm::vec3 rgb(int hex) {
  const auto channel = [hex](int shift) {
    return static_cast<float>(linearFromSrgb(((hex >> shift) & 0xFF) / 255.0));
  };
  return {channel(16), channel(8), channel(0)};
}

// Collects quads; sizes in pixels of the finished picture.
class Pen {
 public:
  Pen(std::vector<gpu::Quad>& quads, Glyphs& glyphs) : quads_(quads), glyphs_(glyphs) {}

  void box(double left, double top, double width, double height, const glm::vec3& colour,
           float opacity = 1.0F) {
    put({left, top, left + width, top + height}, {}, colour, opacity, gpu::kFillSolid);
  }
  // Left end of the text at x, its baseline at y; rounded to whole pixels, otherwise the light hinting is
  // lost.
  void text(double x, double y, const std::string& what, int px, Glyphs::Weight weight,
            const glm::vec3& colour) {
    double pen = std::round(x);
    const double base = std::round(y);
    for (const char32_t c : charactersOf(what)) {
      const Glyphs::Glyph& g = glyphs_.glyph(c, px, weight);
      if (g.width > 0) {
        const double left = std::round(pen) + g.left, top = base - g.top;
        put({left, top, left + g.width, top + g.height}, {g.x, g.y, g.x + g.width, g.y + g.height}, colour,
            1.0F, gpu::kFillGlyph);
      }
      pen += g.advance;
    }
  }
  void put(const glm::dvec4& pixels, const glm::dvec4& uv, const glm::vec3& colour, float opacity, int fill) {
    quads_.push_back(
        {glm::vec4(pixels), glm::vec4(uv), glm::vec4(colour, opacity), glm::ivec4(fill, 1, 0, 0)});
  }
  // The largest font size, `px` at most, in which every line is at most `room` wide; 0 when none is legible.
  // Text with a number is fitted so and never truncated: a truncated number is another number.
  int sizeFor(const std::vector<std::string>& lines, double room, int px, Glyphs::Weight weight) {
    const auto fits = [&](int size) {
      return std::all_of(lines.begin(), lines.end(),
                         [&](const std::string& line) { return glyphs_.width(line, size, weight) <= room; });
    };
    while (px >= kSmallestPx && !fits(px)) --px;
    return px >= kSmallestPx ? px : 0;
  }
  // User's text, or text without numbers, truncated with an ellipsis to at most `room` wide.
  std::string fitted(const std::string& what, double room, int px, Glyphs::Weight weight) {
    if (glyphs_.width(what, px, weight) <= room) return what;
    std::string cut = what;
    while (!cut.empty()) {
      // Whole characters: continuation bytes go with their first one.
      while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
      if (!cut.empty()) cut.pop_back();
      if (glyphs_.width(cut + "\u2026", px, weight) <= room) return cut + "\u2026";
    }
    return {};
  }
  [[nodiscard]] Glyphs& glyphs() noexcept { return glyphs_; }

 private:
  static constexpr int kSmallestPx = 8;
  std::vector<gpu::Quad>& quads_;
  Glyphs& glyphs_;
};

constexpr auto kRegular = Glyphs::Weight::kRegular;
constexpr auto kBold = Glyphs::Weight::kBold;

// The lines of the note under the colour bar, at the size that shows them completely.
struct NoteLines {
  std::vector<std::string> lines;
  int px = 0;
};

// First unchanged, then smaller, then a word and its number one below the other; empty: does not fit.
NoteLines noteLines(Pen& pen, const std::string& note, double room, int px) {
  NoteLines whole, split;
  for (std::size_t from = 0; from <= note.size();) {
    const std::size_t to = std::min(note.find('\n', from), note.size());
    const std::string line = note.substr(from, to - from);
    whole.lines.push_back(line);
    const std::size_t space = line.find(' ');
    split.lines.push_back(line.substr(0, space));
    if (space != std::string::npos) split.lines.push_back(line.substr(space + 1));
    from = to + 1;
  }
  for (NoteLines* candidate : {&whole, &split}) {
    candidate->px = pen.sizeFor(candidate->lines, room, px, kRegular);
    if (candidate->px > 0) return *candidate;
  }
  return {};
}

struct TitleLines {
  std::vector<std::string> lines;
  int px = 0;
};

// First smaller, then in lines of whole words one below the other, and only what that leaves no room for is cut: two titles that
// begin alike are told apart by the numbers at their ends.
TitleLines titleLines(Pen& pen, const std::string& title, double room, int px) {
  constexpr std::size_t kMost = 3;
  const int least = std::min(px, std::max(10, static_cast<int>(std::lround(0.7 * px))));
  if (const int whole = pen.sizeFor({title}, room, px, kBold); whole >= least) return {{title}, whole};
  TitleLines found{{}, least};
  std::vector<std::string>& lines = found.lines;
  for (std::size_t from = 0; from < title.size();) {
    const std::size_t to = std::min(title.find(' ', from), title.size());
    const std::string word = title.substr(from, to - from);
    from = to + 1;
    const std::string longer = lines.empty() ? std::string() : lines.back() + " " + word;
    const bool last = lines.size() == kMost;
    if (!lines.empty() && (last || pen.glyphs().width(longer, least, kBold) <= room))
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  for (std::string& line : lines) line = pen.fitted(line, room, least, kBold);
  return found;
}

void colourBar(Pen& pen, const Layout& layout, const View& view, const DecorationContent& f,
               const Palette& palette, std::vector<std::string>& warnings) {
  const double s = layout.scale;
  const Rectangle& plot = layout.plots.back();
  const double left = std::round(plot.x + plot.width + 16 * s);
  const double width = std::round(18 * s);
  const double room = view.width - left - 4 * s;
  const double line = layout.text_px * 1.3;
  const double tip = std::round(12 * s);

  const ShownUnit& unit = f.height_unit;
  const std::string unit_text = "[" + unit.name + "]";
  const double low = f.range.low * unit.per_unit, high = f.range.high * unit.per_unit;

  double y = plot.y + line * 0.9;
  const int name_px = pen.sizeFor({f.quantity}, room, layout.text_px, kBold);
  pen.text(left, y, name_px > 0 ? f.quantity : pen.fitted(f.quantity, room, layout.text_px, kBold),
           name_px > 0 ? name_px : layout.text_px, kBold, palette.ink);
  if (const int px = pen.sizeFor({unit_text}, room, layout.text_px, kRegular); px > 0)
    pen.text(left, y + line, unit_text, px, kRegular, palette.ink);
  else
    warnings.emplace_back("no room for the unit of the colours, make the picture larger");
  const double top = std::round(y + 1.8 * line + tip);
  const int small = std::max(9, static_cast<int>(std::lround(layout.text_px * 0.8)));
  NoteLines note;
  const auto bottomAbove = [&] {
    // Three lines of the usual size fit the reserved height; a note of more lines gets what it needs.
    const double notes =
        note.lines.empty()
            ? 0.0
            : std::max(3.4 * line, 1.1 * line + static_cast<double>(note.lines.size()) * note.px * 1.35);
    return std::round(plot.y + plot.height - tip - notes - 0.4 * line);
  };
  if (!f.note.empty()) note = noteLines(pen, f.note, room, small);
  if (bottomAbove() - top < 2 * line) note = {};
  if (note.lines.empty() && !f.note.empty())
    warnings.emplace_back("no room for the note under the colour bar, make the picture larger");
  const double bottom = bottomAbove();
  if (bottom - top < 2 * line) {
    warnings.emplace_back("no room for the colour bar, make the picture higher");
    return;
  }
  pen.put({left, top, left + width, bottom}, {0.0, 1.0, 0.0, 0.0}, palette.ink, 1.0F, gpu::kFillColours);
  if (f.above) pen.put({left, top - tip, left + width, top}, {-1, 0, 1, 1}, palette.ink, 1.0F, gpu::kFillUp);
  if (f.below)
    pen.put({left, bottom, left + width, bottom + tip}, {-1, 1, 1, 0}, palette.ink, 1.0F, gpu::kFillDown);
  const int wanted = std::clamp(static_cast<int>((bottom - top) / (3.2 * line)), 2, 9);
  const std::vector<Tick> steps = ticks(low, high, wanted);
  std::vector<std::string> figures;
  figures.reserve(steps.size());
  for (const Tick& tick : steps) figures.push_back(tick.text);
  const double text_left = left + width + 9 * s;
  const int figures_px = pen.sizeFor(figures, view.width - text_left - 2 * s, layout.text_px, kRegular);
  if (figures_px == 0)
    warnings.emplace_back("no room for the figures of the colour bar, make the picture larger");
  for (const Tick& tick : steps) {
    const double at = std::round(bottom - (tick.value - low) / (high - low) * (bottom - top));
    pen.box(left + width, at - std::round(0.5 * s), std::round(5 * s), std::max(1.0, std::round(s)),
            palette.ink);
    if (figures_px > 0)
      pen.text(text_left, at + figures_px * 0.36, tick.text, figures_px, kRegular, palette.ink);
  }
  double note_y = bottom + tip + 1.1 * line;
  for (const std::string& words : note.lines) {
    pen.text(left, note_y, words, note.px, kRegular, palette.faint_ink);
    note_y += note.px * 1.35;
  }
}

// The stripes of shading.glsl, over a square of the grey that they are on.
void hatch(Pen& pen, double left, double top, double side, const glm::vec3& grey, double scale) {
  const double period = hatchPeriod(scale), dark = period / gpu::kHatchStripes;
  const glm::vec3 stripe = grey / static_cast<float>(gpu::kHatchShade);
  const auto rows = static_cast<int>(side);
  const auto stripes = static_cast<int>(std::ceil(side / period)) + 1;
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < stripes; ++k) {
      const double at = k * period - std::fmod(left + top + row, period);
      const double from = std::max(0.0, at), to = std::min(side, at + dark);
      if (to > from) pen.box(left + from, top + row, to - from, 1.0, stripe);
    }
}

// A line of a round length, its label, the vertical exaggeration, and what the special colours mean.
void bottomLine(Pen& pen, const Layout& layout, const View& view, const DecorationContent& f,
                const Palette& palette, std::vector<std::string>& warnings) {
  const double s = layout.scale;
  const Rectangle& plot = layout.plots.front();
  // Under the lowest row of panels.
  const Rectangle& lowest = layout.plots.back();
  const double middle = std::round(lowest.y + lowest.height + (view.height - lowest.y - lowest.height) * 0.5);
  const double base = middle + layout.text_px * 0.36;
  double x = plot.x;

  const double longest = 0.22 * plot.width / f.pixels_per_mm / f.lateral_unit.mm;  // [lateral_unit]
  // In the unit of the other lengths as long as that needs no more than two decimals.
  const double shown = longest * f.length_unit.per_unit;
  const ShownUnit unit =
      shown >= 0.01 && shown < 1e5 ? f.length_unit : shownUnit(f.lateral_unit, longest, 0.5, 2e3);
  const double length = roundDown125(longest * unit.per_unit);
  const double bar = length / unit.per_unit * f.lateral_unit.mm * f.pixels_per_mm;
  const std::string label =
      (f.approximate_scale ? "\u2248 " : "") + ticks(0.0, length, 2).back().text + " " + unit.name;
  const double thick = std::max(2.0, std::round(3 * s)), cap = std::round(6 * s);
  if (x + bar + pen.glyphs().width(label, layout.text_px, kRegular) > view.width) {
    warnings.emplace_back("no room for the scale bar, make the picture wider");
    return;
  }
  pen.box(x, middle - std::floor(thick / 2), std::round(bar), thick, palette.ink);
  pen.box(x, middle - cap, std::max(1.0, std::round(1.5 * s)), 2 * cap, palette.ink);
  pen.box(x + std::round(bar) - std::max(1.0, std::round(1.5 * s)), middle - cap,
          std::max(1.0, std::round(1.5 * s)), 2 * cap, palette.ink);
  x += std::round(bar) + 10 * s;
  const auto add = [&](const std::string& what, const glm::vec3& colour) {
    const double width = pen.glyphs().width(what, layout.text_px, kRegular);
    if (x + width > view.width - 4 * s) {
      warnings.emplace_back("no room for \"" + what + "\", make the picture wider");
      return false;
    }
    pen.text(x, base, what, layout.text_px, kRegular, colour);
    x += width + 26 * s;
    return true;
  };
  if (!add(label, palette.ink)) return;
  if (f.exaggeration != 1.0 && view.elevation_deg < 90.0)
    if (!add("heights \u00d7 " + fmt::format("{:.4g}", f.exaggeration), palette.faint_ink)) return;
  const auto swatch = [&](const glm::vec3& colour, const std::string& what) {
    const double side = std::round(13 * s);
    if (x + side + pen.glyphs().width(what, layout.text_px, kRegular) > view.width - 8 * s) return;
    pen.box(x, middle - std::floor(side / 2), side, side, colour);
    x += side + 7 * s;
    (void)add(what, palette.ink);
  };
  if (f.no_data) swatch(palette.no_data, "no data");
  if (!f.without.empty()) {
    const double at = x;
    swatch(palette.no_data, f.without);
    if (x > at)
      hatch(pen, at, middle - std::floor(std::round(13 * s) / 2), std::round(13 * s), palette.no_data, s);
  }
  if (f.marks) swatch(palette.marks, "marked");
  if (f.suggested) swatch(palette.suggested, "suggested");
}

// What the colours of lines mean, smaller and under all that is always there: nothing moves when lines come and go. At the
// right: under the scale bar a short line with a word would be read as its label.
void linesRow(Pen& pen, const Layout& layout, const View& view, const DecorationContent& f,
              const Palette& palette, std::vector<std::string>& warnings) {
  if (f.lines.empty()) return;
  const double s = layout.scale;
  const Rectangle& lowest = layout.plots.back();
  const int px = std::max(8, static_cast<int>(std::lround(layout.text_px * 0.8)));
  const double below = view.height - lowest.y - lowest.height;
  const double middle = std::round(lowest.y + lowest.height + below - 0.6 * px);
  const double long_side = std::round(18 * s), thick = std::max(3.0, std::round(4 * s));
  const double rim = std::max(1.0, std::round(s));
  const auto widthOf = [&](const LineMeaning& line) {
    return pen.glyphs().width(std::string(line.name), px, kRegular);
  };
  const double apart = 18 * s;
  double all = -apart;
  for (const LineMeaning& line : f.lines) all += long_side + 6 * s + widthOf(line) + apart;
  const double left = layout.plots.front().x + rim, right = lowest.x + lowest.width - rim;
  double x = std::round(std::max(left, right - all));
  for (const LineMeaning& line : f.lines) {
    const std::string name(line.name);
    const double width = widthOf(line);
    if (x + long_side + 6 * s + width > view.width - 4 * s) {
      warnings.emplace_back("no room for \"" + name + "\", make the picture wider");
      return;
    }
    // Some are as dark, or as light, as the ground.
    pen.box(x - rim, middle - std::floor(thick / 2) - rim, long_side + 2 * rim, thick + 2 * rim,
            palette.faint_ink);
    pen.box(x, middle - std::floor(thick / 2), long_side, thick, line.colour);
    x += long_side + 6 * s;
    pen.text(x, middle + px * 0.36, name, px, kRegular, palette.ink);
    x += width + apart;
  }
}

}  // namespace

Palette paletteOf(Theme theme, ColourMap map) {
  Palette p;
  const bool light = theme == Theme::kLight;
  p.ground = rgb(light ? 0xF7F7F5 : 0x17191D);
  p.ink = rgb(light ? 0x1B1E23 : 0xE8EAED);
  p.faint_ink = rgb(light ? 0x5A6068 : 0xA3A9B2);
  p.no_data = rgb(light ? 0xA6A8AB : 0x6A6D72);
  p.wall = rgb(light ? 0x8B9099 : 0x565B63);
  // Vermilion is distinct from viridis, cividis and grey; on blue-white-red it would be read as a value.
  p.marks = rgb(map == ColourMap::kDiverging ? 0x12A150 : 0xFF3B1F);
  // Distinct from the maps and from the marks, for colour-blind users by its lightness.
  p.suggested = rgb(map == ColourMap::kDiverging ? 0xB8860B : 0xFF9DF5);
  return p;
}

Layout layOut(const View& view, Decoration decoration, int panels, Titles titles, double scale) {
  Layout layout;
  // The margins below, at scale 1, are two fifths of these.
  constexpr double kWidth = 2.5 * (20 + 116), kHeight = 2.5 * (48 + 46);
  const double wanted = scale > 0.0 ? std::min({scale, view.width / kWidth, view.height / kHeight})
                                    : std::min(view.width / 1280.0, view.height / 800.0);
  layout.scale = std::clamp(wanted, 0.6, 6.0);
  layout.text_px = std::max(10, static_cast<int>(std::lround(15.0 * layout.scale)));
  const bool above = titles == Titles::kAbove;
  layout.title_px = static_cast<int>(std::lround(layout.text_px * (above ? 1.2 : 1.0)));
  layout.title_above = (above ? 14.0 : 3.0) * layout.scale;
  const double s = layout.scale;
  // Below this size the decorations would leave no room for the surface.
  layout.decorated = decoration == Decoration::kFull && view.width >= 200 && view.height >= 140;
  const auto px = [s](double at_full_size) { return static_cast<int>(std::lround(at_full_size * s)); };
  const int left = layout.decorated ? px(20) : 0, top = layout.decorated ? px(above ? 48 : 18) : 0;
  const int right = layout.decorated ? std::max(px(116), 72) : 0, bottom = layout.decorated ? px(46) : 0;
  const int gap = panels > 1 ? px(16) : 0;
  const int width = (view.width - left - right - gap * (panels - 1)) / panels;
  for (int i = 0; i < panels; ++i)
    layout.plots.push_back({left + i * (width + gap), top, width, view.height - top - bottom});
  return layout;
}

std::vector<gpu::Quad> decorationQuads(const Layout& layout, const View& view,
                                       const DecorationContent& decorations, const Palette& palette,
                                       Glyphs& glyphs, std::vector<std::string>& warnings) {
  std::vector<gpu::Quad> quads;
  if (!layout.decorated) return quads;
  const std::int64_t lost = glyphs.lost();
  Pen pen(quads, glyphs);
  for (std::size_t i = 0; i < layout.plots.size() && i < decorations.titles.size(); ++i) {
    const Rectangle& plot = layout.plots[i];
    const TitleLines title = titleLines(pen, decorations.titles[i], plot.width, layout.title_px);
    double y = plot.y - layout.title_above;
    for (const std::string& line : title.lines) {
      pen.text(plot.x, y, line, title.px, kBold, palette.ink);
      y += 1.2 * title.px;
    }
  }
  if (decorations.colours) colourBar(pen, layout, view, decorations, palette, warnings);
  bottomLine(pen, layout, view, decorations, palette, warnings);
  linesRow(pen, layout, view, decorations, palette, warnings);
  if (glyphs.lost() != lost) warnings.emplace_back("some letters had no room in the glyph image");
  return quads;
}

}  // namespace fettle::render

// How much of the sky the surroundings of a point hide, and how the surface curves there, from the heights around it.
//
// Four lines through the point, two samples on each at equal distances: by how much the point lies below the middle of
// the two, over their distance, is the tangent of the angle by which they rise above it on both sides. It is zero on any
// plane, which therefore keeps its colour however it is tilted. Two lines along x and y reach as far as
// panel.around.xy, the two between them as far as panel.around.zw.
//
// Eye-dome lighting (Boucheny 2009, "Visualisation scientifique de grands volumes de donnees", chapter 4) compares the
// depth of pixels instead: it needs no heights, but darkens tilted planes, and shows how coarsely the surface is drawn,
// which is up to ten pixels while the view moves and without limit from straight above.

struct Surroundings {
  float hidden;  // 0 .. 1: mean over the lines of the sine of that angle, where the samples rise
  float hollow;  // -1 .. 1: the same, less where they fall: below 0 on ridges
};

// Heights are clipped as they are drawn.
float clipped(float height) { return clamp(height, panel.limits.x, panel.limits.y); }

// Between the corners of a cell.
float clippedBetween(vec4 h, vec2 f) {
  h = clamp(h, panel.limits.x, panel.limits.y);
  return mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
}

// Height of the point `d` steps from the point `f` of `cell`; false where it is not known. Cells larger than a pixel
// and a half: between samples.
bool heightAround(ivec2 cell, vec2 f, vec2 d, out float height) {
  height = 0.0;
  if (!kSmooth) {
    const ivec2 s = cell + ivec2(d);
    if (!inField(s)) return false;
    const uint raw = shadeHeight(s);
    if (kHoles && isHole(raw)) return false;
    height = clipped(heightOf(raw));
    return true;
  }
  const vec2 at = f + d, low = floor(at), g = at - low;
  const ivec2 s = cell + ivec2(low);
  if (!inField(s) || !inField(s + 1)) return false;
  const uvec4 raw = cellHeights(s);
  if (kHoles && (isHole(raw.x) || isHole(raw.y) || isHole(raw.z) || isHole(raw.w))) return false;
  height = clippedBetween(panel.relief.x * uintBitsToFloat(raw), g);
  return true;
}

// Of the point `f` of `cell`, at height `here`.
Surroundings surroundings(ivec2 cell, vec2 f, float here) {
  // On demand a coarser level may be all that is there.
  const int coarser = shade_log2 - panel.shade.x;
  const vec4 around = coarser > 0 ? max(round(panel.around / float(1 << coarser)), 1.0) : panel.around;
  const vec2 step_mm = panel.placing.zw * float(1 << shade_log2);
  // Small cells: the samples lie about the nearest one. What lies between it and the point is taken off along the slope
  // of the axes' samples, so that a plane is a plane.
  const vec2 off = kSmooth ? vec2(0.0) : f - round(f);
  if (!kSmooth) cell += ivec2(round(f));
  float rise[4], span[4];
  for (int line = 0; line < 4; ++line) {
    const vec2 d = line == 0   ? vec2(around.x, 0.0)
                   : line == 1 ? vec2(0.0, around.y)
                   : line == 2 ? around.zw
                               : vec2(around.z, -around.w);
    float after, before;
    const bool both = heightAround(cell, f, d, after) && heightAround(cell, f, -d, before);
    rise[line] = 0.5 * (after + before);
    span[line] = both ? length(d * step_mm) : 0.0;
    if (both && !kSmooth && line < 2) here -= off[line] * 0.5 * (after - before) / around[line];
  }
  Surroundings s = Surroundings(0.0, 0.0);
  for (int line = 0; line < 4; ++line) {
    if (span[line] == 0.0) continue;
    const float tangent = (rise[line] - here) * panel.relief.z / span[line];
    const float sine = tangent * inversesqrt(1.0 + tangent * tangent);
    s.hidden += 0.25 * max(sine, 0.0);
    s.hollow += 0.25 * sine;
  }
  return s;
}

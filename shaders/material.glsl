// A surface as a material: its light as a function of nothing but the direction of the normal in the picture, as the
// spheres are that sculpting programs look their light up in ("matcaps"; Sloan, Martin, Gooch, Gooch 2001, "The lit
// sphere"). The lights stand beside the viewer and turn with the view, upwards too, so that every direction in the picture
// has a brightness of its own. There is no image: level fields use few of a sphere's pixels, and would show their edges.
//
// render/plan/material.cpp holds the materials, and the same function in double precision.

// Unit vectors to the lights in the picture: right, up, to the viewer. A main one at the left, so far from above that level
// fields, which face up, are half lit and faint slopes change their light, and a weak one opposite.
const vec3 kMainLight = vec3(-0.7, 0.4, 0.5916);
const vec3 kFillLight = vec3(0.64, -0.3, 0.707);
const float kFill = 0.18;

// How bright the body is, 0 .. about 1, as a factor of its colour.
vec3 bodyLight(vec3 n) {
  const float reach = panel.material.body.w;
  const float lit = clamp((dot(n, kMainLight) + reach) / (1.0 + reach), 0.0, 1.0);
  return mix(panel.material.shadow.rgb, vec3(1.0), lit) + kFill * max(dot(n, kFillLight), 0.0);
}

// What a mirror shows: a bright window above, a paler one below, a dark horizon between them.
float mirrored(vec3 n) {
  const vec3 r = vec3(2.0 * n.z * n.xy, 2.0 * n.z * n.z - 1.0);
  const float above = (r.y - 0.55 + 0.35 * r.x) / 0.42, below = (r.y + 0.62) / 0.3;
  return 0.16 + 1.15 * exp(-above * above) + 0.4 * exp(-below * below) + 0.12 * max(r.z, 0.0);
}

float highlight(vec3 n, float strength, float exponent) {
  // Between the main light and the viewer.
  const vec3 h = normalize(kMainLight + vec3(0.0, 0.0, 1.0));
  return strength * pow(max(dot(n, h), 0.0), exponent);
}

// `colour` of a surface with this normal in the light of the material.
vec3 asMaterial(vec3 colour, vec3 normal) {
  const vec3 turned = vec3(dot(normal, panel.to_right.xyz), dot(normal, panel.to_top.xyz),
                           dot(normal, panel.to_viewer.xyz));
  const vec3 n = normalize(vec3(turned.xy, max(turned.z, 0.0)) + vec3(0.0, 0.0, 1e-4));
  const float values = panel.to_right.w;
  vec3 light = mix(bodyLight(n), vec3(mirrored(n)), panel.material.shadow.w);
  // The colours of values are exactly those of the bar where the surface is level, and of deviations less is taken.
  light = mix(vec3(1.0), light * mix(vec3(1.0), panel.of_level.rgb, values), panel.to_viewer.w);
  const float gloss = highlight(n, panel.material.gloss.x, panel.material.gloss.y) +
                      highlight(n, panel.material.gloss.z, panel.material.gloss.w);
  const vec3 rim = panel.material.rim.rgb * pow(1.0 - n.z, panel.material.rim.w);
  return max(colour * light + (1.0 - values) * (gloss + rim), 0.0);
}

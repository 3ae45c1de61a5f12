// Shadows that bodies cast, from the map that body_depth.vert filled.
layout(binding = kBodyShadowUnit) uniform sampler2DShadow body_shadow;

/// Share of the sun that passes the bodies. `offset_m`: how far along the normal to look, against self-shadowing.
float bodyShadow(vec3 rel, vec3 normal, float offset_m) {
  vec4 place = frame.shadow_from_rel * vec4(rel + normal * (offset_m + 1.5 * frame.look.y), 1.0);
  if (any(lessThan(place.xyz, vec3(0.0))) || any(greaterThan(place.xyz, vec3(1.0)))) return 1.0;
  vec2 texel = 1.0 / vec2(textureSize(body_shadow, 0));
  float seen = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) seen += texture(body_shadow, vec3(place.xy + vec2(x, y) * texel, place.z));
  return seen / 9.0;
}

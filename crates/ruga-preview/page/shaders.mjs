/** Shaders: the blend of wrinkle maps, and skin under one light. */

/**
 * `blendedNormal(uv)`: the maps of all active poses, each between its keys, over each other by reoriented
 * normal mapping (Barré-Brisebois and Hill 2012, *Blending in detail*). X along U, Y up, Z outwards.
 *
 * A row of `table` is a pose in one UDIM tile: layer, left and top of the map below, and the share of the map above;
 * those of the map above, and the number of the tile; width and height of both. Only the part of a map that wrinkles
 * is stored, and nothing is read beside it. Tiles lie side by side, two units apart; without any, the map repeats.
 */
export const BLEND = /* glsl */`
  precision highp sampler2DArray;
  uniform sampler2DArray maps;
  uniform highp sampler2D table;
  uniform int activePoses;
  uniform vec2 slotSize;
  uniform float mapSize;
  uniform bool hasTiles;

  vec3 layOver(vec3 base, vec3 detail) {
    vec3 t = base + vec3(0.0, 0.0, 1.0);
    vec3 u = detail * vec3(-1.0, -1.0, 1.0);
    return normalize(t * dot(t, u) - u * t.z);
  }

  vec3 mapNormal(vec3 place, vec2 size, vec2 uv, vec2 right, vec2 up) {
    vec2 at = uv * mapSize - place.yz;
    if (place.x < 0.0 || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, size))) return vec3(0.0, 0.0, 1.0);
    vec2 xy = (255.0 * textureGrad(maps, vec3(at / slotSize, place.x), right, up).rg - 128.0) / 127.0;
    return vec3(xy, sqrt(max(0.0, 1.0 - dot(xy, xy))));
  }

  vec3 blendedNormal(vec2 uv) {
    vec2 right = dFdx(uv) * mapSize / slotSize;
    vec2 up = dFdy(uv) * mapSize / slotSize;
    float tile = hasTiles ? floor(0.5 * (uv.x + 0.5)) : 0.0;
    uv -= hasTiles ? vec2(2.0 * tile, 0.0) : floor(uv);
    vec3 normal = vec3(0.0, 0.0, 1.0);
    for (int pose = 0; pose < activePoses; pose += 1) {
      vec4 below = texelFetch(table, ivec2(0, pose), 0);
      vec4 above = texelFetch(table, ivec2(1, pose), 0);
      if (above.w != tile) continue;
      vec4 sizes = texelFetch(table, ivec2(2, pose), 0);
      vec3 detail = mapNormal(above.xyz, sizes.zw, uv, right, up);
      if (below.w < 1.0) detail = normalize(mix(mapNormal(below.xyz, sizes.xy, uv, right, up), detail, below.w));
      normal = layOver(normal, detail);
    }
    return normal;
  }
`;

export const VERTEX = /* glsl */`
  in vec4 tangent;
  in float strain;
  out vec3 vNormal;
  out vec4 vTangent;
  out vec3 vPlace;
  out vec2 vUv;
  out float vStrain;
  void main() {
    vNormal = normal;
    vTangent = tangent;
    vPlace = position;
    vUv = uv;
    vStrain = strain;
    gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  }
`;

/** Numbers of the views that the fragment shader knows. */
export const VIEWS = { skin: 0, clay: 1, map: 2, compression: 3, plan: 4 };

export const FRAGMENT = /* glsl */`
  ${BLEND}
  uniform int view;
  uniform float strength;
  uniform vec3 toLight;
  uniform float strainLimit;
  uniform sampler2D overlay;
  in vec3 vNormal;
  in vec4 vTangent;
  in vec3 vPlace;
  in vec2 vUv;
  in float vStrain;
  out vec4 color;

  const float PI = 3.14159265;

  float ggx(vec3 n, vec3 l, vec3 v, float roughness) {
    float a = roughness * roughness;
    vec3 h = normalize(l + v);
    float nh = max(dot(n, h), 0.0);
    float nl = max(dot(n, l), 0.0);
    float nv = max(dot(n, v), 0.001);
    float d = nh * nh * (a * a - 1.0) + 1.0;
    float k = 0.5 * a;
    float visible = 0.25 / ((nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
    float fresnel = 0.028 + 0.972 * pow(1.0 - max(dot(v, h), 0.0), 5.0);
    return a * a / (PI * d * d) * visible * fresnel * nl;
  }

  // Light that enters skin leaves it around the place, red furthest: it reaches beyond the shadow's edge,
  // and sees a smoother surface (Penner and Borshukov 2011, pre-integrated skin shading).
  vec3 scattered(vec3 smoothNormal, vec3 detail, vec3 l, vec3 reach) {
    vec3 soft = 0.6 * reach;
    vec3 cosine = vec3(
      dot(normalize(mix(detail, smoothNormal, soft.r)), l),
      dot(normalize(mix(detail, smoothNormal, soft.g)), l),
      dot(normalize(mix(detail, smoothNormal, soft.b)), l));
    return max(cosine + reach, 0.0) / ((1.0 + reach) * (1.0 + reach));
  }

  vec3 lit(vec3 smoothNormal, vec3 n, vec3 v, bool isSkin) {
    vec3 base = isSkin ? vec3(0.56, 0.285, 0.19) : vec3(0.36);
    vec3 reach = isSkin ? vec3(0.20, 0.11, 0.08) : vec3(0.03);
    float high = 0.5 + 0.5 * n.y;
    vec3 around = mix(vec3(0.085, 0.075, 0.07), vec3(0.21, 0.225, 0.25), high);
    vec3 back = normalize(vec3(-toLight.x, 0.35, -toLight.z) + 0.25 * v);
    vec3 diffuse = 1.75 * scattered(smoothNormal, n, toLight, reach)
      + vec3(0.13, 0.15, 0.18) * scattered(smoothNormal, n, back, vec3(0.05)) + around;
    float shine = isSkin ? 0.75 * ggx(n, toLight, v, 0.48) + 0.35 * ggx(n, toLight, v, 0.30) : ggx(n, toLight, v, 0.6);
    float edge = pow(1.0 - max(dot(n, v), 0.0), 4.0);
    return base * diffuse + 1.9 * shine + 0.12 * edge * around;
  }

  // Red is compressed, blue is stretched, as in figures of this project.
  vec3 strainColor(float strain) {
    float t = clamp(strain / strainLimit, -1.0, 1.0);
    vec3 middle = vec3(0.80, 0.79, 0.77);
    vec3 end = t < 0.0 ? vec3(0.80, 0.13, 0.08) : vec3(0.10, 0.32, 0.78);
    return mix(middle, end, pow(abs(t), 0.8));
  }

  vec3 toScreen(vec3 light) {
    vec3 c = 1.0 - exp(-1.15 * light);
    return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  }

  void main() {
    vec3 v = normalize(cameraPosition - vPlace);
    // The inside of the mesh is seen from within. Slivers at the outline face away, too, but their normals do not.
    float side = !gl_FrontFacing && dot(vNormal, v) < 0.0 ? -1.0 : 1.0;
    vec3 bitangent = vTangent.w * cross(vNormal, vTangent.xyz);
    vec3 map = blendedNormal(vUv);
    map = normalize(vec3(strength * map.xy, map.z));
    vec3 smoothNormal = side * normalize(vNormal);
    vec3 n = side * normalize(map.x * vTangent.xyz + map.y * bitangent + map.z * vNormal);
    if (view == ${VIEWS.map}) {
      color = vec4(0.5 * map + 0.5, 1.0);
    } else if (view == ${VIEWS.compression} || view == ${VIEWS.plan}) {
      float shade = 0.62 + 0.38 * max(dot(n, normalize(toLight + 0.6 * v)), 0.0);
      vec3 paint = view == ${VIEWS.plan} ? texture(overlay, vUv).rgb : strainColor(vStrain);
      color = vec4(paint * shade, 1.0);
    } else {
      color = vec4(toScreen(lit(smoothNormal, n, v, view == ${VIEWS.skin})), 1.0);
    }
  }
`;

/** Draws the blended normals themselves, texel by texel of the map, first row at V = 0. */
export const TEXELS = /* glsl */`
  ${BLEND}
  out vec4 color;
  void main() {
    color = vec4(0.5 * blendedNormal(gl_FragCoord.xy / mapSize) + 0.5, 1.0);
  }
`;

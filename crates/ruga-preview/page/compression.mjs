/** How much a pose compresses or stretches the mesh, against the mesh at rest. */

/** Strain of a posed mesh, per vertex. */
export class Compression {
  constructor(preview) {
    this.preview = preview;
    this.groupCount = preview.groups.reduce((most, group) => Math.max(most, group + 1), 0);
    this.strains = new Float32Array(preview.positions.length / 3);
    this.rest = restShapes(preview);
  }

  /**
   * Strains of the vertices in the direction in which the skin is shortened most, negative where it is
   * compressed: means of the lesser principal strain of the triangles around, weighted by their area at rest.
   */
  of(positions) {
    const { triangles, groups } = this.preview;
    const sums = new Float64Array(this.groupCount);
    const areas = new Float64Array(this.groupCount);
    for (let t = 0; t < triangles.length; t += 3) {
      const [inverse1, inverse2, inverse3, area] = this.rest.subarray((4 * t) / 3, (4 * t) / 3 + 4);
      if (area === 0) continue;
      const strain = leastStrain(positions, triangles, t, [inverse1, inverse2, inverse3]);
      for (let corner = 0; corner < 3; corner += 1) {
        const group = groups[triangles[t + corner]];
        sums[group] += area * strain;
        areas[group] += area;
      }
    }
    for (let v = 0; v < groups.length; v += 1) this.strains[v] = sums[groups[v]] / (areas[groups[v]] || 1);
    return this.strains;
  }
}

/** Two edges of a triangle, from its first corner. */
function edges(p, triangles, t) {
  const [a, b, c] = [0, 1, 2].map((corner) => 3 * triangles[t + corner]);
  return [
    [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]],
    [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]],
  ];
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Per triangle: the inverse of its edge matrix at rest, which is triangular, and its area. */
function restShapes({ positions, triangles }) {
  const shapes = new Float64Array((triangles.length / 3) * 4);
  for (let t = 0; t < triangles.length; t += 3) {
    const [e, f] = edges(positions, triangles, t);
    const length = Math.sqrt(dot(e, e));
    const along = length > 0 ? dot(e, f) / length : 0;
    const across = Math.sqrt(Math.max(dot(f, f) - along * along, 0));
    if (length * across === 0) continue;
    shapes.set([1 / length, -along / (length * across), 1 / across, (length * across) / 2], (4 * t) / 3);
  }
  return shapes;
}

/** The lesser principal strain: `lambda - 1`, `lambda` the lesser singular value of the deformation gradient. */
function leastStrain(positions, triangles, t, [i11, i12, i22]) {
  const [e, f] = edges(positions, triangles, t);
  const first = e.map((value) => value * i11);
  const second = e.map((value, c) => value * i12 + f[c] * i22);
  const [aa, ab, bb] = [dot(first, first), dot(first, second), dot(second, second)];
  const mean = (aa + bb) / 2;
  const half = Math.hypot((aa - bb) / 2, ab);
  return Math.sqrt(Math.max(mean - half, 0)) - 1;
}

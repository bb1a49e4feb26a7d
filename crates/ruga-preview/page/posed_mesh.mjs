/** The mesh in a blend of poses: positions, normals and tangents, computed as the baker does. */

/** A mesh that follows the weights of its poses. */
export class PosedMesh {
  constructor(preview) {
    const count = preview.positions.length;
    this.preview = preview;
    this.positions = new Float32Array(preview.positions);
    this.normals = new Float32Array(count);
    /** Unit tangents along U; the fourth number is the sign of the bitangent, as in glTF. */
    this.tangents = new Float32Array((count / 3) * 4);
    this.groupCount = preview.groups.reduce((most, group) => Math.max(most, group + 1), 0);
    this.sums = new Float32Array(3 * this.groupCount);
    this.signs = tangentSigns(preview);
    this.take([]);
  }

  /** Takes the weights of the poses, a fraction each; what is left out is 0. */
  take(weights) {
    this.positions.set(this.preview.positions);
    this.add(this.positions, weights, 'deltas');
    this.updateNormals(weights);
    this.updateTangents();
  }

  add(values, weights, name) {
    this.preview.poses.forEach((pose, number) => {
      const weight = weights[number] ?? 0;
      if (weight === 0) return;
      const deltas = pose[name];
      for (let i = 0; i < pose.moved.length; i += 1) {
        const at = 3 * pose.moved[i];
        values[at] += weight * deltas[3 * i];
        values[at + 1] += weight * deltas[3 * i + 1];
        values[at + 2] += weight * deltas[3 * i + 2];
      }
    });
  }

  /** The file's normals where it says how its shapes change them, else means over triangles. */
  updateNormals(weights) {
    if (this.preview.normals) {
      this.normals.set(this.preview.normals);
      this.add(this.normals, weights, 'normalDeltas');
    } else {
      this.sumTriangles();
    }
    normalise(this.normals, 3);
  }

  /** Area-weighted sums around each group of vertices: smooth across seams, not across hard edges. */
  sumTriangles() {
    const { preview, positions: p, normals, sums } = this;
    const { triangles, groups } = preview;
    sums.fill(0);
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t];
      const b = 3 * triangles[t + 1];
      const c = 3 * triangles[t + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (let corner = 0; corner < 3; corner += 1) {
        const at = 3 * groups[triangles[t + corner]];
        sums[at] += nx;
        sums[at + 1] += ny;
        sums[at + 2] += nz;
      }
    }
    for (let v = 0; v < groups.length; v += 1) {
      for (let c = 0; c < 3; c += 1) normals[3 * v + c] = sums[3 * groups[v] + c];
    }
  }

  /**
   * Tangents of the posed mesh with the weights of MikkTSpace: of each triangle the direction of U, in the
   * plane of the vertex normal, times the angle at the corner. The tangents of the file are those of rest,
   * and three.js knows no change of them.
   */
  updateTangents() {
    const { preview, positions: p, normals: n, tangents, signs } = this;
    const { triangles, uvs } = preview;
    tangents.fill(0);
    for (let t = 0; t < triangles.length; t += 3) {
      for (let corner = 0; corner < 3; corner += 1) {
        const a = triangles[t + corner];
        const b = triangles[t + ((corner + 1) % 3)];
        const c = triangles[t + ((corner + 2) % 3)];
        const u1 = uvs[2 * b] - uvs[2 * a], v1 = uvs[2 * b + 1] - uvs[2 * a + 1];
        const u2 = uvs[2 * c] - uvs[2 * a], v2 = uvs[2 * c + 1] - uvs[2 * a + 1];
        const turn = Math.sign(u1 * v2 - u2 * v1);
        // Glued to the other side of a mirror a vertex would have no tangent at all.
        if (turn === 0 || -turn !== signs[a]) continue;
        const x = 3 * a, y = 3 * b, z = 3 * c;
        let ex = p[y] - p[x], ey = p[y + 1] - p[x + 1], ez = p[y + 2] - p[x + 2];
        let fx = p[z] - p[x], fy = p[z + 1] - p[x + 1], fz = p[z + 2] - p[x + 2];
        let tx = turn * (v2 * ex - v1 * fx), ty = turn * (v2 * ey - v1 * fy), tz = turn * (v2 * ez - v1 * fz);
        const nx = n[x], ny = n[x + 1], nz = n[x + 2];
        let out = tx * nx + ty * ny + tz * nz;
        tx -= out * nx; ty -= out * ny; tz -= out * nz;
        out = ex * nx + ey * ny + ez * nz;
        ex -= out * nx; ey -= out * ny; ez -= out * nz;
        out = fx * nx + fy * ny + fz * nz;
        fx -= out * nx; fy -= out * ny; fz -= out * nz;
        const length = Math.hypot(tx, ty, tz);
        const sides = Math.hypot(ex, ey, ez) * Math.hypot(fx, fy, fz);
        if (length === 0 || sides === 0) continue;
        const cosine = (ex * fx + ey * fy + ez * fz) / sides;
        const weight = Math.acos(Math.min(1, Math.max(-1, cosine))) / length;
        tangents[4 * a] += weight * tx;
        tangents[4 * a + 1] += weight * ty;
        tangents[4 * a + 2] += weight * tz;
      }
    }
    normalise(tangents, 4);
    for (let v = 0; v < signs.length; v += 1) tangents[4 * v + 3] = signs[v];
  }
}

/** Gives the first three of every `stride` numbers length 1. */
function normalise(values, stride) {
  for (let i = 0; i < values.length; i += stride) {
    const length = Math.hypot(values[i], values[i + 1], values[i + 2]);
    if (length > 0) {
      values[i] /= length;
      values[i + 1] /= length;
      values[i + 2] /= length;
    } else {
      values[i] = 1;
    }
  }
}

/** +1 where U, V up and the outside are right-handed for most triangles of a vertex, else -1. */
function tangentSigns({ triangles, uvs }) {
  const votes = new Float32Array(uvs.length / 2);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = triangles.subarray(t, t + 3);
    const area = (uvs[2 * b] - uvs[2 * a]) * (uvs[2 * c + 1] - uvs[2 * a + 1])
      - (uvs[2 * c] - uvs[2 * a]) * (uvs[2 * b + 1] - uvs[2 * a + 1]);
    for (const vertex of [a, b, c]) votes[vertex] -= Math.sign(area);
  }
  return votes.map((vote) => (vote < 0 ? -1 : 1));
}

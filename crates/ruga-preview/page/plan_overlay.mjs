/** Pictures of a plan, which lie on the mesh: one at a time is on the graphics card. */

import { DataTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, Texture } from 'three';
import { readPicture } from './data.mjs';

/** The picture of the pose that is on, or was last. */
export class PlanOverlay {
  constructor({ about, poses }) {
    const plain = about.plan?.colours[0][0] ?? [0, 0, 0];
    /** A mesh without a picture. */
    this.plain = new DataTexture(new Uint8Array([...plain, 255]), 1, 1);
    this.plain.needsUpdate = true;
    this.texture = this.plain;
    this.poses = poses;
    this.pose = 0;
    this.layer = 0;
    this.shown = null;
  }

  /** Chooses the pose of the largest weight; that of before where all are 0. */
  choose(weights) {
    const largest = Math.max(...weights);
    if (largest > 0) this.pose = weights.indexOf(largest);
  }

  /** Number of the picture of this pose and layer, if there is one. */
  get wanted() {
    return this.poses[this.pose]?.plan.overlays[this.layer] ?? null;
  }

  /** Takes the picture of the chosen pose and layer; resolves to whether that is still the one that is wanted. */
  async load() {
    const { wanted } = this;
    if (wanted === this.shown) return true;
    const picture = wanted === null ? null : await readPicture(`overlay${wanted}`);
    if (wanted !== this.wanted) return false;
    if (this.texture !== this.plain) this.texture.dispose();
    this.texture = picture === null ? this.plain : textureOf(picture);
    this.shown = wanted;
    return true;
  }
}

/** A texture whose first row is at V = 0, and whose numbers are the picture's. */
function textureOf(picture) {
  const texture = new Texture(picture);
  texture.flipY = false;
  texture.wrapS = RepeatWrapping;
  texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}

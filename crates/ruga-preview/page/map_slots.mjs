/** Wrinkle maps on the graphics card: a texture array whose layers are lent to the maps in use. */

import { DataTexture, ExternalTexture, FloatType, NearestFilter, RGBAFormat } from 'three';
import { readPicture } from './data.mjs';

/** Bytes of graphics memory for maps; more maps than that take turns. */
const BUDGET = 512e6;

/** Numbers of a pose in one UDIM tile in the table of the shader. */
const ROW = 12;

/** Code of a neutral texel, red and green. */
const NEUTRAL = 128;

/** The maps that are loaded, and the table of those that the shader blends. */
export class MapSlots {
  constructor(renderer, { about, poses }) {
    this.renderer = renderer;
    this.gl = renderer.getContext();
    this.about = about;
    /** Per pose and UDIM tile, the maps of its keys. */
    this.tiles = poses.map((pose) => byTile(pose.maps, about.maps));
    const rows = this.tiles.reduce((sum, tiles) => sum + tiles.length, 1);
    [this.width, this.height] = about.slot;
    const { gl } = this;
    this.layerBytes = (2 * this.width * this.height * 4) / 3;
    const most = Math.min(gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), Math.floor(BUDGET / this.layerBytes));
    /** Number of the map in each layer; null where it is free. */
    this.layers = new Array(Math.max(1, Math.min(about.maps.length, most))).fill(null);
    this.used = this.layers.map(() => 0);
    this.clock = 0;
    this.loading = new Map();
    this.levels = 1 + Math.floor(Math.log2(Math.max(this.width, this.height)));
    this.texture = this.allocate();
    this.table = new DataTexture(new Float32Array(ROW * rows), ROW / 4, rows, RGBAFormat, FloatType);
    this.table.minFilter = NearestFilter;
    this.table.magFilter = NearestFilter;
    this.active = 0;
  }

  /** Graphics memory of the maps, bytes. */
  get bytes() {
    return this.layers.length * this.layerBytes;
  }

  allocate() {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, this.levels, gl.RG8, this.width, this.height, this.layers.length);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    const anisotropy = gl.getExtension('EXT_texture_filter_anisotropic');
    if (anisotropy) gl.texParameteri(gl.TEXTURE_2D_ARRAY, anisotropy.TEXTURE_MAX_ANISOTROPY_EXT, 4);
    this.renderer.resetState();
    const wrapped = new ExternalTexture(texture);
    wrapped.isDataArrayTexture = true;
    return wrapped;
  }

  /**
   * Fills the table with the poses of these weights whose maps are there; returns the numbers of the maps
   * that are not.
   */
  blend(weights) {
    this.clock += 1;
    const missing = [];
    const { data } = this.table.image;
    this.active = 0;
    this.tiles.forEach((tiles, number) => {
      const weight = weights[number] ?? 0;
      if (weight <= 0) return;
      for (const maps of tiles) {
        const { below, above, share } = betweenKeys(maps, weight);
        const wanted = [below, above].filter((entry) => entry !== null).map((entry) => entry.map);
        const absent = wanted.filter((map) => !this.touch(map));
        missing.push(...absent);
        if (absent.length > 0) continue;
        const { tile } = this.about.maps[above.map];
        data.set([...this.place(below), share, ...this.place(above), tile, ...this.extent(below), ...this.extent(above)], ROW * this.active);
        this.active += 1;
      }
    });
    this.table.needsUpdate = true;
    return missing;
  }

  /** Whether a map is loaded, which is then the last to give up its layer. */
  touch(map) {
    const layer = this.layers.indexOf(map);
    if (layer >= 0) this.used[layer] = this.clock;
    return layer >= 0;
  }

  /** Layer of a map and where its left and upper edges lie in the whole map, texels. */
  place(entry) {
    if (entry === null) return [-1, 0, 0];
    const { left, top } = this.about.maps[entry.map];
    return [this.layers.indexOf(entry.map), left, top];
  }

  /** Columns and rows of a map that are stored. */
  extent(entry) {
    if (entry === null) return [0, 0];
    const { width, height } = this.about.maps[entry.map];
    return [width, height];
  }

  /** Loads a map into a free layer, or that of the map that was not used for longest. */
  load(map) {
    if (this.layers.includes(map)) return Promise.resolve(true);
    if (!this.loading.has(map)) {
      const done = this.fill(map).finally(() => this.loading.delete(map));
      this.loading.set(map, done);
    }
    return this.loading.get(map);
  }

  async fill(map) {
    const picture = await readPicture(`map${map}`);
    const layer = this.freeLayer();
    if (layer >= 0) {
      this.upload(layer, picture);
      this.layers[layer] = map;
      this.used[layer] = this.clock;
    }
    picture.close();
    return layer >= 0;
  }

  freeLayer() {
    const free = this.layers.indexOf(null);
    if (free >= 0) return free;
    const oldest = this.used.indexOf(Math.min(...this.used));
    // Maps of this very moment are not driven out by each other.
    return this.used[oldest] < this.clock ? oldest : -1;
  }

  upload(layer, picture) {
    const { gl } = this;
    const texture = this.texture.sourceTexture;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const put = (width, height, source) => gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, width, height, 1, gl.RG, gl.UNSIGNED_BYTE, source);
    if (picture.width < this.width || picture.height < this.height) {
      put(this.width, this.height, new Uint8Array(2 * this.width * this.height).fill(NEUTRAL));
    }
    put(picture.width, picture.height, picture);
    this.shrink(layer, texture);
    this.renderer.resetState();
  }

  /** Smaller copies of one layer: `generateMipmap` would make those of all of them again. */
  shrink(layer, texture) {
    const { gl } = this;
    const [from, to] = [gl.createFramebuffer(), gl.createFramebuffer()];
    const size = (level) => [this.width, this.height].map((side) => Math.max(1, side >> level));
    for (let level = 1; level < this.levels; level += 1) {
      gl.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
      gl.framebufferTextureLayer(gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, texture, level - 1, layer);
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
      gl.framebufferTextureLayer(gl.DRAW_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, texture, level, layer);
      gl.blitFramebuffer(0, 0, ...size(level - 1), 0, 0, ...size(level), gl.COLOR_BUFFER_BIT, gl.LINEAR);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(from);
    gl.deleteFramebuffer(to);
  }
}

/** The maps of a pose, keys ascending, in one list for each of its UDIM tiles. */
export function byTile(maps, places) {
  const tiles = new Map();
  for (const entry of maps) {
    const { tile } = places[entry.map];
    tiles.set(tile, [...(tiles.get(tile) ?? []), entry]);
  }
  return [...tiles.values()];
}

/** The maps on both sides of a weight among the keys of a pose; `below` is null for neutral at 0. */
export function betweenKeys(maps, weight) {
  const number = maps.findIndex((entry) => entry.key >= weight);
  const at = number < 0 ? maps.length - 1 : number;
  const above = maps[at];
  const below = maps[at - 1] ?? null;
  const start = below?.key ?? 0;
  const share = Math.min((weight - start) / (above.key - start), 1);
  return share === 1 ? { below: null, above, share } : { below, above, share };
}

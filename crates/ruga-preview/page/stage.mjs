/** What is seen: the mesh, its edges, camera and light. */

import {
  BufferAttribute, BufferGeometry, GLSL3, LineBasicMaterial, LineSegments, Mesh, PerspectiveCamera,
  Scene, ShaderMaterial, Sphere, Spherical, Vector2, Vector3, WebGLRenderTarget, WebGLRenderer, DoubleSide,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { FRAGMENT, TEXELS, VERTEX, VIEWS } from './shaders.mjs';
import { Compression } from './compression.mjs';
import { MapSlots } from './map_slots.mjs';
import { PlanOverlay } from './plan_overlay.mjs';
import { PosedMesh } from './posed_mesh.mjs';

/** Strain at the ends of the scale of the compression view. */
export const STRAIN_LIMIT = 0.25;

/** The picture, drawn anew when something has changed. */
export class Stage {
  constructor(canvas, preview) {
    this.preview = preview;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.slots = new MapSlots(this.renderer, preview);
    this.overlay = new PlanOverlay(preview);
    this.posed = new PosedMesh(preview);
    this.weights = preview.poses.map(() => 0);
    this.view = 'skin';
    this.light = { turn: -45, height: 32 };
    this.makeScene();
    this.makeCamera();
    this.aimLight();
    this.pending = false;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  makeScene() {
    const { preview, posed, slots } = this;
    const geometry = new BufferGeometry();
    const attribute = (values, size) => new BufferAttribute(values, size);
    geometry.setIndex(attribute(preview.triangles, 1));
    geometry.setAttribute('position', attribute(posed.positions, 3));
    geometry.setAttribute('normal', attribute(posed.normals, 3));
    geometry.setAttribute('tangent', attribute(posed.tangents, 4));
    geometry.setAttribute('uv', attribute(preview.uvs, 2));
    geometry.setAttribute('strain', attribute(new Float32Array(preview.uvs.length / 2), 1));
    this.uniforms = {
      maps: { value: slots.texture },
      table: { value: slots.table },
      activePoses: { value: 0 },
      slotSize: { value: new Vector2(slots.width, slots.height) },
      mapSize: { value: preview.about.size },
      hasTiles: { value: preview.about.tiles > 0 },
      view: { value: VIEWS.skin },
      strength: { value: 1 },
      toLight: { value: new Vector3() },
      strainLimit: { value: STRAIN_LIMIT },
      overlay: { value: this.overlay.texture },
    };
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: this.uniforms, side: DoubleSide,
      // Edges lie on the surface and would flicker through it.
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.lines = new LineSegments(edgeGeometry(geometry, preview.triangles),
      new LineBasicMaterial({ color: 0x0d1a26, transparent: true, opacity: 0.35 }));
    this.lines.frustumCulled = false;
    this.lines.visible = false;
    this.scene = new Scene();
    this.scene.add(this.mesh, this.lines);
  }

  makeCamera() {
    this.mesh.geometry.computeBoundingSphere();
    this.whole = this.mesh.geometry.boundingSphere ?? new Sphere();
    const { center, radius, direction } = this.preview.about.focus;
    this.focus = new Sphere(new Vector3(...center), radius);
    this.direction = new Vector3(...direction);
    this.camera = new PerspectiveCamera(28, 1, 0.01, 100);
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.enableDamping = false;
    this.orbit.zoomToCursor = true;
    this.orbit.addEventListener('change', () => this.redraw());
    this.frame('focus');
  }

  /** Looks at the skin that wrinkles (`focus`) or at all of the mesh (`whole`). */
  frame(what) {
    const sphere = what === 'focus' ? this.focus : this.whole;
    const radius = Math.max(sphere.radius, 1e-6);
    // Posed, the mesh is larger than at rest.
    const room = what === 'focus' ? 0.95 : 1.12;
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(1, this.camera.aspect);
    this.orbit.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).addScaledVector(this.direction, (room * radius) / Math.sin(half) / narrow);
    this.camera.near = this.whole.radius / 200;
    this.camera.far = this.whole.radius * 60;
    this.camera.updateProjectionMatrix();
    this.orbit.minDistance = this.whole.radius / 50;
    this.orbit.maxDistance = this.whole.radius * 20;
    this.orbit.update();
    this.redraw();
  }

  /** Goes round the mesh by angles (rad), and closer by a factor. */
  move(turn, tilt, factor) {
    const offset = this.camera.position.clone().sub(this.orbit.target);
    const sphere = new Spherical().setFromVector3(offset);
    sphere.theta += turn;
    sphere.phi += tilt;
    sphere.radius *= factor;
    sphere.makeSafe();
    this.camera.position.copy(this.orbit.target).add(offset.setFromSpherical(sphere));
    this.orbit.update();
    this.redraw();
  }

  /** Puts the light where `light` says: degrees around the upright axis and above the horizon. */
  aimLight() {
    const [turn, height] = [this.light.turn, this.light.height].map((degrees) => (degrees * Math.PI) / 180);
    // From the side that the page opens on.
    const start = Math.atan2(this.direction.x, this.direction.z);
    const flat = Math.cos(height);
    this.uniforms.toLight.value.set(flat * Math.sin(start + turn), Math.sin(height), flat * Math.cos(start + turn));
    this.redraw();
  }

  /** Poses the mesh and blends its maps; resolves when all maps that this takes are loaded. */
  async pose(weights) {
    this.weights = [...weights];
    this.posed.take(this.weights);
    const { attributes } = this.mesh.geometry;
    for (const name of ['position', 'normal', 'tangent']) attributes[name].needsUpdate = true;
    this.updateStrain();
    this.overlay.choose(this.weights);
    await this.showOverlay();
    return this.blend();
  }

  /** Lays the plan of a layer on the mesh, by its number. */
  setLayer(layer) {
    this.overlay.layer = layer;
    return this.showOverlay();
  }

  async showOverlay() {
    if (!this.preview.about.plan || !(await this.overlay.load())) return;
    this.uniforms.overlay.value = this.overlay.texture;
    this.redraw();
  }

  /** Returns whether every map that the weights ask for could be loaded. */
  async blend() {
    const missing = this.slots.blend(this.weights);
    this.uniforms.activePoses.value = this.slots.active;
    this.redraw();
    if (missing.length === 0) return true;
    const loaded = await Promise.all(missing.map((map) => this.slots.load(map)));
    this.slots.blend(this.weights);
    this.uniforms.activePoses.value = this.slots.active;
    this.redraw();
    return loaded.every(Boolean);
  }

  setView(view) {
    this.view = view;
    this.uniforms.view.value = VIEWS[view];
    this.updateStrain();
    this.redraw();
  }

  updateStrain() {
    if (this.view !== 'compression') return;
    this.compression ??= new Compression(this.preview);
    const { strain } = this.mesh.geometry.attributes;
    strain.array.set(this.compression.of(this.posed.positions));
    strain.needsUpdate = true;
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Draws with the next frame of the screen. */
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.pending = false;
    this.renderer.render(this.scene, this.camera);
  }

  /** Blended normals of every texel as bytes, red, green, blue and alpha, the top row of the map first. */
  texels() {
    const size = this.preview.about.size;
    const target = new WebGLRenderTarget(size, size, { depthBuffer: false });
    const corners = new BufferGeometry();
    corners.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: 'void main() { gl_Position = vec4(position, 1.0); }', fragmentShader: TEXELS, uniforms: this.uniforms,
    });
    const square = new Mesh(corners, material);
    square.frustumCulled = false;
    const scene = new Scene();
    scene.add(square);
    const bytes = new Uint8Array(4 * size * size);
    this.renderer.setRenderTarget(target);
    this.renderer.render(scene, this.camera);
    this.renderer.readRenderTargetPixels(target, 0, 0, size, size, bytes);
    this.renderer.setRenderTarget(null);
    target.dispose();
    return bytes;
  }
}

/** Every edge of the triangles once, on the positions of the mesh. */
function edgeGeometry(mesh, triangles) {
  const ends = [];
  const seen = new Set();
  const count = mesh.attributes.position.count;
  for (let t = 0; t < triangles.length; t += 3) {
    for (let corner = 0; corner < 3; corner += 1) {
      const [a, b] = [triangles[t + corner], triangles[t + ((corner + 1) % 3)]].sort((x, y) => x - y);
      const key = a * count + b;
      if (!seen.has(key)) ends.push(a, b);
      seen.add(key);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', mesh.attributes.position);
  geometry.setIndex(new BufferAttribute(new Uint32Array(ends), 1));
  return geometry;
}

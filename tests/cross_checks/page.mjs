/** The page of picture.mjs: `window.draw` shows the mesh once everything is loaded. */

import * as THREE from 'three';
import { GLTFLoader } from 'three/loaders/GLTFLoader.js';
import { OBJLoader } from 'three/loaders/OBJLoader.js';
import { mergeVertices } from 'three/utils/BufferGeometryUtils.js';

/** Reoriented normal mapping: `detail` on `base`, both unit vectors (Barré-Brisebois and Hill 2012). */
const BLEND = `
  vec3 layOver(vec3 base, vec3 detail) {
    vec3 t = base + vec3(0.0, 0.0, 1.0);
    vec3 u = detail * vec3(-1.0, -1.0, 1.0);
    return normalize(t * dot(t, u) - u * t.z);
  }`;

/** The maps to the left and right of a weight among the keys of a pose, null for neutral. */
function between(maps, pose, weight) {
  const keys = maps.filter((map) => map.pose === pose && map.kind === 'normal');
  keys.sort((a, b) => a.key - b.key);
  const above = keys.find((map) => map.key >= weight) ?? keys.at(-1);
  const below = keys.filter((map) => map.key < above.key).at(-1) ?? null;
  const start = below?.key ?? 0;
  return { below, above, share: Math.min((weight - start) / (above.key - start), 1) };
}

async function texture(map) {
  const loaded = await new THREE.TextureLoader().loadAsync(map.file);
  loaded.flipY = false;
  loaded.anisotropy = 8;
  return loaded;
}

/** Makes a material shade with the blended maps of all poses that have a weight. */
async function wear(material, maps, weights) {
  const uniforms = {};
  let blend = 'vec3 mapN = vec3(0.0, 0.0, 1.0);';
  let declare = BLEND;
  for (const [index, [pose, weight]] of Object.entries(weights).entries()) {
    const { below, above, share } = between(maps, pose, weight);
    const sign = above.green === '+' ? '1.0' : '-1.0';
    const read = (name) => `(2.0 * texture2D(${name}, vNormalMapUv).xyz - 1.0) * vec3(1.0, ${sign}, 1.0)`;
    uniforms[`above${index}`] = { value: await texture(above) };
    uniforms[`below${index}`] = { value: below && await texture(below) };
    declare += `uniform sampler2D above${index}; uniform sampler2D below${index};`;
    const start = below ? read(`below${index}`) : 'vec3(0.0, 0.0, 1.0)';
    blend += `mapN = layOver(mapN, normalize(mix(${start}, ${read(`above${index}`)}, ${share.toFixed(6)})));`;
  }
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    const chunk = THREE.ShaderChunk.normal_fragment_maps;
    const blended = chunk.replace(/vec3 mapN = texture2D\( normalMap, vNormalMapUv \)[^;]*;/, blend);
    if (blended === chunk) throw new Error('three.js has changed: nowhere to put the blended maps');
    shader.fragmentShader = `${declare}\n${shader.fragmentShader.replace('#include <normal_fragment_maps>', blended)}`;
  };
}

/** The artist's mesh in the blended pose, wearing its maps. */
async function artistMesh(weights) {
  const manifest = await (await fetch('wrinkles.json')).json();
  const { scene } = await new GLTFLoader().loadAsync(`${manifest.mesh}.glb`);
  const mesh = scene.getObjectByProperty('isMesh', true);
  for (const [pose, weight] of Object.entries(weights)) {
    for (const [shape, full] of Object.entries(manifest.poses[pose])) {
      mesh.morphTargetInfluences[mesh.morphTargetDictionary[shape]] += full * weight;
    }
  }
  await wear(mesh.material, manifest.maps, weights);
  return mesh;
}

/** The simulated skin, smooth. */
async function simulatedSkin() {
  const mesh = (await new OBJLoader().loadAsync('skin.obj')).getObjectByProperty('isMesh', true);
  for (const name of ['normal', 'uv']) mesh.geometry.deleteAttribute(name);
  mesh.geometry = mergeVertices(mesh.geometry, 1e-7);
  mesh.geometry.computeVertexNormals();
  return mesh;
}

window.draw = async ({ weights, skin }) => {
  const mesh = skin ? await simulatedSkin() : await artistMesh(weights);
  Object.assign(mesh.material, { color: new THREE.Color(0.8, 0.6, 0.5), roughness: 0.6, metalness: 0, side: THREE.DoubleSide });
  const scene = new THREE.Scene();
  scene.add(mesh, new THREE.AmbientLight(0xffffff, 0.25));
  const light = new THREE.DirectionalLight(0xffffff, 3);
  light.position.set(-1, 1, 0.8);
  scene.add(light);

  const { center, radius } = new THREE.Box3().setFromObject(mesh).getBoundingSphere(new THREE.Sphere());
  const reach = 0.75 * radius;
  const camera = new THREE.OrthographicCamera(-reach, reach, reach, -reach, 0, 10 * radius);
  camera.position.copy(center).z += 5 * radius;
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(1024, 1024);
  document.body.append(renderer.domElement);
  renderer.render(scene, camera);
  return `${renderer.info.render.triangles} triangles, ${Object.entries(weights).map((w) => w.join(' ')).join(', ') || 'geometry'}`;
};

/** What stands in the page beside its scripts: a description, arrays of the mesh, and maps. */

/** Bytes of a base64 text. */
function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Takes the text of an element away from the page, so that it is not kept twice. */
function take(id) {
  const element = document.getElementById(id);
  const { textContent } = element;
  element.remove();
  return textContent;
}

/**
 * Reads the mesh: `about` is the description that `ruga` wrote, and the arrays have its names.
 *
 * Positions are metres, texture coordinates have V down, all numbers are little-endian.
 */
export function readPreview() {
  const about = JSON.parse(take('about'));
  const { buffer } = bytesOf(take('mesh'));
  const floats = ([start, count]) => new Float32Array(buffer, start, count);
  const integers = ([start, count]) => new Uint32Array(buffer, start, count);
  const poses = about.poses.map((pose) => ({
    ...pose,
    moved: integers(pose.moved),
    deltas: floats(pose.deltas),
    normalDeltas: pose.normal_deltas && floats(pose.normal_deltas),
  }));
  return {
    about,
    poses,
    positions: floats(about.mesh.positions),
    normals: about.mesh.normals && floats(about.mesh.normals),
    uvs: floats(about.mesh.uvs),
    triangles: integers(about.mesh.triangles),
    groups: integers(about.mesh.groups),
  };
}

/** The picture in an element, decoded without any change of its numbers. */
export async function readPicture(id) {
  const blob = new Blob([bytesOf(document.getElementById(id).textContent)], { type: 'image/png' });
  return createImageBitmap(blob, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
}

import {
  AnimationClip,
  BufferAttribute,
  BufferGeometry,
  Mesh,
  MeshStandardMaterial,
  NumberKeyframeTrack,
  Scene,
} from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";

/** A surface at an instant. */
export interface Frame {
  readonly t: number;
  readonly positions: Float32Array;
  readonly normals: Float32Array;
}

/**
 * A moving surface as a binary glTF file: the first frame, each other one as a morph target, and an animation whose
 * seconds are the unit of `t`, linear between the frames. The words are in the mesh's extras.
 */
export async function toGlb(
  frames: readonly Frame[],
  triangles: Uint32Array,
  words: readonly string[],
): Promise<ArrayBuffer> {
  const [first, ...others] = frames;
  if (first === undefined) throw new Error("an animation has at least one frame");
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute("position", new BufferAttribute(first.positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(first.normals, 3));
  geometry.morphTargetsRelative = true;
  const change = (to: Float32Array, from: Float32Array) =>
    new BufferAttribute(
      to.map((x, i) => x - (from[i] ?? 0)),
      3,
    );
  geometry.morphAttributes.position = others.map(({ positions }) => change(positions, first.positions));
  geometry.morphAttributes.normal = others.map(({ normals }) => change(normals, first.normals));
  const mesh = new Mesh(geometry, new MeshStandardMaterial({ color: 0xd9843b, roughness: 0.6, metalness: 0 }));
  mesh.name = "capsule";
  mesh.userData.provenance = words;
  // glTF has y upwards, the channel z.
  mesh.rotation.x = -Math.PI / 2;
  const scene = new Scene();
  scene.add(mesh);
  // At a frame, its own target counts alone; at the first one, none does.
  const weights = frames.flatMap((_, frame) => others.map((_, target) => (target + 1 === frame ? 1 : 0)));
  const times = frames.map(({ t }) => t);
  const track = new NumberKeyframeTrack("capsule.morphTargetInfluences", times, weights);
  const animations = others.length > 0 ? [new AnimationClip("motion", -1, [track])] : [];
  const file = await new GLTFExporter().parseAsync(scene, { binary: true, animations });
  if (!(file instanceof ArrayBuffer)) throw new Error("the exporter gave no binary file");
  return file;
}

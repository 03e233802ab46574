import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
} from "three";

/** Length of channel drawn on each side of the capsule; it fades out towards the ends. */
export const REACH = 7;

const CORNERS = [
  [-1, -1],
  [1, -1],
  [1, 1],
  [-1, 1],
] as const;

/** Whole x within reach of any place, and the vertices of a ring. */
const RINGS = 2 * REACH + 1;
const RING = 2 * CORNERS.length;

/** The channel around the capsule in space: four edges, a ring at each whole x, the wall below and the one behind. */
export class Channel {
  readonly group = new Group();
  readonly #wall = new MeshBasicMaterial({
    vertexColors: true,
    transparent: true,
    opacity: 0.07,
    side: DoubleSide,
    depthWrite: false,
  });
  readonly #edge = new LineBasicMaterial({ vertexColors: true, transparent: true });
  readonly #rings = new LineSegments(
    lines(new Float32Array(3 * RINGS * RING), new Float32Array(4 * RINGS * RING)),
    this.#edge,
  );
  #origin = Number.NaN;

  constructor() {
    this.#rings.frustumCulled = false;
    this.group.add(new LineSegments(edges(), this.#edge), this.#rings, ...this.#walls());
  }

  set colour(value: string) {
    this.#wall.color.set(value);
    this.#edge.color.set(value);
  }

  /** Places the rings around a centroid at the axial position `origin`. */
  moveTo(origin: number): void {
    if (origin === this.#origin) return;
    this.#origin = origin;
    const { position, color } = this.#rings.geometry.attributes;
    const first = Math.ceil(origin - REACH);
    for (let i = 0; i < RINGS * RING; i++) {
      const x = first + Math.floor(i / RING);
      // The ends of an edge, one edge after the other.
      const [y, z] = CORNERS[((i + 1) >> 1) % CORNERS.length] ?? [0, 0];
      position?.setXYZ(i, x - origin, y, z);
      color?.setXYZW(i, 1, 1, 1, (x % 5 === 0 ? 0.75 : 0.28) * fadeOut(x - origin));
    }
    for (const attribute of [position, color]) if (attribute) attribute.needsUpdate = true;
  }

  #walls(): Mesh[] {
    const plane = new PlaneGeometry(2 * REACH, 2, 2 * REACH, 1);
    const x = plane.getAttribute("position");
    const fades = Float32Array.from({ length: 4 * x.count }, (_, i) => (i % 4 === 3 ? fadeOut(x.getX(i >> 2)) : 1));
    plane.setAttribute("color", new BufferAttribute(fades, 4));
    const floor = new Mesh(plane, this.#wall);
    floor.position.z = -1;
    const back = new Mesh(plane, this.#wall);
    back.rotation.x = Math.PI / 2;
    back.position.y = 1;
    return [floor, back];
  }
}

/** 1 at the capsule, 0 at the ends of what is drawn. */
export function fadeOut(x: number): number {
  return Math.max(0, 1 - (x / REACH) ** 2);
}

function edges(): BufferGeometry {
  const along: number[] = [];
  const alpha: number[] = [];
  for (const [y, z] of CORNERS) {
    for (let x = -REACH; x < REACH; x++) {
      along.push(x, y, z, x + 1, y, z);
      alpha.push(1, 1, 1, fadeOut(x), 1, 1, 1, fadeOut(x + 1));
    }
  }
  return lines(Float32Array.from(along), Float32Array.from(alpha));
}

function lines(positions: Float32Array, colours: Float32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("color", new BufferAttribute(colours, 4));
  return geometry;
}

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
  readonly #rings = new LineSegments(new BufferGeometry(), this.#edge);
  #origin = Number.NaN;

  constructor() {
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
    const rings: number[] = [];
    const fades: number[] = [];
    for (let x = Math.ceil(origin - REACH); x <= origin + REACH; x++) {
      const at = x - origin;
      const fade = (x % 5 === 0 ? 0.75 : 0.28) * fadeOut(at);
      CORNERS.forEach(([y, z], i) => {
        const [nextY, nextZ] = CORNERS[(i + 1) % 4] ?? [y, z];
        rings.push(at, y, z, at, nextY, nextZ);
        fades.push(1, 1, 1, fade, 1, 1, 1, fade);
      });
    }
    this.#rings.geometry.dispose();
    this.#rings.geometry = lines(rings, fades);
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
  return lines(along, alpha);
}

function lines(positions: number[], colours: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(colours), 4));
  return geometry;
}

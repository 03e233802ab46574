import {
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  DoubleSide,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { Frame } from "../app/state";
import { label, onResize } from "./svg";

/** What the space view shows. All positions are relative to the capsule's centroid, which stays in mid-picture. */
export interface SolidScene {
  /** Node positions x, y, z, ...; read during the call, not kept. */
  readonly positions: Float32Array;
  /** Vertices at t = 0, when the centroid was at x = 0, where they are to be shown. */
  readonly initial: Float32Array | undefined;
  /** Axial position of the centroid in the laboratory frame. */
  readonly centroid: number;
  readonly frame: Frame;
  /** Curves on the membrane where the shown section planes cut it. */
  readonly cuts: readonly { readonly plane: Cut; readonly points: Float32Array }[];
}

export type Cut = "midplane" | "diagonal" | "transversal";

/** Length of channel drawn on each side of the capsule; it fades out towards the ends. */
const REACH = 7;
const HOME = new Vector3(-6.2, 3.6, 9.2);

/** The capsule in the channel, seen in space. */
export class Solid {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(24, 1, 1, 60);
  readonly #controls: OrbitControls;
  readonly #surface = new MeshStandardMaterial({ side: DoubleSide, roughness: 0.5, metalness: 0 });
  readonly #ghost = new MeshStandardMaterial({ transparent: true, opacity: 0.22, roughness: 0.8, depthWrite: false });
  readonly #wall = new MeshBasicMaterial({
    vertexColors: true,
    transparent: true,
    opacity: 0.07,
    side: DoubleSide,
    depthWrite: false,
  });
  readonly #edge = new LineBasicMaterial({ vertexColors: true, transparent: true });
  readonly #capsule = new Mesh(new BufferGeometry(), this.#surface);
  readonly #initial = new Mesh(new BufferGeometry(), this.#ghost);
  readonly #edges = new LineSegments(new BufferGeometry(), this.#edge);
  readonly #rings = new LineSegments(new BufferGeometry(), this.#edge);
  readonly #cuts: Record<Cut, Line2>;
  readonly #channel: Group;
  readonly #labels: HTMLElement;
  readonly #stage: HTMLElement;
  #width = 1;
  #height = 1;
  #shift = 0;
  #firstLabel = 0;

  /** Throws when the browser has no WebGL. */
  constructor(stage: HTMLElement) {
    this.#stage = stage;
    this.#renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "low-power" });
    const canvas = this.#renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute(
      "aria-label",
      "Capsule in the channel, in space. Drag or use the arrow keys to turn, + and − to zoom.",
    );
    this.#labels = document.createElement("div");
    this.#labels.className = "ring-labels";
    this.#labels.ariaHidden = "true";
    stage.replaceChildren(canvas, this.#labels);

    this.#initial.renderOrder = 2;
    // The curves on the membrane join its nodes, the surface bulges a little between: draw it that much farther away.
    this.#surface.polygonOffset = true;
    this.#surface.polygonOffsetFactor = 2;
    this.#surface.polygonOffsetUnits = 300;
    for (const mesh of [this.#capsule, this.#initial]) {
      mesh.frustumCulled = false;
    }
    this.#cuts = { midplane: cutLine(), diagonal: cutLine(), transversal: cutLine() };

    this.#channel = this.#walls();
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(-3, 7, 5);
    const rim = new DirectionalLight(0xffffff, 0.7);
    rim.position.set(6, -2, -5);
    this.#scene.add(new HemisphereLight(0xffffff, 0x8a98a3, 1.5), key, rim);
    this.#scene.add(
      this.#capsule,
      this.#initial,
      this.#edges,
      this.#rings,
      ...Object.values(this.#cuts),
      this.#channel,
    );

    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enablePan = false;
    // A finger that moves up or down scrolls the page; sideways it turns the capsule.
    canvas.style.touchAction = "pan-y";
    this.#controls.minDistance = 4;
    this.#controls.maxDistance = 26;
    this.#controls.addEventListener("change", () => this.#render());
    canvas.addEventListener("keydown", (event) => this.#turn(event));
    this.recolour();
    this.resetCamera();
    onResize(stage, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.#renderer.setSize(width, height);
      this.#camera.aspect = width / height;
      this.#frameCapsule();
      this.#render();
    });
  }

  /** Sets the surface's triangles, which all positions that follow refer to. */
  setTriangles(triangles: Uint32Array): void {
    for (const mesh of [this.#capsule, this.#initial]) {
      mesh.geometry.dispose();
      mesh.geometry = new BufferGeometry().setIndex(new BufferAttribute(triangles, 1));
    }
  }

  /** Shows the channel, or leaves it out for a model that has none. */
  setChannel(exists: boolean): void {
    for (const part of [this.#edges, this.#rings, this.#channel]) {
      part.visible = exists;
    }
    this.#labels.hidden = !exists;
  }

  /** Takes the colours of the theme; call it again when the theme changes. */
  recolour(): void {
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(`--${name}`).trim();
    this.#surface.color.set(colour("membrane"));
    this.#ghost.color.set(colour("wall"));
    this.#wall.color.set(colour("wall"));
    this.#edge.color.set(colour("wall"));
    for (const [plane, line] of Object.entries(this.#cuts)) {
      line.material.color.set(colour(plane));
    }
    this.#render();
  }

  resetCamera(): void {
    this.#camera.position.copy(HOME);
    this.#controls.target.set(0, 0, 0);
    this.#frameCapsule();
    this.#controls.update();
    this.#render();
  }

  /** Shows the capsule, or the empty channel. */
  draw(scene: SolidScene | undefined): void {
    for (const part of [this.#capsule, this.#initial, ...Object.values(this.#cuts)]) {
      part.visible = false;
    }
    if (scene !== undefined) this.#place(scene);
    this.#render();
  }

  #place(scene: SolidScene): void {
    this.#capsule.visible = true;
    replace(this.#capsule.geometry, scene.positions);
    this.#capsule.geometry.computeVertexNormals();
    if (scene.initial !== undefined) {
      this.#initial.visible = true;
      replace(this.#initial.geometry, scene.initial);
      this.#initial.position.x = -scene.centroid;
    }
    for (const { plane, points } of scene.cuts) {
      if (points.length < 6) continue;
      const line = this.#cuts[plane];
      line.geometry.dispose();
      line.geometry = new LineGeometry();
      line.geometry.setPositions(points);
      line.visible = true;
    }
    this.#drawChannel(scene.frame === "laboratory" ? scene.centroid : 0);
  }

  /** The four edges, and a ring at each whole x. */
  #drawChannel(origin: number): void {
    const first = Math.ceil(origin - REACH);
    this.#shift = origin;
    this.#firstLabel = first;
    const rings: number[] = [];
    const fades: number[] = [];
    const corners = [-1, -1, 1, -1, 1, 1, -1, 1] as const;
    for (let x = first; x <= origin + REACH; x++) {
      const at = x - origin;
      const fade = (x % 5 === 0 ? 0.75 : 0.28) * fadeOut(at);
      for (let i = 0; i < 4; i++) {
        const j = (i + 1) % 4;
        rings.push(at, corners[2 * i] ?? 0, corners[2 * i + 1] ?? 0, at, corners[2 * j] ?? 0, corners[2 * j + 1] ?? 0);
        fades.push(1, 1, 1, fade, 1, 1, 1, fade);
      }
    }
    this.#rings.geometry.dispose();
    this.#rings.geometry = lines(rings, fades);
    if (this.#edges.geometry.getAttribute("position") === undefined) {
      const along: number[] = [];
      const alpha: number[] = [];
      for (let i = 0; i < 4; i++) {
        for (let x = -REACH; x < REACH; x++) {
          along.push(
            x,
            corners[2 * i] ?? 0,
            corners[2 * i + 1] ?? 0,
            x + 1,
            corners[2 * i] ?? 0,
            corners[2 * i + 1] ?? 0,
          );
          alpha.push(1, 1, 1, fadeOut(x), 1, 1, 1, fadeOut(x + 1));
        }
      }
      this.#edges.geometry = lines(along, alpha);
    }
  }

  /** The wall below and the one behind, barely tinted. */
  #walls(): Group {
    const group = new Group();
    const plane = new PlaneGeometry(2 * REACH, 2, 2 * REACH, 1);
    const x = plane.getAttribute("position");
    const fades = Float32Array.from({ length: 4 * x.count }, (_, i) => (i % 4 === 3 ? fadeOut(x.getX(i >> 2)) : 1));
    plane.setAttribute("color", new BufferAttribute(fades, 4));
    const floor = new Mesh(plane, this.#wall);
    floor.rotation.x = -Math.PI / 2;
    floor.position.y = -1;
    const back = new Mesh(plane, this.#wall);
    back.position.z = -1;
    group.add(floor, back);
    return group;
  }

  /** Steps back on a narrow stage, so that the capsule and the walls around it fit its width. */
  #frameCapsule(): void {
    const wanted = 2.05 / Math.min(1, this.#camera.aspect * 0.62);
    const distance = wanted / Math.tan((this.#camera.fov * Math.PI) / 360);
    this.#camera.position.setLength(Math.min(distance, this.#controls.maxDistance));
    this.#camera.updateProjectionMatrix();
    this.#controls.update();
  }

  #turn(event: KeyboardEvent): void {
    const turns: Record<string, [number, number, number]> = {
      ArrowLeft: [-0.1, 0, 1],
      ArrowRight: [0.1, 0, 1],
      ArrowUp: [0, -0.1, 1],
      ArrowDown: [0, 0.1, 1],
      "+": [0, 0, 0.9],
      "-": [0, 0, 1.1],
    };
    const turn = turns[event.key];
    if (turn === undefined) return;
    const spherical = new Spherical().setFromVector3(this.#camera.position);
    spherical.theta += turn[0];
    spherical.phi = Math.min(Math.PI - 0.05, Math.max(0.05, spherical.phi + turn[1]));
    const { minDistance, maxDistance } = this.#controls;
    spherical.radius = Math.min(maxDistance, Math.max(minDistance, spherical.radius * turn[2]));
    this.#camera.position.setFromSpherical(spherical);
    this.#controls.update();
    this.#render();
    event.preventDefault();
    event.stopPropagation();
  }

  #render(): void {
    for (const line of Object.values(this.#cuts)) {
      line.material.resolution.set(this.#width, this.#height);
    }
    this.#renderer.render(this.#scene, this.#camera);
    this.#placeLabels();
  }

  /** Writes x beside the lower front edge, at each ring. */
  #placeLabels(): void {
    const count = 2 * REACH + 1;
    while (this.#labels.childElementCount < count) {
      this.#labels.append(document.createElement("span"));
    }
    const at = new Vector3();
    [...this.#labels.children].forEach((element, i) => {
      const x = this.#firstLabel + i;
      at.set(x - this.#shift, -1.13, 1.02).project(this.#camera);
      const span = element as HTMLElement;
      const fade = fadeOut(x - this.#shift);
      span.textContent = label(x);
      span.style.opacity = String(Math.abs(at.x) < 1 && Math.abs(at.y) < 1 ? fade : 0);
      span.style.transform = `translate(-50%, -50%) translate(${(((at.x + 1) * this.#width) / 2).toFixed(1)}px, ${(((1 - at.y) * this.#height) / 2).toFixed(1)}px)`;
    });
    this.#stage.dataset.rendered = "true";
  }
}

function cutLine(): Line2 {
  const line = new Line2(new LineGeometry(), new LineMaterial({ linewidth: 2.25 }));
  line.frustumCulled = false;
  line.renderOrder = 1;
  return line;
}

function lines(positions: number[], colours: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(colours), 4));
  return geometry;
}

function fadeOut(x: number): number {
  return Math.max(0, 1 - (x / REACH) ** 2);
}

/** Copies the positions into the geometry, whose buffer is made at the first call. */
function replace(geometry: BufferGeometry, positions: Float32Array): void {
  const attribute = geometry.getAttribute("position");
  if (attribute === undefined || attribute.count * 3 !== positions.length) {
    geometry.setAttribute("position", new BufferAttribute(positions.slice(), 3));
  } else {
    (attribute as BufferAttribute).copyArray(positions).needsUpdate = true;
  }
}

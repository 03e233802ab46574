import {
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  type InterleavedBufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  Plane,
  Scene,
  Spherical,
  type Texture,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { Camera, Clip } from "../app/schema";
import type { Messages } from "../messages/en";
import { Channel, fadeOut, REACH } from "./channel";
import { type ColourMap, colourTexture } from "./colours";
import { label, onResize, tidy } from "./svg";
import type { Trace } from "./view";

export type Cut = "midplane" | "diagonal" | "transversal";

/** One capsule. */
export interface SolidBody {
  readonly name: Trace["name"];
  /** Vertices x, y, z, ... relative to its centroid; read during the call, not kept. */
  readonly positions: Float32Array;
  /** Unit normals at the vertices. */
  readonly normals: Float32Array;
  /** Axial position of its centroid relative to the live one's. */
  readonly shift: number;
  /** Coordinates in the colour map's texture at the vertices; undefined: the body's own colour. */
  readonly colours: Float32Array | undefined;
}

/** The space view's content. All positions are relative to the live capsule's centroid, which stays in mid-picture. */
export interface SolidScene {
  /** The live one first; the others stand beside it, each in a part of the picture. */
  readonly bodies: readonly SolidBody[];
  /** The live one at t = 0, where it is to be shown. */
  readonly initial: SolidBody | undefined;
  /** Axial position that the channel's rings are numbered from, and what one of the drawn length is in their unit. */
  readonly origin: number;
  readonly factor: number;
  /** Curves on the membrane where the open section planes cut it. */
  readonly cuts: readonly { readonly plane: Cut; readonly points: Float32Array }[];
  /** The map that the bodies with such coordinates are coloured by. */
  readonly map: ColourMap;
  readonly clip: Clip;
  /** Pairs of ends of the lines that draw the undisturbed flow; undefined where it is not to be shown. */
  readonly flow: Float32Array | undefined;
}

/** Called when the browser takes the graphics context away, and when it gives it back. */
export interface ContextListener {
  readonly lost: () => void;
  readonly restored: () => void;
}

/** Where it is seen from, z upwards: from beside and a little above; along y; from the front, as the section across. */
const PLACES: Record<Camera, Vector3> = {
  oblique: new Vector3(-6.2, -9.2, 3.6),
  side: new Vector3(0, -1, 0),
  front: new Vector3(1, 0, 0),
};

/** Pixels between two numbers along the channel. */
const LEAST_APART = 20;

/** The half of the membrane that stays, seen from the oblique place: the curves in the plane itself stay too. */
const HALVES: Record<Exclude<Clip, "none">, readonly [surface: Plane, curves: Plane]> = {
  y: [new Plane(new Vector3(0, 1, 0), 0), new Plane(new Vector3(0, 1, 0), 0.01)],
  z: [new Plane(new Vector3(0, 0, -1), 0), new Plane(new Vector3(0, 0, -1), 0.01)],
};

/** The capsule in the channel, seen in space. */
export class Solid {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(24, 1, 1, 60);
  readonly #controls: OrbitControls;
  readonly #ghost = new MeshStandardMaterial({ transparent: true, opacity: 0.22, roughness: 0.8, depthWrite: false });
  readonly #initial = new Mesh(new BufferGeometry(), this.#ghost);
  readonly #channel = new Channel();
  readonly #cuts: Record<Cut, Line2> = { midplane: cutLine(), diagonal: cutLine(), transversal: cutLine() };
  readonly #flow = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  readonly #labels = document.createElement("div");
  readonly #stage: HTMLElement;
  /** A mesh for each body; the first is the live one's. */
  readonly #meshes: Mesh<BufferGeometry, MeshStandardMaterial>[] = [];
  #triangles: Uint32Array = new Uint32Array();
  readonly #textures = new Map<ColourMap, Texture>();
  /** How each body is coloured. */
  #painted = "";
  /** The names of the bodies on screen. */
  #shown: readonly Trace["name"][] = [];
  #width = 1;
  #height = 1;
  #origin = 0;
  #factor = 1;
  #live = "";

  /** Throws when the browser has no WebGL. */
  constructor(stage: HTMLElement, { lost, restored }: ContextListener) {
    this.#stage = stage;
    this.#renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "low-power" });
    this.#renderer.autoClear = false;
    this.#renderer.localClippingEnabled = true;
    const canvas = this.#renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.addEventListener("webglcontextlost", lost);
    canvas.addEventListener("webglcontextrestored", () => {
      restored();
      this.#render();
    });
    this.#labels.className = "ring-labels";
    this.#labels.ariaHidden = "true";
    stage.replaceChildren(canvas, this.#labels);

    this.#initial.renderOrder = 2;
    this.#initial.frustumCulled = false;
    this.#flow.frustumCulled = false;
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(-3, -5, 7);
    const rim = new DirectionalLight(0xffffff, 0.7);
    rim.position.set(6, 5, -2);
    const sky = new HemisphereLight(0xffffff, 0x8a98a3, 1.5);
    sky.position.set(0, 0, 1);
    this.#scene.add(sky, key, rim, this.#initial, this.#channel.group, this.#flow, ...Object.values(this.#cuts));

    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enablePan = false;
    // A finger that moves up or down scrolls the page; sideways it turns the capsule.
    canvas.style.touchAction = "pan-y";
    this.#controls.minDistance = 4;
    this.#controls.maxDistance = 26;
    this.#controls.addEventListener("change", () => this.#render());
    canvas.addEventListener("keydown", (event) => this.#turn(event));
    this.recolour();
    this.look("oblique");
    onResize(stage, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.#renderer.setSize(width, height);
      this.#frameCapsule();
      this.#render();
    });
  }

  /** Names the picture, and the live capsule beside pinned ones. */
  speak({ canvas, live }: Messages["space"]): void {
    this.#renderer.domElement.ariaLabel = canvas;
    this.#live = live;
    this.#render();
  }

  /** Sets the surface's triangles, which all positions that follow refer to. */
  setTriangles(triangles: Uint32Array): void {
    this.#triangles = triangles;
    for (const { geometry } of this.#meshes.splice(0)) geometry.dispose();
    this.#initial.geometry.dispose();
    this.#initial.geometry = new BufferGeometry().setIndex(new BufferAttribute(triangles, 1));
  }

  /** Shows the channel, or leaves it out for a model that has none. */
  setChannel(exists: boolean): void {
    this.#channel.group.visible = exists;
    this.#labels.hidden = !exists;
  }

  /** Takes the colours of the theme; call it again when the theme changes. */
  recolour(): void {
    const style = getComputedStyle(this.#stage);
    const colour = (name: string) => style.getPropertyValue(`--${name}`).trim();
    this.#shown.forEach((name, i) => {
      const material = this.#meshes[i]?.material;
      // Data are coloured by the map alone.
      material?.color.set(material.map === null ? colour(name === "live" ? "membrane" : `pin-${name}`) : "white");
    });
    this.#ghost.color.set(colour("wall"));
    this.#channel.colour = colour("wall");
    this.#flow.material.color.set(colour("ink-soft"));
    for (const [plane, line] of Object.entries(this.#cuts)) line.material.color.set(colour(plane));
    this.#render();
  }

  /** Goes to a place to look from. */
  look(from: Camera): void {
    this.#camera.position.copy(PLACES[from]);
    this.#controls.target.set(0, 0, 0);
    this.#frameCapsule();
    this.#controls.update();
    this.#render();
  }

  /** Shows the capsules, or the empty channel. */
  draw(scene: SolidScene | undefined): void {
    const names = scene?.bodies.map(({ name }) => name) ?? [];
    const isNew = names.join() !== this.#shown.join();
    this.#shown = names;
    const painted = scene?.bodies.map(({ colours }) => (colours === undefined ? "none" : scene.map)).join() ?? "";
    const isPainted = painted !== this.#painted;
    this.#painted = painted;
    this.#initial.visible = scene?.initial !== undefined;
    this.#flow.visible = scene?.flow !== undefined;
    for (const line of Object.values(this.#cuts)) line.visible = false;
    if (scene !== undefined) this.#place(scene);
    if (isNew || isPainted) this.recolour();
    if (isNew) this.#frameCapsule();
    this.#render();
  }

  /** The picture as it is on screen. */
  picture(): HTMLCanvasElement {
    this.#render();
    return this.#renderer.domElement;
  }

  dispose(): void {
    this.#controls.dispose();
    this.#renderer.dispose();
  }

  #place(scene: SolidScene): void {
    scene.bodies.forEach(({ positions, normals, shift, colours }, i) => {
      const mesh = this.#mesh(i);
      replace(mesh.geometry, "position", positions);
      replace(mesh.geometry, "normal", normals);
      if (colours !== undefined) replace(mesh.geometry, "uv", colours);
      paint(mesh.material, colours === undefined ? null : this.#texture(scene.map));
      mesh.position.x = shift;
    });
    this.#cutOpen(scene.clip);
    if (scene.initial !== undefined) {
      replace(this.#initial.geometry, "position", scene.initial.positions);
      replace(this.#initial.geometry, "normal", scene.initial.normals);
      this.#initial.position.x = scene.initial.shift;
    }
    if (scene.flow !== undefined) replace(this.#flow.geometry, "position", scene.flow);
    for (const { plane, points } of scene.cuts) {
      if (points.length < 6) continue;
      const line = this.#cuts[plane];
      setLine(line.geometry, points);
      line.visible = true;
    }
    this.#origin = scene.origin;
    this.#factor = scene.factor;
    this.#channel.moveTo(scene.origin);
  }

  #texture(map: ColourMap): Texture {
    const texture = this.#textures.get(map) ?? colourTexture(map);
    this.#textures.set(map, texture);
    return texture;
  }

  /** Leaves out the half of the membrane, and of the curves on it, that hides the other one. */
  #cutOpen(clip: Clip): void {
    const [surface, curves] = clip === "none" ? [] : HALVES[clip];
    for (const { material } of [...this.#meshes, this.#initial]) material.clippingPlanes = surface ? [surface] : null;
    for (const { material } of Object.values(this.#cuts)) material.clippingPlanes = curves ? [curves] : null;
  }

  #mesh(i: number): Mesh<BufferGeometry, MeshStandardMaterial> {
    let mesh = this.#meshes[i];
    if (mesh === undefined) {
      const material = new MeshStandardMaterial({ side: DoubleSide, roughness: 0.5, metalness: 0 });
      // The curves on the membrane join its nodes, the surface bulges a little between: draw it that much farther away.
      material.polygonOffset = true;
      material.polygonOffsetFactor = 2;
      material.polygonOffsetUnits = 300;
      mesh = new Mesh(new BufferGeometry().setIndex(new BufferAttribute(this.#triangles, 1)), material);
      mesh.frustumCulled = false;
      this.#meshes[i] = mesh;
      this.#scene.add(mesh);
    }
    return mesh;
  }

  /** Steps back in a narrow part of the picture, so that the capsule and the walls around it fit its width. */
  #frameCapsule(): void {
    this.#camera.aspect = this.#width / Math.max(1, this.#shown.length) / this.#height;
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
    // Spherical coordinates have their pole along y.
    const { x, y, z } = this.#camera.position;
    const spherical = new Spherical().setFromVector3(new Vector3(x, z, -y));
    spherical.theta += turn[0];
    spherical.phi = Math.min(Math.PI - 0.05, Math.max(0.05, spherical.phi + turn[1]));
    const { minDistance, maxDistance } = this.#controls;
    spherical.radius = Math.min(maxDistance, Math.max(minDistance, spherical.radius * turn[2]));
    const turned = new Vector3().setFromSpherical(spherical);
    this.#camera.position.set(turned.x, -turned.z, turned.y);
    this.#controls.update();
    this.#render();
    event.preventDefault();
    event.stopPropagation();
  }

  /** Draws each capsule in a part of the picture of its own, side by side, from the same place. */
  #render(): void {
    const parts = Math.max(1, this.#shown.length);
    const width = this.#width / parts;
    for (const line of Object.values(this.#cuts)) line.material.resolution.set(width, this.#height);
    this.#renderer.setScissorTest(true);
    for (let part = 0; part < parts; part++) {
      const isLive = this.#shown[part] === "live";
      this.#meshes.forEach((mesh, i) => {
        mesh.visible = i === part && i < this.#shown.length;
      });
      for (const own of [this.#initial, this.#flow, ...Object.values(this.#cuts)]) own.layers.set(isLive ? 0 : 1);
      this.#renderer.setViewport(part * width, 0, width, this.#height);
      this.#renderer.setScissor(part * width, 0, width, this.#height);
      this.#renderer.clear();
      this.#renderer.render(this.#scene, this.#camera);
    }
    this.#placeLabels(width);
  }

  /** Writes x beside the lower front edge of the first part, at each ring, and the names of pinned capsules. */
  #placeLabels(width: number): void {
    const count = 2 * REACH + 1 + this.#shown.length;
    while (this.#labels.childElementCount < count) this.#labels.append(document.createElement("span"));
    const first = Math.ceil(this.#origin - REACH);
    const at = new Vector3();
    let last = new Vector2(Number.NaN, Number.NaN);
    [...this.#labels.children].forEach((element, i) => {
      const span = element as HTMLElement;
      const part = i - (2 * REACH + 1);
      if (part >= 0) {
        const name = this.#shown.length > 1 ? this.#shown[part] : undefined;
        span.textContent = name === undefined ? "" : name === "live" ? this.#live : name;
        span.style.opacity = "1";
        span.style.transform = `translate(${((part + 0.5) * width).toFixed(1)}px, 8px)`;
        return;
      }
      const x = first + i;
      at.set(x - this.#origin, -1.02, -1.13).project(this.#camera);
      span.textContent = label(tidy(x * this.#factor));
      const [left, top] = [((at.x + 1) * width) / 2, ((1 - at.y) * this.#height) / 2];
      // Seen along the channel, one number would lie over the other.
      const hasRoom = !(last.distanceTo(new Vector2(left, top)) < LEAST_APART);
      if (hasRoom) last = new Vector2(left, top);
      const isSeen = hasRoom && Math.abs(at.x) < 1 && Math.abs(at.y) < 1;
      span.style.opacity = String(isSeen ? fadeOut(x - this.#origin) : 0);
      span.style.transform = `translate(-50%, -50%) translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
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

/** Leads a line through points x, y, z, ...; its buffer, which is made where it is too short, holds pairs of ends. */
function setLine(geometry: LineGeometry, points: Float32Array): void {
  const count = points.length / 3 - 1;
  const ends = geometry.getAttribute("instanceStart") as InterleavedBufferAttribute | undefined;
  if (ends === undefined || ends.data.count < count) {
    geometry.dispose();
    geometry.setPositions(points);
    return;
  }
  for (let i = 0; i < count; i++) ends.data.array.set(points.subarray(3 * i, 3 * i + 6), 6 * i);
  ends.data.needsUpdate = true;
  geometry.instanceCount = count;
}

/** Colours a material by a map, or by its own colour. */
function paint(material: MeshStandardMaterial, map: Texture | null): void {
  if (material.map === map) return;
  // Whether there is one is compiled into the shader.
  material.needsUpdate = (material.map === null) !== (map === null);
  material.map = map;
}

/** Copies numbers into the geometry, whose buffer is made at the first call. */
function replace(geometry: BufferGeometry, name: "position" | "normal" | "uv", numbers: Float32Array): void {
  const size = name === "uv" ? 2 : 3;
  const attribute = geometry.getAttribute(name);
  if (attribute === undefined || attribute.count * size !== numbers.length) {
    geometry.setAttribute(name, new BufferAttribute(numbers.slice(), size));
  } else {
    (attribute as BufferAttribute).copyArray(numbers).needsUpdate = true;
  }
}

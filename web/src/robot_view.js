// The robot in 3-D: turned with the mouse, drawn only when something has changed.

import {
  AmbientLight,
  AxesHelper,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  GridHelper,
  Group,
  HemisphereLight,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshPhongMaterial,
  PerspectiveCamera,
  Quaternion,
  Scene,
  SphereGeometry,
  Spherical,
  SRGBColorSpace,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { alongZ, Arrow } from "./arrow.js";
import { Kinematics, transform } from "./kinematics.js";

const kUp = new Vector3(0, 0, 1);
const kTraceRows = 1500;
const kDirection = new Vector3(1, -1.15, 0.62).normalize();
const kFieldOfView = 32; // degrees, upwards
const kLiveRoom = 0.85; // of the arm's length
const kLiveForce = 25; // [N]

export class RobotView {
  /// Throws where there is no WebGL.
  constructor(robot, canvas) {
    this.kinematics = new Kinematics(robot);
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera = new PerspectiveCamera(kFieldOfView, 1, 0.01, 100);
    this.camera.up.copy(kUp);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false; // until the view is clicked: the wheel belongs to the page
    this.controls.addEventListener("change", () => this.draw());
    this.scene = new Scene();
    this.scene.add(new HemisphereLight(0xffffff, 0x8a8f98, 1.6), new AmbientLight(0xffffff, 0.25));
    const sun = new DirectionalLight(0xffffff, 1.9);
    sun.position.set(1.5, -1, 3);
    const fill = new DirectionalLight(0xffffff, 0.5);
    fill.position.set(-2, 1.5, 0.8);
    this.scene.add(sun, fill);
    this.links = new Map();
    for (const link of robot.links) this.#addLink(link);
    this.frames = robot.frames ?? [];
    this.#addJointsOfBareLinks(robot);
    this.arrows = [];
    this.spent = new Set();
    this.#listen();
  }

  // ---- what is shown ---------------------------------------------------------------------------

  #addLink({ name, visuals = [] }) {
    const group = new Group();
    group.matrixAutoUpdate = false;
    for (const visual of visuals) {
      const mesh = new Mesh(geometryOf(visual), materialOf(visual.color));
      if (visual.position) mesh.position.fromArray(visual.position);
      if (visual.rotation) {
        const [w, x, y, z] = visual.rotation;
        mesh.quaternion.set(x, y, z, w);
      }
      group.add(mesh);
    }
    this.links.set(name, group);
    this.scene.add(group);
  }

  /// A robot without shapes is drawn by its joints: a ball at each, a rod to the next.
  #addJointsOfBareLinks({ links, joints }) {
    if (links.some((link) => link.visuals?.length)) return;
    const lengths = joints.map((joint) => Math.hypot(...(joint.position ?? [0, 0, 0])));
    const radius = 0.08 * Math.max(...lengths, 0.1);
    for (const joint of joints) {
      const ball = new Mesh(new SphereGeometry(1.6 * radius, 24, 16), materialOf());
      this.links.get(joint.child).add(ball);
      const to = new Vector3().fromArray(joint.position ?? [0, 0, 0]);
      const length = to.length();
      if (length < radius) continue;
      const rod = new Mesh(alongZ(new CylinderGeometry(radius, radius, length, 24)), materialOf());
      rod.position.copy(to).multiplyScalar(0.5);
      rod.quaternion.setFromUnitVectors(kUp, to.normalize());
      this.links.get(joint.parent).add(rod);
    }
  }

  setPalette(palette) {
    this.palette = palette;
    const size = this.size ?? 1;
    this.#discard(this.ground, this.axes);
    const cell = 10 ** Math.floor(Math.log10(size)) / (size < 2 ? 10 : 5);
    const cells = 2 * Math.ceil((0.9 * size) / cell);
    this.ground = new GridHelper(cells * cell, cells, palette.grey, palette.grid);
    this.ground.rotation.x = Math.PI / 2;
    Object.assign(this.ground.material, { transparent: true, opacity: 0.7 });
    this.axes = new AxesHelper(0.18 * size);
    this.axes.setColors(palette.vermillion, palette.green, palette.blue);
    this.axes.position.z = 0.002 * size;
    this.scene.add(this.ground, this.axes);
    this.#colourTrace();
    for (const arrow of this.arrows) arrow.material.color.set(palette.vermillion);
    this.draw();
  }

  // ---- a run -----------------------------------------------------------------------------------

  setRun(run, palette) {
    this.run = run;
    const names = run.description.joints ?? [];
    this.angles = names.map((name) => run.byName.get(name));
    if (this.angles.includes(undefined))
      throw new Error(`the run has no column “${names[this.angles.indexOf(undefined)]}”`);
    if (names.length !== this.kinematics.movable.length)
      throw new Error(
        `${names.length} columns pose a robot of ${this.kinematics.movable.length} joints`,
      );
    const first = this.size === undefined;
    this.#measure();
    this.trace();
    this.#makeArrows();
    this.setPalette(palette);
    if (first) this.resetCamera();
    this.setTime(run.from);
  }

  /// Of all links, by name.
  poses(t) {
    return this.kinematics.poses(this.angles.map((column) => this.run.between(column, t)));
  }

  /// A box around the origins of the links over the run, and with it the size of the scene. An arm
  /// that may still go anywhere has room to.
  #measure() {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = low.clone().negate();
    for (let k = 0; k <= 40; ++k) {
      const t = this.run.from + (k / 40) * (this.run.to - this.run.from);
      for (const matrix of this.poses(t).values()) {
        const origin = new Vector3(matrix[12], matrix[13], matrix[14]);
        low.min(origin);
        high.max(origin);
      }
    }
    this.centre = low.clone().add(high).multiplyScalar(0.5);
    const room = this.run.grows ? kLiveRoom * this.kinematics.reach : 0;
    this.size = Math.max(1.15 * high.distanceTo(low), room, 0.2);
  }

  /// The path of the tip between two times.
  trace(from = this.run.from, to = this.run.to) {
    this.#discard(this.whole, this.trail);
    const first = Math.max(this.run.rowAt(from), 0);
    const rows = this.run.rowAt(to) + 1 - first;
    const count = Math.min(rows, kTraceRows);
    this.points = new Float32Array(3 * (this.run.grows ? 2 * kTraceRows : count));
    this.traceTimes = [];
    for (let k = 0; k < count; ++k)
      this.#addToTrace(first + (count > 1 ? Math.round((k * (rows - 1)) / (count - 1)) : 0));
    this.traceFrom = from;
    const line = (opacity) => {
      const geometry = new BufferGeometry().setAttribute(
        "position",
        new BufferAttribute(this.points, 3),
      );
      const material = new LineBasicMaterial({ transparent: true, opacity });
      const made = new Line(geometry, material);
      made.frustumCulled = false;
      this.scene.add(made);
      return made;
    };
    this.whole = line(0.45);
    this.trail = line(1);
    this.#colourTrace();
    this.showTrace(this.traceShown ?? true);
  }

  #addToTrace(row) {
    const matrix = this.poses(this.run.times[row]).get(this.kinematics.tip);
    this.points.set(matrix.slice(12, 15), 3 * this.traceTimes.length);
    this.traceTimes.push(this.run.times[row]);
  }

  /// The path goes on to the last row, and begins at `from`.
  extendTrace(from) {
    const { times } = this.run;
    const last = this.traceTimes.at(-1) ?? -Infinity;
    const apart = (this.run.to - from) / kTraceRows;
    for (let row = this.run.rowAt(last) + 1; row < times.length; ++row) {
      if (times[row] < from || times[row] - (this.traceTimes.at(-1) ?? -Infinity) < apart) continue;
      if (3 * this.traceTimes.length === this.points.length) {
        const half = kTraceRows;
        this.points.copyWithin(0, 3 * half);
        this.traceTimes.splice(0, half);
      }
      this.#addToTrace(row);
    }
    this.traceFrom = from;
    for (const one of [this.whole, this.trail]) one.geometry.attributes.position.needsUpdate = true;
  }

  #rangeOfTrace(to) {
    const begin = this.traceTimes.findIndex((time) => time >= this.traceFrom);
    if (begin < 0) return [0, 0];
    let end = begin;
    while (end < this.traceTimes.length && this.traceTimes[end] <= to) ++end;
    return [begin, end - begin];
  }

  #colourTrace() {
    if (!this.palette) return;
    this.trail?.material.color.set(this.palette.blue);
    this.whole?.material.color.set(this.palette.grey);
  }

  showTrace(shown) {
    this.traceShown = shown;
    if (this.whole) this.whole.visible = this.trail.visible = shown;
    this.draw();
  }

  #makeArrows() {
    this.#discard(...this.arrows.map((arrow) => arrow.group));
    const forces = this.run.description.forces ?? [];
    if (forces.length) this.#checkFrames();
    this.arrows = forces.map(({ name, link, point, force }) => {
      const columnOf = (column) => {
        const found = this.run.byName.get(column);
        if (!found) throw new Error(`the force “${name}” needs a column “${column}”`);
        return found;
      };
      return Object.assign(new Arrow(this.scene), {
        name,
        link: columnOf(link),
        point: point.map(columnOf),
        force: force.map(columnOf),
      });
    });
  }

  #checkFrames() {
    if (!this.frames.length) throw new Error("forces act on links, but the robot has no “frames”");
    const unknown = this.frames.find((name) => !this.links.has(name));
    if (unknown) throw new Error(`the frame “${unknown}” is no link of the robot`);
  }

  /// A frame on the same body as a link, so that forces can act on it; undefined if there is none.
  frameOn(link) {
    if (this.frames.includes(link)) return link;
    const hangs = ({ type, parent, child }) =>
      type === "fixed" && parent === link && this.frames.includes(child);
    return this.kinematics.joints.find(({ joint }) => hangs(joint))?.joint.child;
  }

  /// Of all forces, over the run; of a run that goes on it is at least one that a hand makes.
  get greatestForce() {
    const squares = this.arrows.map(({ force }) =>
      force.reduce((sum, column) => sum + column.greatest ** 2, 0),
    );
    return Math.max(Math.sqrt(Math.max(...squares, 0)), this.run.grows ? kLiveForce : 0);
  }

  #vectorAt(columns, t) {
    return new Vector3(...columns.map((column) => this.run.valueAt(column, t) || 0));
  }

  #poseArrow(arrow, poses, t) {
    const link = this.frames[this.run.valueAt(arrow.link, t)];
    const force = this.#vectorAt(arrow.force, t);
    const greatest = this.greatestForce;
    arrow.group.visible = false;
    if (!link || !(force.length() > 2e-3 * greatest) || this.muted?.(arrow.name)) return;
    const tip = transform(poses.get(link), this.#vectorAt(arrow.point, t).toArray());
    this.poseForce(arrow, tip, force, greatest);
  }

  /// As long as the force is great.
  poseForce(arrow, tip, force, greatest = this.greatestForce) {
    const length = Math.max((0.32 * this.size * force.length()) / greatest, 0.02 * this.size);
    arrow.pose(tip, force, length, 0.011 * this.size);
  }

  setTime(t) {
    const poses = this.poses(t);
    for (const [name, group] of this.links) {
      group.matrix.fromArray(poses.get(name));
      group.matrixWorldNeedsUpdate = true;
    }
    for (const arrow of this.arrows) this.#poseArrow(arrow, poses, t);
    this.trail.geometry.setDrawRange(...this.#rangeOfTrace(t));
    this.whole.geometry.setDrawRange(...this.#rangeOfTrace(Infinity));
    this.draw();
  }

  /// The forces that act: [{name, size}], as text.
  forces(t) {
    return this.arrows
      .filter((arrow) => arrow.group.visible)
      .map(({ name, force }) => ({
        name,
        size: `${this.#vectorAt(force, t).length().toFixed(1)} N`,
      }));
  }

  // ---- the camera ------------------------------------------------------------------------------

  resetCamera() {
    const distance = (0.57 * this.size) / Math.tan((kFieldOfView * Math.PI) / 360);
    this.camera.near = 0.01 * this.size;
    this.camera.far = 60 * this.size;
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(kDirection, distance);
    this.controls.minDistance = 0.1 * this.size;
    this.controls.maxDistance = 12 * this.size;
    this.#fit();
    this.controls.update();
    this.draw();
  }

  /// What fits the height of a wide view fits the width of a narrow one.
  #fit() {
    const width = this.canvas.clientWidth || 1;
    const height = this.canvas.clientHeight || 1;
    this.camera.aspect = width / height;
    const half = Math.tan((kFieldOfView * Math.PI) / 360);
    const widened = this.camera.aspect < 1 ? half / this.camera.aspect : half;
    this.camera.fov = (360 / Math.PI) * Math.atan(widened);
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height, false);
  }

  resize() {
    this.#fit();
    this.draw();
  }

  turn(across, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const toYUp = new Quaternion().setFromUnitVectors(kUp, new Vector3(0, 1, 0));
    const where = new Spherical().setFromVector3(offset.applyQuaternion(toYUp));
    where.theta += across;
    where.phi -= up;
    where.makeSafe();
    offset.setFromSpherical(where).applyQuaternion(toYUp.invert());
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.clampLength(this.controls.minDistance * factor, this.controls.maxDistance * factor);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, 1 / factor);
    this.controls.update();
  }

  #listen() {
    const { canvas, controls } = this;
    canvas.addEventListener("pointerdown", () => {
      canvas.focus({ preventScroll: true });
      controls.enableZoom = true;
    });
    canvas.addEventListener("blur", () => (controls.enableZoom = false));
    canvas.addEventListener("keydown", (event) => {
      const acts = {
        ArrowLeft: () => this.turn(-0.1, 0),
        ArrowRight: () => this.turn(0.1, 0),
        ArrowUp: () => this.turn(0, 0.1),
        ArrowDown: () => this.turn(0, -0.1),
        "+": () => this.zoom(1.15),
        "=": () => this.zoom(1.15),
        "-": () => this.zoom(1 / 1.15),
        0: () => this.resetCamera(),
        Escape: () => canvas.blur(),
      };
      if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      acts[event.key]();
      event.preventDefault();
    });
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  draw() {
    if (this.drawing || !this.run) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.renderer.render(this.scene, this.camera);
      for (const one of this.spent) one.dispose();
      this.spent.clear();
    });
  }

  /// Takes objects from the scene. What they hold on the GPU is given back after the next picture, in
  /// which new materials share the shaders of the old: else these would be compiled anew.
  #discard(...objects) {
    for (const object of objects) {
      object?.removeFromParent();
      object?.traverse(({ geometry, material }) => {
        if (geometry) this.spent.add(geometry).add(material);
      });
    }
  }
}

// ---- shapes ------------------------------------------------------------------------------------

/// The length of a capsule is that of the cylinder between its caps.
function geometryOf({ shape, radius, length, size }) {
  switch (shape) {
    case "cylinder":
      return alongZ(new CylinderGeometry(radius, radius, length, 40));
    case "capsule":
      return alongZ(new CapsuleGeometry(radius, length, 12, 32));
    case "sphere":
      return new SphereGeometry(radius, 36, 24);
    case "box":
      return new BoxGeometry(...size);
    default:
      throw new Error(
        `a link has the shape “${shape}”: cylinder, capsule, sphere and box are drawn`,
      );
  }
}

function materialOf(color) {
  const [r, g, b] = color ?? [0.72, 0.75, 0.79];
  return new MeshPhongMaterial({
    color: new Color().setRGB(r, g, b, SRGBColorSpace),
    specular: 0x1c1c1c,
    shininess: 30,
  });
}

// A hand on the robot: a link is dragged, and a spring from the point that was grasped to the cursor
// pulls it:
//
//   F = k (x_cursor − x_point), at most F_max, in the plane through the point that faces the camera

import { Matrix4, Plane, Raycaster, Vector2, Vector3 } from "three";

import { Arrow } from "./arrow.js";
import { make } from "./element.js";

const kStiffness = 200; // [N/m]
const kMostForce = 60; // [N]
const kPeriod = 33; // milliseconds from one message to the next

/// `send({link, point, force})` tells the run; `begin()` asks whether it can be pushed now.
export class Push {
  constructor({ view, frame, begin, send }) {
    Object.assign(this, { view, frame, canvas: view.canvas, begin, send });
    this.ray = new Raycaster();
    this.arrow = new Arrow(view.scene);
    this.arrow.material.depthTest = false;
    this.arrow.group.renderOrder = 1;
    this.always = false;
    this.label = make("div", { class: "push-label", hidden: true });
    this.button = make(
      "button",
      {
        type: "button",
        "aria-pressed": "false",
        title: "Drag links to push them, without Ctrl",
        onclick: () => this.#setAlways(!this.always),
      },
      "Push",
    );
    frame.append(this.label);
    // What the run makes of this hand would stand beside it, a moment late.
    view.muted = (name) => this.hold && name.startsWith("live_push");
    // Before the controls of the camera hear of it.
    frame.addEventListener("pointerdown", (event) => this.#down(event), { capture: true });
    this.canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
      this.canvas.addEventListener(end, (event) => this.#up(event));
    frame.addEventListener("contextmenu", (event) => event.ctrlKey && event.preventDefault());
    for (const change of ["keydown", "keyup"])
      document.addEventListener(change, (event) => this.#showReady(event.ctrlKey));
  }

  setColour(colour) {
    this.arrow.material.color.set(colour);
  }

  #setAlways(always) {
    this.always = always;
    this.button.setAttribute("aria-pressed", String(always));
    this.#showReady(false);
  }

  /// The cursor tells where a link can be grasped.
  #showReady(ctrl) {
    const ready = this.hold || ((this.always || ctrl) && this.place && this.#graspedAt(this.place));
    this.canvas.classList.toggle("push", Boolean(ready));
  }

  // ---- the hand --------------------------------------------------------------------------------

  #down(event) {
    const wanted = this.always || event.ctrlKey;
    if (event.target !== this.canvas || event.button || !wanted || this.hold) return;
    const grasped = this.#graspedAt(placeOf(event));
    if (!grasped) return;
    event.stopPropagation();
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    if (!this.begin()) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.hold = { ...grasped, pointer: event.pointerId, cursor: placeOf(event) };
    this.timer = setInterval(() => this.#pull(), kPeriod);
    this.#pull();
  }

  #move(event) {
    this.place = placeOf(event);
    if (this.hold?.pointer === event.pointerId) this.hold.cursor = this.place;
    else this.#showReady(event.ctrlKey);
  }

  #up(event) {
    if (this.hold?.pointer === event.pointerId) this.release();
  }

  /// Lets go.
  release() {
    if (!this.hold) return;
    clearInterval(this.timer);
    const { link, point } = this.hold;
    this.hold = null;
    this.send({ link, point, force: [0, 0, 0] });
    this.arrow.group.visible = false;
    this.label.hidden = true;
    this.view.draw();
  }

  // ---- where -----------------------------------------------------------------------------------

  #aim({ x, y }) {
    const box = this.canvas.getBoundingClientRect();
    const place = new Vector2(
      (2 * (x - box.left)) / box.width - 1,
      1 - (2 * (y - box.top)) / box.height,
    );
    this.ray.setFromCamera(place, this.view.camera);
    return this.ray;
  }

  /// The link under the cursor and the point on it, in its frame.
  #graspedAt(place) {
    this.view.scene.updateMatrixWorld();
    const groups = [...this.view.links];
    const [hit] = this.#aim(place).intersectObjects(groups.map(([, group]) => group));
    if (!hit) return null;
    let group = hit.object;
    while (group.parent !== this.view.scene) group = group.parent;
    const link = this.view.frameOn(groups.find(([, one]) => one === group)[0]);
    if (!link) return null;
    const inLink = new Matrix4().copy(this.view.links.get(link).matrix).invert();
    return { link, point: hit.point.applyMatrix4(inLink).toArray() };
  }

  #pull() {
    const { link, point, cursor } = this.hold;
    const at = new Vector3(...point).applyMatrix4(this.view.links.get(link).matrix);
    const facing = this.view.camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(facing, at);
    const to = this.#aim(cursor).ray.intersectPlane(plane, new Vector3());
    const force = (to ?? at).clone().sub(at).multiplyScalar(kStiffness);
    force.clampLength(0, kMostForce);
    this.send({ link, point, force: force.toArray() });
    this.#show(at, force, cursor);
  }

  /// The arrow begins at the point: a hand pulls.
  #show(at, force, { x, y }) {
    const size = force.length();
    this.arrow.group.visible = false;
    if (size > 0.2) {
      const length = Math.max((0.4 * this.view.size * size) / kMostForce, 0.02 * this.view.size);
      const tip = at.clone().addScaledVector(force, length / size);
      this.arrow.pose(tip.toArray(), force, length, 0.012 * this.view.size);
    }
    const box = this.frame.getBoundingClientRect();
    const most = size > kMostForce - 0.05 ? " (most)" : "";
    this.label.textContent = `${size.toFixed(0)} N${most}`;
    this.label.hidden = false;
    const within = (place, most) => `${Math.min(Math.max(place, 4), most)}px`;
    this.label.style.left = within(x - box.left + 12, box.width - this.label.offsetWidth - 6);
    this.label.style.top = within(y - box.top - 26, box.height - 30);
    this.view.draw();
  }
}

function placeOf({ clientX, clientY }) {
  return { x: clientX, y: clientY };
}

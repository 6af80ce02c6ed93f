// Poses of a robot's links, as column-major 4 × 4 matrices:
//
//   X_world_child = X_world_parent · origin · R(axis, q),   or T(axis q) for a prismatic joint

export const kIdentity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function multiply(a, b) {
  const product = new Array(16).fill(0);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return product;
}

/// rotation is a unit quaternion [w, x, y, z].
export function pose(position = [0, 0, 0], rotation = [1, 0, 0, 0]) {
  const [w, x, y, z] = rotation;
  return [
    1 - 2 * (y * y + z * z),
    2 * (x * y + w * z),
    2 * (x * z - w * y),
    0,
    2 * (x * y - w * z),
    1 - 2 * (x * x + z * z),
    2 * (y * z + w * x),
    0,
    2 * (x * z + w * y),
    2 * (y * z - w * x),
    1 - 2 * (x * x + y * y),
    0,
    ...position,
    1,
  ];
}

export function transform(matrix, [x, y, z]) {
  return [0, 1, 2].map(
    (row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row],
  );
}

function motion({ type, axis = [0, 0, 1] }, q) {
  const length = Math.hypot(...axis) || 1;
  const unit = axis.map((a) => a / length);
  if (type === "prismatic") return pose(unit.map((a) => a * q));
  return pose([0, 0, 0], [Math.cos(q / 2), ...unit.map((a) => a * Math.sin(q / 2))]);
}

export class Kinematics {
  /// robot: {links: [{name}], joints: [{name, parent, child, type, axis, position, rotation}]}
  constructor({ links, joints }) {
    this.links = links.map((link) => link.name);
    this.movable = joints.filter((joint) => joint.type !== "fixed");
    this.tip = joints.length ? joints[joints.length - 1].child : this.links[0];
    this.#order(joints);
    this.reach = this.#lengthTo(this.tip, joints);
  }

  /// From the root to a link along its joints.
  #lengthTo(link, joints) {
    const joint = joints.find(({ child }) => child === link);
    if (!joint) return 0;
    return Math.hypot(...(joint.position ?? [0, 0, 0])) + this.#lengthTo(joint.parent, joints);
  }

  /// From the root outwards.
  #order(joints) {
    const children = new Set(joints.map((joint) => joint.child));
    const placed = new Set(this.links.filter((name) => !children.has(name)));
    this.joints = [];
    let waiting = joints;
    while (waiting.length) {
      const ready = waiting.filter((joint) => placed.has(joint.parent));
      if (!ready.length)
        throw new Error(`the joint “${waiting[0].name}” hangs on no link of the robot`);
      for (const joint of ready) {
        placed.add(joint.child);
        this.joints.push({
          joint,
          origin: pose(joint.position, joint.rotation),
          index: this.movable.indexOf(joint),
        });
      }
      waiting = waiting.filter((joint) => !placed.has(joint.child));
    }
  }

  /// Poses by the name of the link; q in the order of the movable joints.
  poses(q) {
    const poses = new Map(this.links.map((name) => [name, kIdentity]));
    for (const { joint, origin, index } of this.joints) {
      const fixed = multiply(poses.get(joint.parent), origin);
      const moved = index < 0 ? fixed : multiply(fixed, motion(joint, q[index] || 0));
      poses.set(joint.child, moved);
    }
    return poses;
  }
}

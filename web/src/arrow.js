// The arrow of a force in the 3-D view.

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshPhongMaterial, Quaternion, Vector3 } from "three";

const kUp = new Vector3(0, 0, 1);

/// Its tip is at the point where the force acts: it pushes.
export class Arrow {
  constructor(scene) {
    this.material = new MeshPhongMaterial({ specular: 0x1c1c1c, shininess: 30 });
    this.shaft = new Mesh(alongZ(new CylinderGeometry(1, 1, 1, 20)), this.material);
    this.head = new Mesh(alongZ(new ConeGeometry(1, 1, 24)), this.material);
    this.group = new Group();
    this.group.add(this.shaft, this.head);
    this.group.visible = false;
    scene.add(this.group);
  }

  /// tip as [x, y, z]; direction a Vector3, of any length; length and width [m].
  pose(tip, direction, length, width) {
    const head = Math.min(5 * width, 0.6 * length);
    this.shaft.scale.set(width, width, length - head);
    this.shaft.position.z = -head - (length - head) / 2;
    this.head.scale.set(2.4 * width, 2.4 * width, head);
    this.head.position.z = -head / 2;
    this.group.position.fromArray(tip);
    this.group.quaternion.copy(
      new Quaternion().setFromUnitVectors(kUp, direction.clone().normalize()),
    );
    this.group.visible = true;
  }
}

/// Cylinders, capsules and cones of three lie along y, those of a robot along z.
export function alongZ(geometry) {
  return geometry.rotateX(Math.PI / 2);
}

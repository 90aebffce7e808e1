// Cameras: turning, moving, zooming with pointer and keys; the standard views; the little axes that tell where one is.
import { MathUtils, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { element, shape } from "./elements.js";

const axisNames = ["X", "Y", "Z"];
const axisColours = ["#d1495b", "#3a9d5d", "#3f7fd1"];
const axis = (k, sign = 1) => new Vector3().setComponent(k, sign);

const turn = 0.12; // radians a key
const shift = 30; // pixels a key
const zoom = 0.87;
const keys = {
  ArrowLeft: (controls) => controls.rotateLeft(turn),
  ArrowRight: (controls) => controls.rotateLeft(-turn),
  ArrowUp: (controls) => controls.rotateUp(turn),
  ArrowDown: (controls) => controls.rotateUp(-turn),
  "+": (controls) => controls.dollyIn(zoom),
  "=": (controls) => controls.dollyIn(zoom),
  "-": (controls) => controls.dollyOut(zoom),
};
const shiftedKeys = {
  ArrowLeft: (controls) => controls.pan(shift, 0),
  ArrowRight: (controls) => controls.pan(-shift, 0),
  ArrowUp: (controls) => controls.pan(0, shift),
  ArrowDown: (controls) => controls.pan(0, -shift),
  "+": keys["+"],
};

// From its middle, for `camera` to see the whole of a sphere.
export function distanceThatShows(radius, camera) {
  const narrowest = Math.min(1, camera.aspect);
  const halfAngle = Math.atan(Math.tan(MathUtils.degToRad(camera.fov / 2)) * narrowest);
  return (1.02 * radius) / Math.sin(halfAngle) || 1;
}

export class Views {
  // `up`: what stands on top, of length 1.
  constructor(scene, stage, up) {
    this.scene = scene;
    this.up = new Vector3(...up);
    this.stand(1);
    stage.addEventListener("keydown", (event) => this.press(event));
  }

  // Which end of the upright axis is up: 1 or -1. The controls read the camera's up once, so they are made anew.
  stand(sign) {
    const { camera, canvas } = this.scene;
    this.upwards = sign;
    camera.up.copy(this.up).multiplyScalar(sign);
    this.controls?.dispose();
    this.controls = new OrbitControls(camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.scene.drawSoon());
    this.reset();
  }

  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "0") this.reset();
    else if ((event.shiftKey ? shiftedKeys : keys)[event.key])
      (event.shiftKey ? shiftedKeys : keys)[event.key](this.controls);
    else return;
    event.preventDefault();
    this.controls.update();
  }

  // Shows everything, seen from `direction`.
  look(direction) {
    const { camera, sphere } = this.scene;
    const distance = distanceThatShows(sphere.radius, camera);
    camera.near = distance / 1000;
    camera.far = distance * 20;
    camera.updateProjectionMatrix();
    this.controls.minDistance = sphere.radius / 100;
    this.controls.maxDistance = distance * 6;
    this.controls.target.copy(sphere.center);
    camera.position.copy(sphere.center).addScaledVector(direction.clone().normalize(), distance);
    this.controls.update();
    this.scene.drawSoon();
  }

  reset() {
    const sizes = this.up.toArray().map(Math.abs);
    const along = sizes.indexOf(Math.max(...sizes));
    const front = axis((along + 1) % 3).projectOnPlane(this.up).normalize();
    const side = this.up.clone().cross(front).multiplyScalar(Math.sign(this.up.getComponent(along)));
    this.look(front.addScaledVector(side, -0.55).addScaledVector(this.up, 0.25 * this.upwards));
  }

  // Turns the camera so that a vertex is seen from outside, at the present distance; from the side if it can be, for
  // bones are long.
  face(vertex) {
    const { camera, sphere } = this.scene;
    const normal = this.scene.outwardNormal(vertex);
    const sideways = normal.clone().projectOnPlane(this.up);
    const direction = sideways.length() > 0.25 ? sideways.normalize() : normal;
    if (direction.lengthSq() === 0) return;
    const distance = camera.position.distanceTo(this.controls.target);
    this.controls.target.copy(sphere.center);
    camera.position.copy(sphere.center).addScaledVector(direction, distance);
    this.controls.update();
    this.scene.drawSoon();
  }

  addButtons(parent) {
    const button = (label, description, act) => {
      const result = element("button", { type: "button", "aria-label": description, title: description }, label);
      result.addEventListener("click", act);
      parent.append(result);
    };
    for (const k of [0, 1, 2]) {
      for (const sign of [1, -1]) {
        const label = `${sign > 0 ? "+" : "\u2212"}${axisNames[k]}`;
        button(label, `seen from ${label}`, () => this.look(axis(k, sign)));
      }
    }
    button("Turn over", "turn the picture upside down", () => this.stand(-this.upwards));
    button("Reset", "reset the view", () => this.reset());
  }
}

// Draws the axes of the mesh as `camera` sees them.
export function drawTriad(svg, camera) {
  const inverse = camera.quaternion.clone().invert();
  const arms = axisNames.map((name, k) => ({ name, colour: axisColours[k], tip: axis(k).applyQuaternion(inverse) }));
  arms.sort((a, b) => a.tip.z - b.tip.z);
  svg.replaceChildren(
    ...arms.flatMap(({ name, colour, tip }) => {
      const [x, y] = [32 * tip.x, -32 * tip.y];
      const label = shape("text", { x: 1.32 * x, y: 1.32 * y, fill: colour }, name);
      return [shape("line", { x2: x, y2: y, stroke: colour }), label];
    }),
  );
}

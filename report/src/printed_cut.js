// The second picture that paper gets: the bone around the implant, cut open, for nobody turns paper.
import { Sphere, Vector3 } from "three";
import { distanceThatShows } from "./views.js";

const margin = 1.25; // how much of the bone around the implant is shown

// Of a mesh as it is placed: depths along `direction` that are a share of the way from the farthest to the nearest.
function depthsOf(mesh, direction) {
  const { position } = mesh.geometry.attributes;
  const vertex = new Vector3();
  let [farthest, nearest] = [Infinity, -Infinity];
  mesh.updateMatrixWorld();
  for (let k = 0; k < position.count; ++k) {
    const depth = direction.dot(vertex.fromBufferAttribute(position, k).applyMatrix4(mesh.matrixWorld));
    nearest = Math.max(nearest, depth);
    farthest = Math.min(farthest, depth);
  }
  return (share) => farthest + share * (nearest - farthest);
}

// Through the middle of the implant, or as near to it as there is bone on both sides: a cut that shows none tells
// nothing.
function planeThroughImplant({ bone, implant }, normal) {
  const [ofBone, ofImplant] = [depthsOf(bone, normal), depthsOf(implant[0], normal)];
  return { normal, offset: Math.min(Math.max(ofImplant(0.5), ofBone(0.25)), ofBone(0.75)) };
}

function sphereAroundImplant({ implant: [mesh], sphere }) {
  const { center, radius } = mesh.geometry.boundingSphere;
  return new Sphere(center.clone().applyMatrix4(mesh.matrixWorld), Math.min(margin * radius, sphere.radius));
}

// Drawn into `canvas`, as large as that of the scene, which stays as it is; seen from `front`, of length 1.
export function drawCutOpen(canvas, scene, { up, front }) {
  const normal = new Vector3(...front);
  const plane = planeThroughImplant(scene, normal);
  const { center, radius } = sphereAroundImplant(scene);
  const camera = scene.camera.clone();
  const distance = distanceThatShows(radius, camera);
  camera.up.set(...up);
  camera.position.copy(center).addScaledVector(normal, distance);
  camera.lookAt(center);
  [camera.near, camera.far] = [distance / 1000, 20 * Math.max(distance, scene.sphere.radius)];
  camera.updateProjectionMatrix();
  [canvas.width, canvas.height] = [scene.canvas.width, scene.canvas.height];
  scene.drawOnce(camera, plane);
  canvas.getContext("2d").drawImage(scene.canvas, 0, 0);
  scene.draw();
}

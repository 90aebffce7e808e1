// Draws bone and implant, only when something has changed.
import {
  BufferAttribute,
  BufferGeometry,
  Mesh,
  PerspectiveCamera,
  Points,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from "three";
import { boneMaterial, implantColourMaterial, implantDepthMaterial, ringMaterial, unbounded } from "./materials.js";
import { pointsOutwards, vertexNormals } from "./surface_normals.js";

const fieldOfView = 28; // degrees: little perspective

function geometryOf(surface) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(surface.positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(vertexNormals(surface), 3));
  geometry.setIndex(new BufferAttribute(surface.triangles, 1));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}

// Of the middle of the box of all surfaces.
function sphereAround(box, surfaces) {
  const centre = box.getCenter(new Vector3());
  let squared = 0;
  for (const { positions } of surfaces) {
    for (let k = 0; k < positions.length; k += 3) {
      const [x, y, z] = [positions[k] - centre.x, positions[k + 1] - centre.y, positions[k + 2] - centre.z];
      squared = Math.max(squared, x * x + y * y + z * z);
    }
  }
  return new Sphere(centre, Math.sqrt(squared));
}

function boneOf(surface) {
  const geometry = geometryOf(surface);
  geometry.setAttribute("coordinate", new BufferAttribute(new Float32Array(surface.positions.length / 3), 1));
  return new Mesh(geometry, boneMaterial());
}

// Drawn after the bone: what is in front of the bone, then once more as if there were no bone, so that the implant
// shines through it.
function implantOf(surface) {
  const geometry = geometryOf(surface);
  const layers = [
    implantDepthMaterial(),
    implantColourMaterial(0.14, 0.75),
    implantDepthMaterial(),
    implantColourMaterial(0.1, 0.6),
  ].map((material) => new Mesh(geometry, material));
  layers.forEach((layer, k) => (layer.renderOrder = 1 + k));
  layers[2].onBeforeRender = (renderer) => renderer.clearDepth();
  return layers;
}

function ring(size, opacity) {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(3), 3));
  const points = new Points(geometry, ringMaterial(size * window.devicePixelRatio, opacity));
  points.frustumCulled = false;
  points.renderOrder = 5;
  points.visible = false;
  return points;
}

// The context of WebGL 2, or null where the browser has none.
export function graphicsContext(canvas) {
  return canvas.getContext("webgl2", { alpha: true, antialias: true, preserveDrawingBuffer: true });
}

export class BoneScene {
  constructor(canvas, context, { bone, implant, path }) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.camera = new PerspectiveCamera(fieldOfView, 1);
    this.scene = new Scene();
    this.bone = boneOf(bone);
    this.implant = implantOf(implant);
    this.rings = { pinned: ring(22, 1), hovered: ring(14, 0.85) };
    this.scene.add(this.bone, ...this.implant, ...Object.values(this.rings));
    this.box = this.bone.geometry.boundingBox;
    // An implant on its way is where the path has it, not where its own file does.
    this.sphere = path
      ? sphereAround(this.box, [bone])
      : sphereAround(this.box.clone().union(this.implant[0].geometry.boundingBox), [bone, implant]);
    this.outwards = pointsOutwards(bone) ? 1 : -1;
    this.onDraw = () => {};
    this.isDue = false;
  }

  resize(width, height) {
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    this.isDue = false;
    this.renderer.render(this.scene, this.camera);
    this.onDraw(this.camera);
  }

  drawSoon() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.draw());
  }

  showQuantity(quantity) {
    const { coordinate } = this.bone.geometry.attributes;
    for (let vertex = 0; vertex < coordinate.count; ++vertex) {
      const value = quantity.coordinate(vertex);
      coordinate.array[vertex] = Number.isFinite(value) ? value : Math.sign(value) * unbounded;
    }
    coordinate.needsUpdate = true;
    this.drawSoon();
  }

  showScale(scale) {
    const { uniforms } = this.bone.material;
    uniforms.table.value.image.data.set(scale.table);
    uniforms.table.value.needsUpdate = true;
    uniforms.scale.value.set(scale.from, scale.to);
    uniforms.isSigned.value = scale.axis === "signed";
    uniforms.isCategory.value = scale.axis === "category";
    this.drawSoon();
  }

  // Vertices with coordinates outside [from, to) lose their colour.
  highlight(from, to) {
    this.bone.material.uniforms.highlight.value.set(from, to);
    this.drawSoon();
  }

  // Leaves out what lies beyond the plane with this normal; null: draws all.
  cut(plane) {
    const value = this.bone.material.uniforms.cut.value;
    if (plane) value.set(...plane.normal, plane.offset);
    else value.set(0, 0, 0, 1);
    this.drawSoon();
  }

  // Seen by this camera, cut by this plane alone, the rings left out.
  drawOnce(camera, plane) {
    const { cut } = this.bone.material.uniforms;
    const [usual, rings] = [cut.value.clone(), Object.values(this.rings).filter((ring) => ring.visible)];
    cut.value.set(...plane.normal, plane.offset);
    for (const ring of rings) ring.visible = false;
    this.renderer.render(this.scene, camera);
    for (const ring of rings) ring.visible = true;
    cut.value.copy(usual);
  }

  isCutAway(point) {
    const { x, y, z, w } = this.bone.material.uniforms.cut.value;
    return x * point.x + y * point.y + z * point.z > w;
  }

  // Moves the implant, which is drawn about `centre`, by a pose about the origin of the files.
  placeImplant({ translation, quaternion }, centre) {
    const about = new Vector3(...centre);
    const place = about.clone().applyQuaternion(quaternion).sub(about).add(translation);
    for (const mesh of this.implant) {
      mesh.position.copy(place);
      mesh.quaternion.copy(quaternion);
    }
    this.drawSoon();
  }

  showImplant(isShown) {
    for (const mesh of this.implant) mesh.visible = isShown;
    this.drawSoon();
  }

  place(vertex) {
    return new Vector3().fromBufferAttribute(this.bone.geometry.attributes.position, vertex);
  }

  // Of unit length, or zero where there are no triangles.
  outwardNormal(vertex) {
    return new Vector3()
      .fromBufferAttribute(this.bone.geometry.attributes.normal, vertex)
      .normalize()
      .multiplyScalar(this.outwards);
  }

  // A ring around a vertex, or none where it is undefined.
  mark(name, vertex) {
    const points = this.rings[name];
    points.visible = vertex !== undefined;
    if (points.visible) {
      points.geometry.attributes.position.copyArray(this.place(vertex).toArray());
      points.geometry.attributes.position.needsUpdate = true;
    }
    this.drawSoon();
  }
}

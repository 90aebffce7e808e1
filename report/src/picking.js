// The vertex under the pointer: a ray through a bounding volume hierarchy (three-mesh-bvh), then the triangle's nearest
// corner.
import { DoubleSide, Raycaster, Vector2 } from "three";
import { MeshBVH } from "three-mesh-bvh";

export class Picker {
  constructor(scene) {
    this.scene = scene;
    this.hierarchy = undefined;
    // A big bone is drawn first. Safari has no idle callbacks: there the first ray builds.
    window.requestIdleCallback?.(() => this.build());
  }

  build() {
    // Indirect: the triangles keep their order. Big leaves: a second less of building for a million vertices, and rays
    // are few.
    this.hierarchy ??= new MeshBVH(this.scene.bone.geometry, { indirect: true, targetLeafSize: 20 });
  }

  // `x` and `y` in pixels from the canvas's upper left corner. Undefined where there is no bone.
  vertexAt(x, y) {
    this.build();
    const { canvas, camera } = this.scene;
    const raycaster = new Raycaster();
    raycaster.setFromCamera(new Vector2((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight), camera);
    const hits = this.hierarchy.raycast(raycaster.ray, DoubleSide).filter(({ point }) => !this.scene.isCutAway(point));
    if (hits.length === 0) return undefined;
    return this.nearestCorner(hits.reduce((first, hit) => (hit.distance < first.distance ? hit : first)));
  }

  nearestCorner({ face, point }) {
    const distance = (vertex) => this.scene.place(vertex).distanceToSquared(point);
    return [face.a, face.b, face.c].reduce((nearest, vertex) =>
      distance(vertex) < distance(nearest) ? vertex : nearest,
    );
  }
}

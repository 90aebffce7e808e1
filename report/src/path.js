// Poses along a path: between two of them translations are linear, and rotations turn at constant speed.
import { Quaternion, Vector3 } from "three";

function poseOf({ translation, quaternion }) {
  const [w, x, y, z] = quaternion;
  return { translation: new Vector3(...translation), quaternion: new Quaternion(x, y, z, w).normalize() };
}

// `share` of the path's poses, from 0 to 1.
export function poseAlong(path, share) {
  const time = share * (path.length - 1);
  const before = Math.min(Math.floor(time), Math.max(path.length - 2, 0));
  const [first, second] = [before, Math.min(before + 1, path.length - 1)].map((k) => poseOf(path[k]));
  return {
    translation: first.translation.lerp(second.translation, time - before),
    quaternion: first.quaternion.slerp(second.quaternion, time - before),
  };
}

"""Moves a model until a mesh lies at a wanted distance from it: SciPy's least squares with proven gradients.

    python3 optimise_pose.py MODEL.json MESH.off DISTANCE tx,ty,tz,qw,qx,qy,qz

The last is where the model begins. What SciPy finds is a proposal; how good it is is proven at the end.
"""

import sys

import numpy as np
import verisq
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation


def cross_matrix(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def turn_of(w):
    """How the rotation by the vector w turns on when w changes: its left Jacobian."""
    angle = np.linalg.norm(w)
    if angle < 1e-6:
        return np.eye(3) + cross_matrix(w) / 2
    k = cross_matrix(w / angle)
    return np.eye(3) + (1 - np.cos(angle)) / angle * k + (1 - np.sin(angle) / angle) * k @ k


class Problem:
    """In the model's frame the points move: x -> R(w) (x - c) + c + t, of the unknowns (t, w)."""

    def __init__(self, model, points, wanted):
        self.model, self.points, self.wanted = model, points, wanted
        self.centre = points.mean(axis=0)
        self.seen = None
        self.size = np.sqrt(np.mean(np.sum((points - self.centre) ** 2, axis=1)))  # a radian is as long as this

    def look(self, unknowns):
        """Residuals and their derivatives; SciPy asks for both, one after the other."""
        if self.seen is None or not np.array_equal(self.seen[0], unknowns):
            self.seen = unknowns.copy(), *self.residuals_and_derivatives(unknowns)
        return self.seen[1:]

    def residuals_and_derivatives(self, unknowns):
        t, w = unknowns[:3], unknowns[3:] / self.size
        moved = Rotation.from_rotvec(w).apply(self.points - self.centre) + self.centre + t
        found = verisq.closest_points(self.model, moved)
        gradient = found.gradient_by_motion(self.centre + t).mean(axis=2)
        gradient[:, 3:] = gradient[:, 3:] @ turn_of(w) / self.size
        gradient[~found.unique] = 0.0  # no gradient is proven there
        return (found.lo + found.hi) / 2 - self.wanted, gradient

    def pose(self, unknowns):
        """The same as a motion of the model: the inverse."""
        t, back = unknowns[:3], Rotation.from_rotvec(-unknowns[3:] / self.size)
        x, y, z, real = back.as_quat()
        return [*(self.centre - back.apply(self.centre + t)), real, x, y, z]


def main(model, mesh, wanted, start):
    model = verisq.Model.load(model)
    points = verisq.Mesh.load(mesh).vertices
    problem = Problem(model.posed(start), points, wanted)
    off = np.sqrt(np.mean(problem.look(np.zeros(6))[0] ** 2))
    print(f"at the start distances are off {wanted:g} by {off:.3g} (root mean square)")
    solution = least_squares(lambda u: problem.look(u)[0], np.zeros(6), jac=lambda u: problem.look(u)[1],
                             xtol=1e-12, ftol=1e-12, gtol=1e-12)
    moved = problem.model.posed(problem.pose(solution.x))
    lo, hi, _ = verisq.map(moved, points, tolerance=1e-9, device="host")
    most = np.nextafter(max(np.max(hi - wanted), np.max(wanted - lo)), np.inf)
    print(f"after {solution.nfev} evaluations all distances are proven to be off by {most} at most")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]), [float(number) for number in sys.argv[4].split(",")])

"""What is sent to another process, or copied, is the same bit for bit: every class of results, and the models."""

import copy
import enum
import json
import multiprocessing
import pickle
import unittest

import numpy as np
import verisq

from command_line import EXAMPLES

# These are ready for work; what they are made of, models, can be sent instead.
WORKERS = {"Checker", "Mapper", "PoseMapper", "SignedDistance", "TriangleMapper"}


def ball(radius, **others):
    primitive = {"name": "p", "superquadric": {"semi_axes": [radius] * 3, "exponents": [1, 1]}}
    return verisq.Model.from_dict({"format": "verisq-model/1", "units": "mm", "primitives": [primitive], **others})


def contents(thing):
    """All that a result says, as what can be compared."""
    if isinstance(thing, np.ndarray):
        return str(thing.dtype), thing.shape, thing.tobytes()
    if isinstance(thing, verisq.Model):
        return json.dumps(thing.to_dict())
    if isinstance(thing, verisq.Certificates):
        return [repr(thing[k]) for k in range(len(thing))]
    if isinstance(thing, (list, tuple)):
        return [contents(each) for each in thing]
    if isinstance(thing, dict):
        return {key: contents(each) for key, each in thing.items()}
    if type(thing).__module__ == "verisq":
        names = [name for name in dir(type(thing)) if isinstance(getattr(type(thing), name), property)]
        return type(thing).__name__, repr(thing) if "object at" not in repr(thing) else "", \
            {name: contents(getattr(thing, name)) for name in names}
    return repr(thing)


def small_fit():
    surface = verisq.mesh_of_model(ball(5.0), 0.4)
    inward = verisq.Mesh(surface.vertices, surface.triangles[:, ::-1])
    return verisq.fit(ball(4.0, landmarks={"head_centre": [0, 0, 1]}), inward, surface="cavity", gap=2.0,
                      completion="cementless", device="host", samples=4, translation_range=0.1, rotation_range=0.1,
                      landmarks={"head_centre": [0, 0, 1], "shaft_proximal": [0, 0, 0], "shaft_distal": [0, 0, -100]},
                      bound=99.0, bound_time=0.1, implant_contact=True, certificates=True)


def rival_fit():
    surface = verisq.mesh_of_model(ball(5.0), 0.4)
    inward = verisq.Mesh(surface.vertices, surface.triangles[:, ::-1])
    return verisq.fit([ball(4.0), ball(3.5)], inward, surface="cavity", device="host", samples=4, translation_range=0.1,
                      rotation_range=0.1)


def femur():
    """As detect_femur() finds one in the mesh of a bone, which would take long to make."""
    found = verisq.Femur.__new__(verisq.Femur)
    found.__setstate__((verisq.__version__, ({"head_centre": (0.0, 1.0, 2.0)}, "left", ("seen",))))
    return found


def one_of_each():
    """Results by their classes' names."""
    points = np.random.default_rng(1).uniform(-9.0, 9.0, (40, 3))
    model = ball(4.0)
    bent = verisq.Model.load(EXAMPLES / "bent_stem.json")
    mesh = verisq.mesh_of_model(model, 0.5)
    certified = verisq.map(model, points, device="host", certificates=True)
    cloud = verisq.mesh_of_model(ball(3.0), 0.2).vertices
    deviation = verisq.deviation(model, mesh, device="host", relative_tolerance=0.5)
    proven = verisq.certified_deviation(model, mesh, device="host", relative_tolerance=0.5, statistics_of_model=True)
    stance = verisq.StanceModel.load(EXAMPLES / "standing.xml")
    landmarks = {"head_centre": [0, 40, 40], "neck_centre": [0, 20, 20], "shaft_proximal": [0, 0, 0],
                 "shaft_distal": [0, 0, -300]}
    features = verisq.femur_features(landmarks, "left", landmark_radius=1.0)
    answer = features.answer(landmarks, "left", landmark_radius=1.0)
    recovery = verisq.recover(cloud)
    fit = small_fit()
    pair = verisq.distance(model, model, [20, 0, 0, 1, 0, 0, 0])
    results = [
        certified, certified.certificates, verisq.Checker(model).points(points, *list(certified)[:2], certified.certificates),
        verisq.closest_points(model, points), verisq.closest_pairs(model, model, [[20, 0, 0, 1, 0, 0, 0]]), pair, pair.closest, pair.distance,
        verisq.distance(model, model), verisq.certified_distance(model, model),
        verisq.certified_distance(bent, bent, [0.2, 0.05, 0, 1, 0.2, 0.1, 0.05], tolerance=1e-3),
        verisq.distance_along(model, model, [[20, 0, 0, 1, 0, 0, 0], [0, 20, 0, 1, 0, 0, 0]]), deviation, deviation.of_vertices,
        verisq.certified_distance_along(model, model, [[20, 0, 0, 1, 0, 0, 0], [0, 20, 0, 1, 0, 0, 0]]),
        proven, proven.of_vertices, proven.statistics_from_model,
        verisq.mesh_clearance(ball(6.0), mesh, device="host", penetration_limit=1.0, most_samples=500), model, mesh,
        verisq.prove_containment(ball(3.0), mesh, "within", device="host"), verisq.octree(model, depth=3, device="host"),
        verisq.certified_map_along(ball(2.0), points, verisq.straight_path([0, 0, -1], length=1), device="host"),
        verisq.certified_mesh_clearance(ball(2.0), mesh, verisq.straight_path([0, 0, -1], length=1), device="host"),
        verisq.removed_volume(ball(2.0), verisq.straight_path([0, 0, -1], length=1), bone=mesh, relative_tolerance=0.5),
        verisq.certified_removed_volume(ball(2.0), verisq.straight_path([0, 0, -1], length=1), bone=mesh, relative_tolerance=0.5),
        stance.narrowed("mp", 41.0, 42.0), stance.equilibrium(uncertain=[]), stance.certified_equilibrium(uncertain=[]), stance.stability(uncertain=[]), stance.simulate(0.01, uncertain=[]),
        stance.bounce(stance.cylinders[0], uncertain=[]), verisq.PoseUncertainty(0.5, 0.5, (0, 0, 1), 16),
        answer, answer.check()[0], features, features.features[0], recovery, recovery.stages[0], recovery.stages[0].to_model, fit, fit.bound, fit.certified_bound,
        fit.certified_contact,
        fit.areas[0], fit.conditions[0], fit.contact["contact"], rival_fit().finalists[0], femur(), *verisq.devices()[:1],
    ]
    return {type(each).__name__: each for each in results}


def nearest(model, points):
    """What a worker of another process does."""
    return verisq.map(model, points, device="host")


def refuse(text):
    return verisq.Model.loads(text, "of a worker")


class Copies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.results = one_of_each()

    def test_of_every_class_of_results(self):
        classes = {name for name in verisq.__all__ if isinstance(getattr(verisq, name), type)
                   and not issubclass(getattr(verisq, name), (Exception, enum.Enum))}
        self.assertEqual(classes - set(self.results) - {"Device"}, WORKERS)  # of devices there may be none
        self.assertEqual(self.results["Femur"].notes, ["seen"])
        for name, result in self.results.items():
            with self.subTest(name):
                expected = contents(result)
                self.assertEqual(contents(pickle.loads(pickle.dumps(result))), expected)
                self.assertEqual(contents(copy.deepcopy(result)), expected)
                self.assertEqual(contents(copy.copy(result)), expected)
                self.assertEqual(pickle.dumps(copy.deepcopy(result)), pickle.dumps(result))  # as caches compare

    def test_are_as_good_as_what_they_are_copies_of(self):
        stance, octree, fit = (pickle.loads(pickle.dumps(self.results[name])) for name in ("StanceModel", "Octree", "Fit"))
        np.testing.assert_array_equal(stance.wrench(["mp"]), self.results["StanceModel"].wrench(["mp"]))
        self.assertEqual(list(next(p for p in stance.parameters if p["name"] == "mp")["range"]), [41.0, 42.0])
        self.assertEqual(len(octree), len(self.results["Octree"]))
        lo, hi, _ = verisq.map(fit.model, [[0, 0, 9]], device="host")
        self.assertLessEqual(lo[0], hi[0])
        certified = pickle.loads(pickle.dumps(self.results["Map"]))
        points = np.random.default_rng(1).uniform(-9.0, 9.0, (40, 3))
        again = verisq.Checker(self.results["Model"]).points(points, certified.lo, certified.hi, certified.certificates)
        self.assertTrue(again.all_proved)

    def test_of_other_versions_are_refused(self):
        result = self.results["Pair"]
        self.assertEqual(result.__getstate__()[0], verisq.__version__)
        with self.assertRaisesRegex(ValueError, "^pickled by verisq 0.0.1, this is " + verisq.__version__):
            verisq.Pair.__new__(verisq.Pair).__setstate__(("0.0.1", ()))
        with self.assertRaisesRegex(ValueError, "^pickled by another build of verisq"):
            verisq.Pair.__new__(verisq.Pair).__setstate__((verisq.__version__, (1, 2)))

    def test_workers_say_that_they_are_none_to_send(self):
        with self.assertRaises(TypeError):
            pickle.dumps(verisq.SignedDistance(ball(1.0)))

    def test_of_errors(self):
        with self.assertRaises(verisq.Error) as caught:
            verisq.Model.load("missing.json")
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.kind), (str(caught.exception), caught.exception.kind))

    def test_go_to_another_process_and_back(self):
        points = np.random.default_rng(2).uniform(-9.0, 9.0, (10, 3))
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            found = pool.apply(nearest, (ball(4.0), points))
            with self.assertRaisesRegex(verisq.Error, "^of a worker: "):
                pool.apply(refuse, ("{}",))
        self.assertEqual(found.lo.tobytes(), nearest(ball(4.0), points).lo.tobytes())


if __name__ == "__main__":
    unittest.main()

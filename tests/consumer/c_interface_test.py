#!/usr/bin/env python3
"""The C interface from another language: c_interface_test.py LIBRARY EXAMPLES VERSION, by ctypes alone."""

import ctypes
import math
import sys
import unittest
from ctypes import POINTER, Structure, byref, c_char, c_char_p, c_double, c_int, c_size_t, c_ssize_t, c_uint8, c_uint64
from ctypes import c_void_p

library, examples, version = ctypes.CDLL(sys.argv[1]), sys.argv[2], sys.argv[3]
OK, FAILURE, INPUT = range(3)


class Error(Structure):
    _fields_ = [("code", c_int), ("message", c_char * 1024)]


class Enclosure(Structure):
    _fields_ = [("lo", c_double), ("hi", c_double)]


class Pose(Structure):
    _fields_ = [("translation", c_double * 3), ("quaternion", c_double * 4)]


INTERRUPTED = ctypes.CFUNCTYPE(c_int, c_void_p)


class MapOptions(Structure):
    _fields_ = [("tolerance", c_double), ("point_radius", c_double), ("device", c_char_p), ("interrupted", INTERRUPTED),
                ("context", c_void_p)]


class Points(Structure):
    _fields_ = [("count", c_size_t), ("first", c_void_p * 3), ("stride", c_ssize_t * 3)]


class Rows(Structure):
    _fields_ = [("lo", c_void_p), ("hi", c_void_p), ("status", c_void_p), ("stride_lo", c_ssize_t),
                ("stride_hi", c_ssize_t), ("stride_status", c_ssize_t)]


class Summary(Structure):
    _fields_ = [("points", c_uint64), ("device_verified", c_uint64), ("host_verified", c_uint64), ("wide", c_uint64),
                ("minimum", Enclosure), ("largest_width", c_double), ("interrupted", c_int)]


library.verisq_version.restype = c_char_p
library.verisq_model_bounding_radius.restype = c_double
library.verisq_model_bounding_radius.argtypes = [c_void_p]
library.verisq_point_distance.argtypes = [c_void_p, POINTER(c_double), c_double, POINTER(Enclosure), POINTER(Error)]
library.verisq_model_distance.argtypes = [c_void_p, c_void_p, POINTER(Pose), c_double, POINTER(Enclosure),
                                          POINTER(c_int), POINTER(Error)]
library.verisq_model_parse.argtypes = [c_char_p, c_size_t, c_char_p, POINTER(c_void_p), POINTER(Error)]
library.verisq_model_free.argtypes = library.verisq_mapper_free.argtypes = [c_void_p]
library.verisq_mapper_create.argtypes = [c_void_p, POINTER(MapOptions), POINTER(c_void_p), POINTER(Error)]
library.verisq_map_points.argtypes = [c_void_p, POINTER(Points), POINTER(Rows), POINTER(Summary), POINTER(Error)]

BALL = b"""{"format": "verisq-model/1", "units": "mm", "primitives": [
  {"name": "ball", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
   "pose": {"translation": [0, 0, 0]}}]}"""


class CInterfaceTest(unittest.TestCase):
    def setUp(self) -> None:
        self.error = Error()
        self.ball = self.parsed(BALL)

    def parsed(self, json: bytes) -> c_void_p:
        model = c_void_p()
        code = library.verisq_model_parse(json, len(json), b"ball.json", byref(model), byref(self.error))
        self.assertEqual(code, OK, self.error.message)
        self.addCleanup(library.verisq_model_free, model)
        return model

    def mapper(self, **options: object) -> c_void_p:
        mapper = c_void_p()
        given = MapOptions(tolerance=1e-12, device=b"host", **options)
        code = library.verisq_mapper_create(self.ball, byref(given), byref(mapper), byref(self.error))
        self.assertEqual(code, OK, self.error.message)
        self.addCleanup(library.verisq_mapper_free, mapper)
        return mapper

    def refused(self, code: int, words: bytes) -> None:
        self.assertEqual((code, self.error.code), (INPUT, INPUT))
        self.assertIn(words, self.error.message)

    def test_version(self) -> None:
        self.assertEqual(library.verisq_version().decode(), version)

    def test_models_from_files_and_text(self) -> None:
        model = c_void_p()
        path = f"{examples}/soap.json".encode()
        self.assertEqual(library.verisq_model_read(path, byref(model), None), OK)
        library.verisq_model_free(model)
        self.refused(library.verisq_model_read(b"nowhere.json", byref(model), byref(self.error)), b"nowhere.json")
        self.refused(library.verisq_model_parse(b"{}", 2, b"empty", byref(model), byref(self.error)), b"empty")
        self.assertEqual(library.verisq_model_parse(b"{}", 2, b"empty", byref(model), None), INPUT)
        library.verisq_model_free(None)
        radius = library.verisq_model_bounding_radius(self.ball)
        self.assertTrue(math.sqrt(3) <= radius < 1.8, radius)

    def test_messages_that_are_too_long_are_cut_off(self) -> None:
        name = b"x" * 3000
        code = library.verisq_model_parse(b"{}", 2, name, byref(c_void_p()), byref(self.error))
        self.assertEqual((code, self.error.message), (INPUT, b"x" * 1023))

    def test_distance_of_a_point(self) -> None:
        found = Enclosure()
        point = (c_double * 3)(3.0, 0.0, 0.0)
        code = library.verisq_point_distance(self.ball, point, 1e-12, byref(found), byref(self.error))
        self.assertEqual((code, self.error.message), (OK, b""))
        self.assertTrue(found.lo <= 2.0 <= found.hi <= found.lo + 1e-12)
        for wrong in (math.nan, math.inf):
            nowhere = (c_double * 3)(wrong, 0.0, 0.0)
            self.refused(library.verisq_point_distance(self.ball, nowhere, 0.0, byref(found), byref(self.error)),
                         b"the point is not finite")
        for wrong in (math.nan, -1.0):
            self.refused(library.verisq_point_distance(self.ball, point, wrong, byref(found), byref(self.error)),
                         b"tolerance")

    def test_distance_of_models(self) -> None:
        found, proximity = Enclosure(), c_int(-1)
        aside = Pose((5.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0))
        bent = self.parsed(BALL.replace(b'"pose"', b'"bend": {"curvature": 0.1, "angle_deg": 0}, "pose"'))
        for other, slack in ((self.ball, 1e-12), (bent, 0.1)):
            code = library.verisq_model_distance(self.ball, other, byref(aside), 1e-3, byref(found), byref(proximity),
                                                 byref(self.error))
            self.assertEqual((code, proximity.value), (OK, 0), self.error.message)
            self.assertTrue(found.lo - slack <= 3.0 <= found.hi + slack and found.hi - found.lo <= 1e-3)
        code = library.verisq_model_distance(self.ball, self.ball, None, 0.0, byref(found), byref(proximity), None)
        self.assertEqual((code, proximity.value, found.lo, found.hi), (OK, 1, 0.0, 0.0))
        for translation, quaternion in (((0, 0, 0), (0, 0, 0, 0)), ((math.nan, 0, 0), (1, 0, 0, 0))):
            code = library.verisq_model_distance(self.ball, self.ball, byref(Pose(translation, quaternion)), 0.0,
                                                 byref(found), byref(proximity), byref(self.error))
            self.refused(code, b"the pose")

    def test_maps_of_points_of_any_stride(self) -> None:
        count = 5
        # Five numbers a point, of which x is the fourth and z the first, read from the end; y is one number for all.
        numbers = (c_double * (5 * count))(*([0.5] * 5 * count))
        for i in range(count):
            numbers[5 * i + 3], numbers[5 * i] = 3.0 * i, 4.0 * i
        y = c_double(0.0)
        at = ctypes.addressof(numbers)
        last = at + 8 * 5 * (count - 1)
        points = Points(count, (last + 24, ctypes.addressof(y), last), (-5, 0, -5))
        lo, hi, status = (c_double * (2 * count))(), (c_double * count)(), (c_uint8 * count)(*[9] * count)
        rows = Rows(ctypes.addressof(lo), ctypes.addressof(hi), ctypes.addressof(status), 2, 1, 1)
        summary = Summary()
        code = library.verisq_map_points(self.mapper(), byref(points), byref(rows), byref(summary), byref(self.error))
        self.assertEqual(code, OK, self.error.message)
        self.assertEqual((summary.points, summary.host_verified + summary.wide, summary.interrupted), (count, count, 0))
        for i in range(count):
            distance = 5.0 * (count - 1 - i) - 1.0
            self.assertTrue(lo[2 * i] <= distance <= hi[i] <= lo[2 * i] + 1e-8, (lo[2 * i], hi[i], distance))
            self.assertIn(status[i], (1, 2))
            self.assertEqual(lo[2 * i + 1], 0.0)
        self.assertTrue(summary.minimum.lo <= -1.0 <= summary.minimum.hi)

    def test_maps_refuse_what_is_none(self) -> None:
        mapper = self.mapper()
        point = (c_double * 3)(math.nan, 0.0, 0.0)
        at = ctypes.addressof(point)
        lo, hi, status = c_double(), c_double(), c_uint8()
        rows = Rows(ctypes.addressof(lo), ctypes.addressof(hi), ctypes.addressof(status), 1, 1, 1)
        points = Points(1, (at, at + 8, at + 16), (3, 3, 3))
        ask = library.verisq_map_points
        self.refused(ask(mapper, byref(points), byref(rows), None, byref(self.error)), b"finite")
        self.refused(ask(mapper, byref(Points(1, (at, None, at), (3, 3, 3))), byref(rows), None, byref(self.error)),
                     b"NULL")
        self.refused(ask(mapper, byref(points), byref(Rows(at, None, at, 1, 1, 1)), None, byref(self.error)), b"NULL")
        shared = Rows(at, ctypes.addressof(hi), ctypes.addressof(status), 1, 1, 1)
        self.refused(ask(mapper, byref(points), byref(shared), None, byref(self.error)), b"memory")
        self.assertEqual(ask(mapper, byref(Points()), byref(Rows()), None, byref(self.error)), OK)
        none = c_void_p()
        for options in (MapOptions(tolerance=-1.0), MapOptions(tolerance=1.0, point_radius=math.nan),
                        MapOptions(tolerance=1.0, device=b"no such device")):
            code = library.verisq_mapper_create(self.ball, byref(options), byref(none), byref(self.error))
            self.assertEqual((code, none.value), (INPUT, None), self.error.message)

    def test_maps_are_interrupted(self) -> None:
        asked = []

        @INTERRUPTED
        def stop(_context: object) -> int:
            asked.append(True)
            return 1

        points, lo, hi, status = (c_double * 3)(), c_double(), c_double(), c_uint8()
        at = ctypes.addressof(points)
        summary = Summary()
        rows = Rows(ctypes.addressof(lo), ctypes.addressof(hi), ctypes.addressof(status), 1, 1, 1)
        given = Points(1, (at, at + 8, at + 16), (3, 3, 3))
        code = library.verisq_map_points(self.mapper(interrupted=stop), byref(given), byref(rows), byref(summary),
                                         byref(self.error))
        self.assertEqual((code, summary.points, summary.interrupted), (OK, 0, 1), self.error.message)
        self.assertTrue(asked)
        self.assertEqual((summary.minimum.lo, summary.minimum.hi), (math.inf, math.inf))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

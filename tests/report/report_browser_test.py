"""A report in a real browser: pictures, clicks, charts, and numbers, which must be those of the map beside it."""

import argparse
import base64
import csv
import hashlib
import itertools
import json
import math
import os
import struct
import subprocess
import sys
import time
import unittest
from pathlib import Path

skipped = 77  # exit status that CTest knows

try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
except ImportError:
    webdriver = None

options = None  # of the command line

software_graphics = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
no_graphics = ("--disable-3d-apis",)
window = (1200, 800)


class Bone:
    """A closed ellipsoid around the origin with a vertex at each end of its axes; the z axis is the longest."""

    semi_axes = (20.0, 18.0, 30.0)

    def __init__(self, rings=24, around=48):
        self.rings, self.around = rings, around
        unit = [(0.0, 0.0, -1.0)]
        for ring in range(1, self.rings):
            latitude = math.pi * (ring / self.rings - 0.5)
            unit += [(math.cos(latitude) * math.cos(2 * math.pi * k / self.around),
                      math.cos(latitude) * math.sin(2 * math.pi * k / self.around), math.sin(latitude))
                     for k in range(self.around)]
        unit.append((0.0, 0.0, 1.0))
        self.vertices = [tuple(c * a for c, a in zip(point, self.semi_axes)) for point in unit]
        self.triangles = list(self._triangles())

    def _triangles(self):
        at = lambda ring, k: 1 + (ring - 1) * self.around + k % self.around
        for k in range(self.around):
            yield 0, at(1, k + 1), at(1, k)
            for ring in range(1, self.rings - 1):
                yield at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)
                yield at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)
            yield at(self.rings - 1, k), at(self.rings - 1, k + 1), len(self.vertices) - 1

    def nearest(self, point):
        return min(range(len(self.vertices)), key=lambda vertex: math.dist(self.vertices[vertex], point))

    def write_off(self, path):
        lines = ["OFF", f"{len(self.vertices)} {len(self.triangles)} 0"]
        lines += [f"{x!r} {y!r} {z!r}" for x, y, z in self.vertices]
        lines += [f"3 {a} {b} {c}" for a, b, c in self.triangles]
        path.write_text("\n".join(lines) + "\n")


# Pierces the bone at its -x side, so that both signs occur; within the box of the bone.
implant = {"format": "verisq-model/1", "units": "mm", "primitives": [
    {"name": "peg", "superquadric": {"semi_axes": [7, 5, 9], "exponents": [0.5, 1]},
     "pose": {"translation": [-14, 0, 0]}}]}


def read_map(path):
    with path.open() as file:
        return [(float(row["lo"]), float(row["hi"]), row["status"]) for row in csv.DictReader(file)]


def encoded(letter, numbers):
    return base64.b64encode(struct.pack(f"<{len(numbers)}{letter}", *numbers)).decode()


def flat(rows):
    return [number for row in rows for number in row]


def write_page(path, report):
    """Fills the built page as the library does."""
    block = json.dumps(report).replace("<", "\\u003c")
    page = Path(options.page).read_text()
    path.write_text(page.replace("<!--verisq-report-data-->",
                                 f'<script type="application/json" id="verisq-report">{block}</script>'))


drivers = {}  # by their arguments; starting one takes seconds


def driver_with(arguments):
    if arguments not in drivers:
        chrome = webdriver.ChromeOptions()
        chrome.binary_location = options.chromium
        # Containers run as root, which needs no-sandbox, and have little shared memory.
        for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                         f"--window-size={window[0]},{window[1]}", *arguments]:
            chrome.add_argument(argument)
        chrome.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        drivers[arguments] = webdriver.Chrome(service=Service(options.chromedriver), options=chrome)
    return drivers[arguments]


class Browser:
    """A page, newly opened in headless Chromium; leaving it fails when the page has complained."""

    def __init__(self, path, arguments):
        self.driver = driver_with(arguments)
        self.driver.get("about:blank")
        self.driver.get(Path(path).resolve().as_uri())
        self.wait(lambda: {"ready", "broken"} & set(self.one("body").get_attribute("class").split()),
                  "the page to start")

    def one(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def text(self, selector):
        return self.one(selector).text

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not (result := condition()):
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain for {what}; console: {self.console()}")
            time.sleep(0.05)
        return result

    def drawn(self):
        """Waits until what was asked for before is on the canvas."""
        self.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    def view(self, name):
        self.driver.find_element(By.XPATH, f"//fieldset[@id='views']/button[text()='{name}']").click()
        self.drawn()

    def click_canvas(self, x=0, y=0):
        """In pixels from the middle of the picture."""
        ActionChains(self.driver).move_to_element_with_offset(self.one("#stage canvas"), x, y).click().perform()
        self.drawn()

    def pixels(self, canvas="#stage canvas"):
        """What the canvas shows: how many colours, how much of it is covered and warm, the colour in the middle."""
        return self.driver.execute_script("""
            const canvas = document.querySelector(arguments[0]);
            const { width, height } = canvas;
            const copy = Object.assign(document.createElement("canvas"), { width, height });
            const context = copy.getContext("2d");
            context.drawImage(canvas, 0, 0);
            const { data } = context.getImageData(0, 0, width, height);
            const words = new Uint32Array(data.buffer);
            let covered = 0, hash = 0, warm = 0;
            for (let k = 0; k < data.length; k += 4) warm += data[k] > data[k + 2] + 40;
            for (const word of words) { covered += word !== 0; hash = (Math.imul(hash, 31) + word) | 0; }
            const middle = 4 * ((height >> 1) * width + (width >> 1));
            return { colours: new Set(words).size, covered: covered / words.length,
                     warm: warm / words.length, hash, middle: [...data.slice(middle, middle + 4)] };""", canvas)

    def pinned(self):
        """The pinned vertex and its shown ends, as texts."""
        number = int(self.text("#vertex .name").removeprefix("Vertex "))
        return number, self.text("#vertex .lo"), self.text("#vertex .hi")

    def screenshot(self, name):
        self.driver.save_screenshot(str(Path(options.output) / name))

    def console(self):
        return [entry for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        complaints = self.console()
        if complaints and not kind:
            raise AssertionError(f"the page complained: {complaints}")


class WrittenReport(unittest.TestCase):
    """The report that `verisq map --report` writes, against its own `.csv`."""

    @classmethod
    def setUpClass(cls):
        folder = Path(options.output)
        cls.bone = Bone()
        cls.bone.write_off(folder / "bone.off")
        (folder / "implant.json").write_text(json.dumps(implant))
        subprocess.run([options.program, "map", "--model", folder / "implant.json", "--mesh", folder / "bone.off",
                        "--device", "host", "--no-progress", "-o", folder / "map.csv",
                        "--report", folder / "report.html"], check=True, stdout=subprocess.DEVNULL)
        cls.map = read_map(folder / "map.csv")
        cls.page = folder / "report.html"

    def browser(self):
        return Browser(self.page, software_graphics)

    def assert_pinned(self, browser, vertex):
        number, lo, hi = browser.pinned()
        self.assertEqual(number, vertex)
        self.assertEqual((float(lo), float(hi)), self.map[vertex][:2])

    def test_map_has_both_signs(self):
        self.assertEqual(len(self.map), len(self.bone.vertices))
        self.assertTrue(any(hi < 0 for _, hi, _ in self.map) and any(lo > 0 for lo, _, _ in self.map))

    def test_click_shows_the_numbers_of_the_csv(self):
        a, b, c = self.bone.semi_axes
        ends = {"+X": (a, 0, 0), "\u2212X": (-a, 0, 0), "+Y": (0, b, 0), "\u2212Y": (0, -b, 0),
                "+Z": (0, 0, c), "\u2212Z": (0, 0, -c)}
        with self.browser() as browser:
            for name, end in ends.items():
                with self.subTest(view=name):
                    browser.view(name)
                    browser.click_canvas()
                    self.assert_pinned(browser, self.bone.nearest(end))
            browser.screenshot("report_pinned.png")

    def test_click_beside_the_middle(self):
        with self.browser() as browser:
            browser.view("+X")
            browser.click_canvas(x=60, y=-90)  # right and up: towards +y and +z
            vertex = browser.pinned()[0]
            self.assert_pinned(browser, vertex)
            self.assertTrue(all(coordinate > 2 for coordinate in self.bone.vertices[vertex]))
            browser.click_canvas(x=-browser.one("#stage canvas").size["width"] // 2 + 3)  # not the bone
            self.assertEqual(browser.all("#vertex .name"), [])

    def test_a_drag_turns_and_pins_nothing(self):
        with self.browser() as browser:
            before = browser.pixels()["hash"]
            ActionChains(browser.driver).drag_and_drop_by_offset(browser.one("#stage canvas"), 90, 20).perform()
            browser.drawn()
            self.assertNotEqual(browser.pixels()["hash"], before)
            self.assertEqual(browser.all("#vertex .name"), [])

    def test_pointer_shows_the_numbers_of_the_csv(self):
        with self.browser() as browser:
            browser.view("+Y")
            ActionChains(browser.driver).move_to_element(browser.one("#stage canvas")).perform()
            browser.wait(lambda: browser.one("#tip").is_displayed(), "the tip")
            vertex = self.bone.nearest((0, self.bone.semi_axes[1], 0))
            self.assertEqual(browser.text("#tip .name"), f"Vertex {vertex}")
            self.assertEqual((float(browser.text("#tip .lo")), float(browser.text("#tip .hi"))), self.map[vertex][:2])

    def test_colours_tell_the_sign(self):
        with self.browser() as browser:
            browser.one("#implant-shown").click()
            for view, is_inside in (("+X", False), ("\u2212X", True)):
                browser.view(view)
                picture = browser.pixels()
                red, _, blue, _ = picture["middle"]
                self.assertEqual(red > blue, is_inside, f"{view}: {picture}")
                self.assertGreater(picture["colours"], 100)
                self.assertGreater(picture["covered"], 0.1)

    def test_each_quantity(self):
        quantities = {"lo": "Lower bound", "hi": "Upper bound", "width": "Width", "status": "Status"}
        with self.browser() as browser:
            pictures = {}
            for quantity, name in quantities.items():
                browser.one(f"label[for='quantities-{quantity}']").click()
                browser.drawn()
                self.assertTrue(browser.text("#legend .name").startswith(name))
                self.assertTrue(browser.one("#chart").find_elements(By.CSS_SELECTOR, ".bin"))
                pictures[quantity] = browser.pixels()["hash"]
                browser.screenshot(f"report_{quantity}.png")
            self.assertEqual(len({pictures[name] for name in ("lo", "width", "status")}), 3)
            counts = [row.text.split()[0].replace(",", "") for row in browser.all("#chart .row .numbers")]
            rows = {row.text.split(":")[0]: int(count) for row, count in zip(browser.all("#chart .row"), counts)}
            statuses = [status for _, _, status in self.map]
            self.assertEqual(rows, {name: statuses.count(name) for name in rows})
            self.assertEqual(sum(rows.values()), len(self.map))

    def test_histogram_counts_every_vertex_and_highlights(self):
        with self.browser() as browser:
            before = browser.pixels()["hash"]
            chart = browser.one("#chart")
            total = 0
            for _ in browser.all("#chart .bin"):
                chart.send_keys(Keys.ARROW_RIGHT)
                total += int(browser.text("#chart-reading").split(": ")[1].split()[0].replace(",", ""))
            self.assertEqual(total, len(self.map))
            browser.drawn()
            self.assertNotEqual(browser.pixels()["hash"], before)

    def test_facts_and_table(self):
        with self.browser() as browser:
            numbers = [int(fact.text.split("\n")[0].replace(",", "")) for fact in browser.all("#facts dd")[:3]]
            outside, inside = sum(lo > 0 for lo, _, _ in self.map), sum(hi < 0 for _, hi, _ in self.map)
            self.assertEqual(numbers, [outside, inside, len(self.map) - outside - inside])
            rows = {row.find_element(By.TAG_NAME, "th").text: row.find_element(By.TAG_NAME, "td").text
                    for row in browser.all("#summary tr")}
            self.assertTrue(rows)
            self.assertTrue(all(label and value for label, value in rows.items()), rows)
            self.assertIn(str(len(self.map)), {value.replace(",", "") for value in rows.values()})
            self.assertIn(f"{len(self.map):,}", browser.text("#statement"))

    def test_vertex_by_number_and_keys(self):
        with self.browser() as browser:
            browser.one("#vertex-number").send_keys("700", Keys.ENTER)
            self.assert_pinned(browser, 700)
            browser.one("#vertex-closest").click()
            vertex = browser.pinned()[0]
            self.assertEqual(self.map[vertex][0], min(lo for lo, _, _ in self.map))
            before = browser.pixels()["hash"]
            browser.one("#stage").send_keys(Keys.ARROW_LEFT, "+")
            browser.drawn()
            self.assertNotEqual(browser.pixels()["hash"], before)

    def test_cut_opens_the_bone(self):
        with self.browser() as browser:
            browser.one("#implant-shown").click()
            browser.view("+X")
            browser.click_canvas()
            front = browser.pinned()[0]
            browser.one("label[for='section-axes-X']").click()
            browser.drawn()
            browser.click_canvas()
            back = browser.pinned()[0]
            self.assertGreater(self.bone.vertices[front][0], 0)
            self.assertLess(self.bone.vertices[back][0], 0)
            self.assert_pinned(browser, back)
            browser.screenshot("report_cut.png")

    def test_paper_shows_the_bone_cut_open(self):
        with self.browser() as browser:
            browser.one("#implant-shown").click()
            browser.view("+Y")  # from where the bone is broadest; what is inside the peg lies on the bone's -x side
            before = browser.pixels()
            self.assertFalse(browser.one("#cut-open").is_displayed())
            paper = base64.b64decode(browser.driver.print_page())
            (Path(options.output) / "report.pdf").write_bytes(paper)
            self.assertEqual(paper.count(b"/Type /Page\n") + paper.count(b"/Type /Page "), 2)
            self.assertEqual(browser.pixels()["hash"], before["hash"])
            cut = browser.pixels("#cut-open-picture")
            self.assertGreater(cut["covered"], 0.1)
            self.assertGreater(cut["warm"], 20 * before["warm"])


class FittedReport(unittest.TestCase):
    """The report that `verisq fit --report` writes, against the `.csv` of its `--map` and the boxes of its areas."""

    areas = {"ends": 2, "front": 1, "elsewhere": 0.5}  # weights

    @staticmethod
    def area_of(vertex):
        x, _, z = vertex
        return "ends" if z >= 20 else "front" if x >= 5 else "elsewhere"

    @classmethod
    def setUpClass(cls):
        folder = Path(options.output)
        cls.bone = Bone(rings=12, around=24)
        cls.bone.write_off(folder / "cavity.off")
        primitive = {"name": "body", "superquadric": {"semi_axes": [18, 16, 27], "exponents": [1, 1]},
                     "pose": {"translation": [1, -1.5, 2]}}
        boxes = [{"name": "ends", "weight": cls.areas["ends"], "box": [[-99, -99, 20], [99, 99, 99]]},
                 {"name": "front", "weight": cls.areas["front"], "box": [[5, -99, -99], [99, 99, 99]]}]
        (folder / "body.json").write_text(json.dumps(
            {"format": "verisq-model/1", "units": "mm", "primitives": [primitive], "areas": boxes}))
        output = subprocess.run(
            [options.program, "fit", "--any-side", "--implant", folder / "body.json", "--mesh", folder / "cavity.off",
             "--weight", f"elsewhere={cls.areas['elsewhere']}", "--translation-range", "4", "--rotation-range", "10",
             "--samples", "128", "--device", "host", "--no-progress", "--json", "-o", folder / "fitted.json",
             "--map", folder / "fit.csv", "--report", folder / "fit.html", "--png", folder / "fit.png"],
            check=True, capture_output=True).stdout
        cls.summary = json.loads(output)
        cls.map = read_map(folder / "fit.csv")
        cls.page = folder / "fit.html"

    def browser(self):
        return Browser(self.page, software_graphics)

    def vertices_of(self, name):
        return [k for k, vertex in enumerate(self.bone.vertices) if self.area_of(vertex) == name]

    def test_every_number_is_that_of_the_csv(self):
        self.assertEqual(len(self.map), len(self.bone.vertices))
        block = self.page.read_text().split('<script type="application/json" id="verisq-report">')[1]
        data = json.loads(block.split("</script>")[0])
        for column, end in enumerate(("lo", "hi")):
            numbers = struct.unpack(f"<{len(self.map)}d", base64.b64decode(data[end]))
            self.assertEqual(list(numbers), [row[column] for row in self.map])
        with self.browser() as browser:
            field = browser.one("#vertex-number")
            for vertex in range(0, len(self.map), 13):
                field.clear()
                field.send_keys(str(vertex), Keys.ENTER)
                number, lo, hi = browser.pinned()
                self.assertEqual((number, float(lo), float(hi)), (vertex, *self.map[vertex][:2]))
                self.assertIn(self.area_of(self.bone.vertices[vertex]), browser.text("#vertex dl"))
            browser.screenshot("fit_pinned.png")

    def test_areas_are_those_of_the_boxes(self):
        with self.browser() as browser:
            before = browser.pixels()["hash"]
            browser.one("label[for='quantities-area']").click()
            browser.drawn()
            self.assertNotEqual(browser.pixels()["hash"], before)
            rows = [row.text.split("\n") for row in browser.all("#chart .row")]
            counts = {name: int(numbers.split()[0].replace(",", "")) for name, numbers in rows}
            self.assertEqual(counts, {name: len(self.vertices_of(name)) for name in self.areas})
            for name in self.areas:
                self.assertIn(name, browser.text("#legend"))
            browser.screenshot("fit_areas.png")
            # As many colours as areas, and the front end of the bone has that of its own.
            browser.one("#implant-shown").click()
            browser.view("+X")
            front = browser.pixels()["middle"]
            browser.view("\u2212X")
            self.assertNotEqual(browser.pixels()["middle"], front)
            browser.click_canvas()
            vertex = browser.pinned()[0]
            self.assertEqual(vertex, self.bone.nearest((-self.bone.semi_axes[0], 0, 0)))
            self.assertIn("elsewhere", browser.text("#vertex dl"))

    def test_summary_is_what_the_program_says(self):
        smallest = self.summary["smallest_distance"]
        self.assertEqual([smallest["lo"], smallest["hi"]],
                         [min(row[column] for row in self.map) for column in (0, 1)])
        with self.browser() as browser:
            lines = [(row.find_element(By.TAG_NAME, "th").text, row.find_element(By.TAG_NAME, "td").text)
                     for row in browser.all("#summary tr")]
            rows = dict(lines)
            areas = [text for label, text in lines if label == "area"]
            self.assertEqual(len(areas), len(self.summary["areas"]))
            for area, text in zip(self.summary["areas"], areas):
                self.assertEqual(area["points"], len(self.vertices_of(area["name"])))
                self.assertIn(str(area["points"]), text)
                self.assertIn(f'named "{area["name"]}"', text)
            translation = rows["translation"].removeprefix("(").removesuffix(") mm").split(", ")
            self.assertEqual([float(coordinate) for coordinate in translation], self.summary["pose"]["translation"])
            self.assertIn("cavity.off: fit of body.json", browser.text("#title"))


class FilledPage(unittest.TestCase):
    """The page with data that no small map has."""

    hostile = "<img src=x onerror=alert(1)></script><b>&amp;"

    def report(self):
        bone = Bone()
        count = len(bone.vertices)
        lo = [point[0] / 3 for point in bone.vertices]
        hi = [end + 1e-3 for end in lo]
        lo[0], hi[0] = -math.inf, math.inf
        hi[1] = math.inf
        lo[2] = hi[2] = -0.0
        surface = {"positions": encoded("f", flat(bone.vertices)), "triangles": encoded("I", flat(bone.triangles))}
        return {"format": "verisq-report/1", "title": self.hostile, "units": self.hostile,
                "summary": [{"label": self.hostile, "value": self.hostile}], "centre": [0, 0, 0], "up": [0, 0, 1], "front": [1, 0, 0],
                "bone": surface,
                "implant": {"positions": "", "triangles": ""}, "lo": encoded("d", lo), "hi": encoded("d", hi),
                "status": encoded("B", [vertex % 3 for vertex in range(count)]),
                "areas": {"names": ["calcar", self.hostile],
                          "of": encoded("I", [int(vertex % 5 == 0) for vertex in range(count)])}}

    def browser(self, name, report, arguments=software_graphics):
        path = Path(options.output) / name
        write_page(path, report)
        return Browser(path, arguments)

    def test_text_is_never_markup(self):
        with self.browser("hostile.html", self.report()) as browser:
            self.assertEqual(browser.text("#title"), self.hostile)
            self.assertEqual(browser.text("#summary td"), self.hostile)
            browser.one("label[for='quantities-area']").click()
            browser.click_canvas()
            self.assertIn(self.hostile, browser.text("#chart"))
            self.assertEqual(browser.all("img, main b"), [])

    def test_units_cannot_speak_for_the_page(self):
        report = self.report() | {"units": "mm\nall proven\u202e" + "x" * 100}
        with self.browser("units.html", report) as browser:
            shown = "\"mm\\u{a}all proven\\u{202e}" + "x" * 46 + "...\""
            self.assertIn(f"in {shown}) is proven", browser.text("#statement"))
            self.assertIn(shown, browser.text("#legend"))

    def test_special_ends_are_as_in_the_csv(self):
        with self.browser("unbounded.html", self.report()) as browser:
            for number, ends in ((0, ("-inf", "inf")), (2, ("-0", "-0"))):
                field = browser.one("#vertex-number")
                field.clear()
                field.send_keys(str(number), Keys.ENTER)
                self.assertEqual(browser.pinned(), (number, *ends))
            self.assertIn("not bounded", browser.text("#legend"))
            self.assertIn("1 not bounded", browser.text("#chart-reading"))
            for quantity in ("hi", "width", "status", "area"):
                browser.one(f"label[for='quantities-{quantity}']").click()
                browser.drawn()

    def test_without_graphics_all_else_works(self):
        with self.browser("without_graphics.html", self.report(), no_graphics) as browser:
            self.assertIn("WebGL 2", browser.text("#message"))
            self.assertEqual(browser.text("#summary td"), self.hostile)
            self.assertTrue(browser.all("#chart .bin"))
            browser.one("#vertex-number").send_keys("7", Keys.ENTER)
            self.assertEqual(browser.pinned()[0], 7)

    def test_broken_data_is_named(self):
        report = self.report()
        report["lo"] = report["lo"][:-12]
        with self.browser("broken.html", report) as browser:
            self.assertIn("lo: ", browser.text("#statement"))
            self.assertFalse(browser.one("main").is_displayed())


def read_certified(path):
    """Rows as dictionaries of texts."""
    with path.open() as file:
        return list(csv.DictReader(file))


def write_certified(path, rows):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def normals_of(row):
    """(primitive, vector), the first first."""
    found = [(row["primitive"], *(row[f"normal_{axis}"] for axis in "xyz"))] if row["primitive"] else []
    found += [tuple(entry.split(":")) for entry in row["further_normals"].split()]
    return [(int(primitive), [float(number) for number in vector]) for primitive, *vector in found]


def points_of(rows, what):
    """The rows that have one, and the points."""
    found = [(k, [float(row[f"{what}_{axis}"]) for axis in "xyz"]) for k, row in enumerate(rows) if row[f"{what}_x"]]
    return encoded("I", [k for k, _ in found]), encoded("d", flat(point for _, point in found))


def cover_of(row):
    """The bits, which say themselves where they end: one cell more is left than halved."""
    bits, left = [], 1
    for bit in (int(digit, 16) >> place & 1 for digit in row["cover"] for place in (3, 2, 1, 0)):
        if left > 0:
            bits.append(bit)
            left += 1 if bit else -1
    return bits


def ends_of(lists):
    return encoded("I", list(itertools.accumulate(len(found) for found in lists)))


def certificate_columns(rows):
    """The certificates of a .csv as the data of a page has them."""
    normals = [normals_of(row) for row in rows]
    escaping, escapes = points_of(rows, "escape")
    witnessing, witnesses = points_of(rows, "witness")
    covers = [cover_of(row) for row in rows]
    bits = flat(covers)
    covered = [sum(bit << 7 - place for place, bit in enumerate(bits[k:k + 8])) for k in range(0, len(bits), 8)]
    return {"normals_end": ends_of(normals),
            "primitives": encoded("I", [primitive for found in normals for primitive, _ in found]),
            "normals": encoded("d", [number for found in normals for _, vector in found for number in vector]),
            "escaping": escaping, "escapes": escapes, "witnessing": witnessing, "witnesses": witnesses,
            "covers_end": ends_of(covers), "covers": encoded("B", covered)}


def other_digit(text):
    """A number with its fourth digit changed."""
    place = [k for k, character in enumerate(text.split("e")[0]) if character.isdigit()][3]
    return text[:place] + str((int(text[place]) + 5) % 10) + text[place + 1:]


def forged(rows):
    """Each row with one thing changed, in turn."""
    def change(row, key, make):
        return row | {key: make(row[key])} if row[key] else row

    kinds = [lambda row: row,
             lambda row: row | {"lo": repr(float(row["hi"]) + 1e-12)},
             lambda row: row | {"hi": repr(float(row["lo"]) - 1e-12)},
             lambda row: row | {"lo": repr(math.nextafter(float(row["lo"]), math.inf))},
             lambda row: row | {"hi": repr(math.nextafter(float(row["hi"]), -math.inf))},
             lambda row: row | {"hi": repr(float(row["lo"]) + 0.01 * (float(row["hi"]) - float(row["lo"])))},
             lambda row: change(row, "normal_x", other_digit),
             lambda row: change(row, "normal_z", lambda text: str(-float(text))),
             lambda row: change(row, "escape_y", other_digit),
             lambda row: change(row, "witness_y", other_digit),
             lambda row: change(row, "cover", lambda text: "0"),
             lambda row: change(row, "primitive", lambda text: str(1 - int(text))),
             lambda row: change(row, "primitive", lambda text: "7"),
             lambda row: row | {"further_normals": ""},
             lambda row: row | {"lo": row["hi"], "hi": row["lo"]}]
    return [kinds[k % len(kinds)](row) for k, row in enumerate(rows)]


class ProvingReport(unittest.TestCase):
    """A report with certificates proves itself, by a checker that is not the one of `verisq check`."""

    # Overlapping, one of them tapered, in the small bone below: rows outside, inside one and inside both.
    model = {"format": "verisq-model/1", "units": "mm", "primitives": [
        {"name": "peg", "superquadric": {"semi_axes": [7, 5, 9], "exponents": [0.5, 1], "taper": 0.6},
         "pose": {"translation": [-14, 0.1, 0], "quaternion": [0.9, 0.1, -0.2, 0.3]}},
        {"name": "ball", "superquadric": {"semi_axes": [6, 6, 6], "exponents": [1, 1]},
         "pose": {"translation": [-14, 6, 3]}}]}

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(options.output)
        cls.bone = Bone(rings=10, around=16)
        cls.bone.write_off(cls.folder / "small_bone.off")
        (cls.folder / "union.json").write_text(json.dumps(cls.model))
        cls.page = cls.written(cls.folder / "union.json", "certified")
        text = cls.page.read_text()
        cls.report = json.loads(text.split('id="verisq-report">')[1].split("</script>")[0])
        cls.rows = read_certified(cls.folder / "certified.csv")

    @classmethod
    def run_verisq(cls, *arguments):
        return subprocess.run([options.program, *arguments, "--no-progress"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL)

    @classmethod
    def written(cls, model, name, *more):
        """Some rows of overlaps are wide, which is status 3."""
        page = cls.folder / f"{name}.html"
        cls.run_verisq("map", "--model", model, "--mesh", cls.folder / "small_bone.off", "--device", "host",
                       "--certificates", "-o", cls.folder / f"{name}.csv", "--report", page, *more)
        return page

    def forged_page(self, name, rows, **changes):
        page = self.folder / name
        ends = {key: encoded("d", [float(row[key]) for row in rows]) for key in ("lo", "hi")}
        proof = self.report["proof"] | {"certificates": certificate_columns(rows)} | changes
        write_page(page, self.report | ends | {"proof": proof})
        return page

    def prove(self, page):
        """What the page says, and the vertex that it names."""
        with Browser(page, no_graphics) as browser:
            browser.driver.execute_script("arguments[0].click()", browser.one("#proof-start"))
            browser.wait(lambda: browser.one("#proof-start").is_enabled(), "the proofs")
            result = browser.driver.execute_script("return document.getElementById('proof-result').textContent")
            first = browser.one("#proof-first")
            if first.is_displayed():
                browser.driver.execute_script("arguments[0].click()", first)
                return result, int(browser.text("#vertex .name").removeprefix("Vertex "))
            return result, None

    def assert_counts(self, result, proved, refuted, unproved):
        self.assertTrue(result.startswith(f"{proved} proved, {refuted} refuted, {unproved} unproved, in "), result)

    def test_map_has_rows_of_all_kinds(self):
        self.assertTrue(any(float(row["lo"]) > 0 for row in self.rows))
        self.assertTrue(any(float(row["hi"]) < 0 and row["escape_x"] for row in self.rows))
        self.assertTrue(any(row["further_normals"] for row in self.rows))

    def test_proves_every_vertex(self):
        result, first = self.prove(self.page)
        self.assertTrue(result.startswith(f"All {len(self.rows)} vertices are proved, in "), result)
        self.assertIsNone(first)

    def test_proves_every_vertex_of_a_fit(self):
        page = self.folder / "certified_fit.html"
        self.run_verisq("fit", "--any-side", "--on", "vertices", "--implant", self.folder / "union.json", "--mesh",
                        self.folder / "small_bone.off", "--translation-range", "1", "--rotation-range", "2", "--samples",
                        "8", "--device", "host", "--certificates", "-o", self.folder / "certified_fit.json",
                        "--report", page)
        result, first = self.prove(page)
        self.assertRegex(result, r"^(All \d+ vertices are proved|\d+ proved, 0 refuted, \d+ unproved), in ")
        self.assertIn(str(len(self.bone.vertices)), result)

    def test_a_browser_without_workers_proves_too(self):
        driver = driver_with(no_graphics)
        script = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": "window.Worker = undefined"})
        try:
            result, _ = self.prove(self.page)
        finally:
            driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)
        self.assertTrue(result.startswith(f"All {len(self.rows)} vertices are proved, in "), result)

    def test_other_units_are_not_proven(self):
        page = self.folder / "metres.html"
        write_page(page, self.report | {"units": "m"})
        result, _ = self.prove(page)
        self.assertIn("units: not those of the model's text", result)

    def test_a_way_is_not_what_is_proven(self):
        page = self.folder / "way.html"
        pose = {"translation": [0, 0, 0], "quaternion": [1, 0, 0, 0]}
        write_page(page, self.report | {"path": [pose, pose]})
        with Browser(page, no_graphics) as browser:
            self.assertFalse(browser.one("main").is_displayed())

    def test_one_changed_number_is_refuted(self):
        rows = [dict(row) for row in self.rows]
        rows[37]["lo"] = repr(float(rows[37]["hi"]) + 1e-9)
        rows[37]["hi"] = repr(float(rows[37]["hi"]) + 2e-9)
        result, first = self.prove(self.forged_page("changed.html", rows))
        self.assert_counts(result, len(rows) - 1, 1, 0)
        self.assertEqual(first, 37)

    def test_forged_rows_have_the_verdicts_of_check(self):
        rows = forged(self.rows)
        write_certified(self.folder / "forged.csv", rows)
        checked = json.loads(self.run_verisq("check", "--model", self.folder / "union.json", "--mesh",
                                             self.folder / "small_bone.off", "--map", self.folder / "forged.csv",
                                             "--json").stdout)
        result, first = self.prove(self.forged_page("forged.html", rows))
        counts = [checked[verdict] for verdict in ("proved", "refuted", "unproved")]
        self.assertTrue(all(counts), counts)
        self.assert_counts(result, *counts)
        self.assertEqual(first, checked["first"]["index"])

    def test_another_model_is_not_proved(self):
        other = json.dumps(self.model).replace('"exponents": [0.5, 1]', '"exponents": [0.5, 1.0001]')
        result, _ = self.prove(self.forged_page("another.html", self.rows, model=other))
        self.assertNotIn("All", result)
        self.assertNotIn(" 0 refuted", result)

    def test_a_moved_model_is_proved_where_it_stands(self):
        result, _ = self.prove(self.written(self.folder / "union.json", "moved", "--pose", "1,2,3,0.8,0.1,0.2,0.3"))
        self.assertTrue(result.startswith("All "), result)

    def test_uncertain_points_are_proved(self):
        result, _ = self.prove(self.written(self.folder / "union.json", "uncertain", "--point-radius", "0.25"))
        self.assertTrue(result.startswith("All "), result)

    def test_what_has_no_proofs_here_is_said(self):
        for change, words in (
                ({"superquadric": {"semi_axes": [[7, 7.1], 5, 9], "exponents": [0.5, 1]}}, "intervals for numbers"),
                ({"bend": {"curvature": 0.2, "angle_deg": 0}}, "not proven to be one-to-one")):
            first, *others = self.model["primitives"]
            model = json.dumps(self.model | {"primitives": [first | change, *others]})
            result, _ = self.prove(self.forged_page("not_here.html", self.rows, model=model))
            self.assertIn("This page cannot prove", result)
            self.assertIn(words, result)

    def test_bends_and_what_is_cut_out_of_them_are_proved(self):
        peg, ball = self.model["primitives"]
        bent = peg | {"bend": {"curvature": 0.02, "angle_deg": 40}}
        for name, csg in (("bent", {"union": ["peg", "ball"]}), ("cut_out", {"difference": ["peg", "ball"]})):
            model = self.folder / f"{name}.json"
            model.write_text(json.dumps(self.model | {"primitives": [bent, ball], "csg": csg}))
            page = self.written(model, name)
            result, _ = self.prove(page)
            self.assertTrue(result.startswith(f"All {len(self.rows)} vertices are proved, in "), f"{name}: {result}")
            text = page.read_text()
            page.write_text(text.replace('\\"curvature\\": 0.02', '\\"curvature\\": 0.0202'))
            self.assertNotEqual(page.read_text(), text)
            result, _ = self.prove(page)
            self.assertNotIn("All", result)
            if name == "bent":  # covers refute nothing
                self.assertNotIn(" 0 refuted", result)

    def test_closed_meshes_are_proved(self):
        box = [f"{x} {y} {z}" for x in (-20, -8) for y in (-5, 5.5) for z in (-9, 9)]
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        corners = [f"3 {a} {b} {c}" for a, b, c in ((s[0], s[i], s[i + 1]) for s in sides for i in (1, 2))]
        (self.folder / "box.off").write_text("\n".join(["OFF", "8 12 0", *box, *corners, ""]))
        primitives = [{"name": "box", "mesh": {"file": "box.off"},
                       "pose": {"translation": [0.5, 1, 2], "quaternion": [9, 0.1, -0.2, 0.3]}},
                      self.model["primitives"][1]]
        (self.folder / "box_and_ball.json").write_text(json.dumps(self.model | {"primitives": primitives}))
        for model in ("box.off", "box_and_ball.json"):
            page = self.written(self.folder / model, "mesh")
            result, _ = self.prove(page)
            self.assertTrue(result.startswith(f"All {len(self.rows)} vertices are proved, in "), f"{model}: {result}")
            text = page.read_text()
            report = json.loads(text.split('id="verisq-report">')[1].split("</script>")[0])
            digest = hashlib.sha256((self.folder / model).read_bytes())
            if model.endswith(".json"):
                digest.update((self.folder / "box.off").read_bytes())
            self.assertEqual(report["proof"]["model_sha256"], digest.hexdigest())

            mesh = report["proof"]["meshes"][0]
            vertices = list(struct.unpack("<24d", base64.b64decode(mesh["vertices"])))
            vertices[0] -= 1e-6
            mesh["vertices"] = encoded("d", vertices)
            write_page(page, report)
            result, _ = self.prove(page)
            self.assertNotIn("All", result)
            self.assertNotIn(" 0 refuted", result)

            mesh["triangles"] = encoded("I", struct.unpack("<36I", base64.b64decode(mesh["triangles"]))[:-3])
            write_page(page, report)
            result, _ = self.prove(page)
            self.assertIn("its surface is not closed", result)

    def test_no_number_of_the_page_weakens_the_claims(self):
        poses = encoded("d", [math.inf, 0, 0, 1, 0, 0, 0] * 2)
        for changes, words in (({"point_radius": -0.5}, "point_radius"), ({"poses": poses}, "poses")):
            result, _ = self.prove(self.forged_page("weakened.html", self.rows, **changes))
            self.assertIn(f"This page cannot prove its vertices: {words}", result)

    def test_moved_vertices_are_no_report(self):
        vertices = list(struct.unpack(f"<{3 * len(self.rows)}d", base64.b64decode(self.report["proof"]["vertices"])))
        vertices[4] += 0.01
        page = self.forged_page("moved_vertices.html", self.rows, vertices=encoded("d", vertices))
        with Browser(page, no_graphics) as browser:
            self.assertIn("what is drawn is not what is proven", browser.text("#statement"))

    def test_a_page_tells_which_files_it_is_of(self):
        with Browser(self.page, no_graphics) as browser:
            hashes = browser.driver.execute_script(
                "return [...document.querySelectorAll('#proof-files dd')].map((node) => node.textContent)")
        files = (self.folder / name for name in ("union.json", "small_bone.off"))
        self.assertEqual(hashes, [hashlib.sha256(file.read_bytes()).hexdigest() for file in files])

    def test_a_page_without_certificates_says_so(self):
        page = self.folder / "without.html"
        self.run_verisq("map", "--model", self.folder / "union.json", "--mesh", self.folder / "small_bone.off",
                        "--device", "host", "--report", page)
        with Browser(page, no_graphics) as browser:
            self.assertIn("--certificates", browser.text("#proof-offer"))
            self.assertEqual(browser.all("#verisq-prover"), [])
            self.assertFalse(browser.one("#proof-start").is_displayed())


class StancePage(unittest.TestCase):
    """The page that `verisq stance --report` writes, against what it prints."""

    @classmethod
    def setUpClass(cls):
        model = Path(__file__).resolve().parents[2] / "examples" / "standing.xml"
        cls.page = Path(options.output) / "standing.html"
        printed = subprocess.run([options.program, "stance", model, "--uncertain", "k", "--within", "10", "--equilibrium",
                                  "held", "--simulate", "0.1", "--json", "--report", cls.page],
                                 capture_output=True, text=True, check=False)
        assert printed.returncode == 3, printed.stderr  # the motion is open
        cls.result = json.loads(printed.stdout)

    def intervals(self, browser, section):
        return [[float(end) for end in text.strip("[]").split(", ")]
                for text in (node.text for node in browser.all(f"#{section} .interval")) if text.startswith("[")]

    def test_says_what_is_proven_and_where_it_ends(self):
        with Browser(self.page, no_graphics) as browser:
            self.assertIn("Proven: for all parameters in these ranges", browser.text("#equilibrium .verdict.good"))
            self.assertIn("OPEN", browser.text("#motion .verdict.bad"))
            self.assertFalse(browser.one("#stability").is_displayed())
            force = self.result["equilibrium"]["standing"]["cylinders"]["left forefoot"]["force"]
            shown = self.intervals(browser, "equilibrium")
            self.assertTrue(any(lo <= force["lo"] and force["hi"] <= hi and hi - lo < 1.01 * (force["hi"] - force["lo"])
                                for lo, hi in shown))
            browser.one("#all-digits").click()
            self.assertIn([force["lo"], force["hi"]], self.intervals(browser, "equilibrium"))

    def test_moves_the_body_as_far_as_it_is_proven(self):
        with Browser(self.page, no_graphics) as browser:
            set_time = ("const time = document.getElementById('time'); time.value = arguments[0];"
                        "time.dispatchEvent(new Event('input'));")
            browser.driver.execute_script(set_time, 0.5 * self.result["motion"]["reached"])
            self.assertTrue(browser.all("#motion svg.figure .limb"))
            self.assertEqual(len(self.intervals(browser, "motion .now")), 18)
            browser.driver.execute_script(set_time, 0.05)
            self.assertFalse(browser.all("#motion svg.figure .limb"))
            self.assertEqual(browser.text("#motion svg.figure text.open"), "OPEN")
            self.assertEqual(self.intervals(browser, "motion .now"), [])
            browser.driver.execute_script(set_time, 0.0)
            browser.one("#play").click()
            browser.wait(lambda: "OPEN" in browser.text("#time-reading"), "the motion to be played to where it is open")
            browser.wait(lambda: browser.text("#play") == "play", "the end")
            self.assertEqual(float(browser.one("#time").get_property("value")), 0.1)
            beyond = browser.driver.execute_script("return document.documentElement.scrollWidth - innerWidth")
            self.assertLessEqual(beyond, 0)


def missing_tools():
    tools = {"python3-selenium": webdriver, "chromium": options.chromium, "chromium-driver": options.chromedriver}
    return [package for package, tool in tools.items() if not tool]


def main():
    global options
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True, help="verisq")
    parser.add_argument("--page", required=True, help="report/dist/page.html")
    parser.add_argument("--output", required=True, help="folder for reports and screenshots")
    parser.add_argument("--chromium", default="")
    parser.add_argument("--chromedriver", default="")
    options, rest = parser.parse_known_args()
    if missing := missing_tools():
        print(f"skipped: install {' '.join(missing)}")
        # ./run test installs them, so there it is a failure.
        return 1 if os.environ.get("VERISQ_BROWSER") == "required" else skipped
    Path(options.output).mkdir(parents=True, exist_ok=True)
    try:
        program = unittest.main(argv=[sys.argv[0], *rest], exit=False)
    finally:
        for driver in drivers.values():
            driver.quit()
    return 0 if program.result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())

// Fills the page: what is uncertain, then each answer that was asked for.
import { byId, element } from "../src/elements.js";
import { exactText } from "../src/numbers.js";
import { tubeChart, widthChart } from "./chart.js";
import { Drawing, forceMark, magnifications, pressureMark } from "./figure.js";
import { intervalNode, intervalTable, lower, showAllDigits, upper } from "./intervals.js";
import { parameterMap, stabilityMeanings, standingMeanings } from "./parameter_map.js";
import { eigenvaluePlane } from "./plane.js";
import { Player } from "./player.js";
import { equilibriumWords, motionWords, paceWords, stabilityWords } from "./words.js";

const format = "verisq-stance/1";

const interval = ({ lo, hi }) => intervalNode(lower(lo), upper(hi));
const paragraphs = (words) => words.map(([kind, text]) => element("p", { class: `verdict ${kind}` }, text));
// Of the joints that both forms of names agree on: pairs have none that are translated.
const translated = new Set();
const unitOf = (joint, rotation, translation) => (translated.has(joint) ? translation : rotation);

function fill(id, ...nodes) {
  const section = byId(id);
  section.hidden = false;
  section.querySelector(".answer").append(...nodes.filter(Boolean));
}

function scope({ meaning, acts, does_not_act, parameters_without_effect: idle }) {
  const rows = [["Meaning", meaning], ["Acts", acts.join(", ")], ["Does NOT act", does_not_act.join(", ")]];
  if (idle.length > 0) rows.push(["Parameters without effect here", idle.join(", ")]);
  return element("details", { open: "" }, element("summary", {}, "What these numbers are"), intervalTable("", rows));
}

function showParameters(result) {
  const uncertain = result.parameters.filter(({ name }) => result.uncertain.includes(name));
  const rows = uncertain.map((each) => [`${each.name}: ${each.description}`, `[${exactText(each.lo)}, ${exactText(each.hi)}]`, each.unit === "1" ? "" : each.unit]);
  byId("parameters").append(
    uncertain.length > 0 ? intervalTable("These parameters may be anywhere in their ranges, independently of each other", rows)
      : element("p", {}, "Nothing: all parameters are at their nominal values."),
  ); // prettier-ignore
  return uncertain;
}

function mapOf(cells, uncertain, meanings) {
  return uncertain.length === 2 ? parameterMap(cells, uncertain, meanings) : null;
}

function showEquilibrium(result, drawn, uncertain, joints) {
  const nodes = [...paragraphs(equilibriumWords(result)), element("p", {}, `Joints: ${result.joints}.`)];
  if (result.standing && drawn) {
    const { positions, torques, cylinders, least_penetration, centre_of_pressure } = result.standing;
    const drawing = new Drawing(drawn.figure, [drawn.points], "The standing body from the side");
    const names = drawn.figure.cylinders.map(({ name }) => name);
    const marks = [...names.map((name, c) => forceMark((drawn.points.cylinders[c][0] + drawn.points.cylinders[c][1]) / 2, cylinders[name].force)), pressureMark(centre_of_pressure.x)];
    drawing.show(drawn.points, marks);
    const select = element("select", { id: "standing-magnification" }, ...magnifications.map((factor) => element("option", { value: factor }, `\u00d7 ${factor}`)));
    select.addEventListener("change", () => {
      drawing.magnify(Number(select.value));
      drawing.show(drawn.points, Number(select.value) === 1 ? marks : []);
    });
    const hint = "Lines and discs are in the middle of what is proven; shades surely contain them. Arrows: the ground's force on each cylinder; triangle: the centre of pressure.";
    nodes.push(element("figure", {}, drawing.svg, element("div", { class: "bar" }, element("label", {}, "Uncertainty drawn ", select)), element("figcaption", { class: "hint" }, hint)));
    const moving = Object.entries(positions).filter(([, { lo, hi }]) => lo !== hi);
    if (result.stands < 1) nodes.push(element("p", { class: "verdict warn" }, "The numbers and the drawing are of the part of the ranges that is proven to stand, not of the rest."));
    nodes.push(
      intervalTable("Margin to lift-off", [["least penetration of all points of contact", interval(least_penetration), "m"]]),
      intervalTable("Posture (joints not listed are where the file has them)", moving.map(([name, each]) => [name, interval(each), unitOf(name, "rad", "m")])),
      intervalTable("Forces of the ground, upward", names.map((name) => [name, interval(cylinders[name].force), "N"])),
      intervalTable("Penetration", names.map((name) => [name, interval(cylinders[name].penetration), "m"])),
      intervalTable("Centre of pressure", [["x", interval(centre_of_pressure.x), "m"], ["z", interval(centre_of_pressure.z), "m"]]),
      intervalTable("Torques that hold the joints", joints.filter(({ is_of_root }) => !is_of_root).map(({ name }) => [name, interval(torques[name]), unitOf(name, "N m", "N")])),
    ); // prettier-ignore
  }
  fill("equilibrium", ...nodes, mapOf(result.cells, uncertain, standingMeanings), scope(result.scope));
}

function showStability(result, uncertain) {
  const nodes = [...paragraphs(stabilityWords(result)), element("p", {}, `Joints: ${result.joints}.`)];
  if (result.growth) {
    const growth = { lo: lower(result.growth.lo), hi: upper(result.growth.hi) };
    nodes.push(intervalTable(`Greatest rate of growth (below 0: of decay)${result.open > 0 ? ", of what is not open" : ""}`, [["greatest real part of an eigenvalue", interval(growth), "1/s"]]));
    nodes.push(element("p", {}, result.open > 0 ? "" : paceWords(growth)));
  }
  if (result.eigenvalues.length > 0) {
    const rows = result.eigenvalues.map(({ real, imaginary, count }) => [
      count === 1 ? "one" : `${count} of them`,
      imaginary.lo === 0 && imaginary.hi === 0 ? interval(real) : element("span", {}, interval(real), " + i ", interval(imaginary)),
      "1/s",
    ]);
    nodes.push(eigenvaluePlane(result.eigenvalues));
    nodes.push(element("details", {}, element("summary", {}, `All ${rows.length} enclosures of eigenvalues`), intervalTable("Rightmost first", rows)));
  } else {
    nodes.push(element("p", { class: "hint" }, "Eigenvalues are listed only where the whole box was proven in one cell."));
  }
  fill("stability", ...nodes, mapOf(result.cells, uncertain, stabilityMeanings), scope(result.scope));
}

function quantitiesOf({ joints, contacts }) {
  const of = (key, index) => (slab) => slab[key][index];
  return [
    ...joints.map((name, j) => ({ name, unit: unitOf(name, "rad", "m"), of: of("positions", j), isPosition: true })),
    ...joints.map((name, j) => ({ name: `${name}, rate`, unit: unitOf(name, "rad/s", "m/s"), of: of("velocities", j) })),
    ...contacts.map((name, c) => ({ name: `force upward on each ${name}`, unit: "N", of: of("normal", c) })),
    ...contacts.map((name, c) => ({ name: `friction on each ${name}`, unit: "N", of: of("friction", c) })),
  ];
}

function chartsOf(motion, quantities, reached) {
  const charts = quantities.map(({ name, unit, of }) => {
    const slabs = motion.slabs.map((slab) => ({ from: slab.from, to: slab.to, lo: of(slab)[0], hi: of(slab)[1] }));
    const finite = slabs.filter(({ lo, hi }) => lo !== null && hi !== null);
    return finite.length > 0 ? tubeChart(name, unit, finite, motion.duration, reached) : null;
  });
  const curves = quantities.filter(({ isPosition }) => isPosition).map(({ name, of }) => ({
    name,
    widths: motion.slabs.map((slab) => ({ from: slab.from, to: slab.to, width: 1000 * (of(slab)[1] - of(slab)[0]) })),
  })); // prettier-ignore
  charts.push(widthChart("Widths of the positions' enclosures, mm or mrad (each over the times of its slab)", curves, motion.duration, reached));
  return charts.filter(Boolean);
}

function showMotion(result, motion) {
  const words = paragraphs(motionWords(result, motion.duration));
  if (motion.slabs.length === 0) {
    fill("motion", ...words, scope(result.scope));
    return;
  }
  const quantities = quantitiesOf(motion);
  const charts = chartsOf(motion, quantities, result.reached);
  const player = new Player({
    motion, quantities, reached: result.reached, openWords: result.open ? "OPEN" : "not computed",
    showTime: (time) => charts.forEach((chart) => chart.showTime(time)),
  }); // prettier-ignore
  const end = intervalTable(`Then, at ${result.reached} s`, motion.joints.flatMap((name) => [
    [name, interval(result.positions[name]), unitOf(name, "rad", "m")],
    [`${name}, rate`, interval(result.velocities[name]), unitOf(name, "rad/s", "m/s")],
  ])); // prettier-ignore
  const hint = "One of each pair is drawn. Lines and discs are in the middle of what is proven at all times of a short span; shades surely contain them. They follow from the joints alone: feet are known better than drawn.";
  fill("motion", ...words, ...player.nodes(), element("p", { class: "hint" }, hint), element("div", { class: "charts" }, ...charts.map(({ node }) => node)), end, scope(result.scope));
}

function show({ format: given, result, joints, standing, motion }) {
  if (given !== format) throw new Error(`format: ${given} is not ${format}`);
  const name = result.model.split(/[\\/]/).pop();
  document.title = `${name}: verisq stance`;
  byId("title").textContent = name;
  const asked = ["equilibrium", "stability", "motion"].filter((part) => result[part]);
  const ended = result.interrupted ? " The computation was interrupted: what it had not looked at is open." : "";
  byId("statement").textContent = `Proven by verisq: ${asked.join(", ")} of this model. Every number in brackets is an interval that contains the exact value.${ended}`;
  for (const { name: joint, is_translation } of joints) if (is_translation) translated.add(joint);
  const uncertain = showParameters(result);
  if (result.equilibrium) showEquilibrium(result.equilibrium, standing, uncertain, joints);
  if (result.stability) showStability(result.stability, uncertain);
  if (result.motion) showMotion(result.motion, motion);
  byId("all-digits").addEventListener("change", ({ target }) => showAllDigits(target.checked));
}

try {
  show(JSON.parse(byId("verisq-report").textContent));
  document.body.classList.add("ready");
} catch (error) {
  byId("statement").textContent = `This report cannot be shown. ${error.message}`;
  document.body.classList.add("broken");
}

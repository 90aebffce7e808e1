// What depends on what: choices of the reader change the shown quantity, its scale, the chosen bin, the pinned vertex.
import { Vector3 } from "three";
import { scaleOf, usualLimit } from "./colours.js";
import { drawLegend } from "./colour_bar.js";
import { BrokenReport, decodeReport } from "./decoding.js";
import { byId, element, radioButtons } from "./elements.js";
import { factsOf, fillFacts, statement } from "./facts.js";
import { Histogram } from "./histogram.js";
import { fullDescription, shortDescription } from "./inspector.js";
import { poseAlong } from "./path.js";
import { Picker } from "./picking.js";
import { drawCutOpen } from "./printed_cut.js";
import { ProofPanel } from "./proof_panel.js";
import { quantitiesOf } from "./quantities.js";
import { BoneScene, graphicsContext } from "./scene.js";
import { fillSummary } from "./table.js";
import { drawTriad, Views } from "./views.js";

const clickSlack = 4; // pixels that the pointer may move within a click

class Page {
  constructor(report) {
    this.report = report;
    this.quantities = quantitiesOf(report);
    this.facts = factsOf(report);
    this.limits = new Map();
    this.histogram = new Histogram(byId("chart"), byId("chart-reading"), report, (bin) =>
      this.scene?.highlight(bin?.from ?? 0, bin?.to ?? 0),
    );
    this.fillTexts();
    this.prepareScene();
    this.prepareChoices();
    this.prepareVertexForm();
    this.showQuantity(this.quantities[0].id);
    this.proof = new ProofPanel(report, {
      redraw: () => this.quantity.id === "proof" && this.showQuantity("proof"),
      showProof: () => this.chooseQuantity("proof"),
      pin: (vertex) => this.pinAndFace(vertex),
    });
  }

  fillTexts() {
    const { title, units, summary } = this.report;
    document.title = title;
    byId("title").textContent = title;
    byId("statement").textContent = statement(this.report);
    byId("range-units").textContent = units;
    byId("solid-name").textContent = this.report.solidName;
    byId("cut-open-caption").textContent = `The bone around the ${this.report.solidName}, cut open by a plane through it, seen from in front of that plane.`;
    fillFacts(byId("facts"), this.facts, this.report);
    fillSummary(byId("summary").tBodies[0], summary);
    byId("vertex-number").max = this.report.count - 1;
  }

  prepareScene() {
    const stage = byId("stage");
    const canvas = element("canvas");
    const context = graphicsContext(canvas);
    if (!context) {
      document.body.classList.add("without-picture");
      this.tell(
        "This browser shows no 3-D graphics (WebGL 2 is missing or switched off). Everything else on this page works.",
      );
      return;
    }
    stage.prepend(canvas);
    this.scene = new BoneScene(canvas, context, this.report);
    this.scene.resize(stage.clientWidth, stage.clientHeight);
    this.views = new Views(this.scene, stage, this.report.up);
    this.picker = new Picker(this.scene);
    this.scene.onDraw = (camera) => drawTriad(byId("triad"), camera);
    this.views.addButtons(byId("views"));
    new ResizeObserver(() => this.scene.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
    window.addEventListener("beforeprint", () => drawCutOpen(byId("cut-open-picture"), this.scene, this.report));
    this.preparePointer(canvas);
  }

  tell(message) {
    byId("message").textContent = message;
    byId("message").hidden = false;
  }

  prepareChoices() {
    radioButtons(
      byId("quantities"),
      this.quantities.map(({ id, label }, k) => ({ value: id, label, checked: k === 0 })),
      (id) => this.showQuantity(id),
    );
    byId("range-limit").addEventListener("change", ({ target }) => {
      const limit = Number(target.value);
      if (limit > 0) this.limits.set(this.quantity.id, limit);
      else this.limits.delete(this.quantity.id);
      this.showScale();
    });
    radioButtons(
      byId("section-axes"),
      ["none", "X", "Y", "Z"].map((value) => ({ value, label: value, checked: value === "none" })),
      () => this.cut(),
    );
    byId("section-place").addEventListener("input", () => this.cut());
    byId("section-other-side").addEventListener("change", () => this.cut());
    byId("way").hidden = !this.report.path;
    byId("way-place").addEventListener("input", ({ target }) => this.placeImplant(Number(target.value)));
    if (this.report.path) this.placeImplant(1);
    byId("implant-shown").addEventListener("change", ({ target }) => this.scene?.showImplant(target.checked));
  }

  // As if the reader had.
  chooseQuantity(id) {
    byId(`quantities-${id}`).checked = true;
    this.showQuantity(id);
  }

  // At a share of its way in.
  placeImplant(share) {
    this.scene?.placeImplant(poseAlong(this.report.path, share), this.report.centre);
    byId("way-reading").textContent = share === 1 ? "seated" : `${Math.floor(100 * share)} %`;
  }

  showQuantity(id) {
    this.quantity = this.quantities.find((quantity) => quantity.id === id);
    byId("explanation").textContent = this.quantity.explanation;
    byId("range").hidden = this.quantity.axis !== "signed";
    this.histogram.show(this.quantity);
    this.scene?.showQuantity(this.quantity);
    this.scene?.highlight(0, 0);
    this.showScale();
  }

  limit() {
    const { id, axis } = this.quantity;
    const wanted = axis === "signed" ? this.report.range : null;
    if (!this.limits.has(id)) this.limits.set(id, wanted ?? usualLimit(this.quantity, this.report.count));
    return this.limits.get(id);
  }

  showScale() {
    if (this.quantity.axis === "signed") byId("range-limit").value = this.limit();
    this.scale = scaleOf(this.quantity, this.limit());
    this.histogram.draw(this.scale);
    drawLegend(byId("legend"), this.quantity, this.scale, this.report.units, this.histogram.unbounded > 0);
    this.scene?.showScale(this.scale);
    this.hover(undefined);
    if (this.pinned !== undefined) this.pin(this.pinned);
  }

  cut() {
    const chosen = document.querySelector('input[name="section-axes"]:checked').value;
    byId("section-depth").hidden = byId("section-turn").hidden = chosen === "none";
    if (!this.scene) return;
    if (chosen === "none") {
      this.scene.cut(null);
      return;
    }
    const k = ["X", "Y", "Z"].indexOf(chosen);
    const { min, max } = this.scene.box;
    const place =
      min.getComponent(k) + Number(byId("section-place").value) * (max.getComponent(k) - min.getComponent(k));
    const sign = byId("section-other-side").checked ? -1 : 1;
    this.scene.cut({ normal: new Vector3().setComponent(k, sign), offset: sign * place });
  }

  preparePointer(canvas) {
    let pressed;
    const vertexOf = (event) => {
      const { left, top } = canvas.getBoundingClientRect();
      return this.picker.vertexAt(event.clientX - left, event.clientY - top);
    };
    canvas.addEventListener("pointerdown", (event) => {
      pressed = event;
      this.hover(undefined);
    });
    canvas.addEventListener("pointerup", (event) => {
      const isClick =
        pressed &&
        event.button === 0 &&
        Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) <= clickSlack;
      pressed = undefined;
      if (isClick) this.pin(vertexOf(event));
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0 && event.pointerType !== "touch") this.hover(vertexOf(event), event);
    });
    canvas.addEventListener("pointerleave", () => this.hover(undefined));
  }

  colourOf(vertex) {
    return this.scale.at(this.quantity.coordinate(vertex));
  }

  hover(vertex, event) {
    const tip = byId("tip");
    tip.hidden = vertex === undefined;
    if (vertex !== this.hovered) {
      this.hovered = vertex;
      this.scene?.mark("hovered", vertex);
      if (vertex !== undefined) tip.replaceChildren(...shortDescription(this.report, vertex, this.colourOf(vertex)));
    }
    if (vertex !== undefined) this.placeTip(tip, event);
  }

  // Beside the pointer, on the side where there is room.
  placeTip(tip, event) {
    const stage = byId("stage").getBoundingClientRect();
    const [x, y] = [event.clientX - stage.left, event.clientY - stage.top];
    tip.style.left = `${Math.max(4, x + 18 + tip.offsetWidth < stage.width ? x + 18 : x - 18 - tip.offsetWidth)}px`;
    tip.style.top = `${Math.max(4, Math.min(y + 12, stage.height - tip.offsetHeight - 4))}px`;
  }

  pin(vertex) {
    this.pinned = vertex;
    this.scene?.mark("pinned", vertex);
    byId("vertex-number").value = vertex ?? "";
    byId("vertex").replaceChildren(
      ...(vertex === undefined
        ? [element("p", { class: "hint" }, "Click the bone, or give a number.")]
        : fullDescription(this.report, vertex, this.colourOf(vertex))),
    );
  }

  pinAndFace(vertex) {
    if (!(vertex >= 0 && vertex < this.report.count)) return;
    this.pin(vertex);
    this.views?.face(vertex);
  }

  prepareVertexForm() {
    byId("vertex-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.pinAndFace(byId("vertex-number").valueAsNumber);
    });
    byId("vertex-closest").addEventListener("click", () => this.pinAndFace(this.facts.closest));
    byId("vertex-widest").addEventListener("click", () => this.pinAndFace(this.facts.widest));
    byId("vertex").append(element("p", { class: "hint" }, "Click the bone, or give a number."));
  }
}

function start() {
  const block = byId("verisq-report");
  try {
    if (!block) throw new BrokenReport("the page has no data");
    const report = decodeReport(block.textContent);
    block.remove(); // its text is no longer needed
    new Page(report);
    document.body.classList.add("ready");
  } catch (error) {
    byId("statement").textContent = `This report cannot be shown: ${error.message}.`;
    document.body.classList.add("broken");
    if (!(error instanceof BrokenReport)) throw error;
  }
}

// After the first paint, which says that the report is loading.
requestAnimationFrame(() => setTimeout(start));

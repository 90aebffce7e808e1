// The certified summary, as the program prints it.
import { element } from "./elements.js";

export function fillSummary(body, lines) {
  body.replaceChildren(
    ...lines.map(({ label, value }) =>
      element("tr", {}, element("th", { scope: "row" }, label), element("td", {}, value)),
    ),
  );
}

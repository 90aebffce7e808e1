// Builds the pages in dist, all that the C++ writers need: scripts and styles inlined, no network, ASCII only.
import { createHash } from "node:crypto";
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const folder = dirname(fileURLToPath(import.meta.url));
const marker = "<!--verisq-report-data-->";
// Inlined scripts and styles must not be able to end their own element.
const closing_tag = { script: /<\/script/i, style: /<\/style/i };

// The folder of its entry points, those of all of its sources, and what its script contains from elsewhere.
const pages = [
  {
    name: "page.html",
    from: "src",
    sources: ["prover", "src"],
    packages: ["three", "three-mesh-bvh"],
    prover: "prover",
  },
  { name: "stance_page.html", from: "stance", sources: ["src", "stance"], packages: [] },
];

async function bundle(from, source) {
  const result = await build({
    entryPoints: [join(folder, from, source)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: ["chrome109", "firefox115", "safari16.4"],
    charset: "ascii",
    legalComments: "none",
    logLevel: "warning",
  });
  return result.outputFiles[0].text.trim();
}

const { devDependencies: dependencies } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
const sha256 = (text, encoding) => createHash("sha256").update(text).digest(encoding);

// The licences of what is inlined ask to be kept with it.
async function licences(packages) {
  const texts = packages.map(async (name) => {
    const licence = await readFile(join(folder, "node_modules", name, "LICENSE"), "utf8");
    return `${name}\n\n${licence.replaceAll("\u00a9", "(c)").trim()}`;
  });
  const text = (await Promise.all(texts)).join("\n\n");
  if (text.includes("--")) throw new Error("a licence would end the comment that it is put in");
  return text;
}

// The LGPL (section 4) asks for a notice, both licences, and a way to the same with another version of the library.
async function prover_licences() {
  const notice = `This page contains gmp-wasm ${dependencies["gmp-wasm"]} by Dani Biro
(https://github.com/Daninet/gmp-wasm), which is GNU GMP 6.3 and GNU MPFR 4.2.1 (Free Software Foundation and contributors) compiled to WebAssembly. They are free software under
the GNU Lesser General Public License, version 3, which follows with the GNU General Public License, version 3,
that it supplements. The script with the id verisq-prover holds them, unchanged; verisq's own sources, Apache 2.0,
and report/build.mjs there make this page again with any other version of them.`;
  const texts = ["node_modules/gmp-wasm/LICENSE", "prover/GPL-3.txt"].map((file) =>
    readFile(join(folder, file), "utf8"),
  );
  const text = [notice, ...(await Promise.all(texts))].map((part) => part.trim()).join("\n\n\n");
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

// The same as cmake/CheckReportPage.cmake computes from the sources: a line "sha256 path" for each file, in byte order.
async function hash_of_sources(folders) {
  const listed = folders.map(async (from) => (await readdir(join(folder, from))).map((name) => `${from}/${name}`));
  const files = ["build.mjs", "package.json", "package-lock.json", ...(await Promise.all(listed)).flat()].sort();
  const lines = await Promise.all(
    files.map(async (file) => `${sha256(await readFile(join(folder, file)), "hex")} ${file}\n`),
  );
  return sha256(lines.join(""), "hex");
}

// Nothing is fetched, and nothing runs but what was built here: strings of a report can never become code.
// WebAssembly is the checker's arithmetic, a part of its script; workers run that script, which they get as a blob.
const content_security_policy = ([script, prover], style) =>
  [
    "default-src 'none'",
    `script-src ${[script, prover].filter(Boolean).map((text) => `'sha256-${sha256(text, "base64")}'`).join(" ")}${
      prover ? " 'wasm-unsafe-eval'" : ""
    }`,
    ...(prover ? ["worker-src blob:"] : []),
    `style-src 'sha256-${sha256(style, "base64")}'`,
    "img-src data: blob:",
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");

function check(page, places) {
  if (!/^[\x00-\x7f]*$/.test(page)) throw new Error("the page is not ASCII: use \\u escapes and entities");
  for (const once of places) {
    if (page.split(once).length !== 2) throw new Error(`the page needs exactly one ${once}`);
  }
}

// The checker of the page with certificates, for its place in the skeleton.
async function prover_parts(from) {
  const prover = await bundle(from, "prover.js");
  return { "{{prover_licences}}": await prover_licences(), "{{prover}}": prover };
}

async function build_page({ name, from, sources, packages, prover }) {
  const [script, style] = [await bundle(from, "main.js"), await bundle(from, "style.css")];
  const checker = prover ? await prover_parts(prover) : {};
  const scripts = [script, checker["{{prover}}"]].filter(Boolean);
  if (scripts.some((text) => closing_tag.script.test(text)) || closing_tag.style.test(style))
    throw new Error("an inlined part ends its element");
  const parts = {
    "{{sources}}": await hash_of_sources(sources),
    "{{licences}}": await licences(packages),
    "{{policy}}": content_security_policy(scripts, style),
    ...checker,
    "{{style}}": style,
    "{{script}}": script,
  };
  const skeleton = await readFile(join(folder, from, "page.html"), "utf8");
  const page = skeleton.replace(/\{\{\w+\}\}/g, (part) => parts[part]);
  check(page, prover ? [marker, "<!--verisq-prover-->", "<!--/verisq-prover-->"] : [marker]);
  await writeFile(join(folder, "dist", name), page);
  console.log(`report/dist/${name}: ${(page.length / 1024).toFixed(0)} KiB`);
}

await mkdir(join(folder, "dist"), { recursive: true });
for (const page of pages) await build_page(page);

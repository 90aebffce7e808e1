// Builds dist/page.html, the one file that the C++ writer needs: scripts and styles inlined, no network, ASCII only.
import { createHash } from "node:crypto";
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const folder = dirname(fileURLToPath(import.meta.url));
const marker = "<!--verisq-report-data-->";
// Inlined scripts and styles must not be able to end their own element.
const closing_tag = { script: /<\/script/i, style: /<\/style/i };

async function bundle(source) {
  const result = await build({
    entryPoints: [join(folder, "src", source)],
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

const sha256 = (text, encoding) => createHash("sha256").update(text).digest(encoding);

// The licences of what is inlined ask to be kept with it.
async function licences() {
  const texts = ["three", "three-mesh-bvh"].map(async (name) => {
    const licence = await readFile(join(folder, "node_modules", name, "LICENSE"), "utf8");
    return `${name}\n\n${licence.replaceAll("\u00a9", "(c)").trim()}`;
  });
  const text = (await Promise.all(texts)).join("\n\n");
  if (text.includes("--")) throw new Error("a licence would end the comment that it is put in");
  return text;
}

// The same as cmake/CheckReportPage.cmake computes from the sources: a line "sha256 path" for each file, in byte order.
async function hash_of_sources() {
  const sources = (await readdir(join(folder, "src"))).map((name) => `src/${name}`);
  const files = ["build.mjs", "package.json", "package-lock.json", ...sources].sort();
  const lines = await Promise.all(
    files.map(async (file) => `${sha256(await readFile(join(folder, file)), "hex")} ${file}\n`),
  );
  return sha256(lines.join(""), "hex");
}

// Nothing is fetched, and nothing runs but what was built here: strings of a report can never become code.
const content_security_policy = (script, style) =>
  [
    "default-src 'none'",
    `script-src 'sha256-${sha256(script, "base64")}'`,
    `style-src 'sha256-${sha256(style, "base64")}'`,
    "img-src data: blob:",
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");

function check(page) {
  if (!/^[\x00-\x7f]*$/.test(page)) throw new Error("the page is not ASCII: use \\u escapes and entities");
  if (page.split(marker).length !== 2) throw new Error(`the page needs exactly one ${marker}`);
}

const [script, style] = [await bundle("main.js"), await bundle("style.css")];
if (closing_tag.script.test(script) || closing_tag.style.test(style))
  throw new Error("an inlined part ends its element");
const parts = {
  "{{sources}}": await hash_of_sources(),
  "{{licences}}": await licences(),
  "{{policy}}": content_security_policy(script, style),
  "{{style}}": style,
  "{{script}}": script,
};
const skeleton = await readFile(join(folder, "src", "page.html"), "utf8");
const page = skeleton.replace(/\{\{\w+\}\}/g, (name) => parts[name]);
check(page);
await mkdir(join(folder, "dist"), { recursive: true });
await writeFile(join(folder, "dist", "page.html"), page);
console.log(`report/dist/page.html: ${(page.length / 1024).toFixed(0)} KiB`);

// The page in a real browser, by real input. AXISFIT_REPORT_PAGE: a report.html of the program
// instead of the synthetic page, for the tests that need no known numbers.

import assert from "node:assert/strict";
import {mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {after, before, beforeEach, afterEach, describe, test} from "node:test";
import {pathToFileURL} from "node:url";

import {HOSTILE, SAMPLES, decimals, encodedColumn, figure, pageData, pageHtml} from "./page.mjs";

const {AXISFIT_REPORT_PAGE, AXISFIT_REPORT_ASSETS, AXISFIT_NODE_MODULES, AXISFIT_CHROMIUM} =
    process.env;
const packages = createRequire(join(AXISFIT_NODE_MODULES, "/"));
const {chromium} = packages("playwright-core");
const axe = readFileSync(packages.resolve("axe-core/axe.min.js"), "utf8");

const folder = mkdtempSync(join(tmpdir(), "axisfit-report-"));
const own = !AXISFIT_REPORT_PAGE;
const any = !own && "the script does so in any page";
const data = pageData();
const asset = (kind) => readFileSync(`${AXISFIT_REPORT_ASSETS}.${kind}`, "utf8");
const path = AXISFIT_REPORT_PAGE ?? join(folder, "report.html");
let browser;
let page;
let complaints;  // of the console, of scripts, and requests that left the file

before(async () => {
  if (own) writeFileSync(path, pageHtml(data, asset("css"), asset("script")));
  browser = await chromium.launch({
    executablePath: AXISFIT_CHROMIUM,
    args: ["--no-sandbox", "--headless", "--disable-gpu", "--disable-quic", "--no-first-run",
           "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
});

after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true});
});

async function open(options = {}, url = pathToFileURL(path).href) {
  page = await browser.newPage({viewport: {width: 1200, height: 900}, ...options});
  complaints = [];
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && complaints.push(m.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("dialog", (dialog) => complaints.push(`dialog: ${dialog.message()}`));
  page.on("request", (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url()))
      complaints.push(`request: ${request.url()}`);
  });
  await page.goto(url);
  await page.evaluate(() => window.axisfit.ready);
}

const charts = () => page.evaluate(() => Object.values(window.axisfit.charts).map((c) => ({
  id: c.spec.id, time: Boolean(c.spec.time), recording: c.spec.recording, x: c.x, y: c.y,
  extent: c.extent})));

const selectorOf = (id) => `[id=${JSON.stringify(id)}]`;

/** Drags the mouse over a part of a chart's plot. */
async function drag(id, from, to) {
  const over = page.locator(`${selectorOf(id)} .over`);
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + from * box.width, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + (from + to) / 2 * box.width, box.y + 24, {steps: 3});
  await page.mouse.move(box.x + to * box.width, box.y + 24, {steps: 3});
  await page.mouse.up();
}

async function saved(id, format) {
  const waiting = page.waitForEvent("download");
  await page.locator(`${selectorOf(id)} .tools button`, {hasText: format}).click();
  const file = await (await waiting).path();
  return readFileSync(file);
}

describe("any report", () => {
  beforeEach(() => open());
  afterEach(async () => {
    assert.deepEqual(complaints, []);
    await page.close();
  });

  test("every chart is live", async () => {
    const [figures, live] = await page.evaluate(() => [
      JSON.parse(document.getElementById("charts").textContent).charts.length,
      Object.keys(window.axisfit.charts).length]);
    assert.ok(figures > 0);
    assert.equal(live, figures);
    assert.equal(await page.locator(".quiet").count(), 0);
  });

  test("a drag zooms all charts over time, Escape shows everything again", async () => {
    const before = await charts();
    const first = before.find((c) => c.time);
    await drag(first.id, 0.3, 0.5);
    const zoomed = await charts();
    const {x} = zoomed.find((c) => c.id === first.id);
    const span = first.x[1] - first.x[0];
    assert.ok(Math.abs((x[1] - x[0]) / span - 0.2) < 0.01, `${x} of ${first.x}`);
    assert.ok(Math.abs((x[0] - first.x[0]) / span - 0.3) < 0.01, `${x} of ${first.x}`);
    zoomed.forEach((chart, i) => {
      const follows = chart.time && chart.extent[0] < x[1] && chart.extent[1] > x[0];
      assert.deepEqual(chart.x, follows ? x : before[i].x, chart.id);
    });
    await page.keyboard.press("Escape");
    assert.deepEqual(await charts(), before);
  });

  test("reading values moves nothing", {skip: any}, async () => {
    for (const {id} of (await charts()).filter((c) => c.time).slice(0, 6)) {
      const over = page.locator(`${selectorOf(id)} .over`);
      await over.scrollIntoViewIfNeeded();
      const box = await over.boundingBox();
      await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.5 * box.height);
      assert.notEqual(await page.locator(`${selectorOf(id)} .at`).textContent(), "");
      assert.deepEqual(await over.boundingBox(), box, id);
    }
  });

  test("a double click resets", {skip: any}, async () => {
    const before = await charts();
    const first = before.find((c) => c.time);
    await drag(first.id, 0.3, 0.5);
    assert.notDeepEqual(await charts(), before);
    await page.locator(`${selectorOf(first.id)} .over`).dblclick();
    assert.deepEqual(await charts(), before);
  });

  test("keys move the cursor, zoom and reset", {skip: any}, async () => {
    const {id, x} = (await charts()).find((c) => c.time);
    await page.locator(`${selectorOf(id)} .plot`).focus();
    const read = () => page.locator(`${selectorOf(id)} .at`).textContent();
    await page.keyboard.press("ArrowRight");
    const first = await read();
    await page.keyboard.press("Shift+ArrowRight");
    const second = await read();
    assert.match(first, /\d/);
    assert.notEqual(second, first);
    assert.match(await page.locator(`${selectorOf(id)} [aria-live]`).textContent(), /\d/);
    await page.keyboard.press("+");
    const closer = (await charts()).find((c) => c.id === id).x;
    assert.ok(closer[1] - closer[0] < 0.51 * (x[1] - x[0]));
    await page.keyboard.press("0");
    assert.deepEqual((await charts()).find((c) => c.id === id).x, x);
  });

  test("Tab reaches every control", async () => {
    const controls = await page.evaluate(() => {
      const all = [...document.querySelectorAll("a[href], button, input, .plot, summary")];
      all.forEach((e, i) => (e.dataset.order = i));
      return all.filter((e) => e.checkVisibility()).map((e) => e.dataset.order);
    });
    const reached = new Set();
    for (let i = 0; i < controls.length + 20; i++) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement.dataset.order));
    }
    assert.deepEqual(controls.filter((c) => !reached.has(c)), []);
  });

  for (const colorScheme of ["light", "dark"])
    test(`axe finds nothing, ${colorScheme}`, async () => {
      await page.emulateMedia({colorScheme});
      await page.evaluate(axe);
      const {violations} = await page.evaluate(() => window.axe.run());
      assert.deepEqual(
          violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html).join(" ")}`), []);
    });

  test("the button changes the colours", {skip: any}, async () => {
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await paper();
    await page.locator(".controls button", {hasText: "Dark"}).click();
    assert.notEqual(await paper(), light);
    await page.locator(".controls button", {hasText: "Light"}).click();
    assert.equal(await paper(), light);
  });

  test("no sideways scrolling on a phone", async () => {
    await page.setViewportSize({width: 360, height: 740});
    await page.waitForTimeout(200);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  });

  test("the verdict follows the links at once", async () => {
    const gap = await page.evaluate(() =>
        document.querySelector("h2").getBoundingClientRect().top -
        document.querySelector("nav").getBoundingClientRect().bottom);
    assert.ok(gap < 80, `${gap} px`);
  });

  test("no name is broken on a phone", async () => {
    await page.setViewportSize({width: 400, height: 800});
    const broken = await page.evaluate(() => [...document.querySelectorAll(".numbers dd")].flatMap(
        (e) => [...e.childNodes].filter((n) => n.nodeType === Node.TEXT_NODE).flatMap((n) =>
            [...n.data.matchAll(/\S+/g)].filter(({0: word, index}) => {
              const range = document.createRange();
              range.setStart(n, index);
              range.setEnd(n, index + word.length);
              return range.getClientRects().length > 1;
            }).map(([word]) => word))));
    assert.deepEqual(broken, []);
  });

  test("texts of charts are filled, not outlined", {skip: any}, async () => {
    const strokes = await page.evaluate(() => [...new Set(
        [...document.querySelectorAll(".chart text")].map((e) => getComputedStyle(e).stroke))]);
    assert.deepEqual(strokes, ["none"]);
  });

  test("still and live charts have the same axes", {skip: own && "its pictures are made up"},
       async () => {
    const different = await page.evaluate(() => [...document.querySelectorAll(".live")].map(
        (e) => ["> svg", ".plot"].map((kind) => [...e.querySelectorAll(`:scope ${kind} .label`)]
                                                    .map((t) => t.textContent).join(", ")))
        .filter(([still, live]) => live && still !== live));
    assert.deepEqual(different, []);
  });

  test("charts do not lie on one another", async () => {
    const overlaps = await page.evaluate(() => [...document.querySelectorAll(".chart")].filter(
        (figure) => [...figure.querySelectorAll("svg")].some(
            (c) => c.getBoundingClientRect().bottom > figure.getBoundingClientRect().bottom + 1))
        .map((figure) => figure.id));
    assert.deepEqual(overlaps, []);
  });

  test("nothing moves when the charts come to life", async () => {
    const places = () => [...document.querySelectorAll("section, .chart")].map(
        (e) => [e.id, e.getBoundingClientRect().top + scrollY, e.getBoundingClientRect().height]);
    for (const viewport of [{width: 1200, height: 900}, {width: 360, height: 740}]) {
      const context = await browser.newContext({viewport});
      const still = await context.newPage();
      await still.addInitScript(`document.addEventListener("DOMContentLoaded",
          () => (window.before = (${places})()));`);
      await still.goto(pathToFileURL(path).href);
      await still.evaluate(() => window.axisfit.ready);
      const before = await still.evaluate(() => window.before);
      const after = await still.evaluate(places);
      assert.ok(before.length > 5);
      const moved = after.filter(([, ...place], i) =>
          place.some((v, k) => Math.abs(v - before[i][k + 1]) > 1));
      assert.deepEqual(moved, []);
      await context.close();
    }
  });

  test("dots are seen in the still pictures", async () => {
    await page.emulateMedia({media: "print"});
    const pictures = page.locator(".chart > svg:has(.dots)").filter({visible: true});
    assert.ok(await pictures.count() > 0);
    for (let i = 0; i < await pictures.count(); i++) {
      const dots = pictures.nth(i).locator(".dots");
      const shown = await pictures.nth(i).screenshot();
      await dots.evaluate((e) => (e.style.visibility = "hidden"));
      assert.ok(!shown.equals(await pictures.nth(i).screenshot()), `picture ${i}`);
      await dots.evaluate((e) => (e.style.visibility = ""));
    }
  });

  // What the first paint shows must wait for nothing; how long it took is told, not judged: a
  // busy machine would fail a test of time.
  test("text and pictures are there without any script", async (t) => {
    const paint = await page.evaluate(
        () => performance.getEntriesByName("first-contentful-paint")[0].startTime);
    t.diagnostic(`first contentful paint after ${paint.toFixed(0)} ms`);
    const ids = (await charts()).map((chart) => chart.id);
    assert.ok(ids.length);
    const context = await browser.newContext({javaScriptEnabled: false});
    const still = await context.newPage();
    await still.goto(pathToFileURL(path).href);
    assert.ok(await still.locator("h1").isVisible());
    // Some stand in parts that a click unfolds.
    assert.ok(await still.locator(`${selectorOf(ids[0])} > svg`).isVisible());
    for (const id of ids)
      assert.equal(await still.locator(`${selectorOf(id)} > svg`).count(), 1, id);
    await context.close();
  });

  test("on paper the pictures are shown, not the live charts", async () => {
    await page.setViewportSize({width: 673, height: 900});  // A4 within its margins
    await page.emulateMedia({media: "print"});
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 673);
    assert.ok(await page.locator(".chart > svg").first().isVisible());
    assert.equal(await page.locator(".plot").first().isVisible(), false);
    assert.ok((await page.pdf()).length > 20000);
  });

  test("a chart is saved as SVG and PNG", {skip: any}, async () => {
    const {id} = (await charts())[0];
    const svg = (await saved(id, "SVG")).toString();
    const [error, names, labels] = await page.evaluate(([text, id]) => {
      const file = new DOMParser().parseFromString(text, "image/svg+xml");
      return [file.querySelector("parsererror")?.textContent,
              [...file.querySelectorAll("g > title")].map((t) => t.textContent),
              window.axisfit.charts[id].series.map((s) => s.label)];
    }, [svg, id]);
    assert.equal(error, undefined);
    for (const label of labels) assert.ok(names.includes(label), label);
    assert.doesNotMatch(svg, /var\(|class=|<image|href/);
    assert.equal((await saved(id, "PNG")).subarray(0, 8).toString("latin1"),
                 "\x89PNG\r\n\x1a\n");
  });
});

describe("the synthetic report", {skip: !own && "another page is tested"}, () => {
  beforeEach(() => open());
  afterEach(async () => {
    assert.deepEqual(complaints, []);
    await page.close();
  });

  test("the page of two recordings is small", () =>
    assert.ok(statSync(path).size < 1.5e6, `${statSync(path).size} bytes`));

  test("the readout is exactly the data", async () => {
    const over = page.locator("#velocity-0 .over");
    await over.scrollIntoViewIfNeeded();
    const box = await over.boundingBox();
    await page.mouse.move(box.x + 0.37 * box.width, box.y + 50);
    const [at, measured] = await Promise.all(["#velocity-0 .at", "#velocity-0 .value >> nth=0"]
                                                 .map((s) => page.locator(s).textContent()));
    const time = at.split(" ")[1];
    const i = decimals(data.columns[0]).indexOf(Number(time));
    assert.ok(i >= 0, `${time} is no sample`);
    const values = await page.evaluate(
        () => Array.from(window.axisfit.charts["velocity-0"].series[0].ys));
    assert.equal(measured, String(values[i]));
    assert.match(measured, /^-?\d\.\d{1,4}$/);
    const other = await page.locator("#velocity-1 .at").textContent();
    assert.ok(Math.abs(other.split(" ")[1] - time) < 1.3e-4, "the cursors are linked");
  });

  test("recordings zoom apart when told", async () => {
    await page.locator("#apart").check();
    await drag("velocity-0", 0.3, 0.5);
    for (const {id, recording, time, x, extent} of await charts())
      if (time) assert.equal(x[0] > extent[0], recording === data.charts[0].recording, id);
  });

  test("names are text, and none of them runs", async () => {
    assert.equal(await page.locator("main img").count(), 0);
    assert.equal(await page.locator("#force-0 .key").textContent(), `=${HOSTILE[0]}`);
  });

  test("the table is the data, with inert names", async () => {
    const lines = (await saved("force-0", "CSV")).toString().trimEnd().split("\n");
    assert.equal(lines[0], `time (s),'=${HOSTILE[0]} (N)`);
    const other = (await saved("force-1", "CSV")).toString().split("\n")[0];
    assert.equal(other, `time (s),"'=${HOSTILE[1].replaceAll('"', '""')} (N)"`);
    assert.equal(lines.length, SAMPLES + 1);
    const times = decimals(data.columns[0]);
    assert.deepEqual(lines.slice(1).map((l) => Number(l.split(",")[0])), times);
    assert.equal(lines[1 + 977].split(",")[1], "");  // no value there
    const shorter = (await saved("velocity-0", "CSV")).toString().trimEnd().split("\n");
    assert.equal(shorter[0], "time (s),measured (m/s),simulated (m/s)");
    assert.match(shorter.at(-1), /^4\.89975,-?0\.\d+,$/);
  });

  test("a spike of one sample in a million is drawn", async () => {
    await page.evaluate(() => {
      const chart = window.axisfit.charts["velocity-0"];
      const n = 1e6;
      const xs = Float64Array.from({length: n}, (_, i) => i / n * 4);
      const ys = new Float64Array(n).fill(0);
      ys[543210] = 0.4;
      chart.series[0].xs = chart.series[1].xs = xs;
      chart.series[0].ys = ys;
      chart.series[1].shown = false;
      chart.show([0, 4], [-0.5, 0.5]);
    });
    const over = page.locator("#velocity-0 .over");
    await over.scrollIntoViewIfNeeded();
    const box = await over.boundingBox();
    const x = Math.round(box.x + box.width * 0.54321) - 2;
    const y = Math.round(box.y + box.height * 0.3);
    const picture = await page.screenshot({clip: {x, y, width: 5, height: 1}});
    const drawn = await page.evaluate(async (base64) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes]));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      canvas.drawImage(bitmap, 0, 0);
      const pixels = canvas.getImageData(0, 0, bitmap.width, bitmap.height).data;
      return Math.min(...pixels.filter((_, i) => i % 4 === 0));
    }, picture.toString("base64"));
    assert.ok(drawn < 200, `brightness ${drawn}`);
  });

  test("where a chart fails, its picture stays and the page says so", async () => {
    const broken = structuredClone(data);
    broken.columns[broken.charts[0].series[0].y].data = "AAAA";
    const file = join(folder, "broken.html");
    writeFileSync(file, pageHtml(broken, asset("css"), asset("script")));
    await page.close();
    await open({}, pathToFileURL(file).href);
    assert.ok(await page.locator("#velocity-0 > svg").isVisible());
    assert.match(await page.locator(".quiet").textContent(), /static pictures/);
    assert.equal(await page.locator("#velocity-1 > svg").isVisible(), false);
  });

  test("columns are decoded to decimals", async () => {
    const file = join(folder, "decimals.html");
    const integers = [0, 3, -3, 2147483647, -2147483647, 1, 7];
    const steps = [0.1, 1e-7, 2.5e-4, 1, 0.3];
    const page0 = {columns: steps.map((s) => encodedColumn(integers, s)), charts: []};
    page0.columns.push({length: 7, start: 0, interval: 1});
    steps.forEach((step, i) => page0.charts.push({
      ...data.charts.find((c) => c.id === "cost"), id: i ? `c${i}` : "cost", y: {label: "y", unit: ""},
      series: [{label: "y", role: "residual", x: 5, y: i}]}));
    const html = pageHtml({...page0, charts: page0.charts}, asset("css"), asset("script"))
        .replace("</main>", page0.charts.slice(1).map(figure).join("") + "</main>");
    writeFileSync(file, html);
    await page.close();
    await open({}, pathToFileURL(file).href);
    const got = await page.evaluate(() => Object.values(window.axisfit.charts).map((c) => Array.from(c.series[0].ys)));
    steps.forEach((step, i) => assert.deepEqual(got[i].map((v) => v + 0), decimals(page0.columns[i], integers).map((v) => v + 0)));
  });
});

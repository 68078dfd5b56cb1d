// fleet.html in a real browser. AXISFIT_FLEET_PAGE: the page, of three axes on five nights, of which the
// first has an alarm.

import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";
import {join} from "node:path";
import {after, before, describe, test} from "node:test";
import {pathToFileURL} from "node:url";

const {AXISFIT_FLEET_PAGE, AXISFIT_NODE_MODULES, AXISFIT_CHROMIUM} = process.env;
const packages = createRequire(join(AXISFIT_NODE_MODULES, "/"));
const {chromium} = packages("playwright-core");
const axe = readFileSync(packages.resolve("axe-core/axe.min.js"), "utf8");
const url = pathToFileURL(AXISFIT_FLEET_PAGE).href;
let browser, page;
const complaints = [];

before(async () => {
  browser = await chromium.launch({
    executablePath: AXISFIT_CHROMIUM,
    args: ["--no-sandbox", "--headless", "--disable-gpu", "--disable-background-networking"],
  });
  page = await browser.newPage({viewport: {width: 1200, height: 900}});
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && complaints.push(m.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("dialog", (dialog) => complaints.push(`dialog: ${dialog.message()}`));
  page.on("request", (r) => r.url() !== url && !/^(data|blob):/.test(r.url()) && complaints.push(r.url()));
  await page.goto(url);
  await page.evaluate(() => window.axisfitFleet.ready);
});
after(() => browser?.close());

describe("fleet.html", () => {
  test("has the axes, with the state of each", async () => {
    assert.equal(await page.locator("#map button").count(), 3);
    assert.equal(await page.locator("#map button[data-state=parameter]").count(), 1);
    assert.deepEqual(await page.locator(".row:not([hidden]) span").allTextContents(), ["<b>x</b>", "y", "z"]);
  });
  test("shows the history of an axis from its alarm", async () => {
    await page.locator("#alarms td button").first().click();
    await page.locator("#charts figure canvas").first().waitFor();
    assert.equal(await page.locator("#axis-name").textContent(), "<b>x</b>");
    assert.match(await page.locator("#axis-alarms").textContent(), /B_a up/);
    const inked = await page.locator("#charts canvas").first().evaluate((canvas) =>
      canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v > 0));
    assert.ok(inked);
  });
  test("finds axes by a part of their name", async () => {
    await page.locator("#filter").fill("z");
    await page.waitForFunction(() => document.querySelectorAll(".row:not([hidden])").length === 1);
    await page.locator("#filter").fill("");
  });
  test("is usable by keyboard", async () => {
    await page.waitForFunction(() => document.querySelectorAll(".row:not([hidden])").length === 3);
    await page.locator(".row:not([hidden])").nth(1).focus();
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("axis-name").textContent === "y");
  });
  test("is accessible", async () => {
    await page.evaluate(axe);
    const {violations} = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes[0].html}`), []);
  });
  test("asks for nothing and complains of nothing", () => assert.deepEqual(complaints, []));
});

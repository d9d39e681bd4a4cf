// Checks of the site in Chromium, on a desk and on a phone, in both colors: contrast, sizes of what is tapped, names,
// moves while a page loads, and width. Also opens the menu, changes the colors and searches, from files without a
// server.
//
// node check_browser.mjs SITE WEB PICTURES    WEB: folder with node_modules of Playwright and axe
import { createRequire } from "node:module";
import { readdirSync, readFileSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [site, web, pictures] = process.argv.slice(2).map((path) => resolve(path));
const require = createRequire(join(web, "package.json"));
const { chromium } = require("@playwright/test");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const SCREENS = { desk: { width: 1280, height: 900 }, phone: { width: 390, height: 844 } };
/** Rules of axe: WCAG 2.2 A and AA, which have a contrast of 4.5 and targets of 24 pixels. */
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"];
/** Largest sum of moves while a page loads that Lighthouse calls good. */
const MOST_SHIFT = 0.1;
/** Pages of which pictures are written, to be looked at. */
const SHOWN = ["index", "gallery", "GRIDS", "PERFORMANCE", "reference/measures"];

const names = readdirSync(site).filter((name) => name.endsWith(".html"));
const pages = [...names, "python/index.html", "python/package.html", "reference/measures.html", "reference/torch.html"];
const address = (name) => pathToFileURL(join(site, name)).href;
const faults = [];
let n_checked = 0;
mkdirSync(pictures, { recursive: true });

/** Violations of the rules of axe on a page that is open. */
async function violations(page) {
  await page.evaluate(axe);
  const found = await page.evaluate((tags) => window.axe.run(document, { runOnly: tags }), RULES);
  // A link that a scrolled list cuts is reached by scrolling the list.
  const isCut = (node) => /partially obscured/.test(node.any[0]?.message ?? "");
  return found.violations.flatMap((rule) => {
    const nodes = rule.nodes.filter((node) => !isCut(node)), first = nodes[0];
    if (!first) return [];
    return `${rule.id} ×${nodes.length}: ${first.target.join(" ")}: ${first.any[0]?.message ?? rule.help}`;
  });
}

/** Opens a page and checks it. */
async function check(page, name, place) {
  const fault = (text) => faults.push(`${name} on a ${place}: ${text}`);
  await page.goto(address(name));
  await page.waitForLoadState("load");
  await page.evaluate(async () => {
    for (let y = 0; y < document.body.scrollHeight; y += 800) {
      window.scrollTo(0, y);
      await new Promise((done) => requestAnimationFrame(done));
    }
    window.scrollTo(0, 0);
    await new Promise((done) => setTimeout(done, 100));
  });
  const shift = await page.evaluate(
    () =>
      new Promise((done) => {
        let sum = 0;
        const add = (list) => list.forEach((entry) => (sum += entry.hadRecentInput ? 0 : entry.value));
        const observer = new PerformanceObserver((list) => add(list.getEntries()));
        observer.observe({ type: "layout-shift", buffered: true });
        setTimeout(() => done(sum), 60);
      }),
  );
  if (shift > MOST_SHIFT) fault(`the page moves by ${shift.toFixed(3)} while it loads`);
  const [inner, outer] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
  if (inner > outer) fault(`the page is ${inner} pixels wide on a screen of ${outer}`);
  const small = await page.evaluate(
    () =>
      [...document.querySelectorAll("article p, article li")].filter(
        (part) => parseFloat(getComputedStyle(part).fontSize) < 12,
      ).length,
  );
  if (small) fault(`${small} paragraphs have letters below 12 pixels`);
  for (const text of await violations(page)) fault(text);
}

/** Uses a page as people do: search by keyboard, colors, menu. */
async function use(browser) {
  const phone = { viewport: SCREENS.phone, hasTouch: true };
  const context = await browser.newContext({ ...phone, colorScheme: "light", reducedMotion: "reduce" });
  const page = await context.newPage();
  await page.goto(address("reference/measures.html"));
  await page.fill("#site-search", "smooth a brain volume inside a mask");
  await page.waitForSelector("#site-results a");
  for (const text of await violations(page)) faults.push(`results of the search: ${text}`);
  await page.screenshot({ path: join(pictures, "search-phone.png") });
  await page.press("#site-search", "ArrowDown");
  const target = await page.evaluate(() => document.activeElement.href);
  await page.keyboard.press("Enter");
  await page.waitForURL((url) => url.href === target);
  const dark = () => page.evaluate(() => document.body.dataset.mdColorScheme === "slate");
  for (let k = 0; k < 3 && !(await dark()); k++) await page.click("form[data-md-component=palette] label:visible");
  if (!(await dark())) faults.push("the button of colors does not lead to dark ones");
  await page.reload();
  if (!(await dark())) faults.push("dark colors are forgotten by the next page");
  await page.click("label[for=__drawer].md-header__button");
  await page.waitForTimeout(400);
  if (!(await page.isVisible(".md-nav--primary >> text=Gallery"))) faults.push("the menu on a phone has no gallery");
  await page.screenshot({ path: join(pictures, "menu-phone.png") });
  await context.close();
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
for (const [place, viewport] of Object.entries(SCREENS))
  for (const colorScheme of ["light", "dark"]) {
    const context = await browser.newContext({ viewport, colorScheme, reducedMotion: "reduce" });
    const page = await context.newPage();
    page.on("request", (request) => {
      if (!/^(?:file|data|blob):/.test(request.url())) faults.push(`${page.url()} asks for ${request.url()}`);
    });
    page.on("pageerror", (error) => faults.push(`${page.url()}: ${error.message}`));
    // Every page twice, on both screens and in both colors; those that are shown on all four.
    const isAll = (place === "desk") === (colorScheme === "light");
    for (const name of isAll ? pages : SHOWN.map((stem) => `${stem}.html`)) {
      n_checked++;
      await check(page, name, `${place}, ${colorScheme}`);
      const stem = name.replace(".html", "");
      const picture = join(pictures, `${stem.replace("/", "-")}-${place}-${colorScheme}.png`);
      if (SHOWN.includes(stem)) await page.screenshot({ path: picture, fullPage: true });
    }
    await context.close();
  }
await use(browser);
await browser.close();
console.log(faults.join("\n"));
console.log(`${n_checked} views of ${pages.length} pages, ${faults.length} faults`);
process.exit(faults.length ? 1 : 0);

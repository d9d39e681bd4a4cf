// Tests of the search of the site: the right page is among the first three for each question of questions.json.
//
// node check_search.mjs SITE
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import vm from "node:vm";

/** Rank that the right page must have. */
const FIRST = 3;
/** Longest time to prepare the index, in seconds; a phone takes about four times as long as a desk. */
const MOST_SECONDS = 2;

const site = process.argv[2];
const here = fileURLToPath(new URL(".", import.meta.url));
const context = vm.createContext({});
for (const name of ["assets/search-index.js", "assets/search.js"])
  vm.runInContext(readFileSync(join(site, name), "utf8"), context);
const search = context.adwaveSearch;
const start = performance.now();
const prepared = search.prepare(context.adwaveIndex);
const seconds = (performance.now() - start) / 1000;

const faults = [];
if (seconds > MOST_SECONDS) faults.push(`the index took ${seconds.toFixed(2)} s to prepare`);
const questions = JSON.parse(readFileSync(join(here, "questions.json"), "utf8"));
if (questions.length < 10) faults.push(`there must be ten questions, got ${questions.length}`);
let sum = 0;
for (const { question, pages } of questions) {
  const found = search.rank(prepared, question).map((page) => page.url);
  const place = found.findIndex((url) => pages.includes(url)) + 1;
  sum += place;
  if (place < 1 || place > FIRST)
    faults.push(`“${question}”: ${pages.join(" or ")} is at place ${place || "none"} of ${found.slice(0, 5).join(", ")}`);
}
// The first word of a line that is being typed finds its page, and nonsense finds nothing.
if (search.rank(prepared, "simplif", true)[0]?.score > 0 !== true) faults.push("the beginning of a word finds nothing");
if (search.rank(prepared, "xyzzyqq").length !== 0) faults.push("a word of no page finds pages");
console.log(faults.join("\n"));
console.log(
  `${questions.length} questions, mean place ${(sum / questions.length).toFixed(2)}, ` +
    `${context.adwaveIndex.sections.length} sections prepared in ${seconds.toFixed(2)} s, ${faults.length} faults`,
);
process.exit(faults.length ? 1 : 0);

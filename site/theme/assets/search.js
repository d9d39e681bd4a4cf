/* The search over all pages, without a server, and tables that scroll by keyboard. The index is a script that is loaded
   when the field is first used. The ranking is BM25 over sections, in which headings and titles count more;
   `site/check_search.mjs` tests it. */
(function (global) {
  "use strict";
  const STOP_WORDS = new Set(
    (
      "a adwave an and are as at aw be by can compute computes do does find finds for from function get has have how " +
      "i if in is it its me my of on or our so that the their them then there this to use using want was we what when " +
      "where which who why will with you your"
    ).split(" "),
  );
  /** Words that mean the same here. */
  const SYNONYMS = {
    mri: ["volume"], voxel: ["volume"], brain: ["cortex", "volume"], ram: ["memory"], big: ["large"], huge: ["large"],
    bigger: ["larg"], speed: ["fast"], quick: ["fast"], cuda: ["gpu"], lidar: ["laser", "scan"], install: ["pip"],
    dem: ["raster", "terrain"], keypoint: ["feature"], decimate: ["simplify"], gene: ["cell"], align: ["match"],
    noise: ["denoise"], noisy: ["denoise"], scan: ["cloud"], cortical: ["cortex"], bold: ["fmri"],
  };
  /** Words that ask for a part of the site: the beginnings of its addresses. */
  const PARTS = { python: /^(?:reference|python)\//, numpy: /^(?:reference|python)\//, rust: /^(?:rust|RUST)/ };
  const PART = 1.5;
  const B = 0.5, K1 = 1.4, HEADING = 3, TITLE = 4, PREFIX = 0.5, SYNONYM = 0.4, PAGE = 0.25, NAME = 20;

  function stem(word) {
    const cut = word.replace(/(?:ings?|ers?|ed|es|s|e)$/, "");
    return cut.length >= 3 ? cut.replace(/([^aeiou])\1$/, "$1") : word;
  }
  function words(text) {
    return text.toLowerCase().match(/[\p{L}\p{N}]+/gu) || [];
  }
  /** Terms of a text: words without endings. */
  function terms(text) {
    return words(text).map(stem);
  }

  /** Sections of each term with its weight there, in which long texts count less: term → Map(section → weight). */
  function prepare(index) {
    const postings = new Map();
    // About 6 characters a word; headings and titles weigh the same beside long and short texts.
    const n = Math.max(1, index.sections.length);
    const mean = index.sections.reduce((sum, section) => sum + section[3].length / 6 + 10, 0) / n;
    const count = (term, section, weight) => {
      let list = postings.get(term);
      if (!list) postings.set(term, (list = new Map()));
      list.set(section, (list.get(section) || 0) + weight);
    };
    index.sections.forEach(([page, , heading, text], section) => {
      const body = terms(text);
      const norm = 1 - B + (B * (body.length + 10)) / mean;
      for (const term of body) count(term, section, 1 / norm);
      // A heading of one word is a name, and says more than a sentence that has the word.
      const head = new Set(terms(heading));
      for (const term of head) count(term, section, HEADING * (1 + 2 / head.size));
      const title = index.pages[page][1].replace(/^(?:Rust|Python): /, "");
      for (const term of new Set(terms(title))) count(term, section, TITLE);
    });
    return { index, postings };
  }

  /** Terms of a question with weights; the last word may be the beginning of one. */
  function questionTerms(prepared, question, isOpen) {
    const all = words(question), kept = all.filter((word) => !STOP_WORDS.has(word));
    const used = kept.length ? kept : all;
    return used.map((word, k) => {
      const term = stem(word), group = new Map([[term, 1]]);
      for (const other of SYNONYMS[word] || SYNONYMS[term] || []) group.set(stem(other), SYNONYM);
      if (k === used.length - 1 && isOpen && word.length >= 2) {
        let n = 0;
        for (const known of prepared.postings.keys())
          if (known.startsWith(term) && known !== term && ++n <= 40) group.set(known, PREFIX);
      }
      return group;
    });
  }

  /** Pages that answer a question, best first: {url, title, score, hits: [{anchor, heading, text}]}. */
  function rank(prepared, question, isOpen = false) {
    const { index, postings } = prepared;
    const groups = questionTerms(prepared, question, isOpen), n = index.sections.length;
    const scores = new Map(), reached = new Map(), together = new Map();
    let total = 0;
    for (const group of groups) {
      const best = new Map();
      let n_found = 0;
      for (const [term, weight] of group) {
        const list = postings.get(term);
        if (!list) continue;
        n_found = Math.max(n_found, list.size);
        for (const [section, count] of list) {
          const value = (weight * count * (K1 + 1)) / (count + K1);
          best.set(section, Math.max(best.get(section) || 0, value));
        }
      }
      const rarity = n_found ? Math.log(1 + (n - n_found + 0.5) / (n_found + 0.5)) : 0;
      total += rarity;
      const ofPage = new Map();
      for (const [section, value] of best) {
        const page = index.sections[section][0];
        ofPage.set(page, Math.max(ofPage.get(page) || 0, value));
        scores.set(section, (scores.get(section) || 0) + rarity * value);
        reached.set(section, (reached.get(section) || 0) + rarity);
      }
      for (const [page, value] of ofPage) together.set(page, (together.get(page) || 0) + rarity * value);
    }
    // `aw.features` asks for the function.
    const name = /\b(?:aw|adwave)\.(\w+)/.exec(question);
    if (name)
      index.sections.forEach(([, anchor], section) => {
        if (anchor === `adwave.${name[1]}`) scores.set(section, (scores.get(section) || 0) + NAME);
      });
    const pages = new Map();
    for (const [section, score] of scores) {
      const [page, anchor, heading, text] = index.sections[section];
      // A section that has all words answers better than one that repeats some of them.
      const value = score * (0.25 + 0.75 * (total ? (reached.get(section) || 0) / total : 0));
      if (!pages.has(page)) pages.set(page, []);
      pages.get(page).push({ value, anchor, heading, text });
    }
    const found = [];
    for (const [page, hits] of pages) {
      hits.sort((a, b) => b.value - a.value);
      const [url, title, weight] = index.pages[page];
      // Several sections of a guide answer together.
      const isAsked = words(question).some((word) => PARTS[word]?.test(url));
      const score = (isAsked ? PART : 1) * weight * (hits[0].value + PAGE * (together.get(page) || 0));
      found.push({ url, title, score, hits: hits.slice(0, 2) });
    }
    return found.sort((a, b) => b.score - a.score || a.url.localeCompare(b.url));
  }

  /** The part of a text around the first word of a question. */
  function excerpt(text, question) {
    const wanted = new Set(terms(question).filter((term) => !STOP_WORDS.has(term)));
    const place = [...text.matchAll(/[\p{L}\p{N}]+/gu)].find((m) => wanted.has(stem(m[0].toLowerCase())));
    const start = place ? Math.max(0, text.lastIndexOf(" ", Math.max(0, place.index - 40))) : 0;
    const part = text.slice(start, start + 160).trim();
    return (start > 0 ? "… " : "") + part + (start + 160 < text.length ? " …" : "");
  }

  global.adwaveSearch = { prepare, rank, excerpt, terms };
  if (typeof document === "undefined") return;

  /** Lets the arrow keys scroll tables and code that are wider than the screen. */
  function focusWideTables() {
    for (const box of document.querySelectorAll(".md-typeset__scrollwrap, .md-typeset pre > code"))
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
  const article = document.querySelector("article") || document.body;
  new MutationObserver(focusWideTables).observe(article, { childList: true, subtree: true });
  global.addEventListener("load", focusWideTables);
  global.addEventListener("resize", focusWideTables);

  const form = document.querySelector(".site-search");
  const input = document.getElementById("site-search"), list = document.getElementById("site-results");
  if (!form || !input || !list) return;
  const base = form.dataset.base;
  let prepared = null;

  function load() {
    if (prepared || document.getElementById("site-search-index")) return;
    const script = document.createElement("script");
    script.id = "site-search-index";
    script.src = `${base}/assets/search-index.js`;
    script.onload = () => {
      prepared = prepare(global.adwaveIndex);
      show();
    };
    document.head.append(script);
  }

  function show() {
    const question = input.value.trim();
    list.replaceChildren();
    list.hidden = question === "";
    if (question === "") return;
    if (!prepared) {
      list.append("Loading …");
      return;
    }
    const found = rank(prepared, question, true).slice(0, 10);
    if (found.length === 0) list.append(`No page has “${question}”.`);
    for (const page of found) {
      const hit = page.hits[0], link = document.createElement("a");
      link.href = `${base}/${page.url}${hit.anchor ? `#${hit.anchor}` : ""}`;
      const title = document.createElement("strong");
      title.textContent = page.title + (hit.heading && hit.heading !== page.title ? ` › ${hit.heading}` : "");
      const text = document.createElement("span");
      text.textContent = excerpt(hit.text, question);
      link.append(title, text);
      list.append(link);
    }
  }

  input.addEventListener("focus", load);
  input.addEventListener("input", () => {
    load();
    show();
  });
  form.addEventListener("keydown", (event) => {
    const links = [...list.querySelectorAll("a")], k = links.indexOf(document.activeElement);
    if (event.key === "Escape") {
      list.hidden = true;
      input.focus();
    } else if (event.key === "Enter" && document.activeElement === input && links.length) {
      links[0].click();
    } else if (event.key === "ArrowDown" && links.length) {
      links[Math.min(k + 1, links.length - 1)].focus();
    } else if (event.key === "ArrowUp" && k >= 0) {
      (k === 0 ? input : links[k - 1]).focus();
    } else return;
    event.preventDefault();
  });
  document.addEventListener("keydown", (event) => {
    const isTyping = /INPUT|TEXTAREA|SELECT/.test(document.activeElement?.tagName || "");
    if (event.key === "/" && !isTyping && !event.ctrlKey && !event.metaKey) {
      event.preventDefault();
      input.focus();
    }
  });
  document.addEventListener("click", (event) => {
    if (!form.contains(event.target)) list.hidden = true;
    else if (event.target === input) show();
  });
})(typeof window === "undefined" ? globalThis : window);

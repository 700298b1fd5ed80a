// SPDX-License-Identifier: MIT
// The search: sections that contain every word, those with the words in their title first. On a small screen the list of
// pages begins closed.
"use strict";

document.querySelector("nav details").open = matchMedia("(min-width: 801px)").matches;

const root = document.currentScript.dataset.root;
const input = document.querySelector("search input");
const list = document.querySelector("search ol");
const kMost = 12;

let loading;
function loadIndex() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = `${root}/sections.js`;
    script.onload = () => resolve(window.sections);
    script.onerror = reject;
    document.head.append(script);
  });
  return loading;
}

// The text around the first of the words.
function excerpt(text, words) {
  const at = text.toLowerCase().indexOf(words[0]);
  const from = at < 40 ? 0 : text.lastIndexOf(" ", at - 40) + 1;
  return (from > 0 ? "... " : "") + text.slice(from, from + 160);
}

function found(sections, words) {
  const hits = [];
  for (const section of sections) {
    const title = section.title.toLowerCase();
    const text = section.text.toLowerCase();
    if (!words.every((word) => title.includes(word) || text.includes(word))) continue;
    const inTitle = words.filter((word) => title.includes(word)).length;
    hits.push({ section, rank: 10 * inTitle - (section.url.includes("CHANGELOG") ? 5 : 0) });
  }
  return hits.sort((a, b) => b.rank - a.rank).slice(0, kMost).map((hit) => hit.section);
}

async function search() {
  const words = input.value.toLowerCase().split(/\s+/).filter((word) => word.length > 1);
  const sections = words.length ? found(await loadIndex(), words) : [];
  list.replaceChildren(
    ...sections.map((section) => {
      const link = document.createElement("a");
      link.href = `${root}/${section.url}`;
      const title = document.createElement("b");
      title.textContent = section.title;
      link.append(title, " ", excerpt(section.text, words));
      const item = document.createElement("li");
      item.append(link);
      return item;
    }),
  );
  if (words.length && !sections.length) list.textContent = "Nothing found.";
}

input.addEventListener("input", search);
input.addEventListener("keydown", (event) => {
  if (event.key === "Enter") list.querySelector("a")?.click();
  if (event.key === "Escape") {
    input.value = "";
    search();
  }
});

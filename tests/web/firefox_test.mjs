// SPDX-License-Identifier: MIT
// firefox_test.mjs NODE_MODULES PAGE.html [FOLDER]: the page in headless Firefox: it loads, shows its first screens, dark and light (as pictures in FOLDER), moves, renders sound, keeps the energy flat and
// complains of nothing. Skipped, in a line, where there is no Firefox.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

import { serve } from "../../web/serve.mjs";
import { assertFirstScreen, kFirstScreens } from "./first_screen.mjs";

const [modules, file, pictures] = process.argv.slice(2);
const executablePath = process.env.FIREFOX ?? "/usr/bin/firefox-esr";
if (!existsSync(executablePath)) {
  console.log(`skipped: there is no Firefox at ${executablePath} (Debian: firefox-esr)`);
  process.exit(0);
}
const { firefox } = createRequire(join(resolve(modules), "x"))("playwright-core");
const server = await serve(file);
// Firefox takes its colours from its profile: 0 dark, 1 light.
const launched = (scheme) => firefox.launch({ channel: "moz-firefox", executablePath, headless: true, firefoxUserPrefs: { "layout.css.prefers-color-scheme.content-override": scheme } });

// The first screens, also as pictures where a folder is given.
async function firstScreens(page, scheme) {
  const paper = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
  assert.ok(scheme === "dark" ? Math.max(...paper) < 60 : Math.min(...paper) > 200, `${scheme}: paper of ${paper}`);
  for (const size of kFirstScreens) {
    await page.setViewportSize(size);
    await assertFirstScreen(page, size);
    // The stage is painted in the same colours.
    const corner = await page.locator("#stage").evaluate((stage) => [...stage.getContext("2d").getImageData(2, stage.height - 2, 1, 1).data.slice(0, 3)]);
    assert.deepEqual(corner, paper.slice(0, 3), `${scheme}, ${size.width} x ${size.height}: the corner of the stage`);
    if (pictures) await page.screenshot({ path: join(pictures, `firefox-${scheme}-${size.width}x${size.height}.png`) });
  }
}

{
  const dark = await launched(0);
  try {
    const page = await (await dark.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: null })).newPage();
    await page.goto(server.address);
    await page.evaluate(() => contactSpline.loaded);
    await firstScreens(page, "dark");
  } finally {
    await dark.close();
  }
}
const browser = await launched(1);
try {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 } })).newPage();
  const complaints = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.goto(server.address);
  await page.evaluate(() => contactSpline.loaded);
  await firstScreens(page, "light");
  await page.setViewportSize({ width: 1280, height: 800 });
  const { imbalance, parts, peaks } = await page.evaluate(async () => {
    const { page, renderOffline } = contactSpline;
    const { study, energies } = page.stage;
    const imbalance = Math.max(...study.column(study.scene.imbalance).map(Math.abs)) / study.scene.work;
    const peaks = {};
    for (const name of ["hammer_on_string", "piano", "tanpura"]) {
      const note = { do: "noteOn", key: 60, velocity: page.instruments.get(name).velocity };
      const channels = await renderOffline([page.instrumentMessage(name), { do: "material", design: page.editor.current }, note], 0.3);
      peaks[name] = Math.max(...channels.map((samples) => samples.reduce((max, x) => Math.max(max, Math.abs(x)), 0)));
    }
    return { imbalance, parts: energies.length, peaks };
  });
  assert.ok(parts === 4 && imbalance < 1e-12, `energy out of balance by ${imbalance}`);
  for (const [name, peak] of Object.entries(peaks)) assert.ok(Math.abs(peak / 0.18 - 1) < 0.06, `${name}: a peak of ${peak}`);
  await page.keyboard.press("d"); // E4, which the stage shows
  await page.waitForFunction(() => document.getElementById("stage-caption").textContent.includes("E4"));
  const at = await page.evaluate(() => contactSpline.page.stage.at);
  await page.waitForFunction((at) => contactSpline.page.stage.at !== at, at);
  await page.evaluate(() => contactSpline.page.story.go(3));
  await page.waitForFunction(() => document.querySelector("#chapter-3 .note[role='status']")?.textContent.includes("%"));
  const state = await page.evaluate(() => contactSpline.page.audio.context.state);
  if (state === "running") await page.waitForFunction(() => contactSpline.page.figures.captured.some((force) => force > 1));
  assert.deepEqual(complaints, []);
  const live = state === "running" ? "plays" : "has no sound device, so that sound is rendered offline";
  console.log(`Firefox ${browser.version()} ${live}; energy within ${imbalance.toExponential(1)}`);
} finally {
  await browser.close();
  server.close();
}

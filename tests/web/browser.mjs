// SPDX-License-Identifier: MIT
// The page in headless Chromium, with everything it asks for and complains about on record.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

let browser = null;

/** How many times slower the thread of the page shall be than this machine, to find tests that read a page too early. */
export const kSlow = Number(process.env.CONTACTSPLINE_SLOW ?? 1);

/** One browser for all pages of a test. */
async function launched(modules) {
  const { chromium } = createRequire(join(resolve(modules), "x"))("playwright-core");
  browser ??= await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
  });
  return browser;
}

export const closeBrowser = () => browser?.close();

/** Opens an address as if for the first time. Returns the page, what it requested and complained of, and close(). */
export async function openPage(modules, address, { width = 1280, height = 800, colorScheme = "light", permissions, scale = 1, hasTouch = false } = {}) {
  const context = await (await launched(modules)).newContext({ viewport: { width, height }, colorScheme, permissions, deviceScaleFactor: scale, hasTouch, acceptDownloads: true });
  const page = await context.newPage();
  if (kSlow > 1) {
    page.setDefaultTimeout(30000 * kSlow);
    await (await context.newCDPSession(page)).send("Emulation.setCPUThrottlingRate", { rate: kSlow });
  }
  const complaints = [];
  const requests = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error.stack ?? error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(address);
  return {
    page,
    complaints,
    requests,
    close: () => context.close(),
  };
}

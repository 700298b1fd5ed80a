// SPDX-License-Identifier: MIT
// The page in headless Chromium, with everything it asks for and complains about on record.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

/** Opens an address in an empty profile. Returns the page, what it requested and complained of, and close(). */
export async function openPage(modules, address, { width = 1280, height = 800, colorScheme = "light", permissions } = {}) {
  const { chromium } = createRequire(join(resolve(modules), "x"))("playwright-core");
  const profile = mkdtempSync(join(tmpdir(), "contactspline-chromium-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
    viewport: { width, height },
    colorScheme,
    permissions,
    acceptDownloads: true,
  });
  const page = context.pages()[0] ?? (await context.newPage());
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
    async close() {
      await context.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

// SPDX-License-Identifier: MIT
// serve.mjs PAGE.html [PORT]: serves the page on this machine, until interrupted.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { resolve } from "node:path";
import { fileURLToPath } from "node:url";

/** A server of one page at http://127.0.0.1:PORT/; port 0 chooses a free one. Returns its address and close(). */
export function serve(page, port = 0) {
  const server = createServer((request, response) => {
    const isPage = new URL(request.url, "http://localhost").pathname === "/";
    response.writeHead(isPage ? 200 : 404, { "Content-Type": "text/html; charset=utf-8" });
    response.end(isPage ? readFileSync(page) : "");
  });
  return new Promise((done) => {
    server.listen(port, "127.0.0.1", () => done({ address: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() }));
  });
}

if (fileURLToPath(import.meta.url) === resolve(process.argv[1])) {
  const [page, port = "8000"] = process.argv.slice(2);
  console.log(`The page is at ${(await serve(page, Number(port))).address}; Ctrl-C ends.`);
}

/** The mock server and the tour over it: `npm run e2e [VERTICES] [FOLDER]`. */

import { fileURLToPath } from 'node:url';
import { mockServer } from './mock.mjs';
import { tour } from './studio.mjs';

const dist = fileURLToPath(new URL('../dist', import.meta.url));
const vertices = Number(process.argv[2] ?? 20_000);
const { url, server } = await mockServer({ vertices, dist });
try {
  const result = await tour(url, process.argv[3] ?? 'out');
  console.log(JSON.stringify(result, null, 2));
  process.exitCode = result.failures.length ? 1 : 0;
} finally {
  server.closeAllConnections();
  server.close();
}

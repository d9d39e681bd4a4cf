/** Servers of the studio for tests: the command `adwave studio`, each with its own state folder. */

import { type ChildProcess, execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

/** Folder of `package.json`; Playwright runs tests in it. */
const WEB = process.cwd();

/** The command; set `ADWAVE` to test another build. */
export const ADWAVE = process.env['ADWAVE'] ?? join(WEB, '../../../target/debug/adwave');

/** Folder for shapes, screenshots and states; set `STUDIO_OUT` to use another one. */
export const OUT = process.env['STUDIO_OUT'] ?? join(WEB, 'out/tests');

/** The build of the page under test. It has the test hooks, unlike the bundle that the server embeds. */
export const TEST_BUILD = process.env['STUDIO_DIST'] ?? join(WEB, 'out/e2e');

export interface StudioServer {
  process: ChildProcess;
  url: string;
}

/** Path of a built-in creature with `nVertices` vertices, created on the first call. */
export function creature(nVertices: number): string {
  mkdirSync(OUT, { recursive: true });
  const path = join(OUT, `creature-${nVertices}.ply`);
  if (!existsSync(path)) {
    execFileSync(ADWAVE, ['sample', 'creature', '--vertices', `${nVertices}`, '--quiet', '-o', path]);
  }
  return path;
}

/** Starts a studio on a shape; edits are stored in `stateFolder`. */
export async function startStudio(shape: string, stateFolder: string): Promise<StudioServer> {
  const child = spawn(ADWAVE, ['studio', '--no-open', shape], {
    env: { ...process.env, XDG_STATE_HOME: stateFolder },
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const noAddress = new Error('the studio printed no address');
  const readAddress = async () => {
    for await (const line of createInterface({ input: child.stdout })) return line.trim();
    throw noAddress;
  };
  const timeout = new Promise<never>((_, reject) => setTimeout(() => reject(noAddress), 60_000).unref());
  return { process: child, url: await Promise.race([readAddress(), timeout]) };
}

/** Kills a server and waits until it has ended. */
export async function killStudio({ process: server }: StudioServer): Promise<void> {
  if (server.exitCode !== null || server.signalCode !== null) return;
  const ended = new Promise((resolve) => server.once('exit', resolve));
  server.kill('SIGKILL');
  await ended;
}

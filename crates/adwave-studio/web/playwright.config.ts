import { defineConfig } from '@playwright/test';

/** Chromium of the system: Playwright must not download one. */
const executablePath = process.env['CHROMIUM'] ?? '/usr/bin/chromium';

export default defineConfig({
  testDir: 'e2e',
  outputDir: 'out/playwright',
  // Tests time the page and share the processors with the server.
  workers: 1,
  timeout: 600_000,
  // Tests run on machines that are busy with other work.
  expect: { timeout: 20_000 },
  reporter: 'list',
  use: {
    actionTimeout: 60_000,
    navigationTimeout: 60_000,
    viewport: { width: 1200, height: 900 },
    colorScheme: 'light',
    launchOptions: {
      executablePath,
      args: ['--no-sandbox', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
    },
  },
  projects: [
    { name: 'page', testIgnore: ['times.spec.ts', 'random.spec.ts'] },
    // Run with `npx playwright test --project=times` and a release build, or with `--project=random`.
    { name: 'times', testMatch: 'times.spec.ts', timeout: 3_600_000 },
    {
      name: 'random',
      testMatch: 'random.spec.ts',
      timeout: 3_600_000,
      use: {
        launchOptions: {
          executablePath,
          args: [
            '--no-sandbox',
            '--use-angle=gl-egl',
            '--ignore-gpu-blocklist',
            '--js-flags=--expose-gc',
            '--enable-blink-features=ForceEagerMeasureMemory',
          ],
        },
      },
    },
  ],
});

// node types_test.mjs PACKAGE PACKAGES: a consumer of the package compiles, in both of the ways in which modules are found. PACKAGES is the
// folder whose node_modules has typescript.
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [folder, packages] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const project = mkdtempSync(join(tmpdir(), 'peerd-consumer-'));
mkdirSync(join(project, 'node_modules'));
symlinkSync(folder, join(project, 'node_modules', 'peerd'));
cpSync(join(here, 'consumer.ts'), join(project, 'consumer.ts'));
writeFileSync(join(project, 'package.json'), '{ "type": "module" }');
const common = ['--noEmit', '--strict', '--exactOptionalPropertyTypes', '--target', 'ES2022', '--lib', 'ES2022,DOM', 'consumer.ts'];
let failed = false;
for (const [module, resolution] of [['NodeNext', 'NodeNext'], ['ESNext', 'Bundler']]) {
  const words = [join(packages, 'node_modules', 'typescript', 'bin', 'tsc'), '--module', module, '--moduleResolution', resolution, ...common];
  const { status, stdout } = spawnSync(process.execPath, words, { cwd: project, encoding: 'utf8' });
  console.log(`${resolution}: ${status === 0 ? 'good' : stdout}`);
  failed ||= status !== 0;
}
rmSync(project, { recursive: true });
process.exit(failed ? 1 : 0);

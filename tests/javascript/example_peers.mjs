// The two peers of meet.toml for a test of an example.
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { freePort, Peer } from '../browser/real_peers.mjs';

// Ends the process by 77 where a program is missing.
export function skipWithout(name) {
  if ((process.env.PATH ?? '').split(delimiter).some((folder) => existsSync(join(folder, name)))) return;
  console.log(`skipped: there is no program ${name}`);
  process.exit(77);
}

// Runs the steps with the addresses of both peers, once they have each other, and with a folder that goes afterwards. `more` are words for the
// program. Ends the process: 0 good, 1 not.
export async function onPeers(program, steps, more = []) {
  const folder = mkdtempSync(join(tmpdir(), 'peerd-example-'));
  process.env.XDG_CONFIG_HOME = folder; // keys of this test's own
  const port = await freePort();
  const configuration = join(dirname(fileURLToPath(import.meta.url)), 'meet.toml');
  const peers = ['a', 'b'].map((name) => new Peer(program, configuration, name, port, more));
  let failed = false;
  try {
    const addresses = await Promise.all(peers.map(({ address }) => address));
    for (const address of addresses) await begun(address);
    await steps(addresses, folder);
    for (const peer of peers) await peer.leave();
  } catch (error) {
    failed = true;
    console.log(error);
    for (const peer of peers) peer.process.kill();
    for (const peer of peers) console.log(`--- peer ${peer.name}\n${peer.log.slice(-3000)}`);
  }
  rmSync(folder, { recursive: true });
  process.exit(failed ? 1 : 0);
}

async function begun(address) {
  const { origin } = new URL(address);
  while (!((await (await fetch(`${origin}/api/v1/status`)).json()).since_start_s > 0)) await new Promise((over) => setTimeout(over, 50));
}

// node follow.mjs ADDRESS OBJECT TARGET: takes an object and drives it towards another one, whoever owns that, until it touches something; then it lets go.
// ADDRESS is what the peer prints, http://HOST:PORT/#token=TOKEN.
import { Peer, unixTime_s } from 'peerd';

const kSpeed_m_s = 2;
const [address, object, target] = process.argv.slice(2);
const { WebSocket } = globalThis.WebSocket === undefined ? await import('ws') : globalThis; // Node 22 has one of its own
const peer = await Peer.connect(address, { WebSocket });
const contacts = await peer.subscribe('contacts');
const watch = await peer.watch({ hz: 60 });
for (const path of [object, target]) {
  if (watch.newestPose(path) === null) throw new Error(`nothing moves that is called ${path}; there are ${watch.paths().join(', ')}`);
}
await peer.grab(object);

let touched = false;
async function awaitContact() {
  for await (const event of contacts) {
    if (event.event !== 'contact' || event.kind === 'predicted' || ![event.collider, event.collidee].includes(object)) continue;
    console.log(`${event.collider} touches ${event.collidee}, peer ${event.decider} has decided it`);
    touched = true;
    return;
  }
}

async function follow() {
  let place = watch.newestPose(object).position_m;
  let before_s = NaN;
  for await (const { sessionTime_s } of watch) {
    if (touched) return;
    const step_s = Number.isNaN(before_s) ? 0 : sessionTime_s - before_s;
    before_s = sessionTime_s;
    const way = watch.newestPose(target).position_m.map((value, axis) => value - place[axis]);
    const far_m = Math.hypot(...way) || 1;
    const velocity_m_s = way.map((value) => (value / far_m) * kSpeed_m_s);
    place = place.map((value, axis) => value + velocity_m_s[axis] * step_s);
    await peer.pose({ object, position_m: place, velocity_m_s, time_s: unixTime_s() });
  }
}

await Promise.all([awaitContact(), follow()]);
await peer.letGo(object);
peer.close();

import { LiveConnection } from './live/live_connection';
import { PlaybackClock } from './live/playback_clock';
import { PoseRow, type PoseFrame } from './live/pose_frame';
import { PoseTable } from './live/pose_table';
import { loadSceneFile } from './scene/scene_file';
import { SceneView } from './scene/scene_view';

const kHz = 30;
const canvas = document.createElement('canvas');
canvas.style.cssText = 'position:fixed;inset:0;width:100vw;height:100vh';
document.body.append(canvas);
const view = new SceneView(canvas);
view.setPageColour('#dfe3e8');
const clock = new PlaybackClock(kHz);
let poses = new PoseTable(0);
let ghosts = new PoseTable(0);
const now_s = () => performance.now() / 1000;

function onFrame(frame: PoseFrame): void {
  clock.onFrame(frame.sessionTime_s, now_s());
  if (frame.revision !== view.file?.revision) return;
  const row = new PoseRow(frame);
  const drawn_s = clock.shownAt(now_s());
  for (let i = 0; i < frame.rowCount; ++i) {
    row.moveTo(i);
    if (row.kind === 0) poses.take(row.node, row, frame.sessionTime_s, drawn_s);
    if (row.kind === 2) ghosts.take(row.node, row, frame.sessionTime_s, drawn_s);
  }
}

async function loadScene(): Promise<void> {
  const file = await loadSceneFile('api/v1/scene.glb');
  poses = new PoseTable(file.nodeCount);
  ghosts = new PoseTable(file.nodeCount);
  for (const node of file.nodes) poses.place(node.index, node.pose, node.owner);
  view.show(file);
  await live.ask({ do: 'watch', hz: kHz, kinds: ['shown', 'truth', 'ghost'] });
}

const live = new LiveConnection(`${location.origin.replace('http', 'ws')}/api/v1/live`, {
  onState: (state) => state === 'open' && void loadScene(),
  onFrame,
  onEvent: (event) => event.event === 'scene' && void loadScene(),
  onFault: (sentence) => console.error(sentence),
});
live.open();

let last_s = now_s();
function picture(): void {
  const at_s = now_s();
  view.resize(innerWidth, innerHeight);
  view.draw(poses, ghosts, clock.shownAt(at_s), at_s - last_s);
  last_s = at_s;
  requestAnimationFrame(picture);
}
picture();

// A client of a peer's gateway. `Peer` is what a program uses; what it stands on is below.
export { Peer, type PeerOptions, type WatchOptions } from './peer.js';
export { Watch, type Instant, type ObjectPose } from './watch.js';
export { EventStream } from './event_stream.js';
export { PeerdError } from './errors.js';
export * from './messages.js';

export { gatewayAddress, type GatewayAddress } from './address.js';
export { Connection, type ConnectionListener, type ConnectionOptions, type LinkState, type WebSocketClass, type WebSocketLike } from './connection.js';
export { edit, refusalIn, type Ask, type Outcome } from './edits.js';
export { LookKind, readLookRecords, type LookRecord } from './look_records.js';
export { PlaybackClock } from './playback_clock.js';
export { PoseBook } from './pose_book.js';
export { PoseFlag, PoseKind, PoseRow, readPoseFrame, type PoseFrame } from './pose_frame.js';
export { PoseTable } from './pose_table.js';
export { sceneNodes, type SceneNode, type SceneNodes } from './scene_nodes.js';

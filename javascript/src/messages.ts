// What is asked of a peer, and what its replies and events hold: docs/reference/control-protocol.md and gateway.md have the
// whole. Members whose name ends with _m, _s, _ms, _rad or _m_s are in metres, seconds, milliseconds, radians, and metres a
// second. Positions and velocities are in the world's frame (right-handed, +Y up), orientations are quaternions x y z w from
// body to world. A value that the peer does not know yet is null. Within version 1 of the protocol a reply may get new members.

export type Numbers3 = readonly [number, number, number];
export type Numbers4 = readonly [number, number, number, number];

/** A reply as it comes. `ok` is false where the peer has done nothing, and `error` says why in one sentence. */
export interface Reply {
  readonly ok: boolean;
  readonly error?: string;
  /** True where this is no answer of the peer: there is no connection, or it ended before one came. */
  readonly unanswered?: true;
  readonly [member: string]: unknown;
}

/** One edit: its author's number, and how many that author had made then. */
export interface OperationId {
  readonly author: number;
  readonly number: number;
}

// ---------------------------------------------------------------------------------------------------------------- replies

export interface Member {
  readonly id: number;
  readonly name: string;
  readonly joined: boolean;
}

export interface Status {
  readonly peer: { readonly id: number; readonly name: string };
  readonly session: {
    readonly joined: boolean;
    /** Session time, which all peers share; about Unix time. */
    readonly time_s: number | null;
    readonly clock_offset_ms: number | null;
    readonly clock_error_ms: number | null;
    readonly sealed: boolean;
    readonly sealed_by: string | null;
  };
  /** The time of the world's TimeSensors. */
  readonly world_time_s: number | null;
  /** Since motions began; negative before. */
  readonly since_start_s: number | null;
  readonly waits_for: readonly { readonly id: number; readonly name: string }[];
  /** What keeps the peer from being in one session with all others, in sentences; absent in peers before 0.2. */
  readonly troubles?: readonly string[];
  readonly members: readonly Member[];
  readonly locks: readonly { readonly path: string; readonly by: string }[];
  /** Own objects, at most 256; `next` is the number to continue from. */
  readonly objects: readonly ObjectRow[];
  readonly next: number | null;
  readonly counters: Readonly<Record<string, number>>;
}

export interface ObjectRow {
  /** Above 2^53 not exact in JavaScript: name objects by their path. */
  readonly id: number;
  readonly path: string;
  readonly owner: number;
  readonly own: boolean;
  readonly driven: boolean;
  readonly outside: boolean;
  readonly position_m: Numbers3;
  readonly orientation_xyzw: Numbers4;
  readonly velocity_m_s: Numbers3;
  /** In the body's frame. */
  readonly angular_velocity_rad_s: Numbers3;
  /** Of own objects: how far what all others predict is from where the object is. */
  readonly ghost_error_m?: number;
  readonly locked_by?: string;
  /** False: the object is in regions that this peer does not listen to, and the state means nothing. */
  readonly heard?: boolean;
}

export interface ObjectsReply {
  readonly objects: readonly ObjectRow[];
  readonly next: number | null;
}

export interface PeerRow {
  readonly id: number;
  readonly name: string;
  readonly joined: boolean;
  readonly leads: boolean;
  readonly heard_ms_ago: number | null;
  readonly round_trip_ms: number | null;
  readonly delay_ms: number | null;
  readonly clock_error_ms: number | null;
  readonly clock_ahead_ms: number | null;
  readonly loss_in: number | null;
  readonly loss_out: number | null;
  readonly bytes_in: number;
}

export interface PeersReply {
  readonly clock: { readonly follows: number | null; readonly error_ms: number | null };
  readonly peers: readonly PeerRow[];
  readonly next: number | null;
}

/** What has become of a request that the peer could refuse: `refused` says why, where `done` is false. */
export interface Done {
  readonly done: boolean;
  readonly refused?: string;
}

export interface EditReply extends Done {
  readonly edit: string;
  readonly operation?: OperationId;
}

export interface OperationReply extends Done {
  readonly operation: OperationId;
  readonly applied: boolean;
  /** Another peer has it. */
  readonly held: boolean;
  /** It is on this peer's disk, if `stores`. */
  readonly stored: boolean;
  readonly stores: boolean;
  readonly alone: boolean;
}

export interface DataReply extends Done {
  readonly path: string;
  readonly key?: string;
  readonly value?: string | null;
  readonly keys?: readonly string[];
}

export interface KeyReply extends Done {
  readonly key: string;
  readonly hits: number;
  readonly consumed: boolean;
  readonly changes: readonly {
    readonly sensor: string;
    readonly recipient: string;
    readonly velocity_m_s: Numbers3;
    readonly absolute: boolean;
    readonly done: boolean;
    readonly refused?: string;
  }[];
}

export interface PoseReply {
  readonly done: boolean;
  readonly taken: number;
  readonly refused: readonly { readonly object: string; readonly why: string }[];
}

export interface Conflict {
  readonly what: string;
  readonly value: string | null;
  readonly value_bytes?: number;
  readonly lost: OperationId & { readonly at_s: number };
  readonly winner: (OperationId & { readonly at_s: number; readonly what: string; readonly value: string | null }) | null;
  readonly found_s: number;
}

export interface ConflictsReply {
  readonly conflicts: readonly Conflict[];
  readonly next: number | null;
  readonly forgotten: number;
}

export interface Hit {
  readonly node: number;
  readonly id: string | number;
  readonly path: string;
  readonly owner: number | null;
  readonly shape?: { readonly path: string };
  readonly distance_m: number;
  readonly position_m: Numbers3;
  readonly normal: Numbers3;
}

export interface Inspected {
  /** Null: it is no instance, such as a Material, so that nobody owns it and it is nowhere. */
  readonly id: string | number | null;
  readonly path: string;
  readonly def: string | null;
  readonly type: string;
  readonly owner: number | null;
  readonly own: boolean;
  readonly driven: boolean;
  readonly threshold_m: number | null;
  /** As VRML text. */
  readonly fields: Readonly<Record<string, string>>;
  readonly data: Readonly<Record<string, string>>;
}

export interface Stride {
  readonly eye_m: Numbers3;
  readonly on_ground: boolean;
  readonly fall_m_s: number;
}

export interface Regions {
  /** 0: the scene is not cut. */
  readonly cell_m: number;
  readonly counts: Numbers3;
  readonly margin_m: number;
  readonly joined: readonly number[];
  /** Those in which own objects are. */
  readonly published: readonly number[];
}

export interface ProximitySphere {
  readonly node: number;
  /** In the node's frame. */
  readonly center_m: Numbers3;
  readonly radius_m: number;
  /** How far it goes within the time that counts as close. */
  readonly range_m: number;
  readonly tight: boolean;
}

export interface SurroundingsReply {
  readonly regions: Regions;
  readonly proximity: { readonly tracks: boolean; readonly close_s: number; readonly tight_m: number; readonly objects: readonly ProximitySphere[] };
}

export interface HierarchyReply {
  readonly path: string;
  readonly level: number;
  readonly is_last: boolean;
  readonly left_out: number;
  readonly triangles: number;
  /** Of the scene file; null: it stands. */
  readonly node: number | null;
  readonly position_m: Numbers3;
  readonly orientation_xyzw: Numbers4;
  /** Of each volume the faces: x y z of each corner. */
  readonly volumes: readonly (readonly (readonly number[])[])[];
}

// --------------------------------------------------------------------------------------------------------------- requests

/** One pose of an object that this peer moves; what is left out is as the peer finds it from the poses before. */
export interface PoseOut {
  /** The path of what is grabbed, or the name that the configuration gives in `motion.OBJECT`. */
  readonly object: string;
  readonly position_m: Numbers3;
  readonly orientation_xyzw?: Numbers4;
  /** Give it where you know it: found from poses it is less exact. */
  readonly velocity_m_s?: Numbers3;
  readonly acceleration_m_s2?: Numbers3;
  /** In the body's frame. */
  readonly angular_velocity_rad_s?: Numbers3;
  /** When it holds, in Unix time of the peer's computer (`unixTime_s()`, where this is it), at most 1 s ago; without it, when it arrives. */
  readonly time_s?: number;
  /** The object was placed there: the poses before say nothing of its motion. */
  readonly jump?: boolean;
}

/** A sphere of the world. */
export interface Near {
  readonly center_m: Numbers3;
  readonly radius_m: number;
}

export type PoseKindName = 'shown' | 'truth' | 'ghost';
/** What can be subscribed to. */
export type EventKind = 'objects' | 'contacts' | 'peers' | 'data' | 'messages' | 'edits';

interface At {
  readonly path: string;
}
type Nothing = Readonly<Record<never, never>>;

/** Each request by its name: the members that it has beside `do`, and the reply to it. */
export interface Requests {
  status: [Nothing, Status];
  peers: [{ readonly from?: number }, PeersReply];
  objects: [{ readonly from?: number; readonly count?: number }, ObjectsReply];
  key: [
    | { readonly key: string; readonly shift?: boolean; readonly control?: boolean; readonly alt?: boolean; readonly meta?: boolean; readonly keypad?: boolean; readonly release?: boolean }
    | { readonly value: number; readonly state?: number; readonly release?: boolean },
    KeyReply,
  ];
  pose: [PoseOut | { readonly poses: readonly PoseOut[]; readonly time_s?: number }, PoseReply];
  let_go: [At, Done & { readonly stays?: boolean }];
  viewpoint: [
    {
      readonly object?: string;
      readonly position_m?: Numbers3;
      readonly orientation_xyzw?: Numbers4;
      readonly field_of_view_rad?: number;
      readonly aspect?: number;
    },
    Done,
  ];
  add: [{ readonly text: string; readonly under?: string }, EditReply];
  remove: [At, EditReply];
  move: [At & { readonly under?: string }, EditReply];
  set: [At & { readonly field: string; readonly value: string }, EditReply];
  own: [At, EditReply];
  grab: [At, EditReply];
  steal: [At, EditReply];
  release: [At, EditReply];
  lock: [At, EditReply];
  unlock: [At, EditReply];
  undo: [Nothing, EditReply];
  redo: [Nothing, EditReply];
  data: [At & { readonly key?: string; readonly value?: string; readonly remove?: boolean }, DataReply & Partial<EditReply>];
  send: [{ readonly topic: string; readonly text: string }, EditReply];
  conflicts: [{ readonly from?: number }, ConflictsReply];
  subscribe: [{ readonly to?: readonly EventKind[] }, { readonly subscribed: readonly EventKind[] }];
  operation: [OperationId, OperationReply];
  viewer: [Nothing, { readonly viewer: string | null }];
  world: [Nothing, Done & { readonly world: string | null }];
  leave: [Nothing, Nothing];
  token: [{ readonly token: string }, Nothing];
  watch: [{ readonly hz?: number; readonly kinds?: readonly PoseKindName[]; readonly looks?: boolean; readonly near?: Near }, Nothing];
  unwatch: [Nothing, Nothing];
  pick: [{ readonly origin_m: Numbers3; readonly direction: Numbers3 }, { readonly hit: Hit | null }];
  walk: [
    {
      readonly eye_m: Numbers3;
      readonly by_m: Numbers3;
      readonly falls?: boolean;
      readonly fall_m_s?: number;
      readonly for_s?: number;
      readonly radius_m?: number;
      readonly height_m?: number;
      readonly step_m?: number;
      readonly except?: string;
    },
    Stride,
  ];
  avatar: [{ readonly path?: string }, Nothing];
  surroundings: [Nothing, SurroundingsReply];
  hierarchy: [At & { readonly level: number }, HierarchyReply];
  inspect: [{ readonly node: number } | At, Inspected];
}

export type RequestName = keyof Requests;
export type Request<Name extends RequestName> = { readonly do: Name } & Requests[Name][0];
export type ReplyTo<Name extends RequestName> = Requests[Name][1];
/** Requests that become operations of the scene, for all peers and for good. */
export type EditName = 'add' | 'remove' | 'move' | 'set' | 'own' | 'grab' | 'steal' | 'release' | 'lock' | 'unlock' | 'undo' | 'redo' | 'data' | 'send';

// ----------------------------------------------------------------------------------------------------------------- events

/** An event as it comes. */
export interface DaemonEvent {
  readonly event: string;
  readonly [member: string]: unknown;
}

export interface ContactEvent {
  /** Session time of the contact. */
  readonly at_s: number;
  readonly known_at_s?: number;
  readonly kind: 'owner' | 'decided' | 'predicted' | 'applied' | 'scene';
  /** The peer whose finding or decision it is. */
  readonly decider?: number | null;
  readonly collider: string;
  readonly collidee: string;
  /** At the contact. */
  readonly collider_position_m?: Numbers3;
  readonly collidee_position_m?: Numbers3;
  /** Of the collidee, facing the collider. */
  readonly normal: Numbers3;
}

/** Each event by the name in its member `event`. `at_s` is session time. */
export interface Events {
  owner: { readonly at_s: number; readonly object: string; readonly id: number; readonly owner: number | null; readonly before: number | null };
  orphaned: { readonly object: string; readonly id: number; readonly before: number };
  contact: ContactEvent;
  contact_overruled: { readonly at_s: number; readonly collider: string; readonly collidee: string };
  contacts_retracted: { readonly object: string; readonly partner?: string; readonly after_s: number; readonly predicted_only?: boolean };
  joined: { readonly peer: number; readonly name: string; readonly restarted: boolean };
  left: { readonly peer: number; readonly name: string; readonly left_gracefully: boolean };
  data: { readonly at_s: number; readonly node: string; readonly key: string; readonly value: string | null };
  message: { readonly at_s: number; readonly operation: OperationId; readonly peer: number; readonly topic: string; readonly text: string };
  edit: { readonly at_s: number; readonly operation: OperationId; readonly refused?: string };
  /** So many events were left out, because this program has not read them in time. */
  dropped: { readonly count: number };
  /** The scene has been edited, or more of it can move. */
  scene: { readonly revision: number };
}

export type EventName = keyof Events;
export type EventOf<Name extends EventName> = { [N in Name]: { readonly event: N } & Events[N] }[Name];

/** The kind that each event belongs to; null: everybody gets it, whatever has been subscribed to. */
export const kKindOfEvent = {
  owner: 'objects',
  orphaned: 'objects',
  contact: 'contacts',
  contact_overruled: 'contacts',
  contacts_retracted: 'contacts',
  joined: 'peers',
  left: 'peers',
  data: 'data',
  message: 'messages',
  edit: 'edits',
  dropped: null,
  scene: null,
} as const satisfies Record<EventName, EventKind | null>;

/** The events that a subscription to these kinds gives: those of the kinds, and those that everybody gets. */
export type EventOfKind<Kind extends EventKind> = EventOf<{ [N in EventName]: (typeof kKindOfEvent)[N] extends Kind | null ? N : never }[EventName]>;

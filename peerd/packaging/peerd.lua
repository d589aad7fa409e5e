-- Wireshark and tshark (4.0 on) show peerd's datagrams, its discovery and its joins with this file: copy it to ~/.local/lib/wireshark/plugins, or
-- say `-X lua_script:peerd.lua`. docs/protocol.md specifies the bytes; peerd/packaging/README.md describes the preferences.
--
-- This file reads Protobuf itself, because Wireshark's own dissector knows messages but not the packed contents of their
-- byte strings: records bit by bit, lists of varints. Bytes that no peer sends are marked as malformed, as peers refuse
-- them, and so are values beyond the limits of the protocol.

local peerd = Proto("peerd", "peerd: a shared world")
local joins = Proto("peerd_join", "peerd: a world for a joining peer")
local inputs = Proto("peerd_input", "peerd: what a recorded peer was told")

peerd.prefs.group = Pref.string("Group of region 0", "239.192.80.0",
  "transport.group of the peers' configuration")
peerd.prefs.regions = Pref.string("Group of region 1", "",
  "as peers log it when they start: a datagram to the n-th group after it is of region n + 1. Empty: no grid has more than 1,023 regions")

local VERSION = 12
local NEXT_HELLO_MOST_MS = 24 * 60 * 60 * 1000
local MOST_BYTES = 1136
local REGION_MARK, RELAY_MARK, GREETING_MARK, SEALED_GREETING_MARK = 0x52, 0x53, 0x47, 0x67
-- The first bytes of what is sealed, without the epoch in their lowest five bits.
local SEALED_MARK, SIGNED_MARK, ANNOUNCEMENT_MARK, ROSTER_MARK = 0x80, 0xA0, 0xC0, 0xE0
local DISCOVERY_PORT = 47473

-- ---- fields -------------------------------------------------------------------------------------------------------

local all_fields = {}
local function field(kind, name, title, ...)
  local f = ProtoField[kind]("peerd." .. name, title, ...)
  all_fields[#all_fields + 1] = f
  return f
end
local function vector(name, title, unit)
  local at = {}
  for i, axis in ipairs({ "x", "y", "z" }) do
    at[i] = field("double", name .. "." .. axis, title .. " " .. axis .. (unit and " [" .. unit .. "]" or ""))
  end
  return at
end
local function quaternion(name, title)
  local at = {}
  for i, axis in ipairs({ "w", "x", "y", "z" }) do
    at[i] = field("double", name .. "." .. axis, title .. " " .. axis)
  end
  return at
end

local KINDS = { "first order", "second order", "history", "third order", "turning", "oscillating", "sliding" }
local RULES = { "id", "velocity", "field of view", "expected error", "server" }

local F = {
  kind = field("string", "kind", "Kind"),
  region = field("uint32", "region", "Region"),
  hops = field("uint8", "hops", "Relays that may pass it on"),
  version = field("uint32", "version", "Version"),
  sender = field("uint32", "sender", "Sender"),
  number = field("uint32", "number", "Number of the sender's datagrams to the region"),
  boot_low = field("uint32", "boot_low", "Boot, lowest 21 bits"),
  leaving = field("bool", "leaving", "Leaving"),
  nearby = field("bool", "nearby", "For who is near"),
  next_hello = field("uint32", "next_hello_ms", "The next one to all comes within [ms]"),
  unknown = field("uint32", "unknown_field", "Unknown field"),
  hello = {
    tx = field("int64", "hello.session_tx_ns", "Session time when it left [ns]"),
    sessions = field("uint32", "hello.sessions", "Sessions entered"),
    latency = field("uint32", "hello.latency_ms", "Hears others so late [ms]"),
    clock_error = field("uint64", "hello.clock_error_us", "Session time may be off by [us]"),
    os_minus_session = field("int64", "hello.os_minus_session_ns", "OS clock minus session time [ns]"),
    os_error = field("uint64", "hello.os_error_us", "OS clock may be off by [us]"),
    scene_digest = field("uint64", "hello.scene_digest", "Digest of the scene objects that contacts have moved", base.HEX),
  },
  echo = {
    peer = field("uint32", "echo.peer", "Peer"),
    hello = field("uint32", "echo.hello", "Number of its last hello"),
    held = field("uint64", "echo.held_ns", "Held for [ns]"),
    newer = field("uint32", "echo.newer", "Highest number, above that"),
    run = field("uint32", "echo.run", "So many up to the highest have come"),
    absent = field("uint64", "echo.absent", "Of those before, not", base.HEX),
    loss = field("uint32", "echo.loss_permille", "Lost, of a thousand"),
  },
  note = {
    collider = field("uint64", "note.collider", "Collider"),
    collidee = field("uint64", "note.collidee", "Collidee"),
    contact = field("int64", "note.contact_ns", "Contact [ns]"),
    held = field("bool", "note.held", "Held"),
  },
  intro = {
    name = field("string", "introduction.name", "Name"),
    world = field("uint64", "introduction.world_hash", "World's hash", base.HEX),
    boot = field("uint64", "introduction.boot", "Boot"),
    enslaved = field("uint64", "introduction.enslaved", "Runs object"),
    start = field("int64", "introduction.start_ns", "Motions begin [ns]"),
    zero = field("int64", "introduction.world_zero_ns", "Time 0 of the world's TimeSensors [ns]"),
    as_founder = field("uint64", "introduction.owned_as_founder", "Of those, bit by bit, as the founder", base.HEX),
    line = field("uint64", "introduction.line", "Line of descent of its edits", base.HEX),
    has_edits = field("bool", "introduction.has_edits", "Has edits"),
  },
  view = {
    object = field("uint64", "viewpoint.object", "In the frame of object"),
    position = vector("viewpoint.position", "Position", "m"),
    orientation = quaternion("viewpoint.orientation", "Orientation"),
    fov = field("double", "viewpoint.field_of_view", "Field of view [rad]"),
    aspect = field("double", "viewpoint.aspect", "Aspect"),
  },
  decision = {
    collider = field("uint64", "decision.collider", "Collider"),
    collidee = field("uint64", "decision.collidee", "Collidee"),
    contact = field("int64", "decision.contact_ns", "Contact [ns]"),
    normal = vector("decision.normal", "Normal"),
    rule = field("uint32", "decision.rule", "Rule", base.DEC, RULES),
    known = field("int64", "decision.known_ns", "Last decision known [ns]"),
    rests = field("bool", "decision.rests", "They rest against each other"),
    collider_free = vector("decision.collider_free", "Collider's acceleration where nothing bears it", "m/s^2"),
    collidee_free = vector("decision.collidee_free", "Collidee's acceleration where nothing bears it", "m/s^2"),
  },
  state = {
    position = vector("decision.position", "Position", "m"),
    velocity = vector("decision.velocity", "Velocity", "m/s"),
    acceleration = vector("decision.acceleration", "Acceleration", "m/s^2"),
    orientation = quaternion("decision.orientation", "Orientation"),
    spin = vector("decision.spin", "Spin", "rad/s"),
  },
  entered = {
    region = field("uint32", "entered.region", "Region"),
    since = field("int64", "entered.since_ns", "Since [ns]"),
    latest = field("int64", "entered.latest_ns", "Latest since [ns]"),
  },
  gone = {
    object = field("uint64", "gone.object", "Object"),
    sequence = field("uint32", "gone.sequence", "Sequence"),
    to = field("uint32", "gone.region", "Told in region"),
  },
  scene = {
    since = field("int64", "scene.since_ns", "The scene is computed since [ns]"),
    base = field("int64", "scene.base_ns", "Base time [ns]"),
  },
  ghosts = {
    time = field("int64", "ghosts.time_ns", "Ghosts at [ns]"),
    number = field("uint16", "ghosts.number", "Number of a group or bucket", base.HEX),
    owner = field("uint32", "ghosts.owner", "Asked of"),
    region = field("uint32", "ghosts.region", "Objects of region"),
    group = field("uint32", "ghosts.group", "Group"),
    reported = field("uint64", "ghosts.reported", "Shown elsewhere: object"),
    distance = field("double", "ghosts.distance", "Shown elsewhere: distance [m]"),
  },
  log = {
    author = field("uint32", "log.author", "Author"),
    bytes = field("uint64", "log.bytes", "Bytes of its log"),
  },
  operations = {
    author = field("uint32", "operations.author", "Author"),
    from = field("uint64", "operations.from", "From byte"),
    bytes = field("uint64", "operations.bytes", "Bytes"),
  },
  asked = {
    author = field("uint32", "operations.asked.author", "Author"),
    from = field("uint64", "operations.asked.from", "From byte"),
    bytes = field("uint64", "operations.asked.bytes", "Bytes"),
  },
  operation = {
    whole = field("none", "operation", "Operation"),
    kind = field("string", "operation.kind", "Kind"),
    author = field("uint32", "operation.author", "Author"),
    number = field("uint32", "operation.number", "Number in its author's log"),
    stamp = field("int64", "operation.stamp_ns", "Holds from [ns]"),
    from = field("uint64", "operation.from", "From byte of the log"),
    bytes = field("uint32", "operation.bytes", "Bytes in the log"),
    author_key = field("bytes", "operation.author_key", "Author's key"),
    signature = field("bytes", "operation.signature", "Author's signature"),
    repeated = field("bool", "operation.repeated", "An earlier packet had it"),
    knows = {
      author = field("uint32", "operation.knows.author", "Knew the log of author"),
      number = field("uint32", "operation.knows.number", "Up to number"),
    },
    object = field("uint64", "operation.object", "Object"),
    node = field("uint64", "operation.node", "Node"),
    parent = field("uint64", "operation.parent", "Parent"),
    before = field("uint64", "operation.before", "Before the child"),
    text = field("string", "operation.text", "VRML text"),
    first_object = field("uint32", "operation.first_object", "Its objects count on from"),
    first_node = field("uint32", "operation.first_node", "Its nodes count on from"),
    path = field("string", "operation.name.path", "A path in the text"),
    named = field("uint64", "operation.name.object", "Means object"),
    field = field("string", "operation.field", "Field"),
    value = field("string", "operation.value", "Value"),
    from_node = field("uint64", "operation.route.from", "From node"),
    to_node = field("uint64", "operation.route.to", "To node"),
    event_out = field("string", "operation.route.event_out", "Event out"),
    event_in = field("string", "operation.route.event_in", "Event in"),
    removes = field("bool", "operation.route.removes", "Removes the ROUTE"),
    owner = field("uint32", "operation.owner", "Owner"),
    owner_before = field("uint32", "operation.owner_before", "Owner before"),
    translation = vector("operation.translation", "Translation", "m"),
    axis = vector("operation.rotation", "Axis of rotation"),
    angle = field("double", "operation.rotation.angle", "Angle [rad]"),
    by = field("uint32", "operation.by", "By peer"),
    request_author = field("uint32", "operation.request.author", "Author of the request"),
    request_number = field("uint32", "operation.request.number", "Number of the request"),
    reason = field("string", "operation.reason", "Reason"),
    at = field("int64", "operation.at_ns", "It stood there at [ns]"),
    key = field("bytes", "operation.key", "Key"),
    data = field("bytes", "operation.data", "Data"),
    topic = field("bytes", "operation.topic", "Topic"),
    message = field("bytes", "operation.message", "Message"),
    undone_number = field("uint32", "operation.undone.number", "Number of the undone operation"),
    undone_stamp = field("int64", "operation.undone.stamp_ns", "Its stamp [ns]"),
    redoes = field("bool", "operation.redoes", "Redoes it"),
    unlocks = field("bool", "operation.unlocks", "Unlocks it"),
  },
  identity = {
    asker = field("uint64", "identity.asker", "Incarnation of the program that asks", base.HEX),
    world = field("uint64", "identity.world_hash", "World's hash", base.HEX),
    answers = field("bool", "identity.answers", "Answers"),
  },
  beacon = {
    protocol = field("uint32", "beacon.protocol", "Protocol version"),
    session = field("uint64", "beacon.session", "Session", base.HEX),
    peer = field("uint32", "beacon.peer", "Peer"),
    incarnation = field("uint64", "beacon.incarnation", "Incarnation", base.HEX),
    port = field("uint16", "beacon.snapshot_port", "TCP port for joining peers"),
    world = field("string", "beacon.world", "World"),
    name = field("string", "beacon.name", "Name"),
    sealed = field("bool", "beacon.sealed", "Sealed"),
  },
  seal = {
    epoch = field("uint8", "seal.epoch", "Epoch"),
    sender = field("uint32", "seal.sender", "Sender"),
    counter = field("uint32", "seal.counter", "Counter of the boot, lowest 3 bytes"),
  },
  base_low = field("uint64", "records.base_low", "Base time, lowest 5 bytes [ns]"),
  base = field("int64", "records.base_ns", "Base time nearest to the capture's [ns]"),
  record = {
    kind = field("uint32", "record.kind", "Model", base.DEC, KINDS),
    step = field("int32", "record.step_log2", "Step of the position, log2 [m]"),
    exact = field("bool", "record.exact", "Exact"),
    object = field("uint64", "record.object", "Object"),
    carrier = field("uint64", "record.carrier", "In the frame of"),
    sequence = field("uint32", "record.sequence", "Sequence"),
    time = field("int64", "record.time_ns", "Time [ns]"),
    decision = field("int64", "record.decision_ns", "Last decision known [ns]"),
    position = vector("record.position", "Position", "m"),
    velocity = vector("record.velocity", "Velocity", "m/s"),
    acceleration = vector("record.acceleration", "Acceleration", "m/s^2"),
    jerk = vector("record.jerk", "Jerk", "m/s^3"),
    rate = vector("record.rate", "Rate", "rad/s"),
    orientation = quaternion("record.orientation", "Orientation"),
    spin = vector("record.spin", "Spin", "rad/s"),
    spin_up = vector("record.spin_acceleration", "Spin acceleration", "rad/s^2"),
    drive = vector("record.drive", "Acceleration where nothing bears it", "m/s^2"),
    driven_since = field("int64", "record.driven_since_ns", "It has that one since [ns]"),
    unknown = field("uint32", "record.unknown_kind", "Model of a later version"),
  },
  greeting = {
    instance = field("uint32", "greeting.instance", "Instance", base.HEX),
    number = field("uint64", "greeting.number", "Number to echo", base.HEX),
    echo = field("uint64", "greeting.echo", "Echo", base.HEX),
    reply = field("bool", "greeting.reply", "Wants a reply"),
    leaving = field("bool", "greeting.leaving", "Leaving"),
    all = field("bool", "greeting.all_regions", "Wants all regions"),
    region = field("uint32", "greeting.region", "Wants region"),
    peer = field("string", "greeting.peer", "Hears"),
    sent_at = field("int64", "greeting.sent_at", "Sent at [ns of the sender's clock]"),
    echoed = field("int64", "greeting.echoed", "Echoes the note of [ns of the receiver's clock]"),
    held = field("uint32", "greeting.held", "Held [us]"),
    datagrams_out = field("uint32", "greeting.sent", "Datagrams sent over this link"),
    datagrams_in = field("uint32", "greeting.received", "Datagrams received over this link"),
    offset = field("uint32", "greeting.group_offset", "Offset of the world's groups"),
    relay = field("uint32", "greeting.path", "Relay on the way to the root", base.HEX),
    detached = field("bool", "greeting.detached", "Without its parent"),
  },
}
peerd.fields = all_fields

local malformed = ProtoExpert.new("peerd.malformed", "Malformed", expert.group.MALFORMED, expert.severity.ERROR)
local unreadable =
  ProtoExpert.new("peerd.operation.malformed", "A log that nobody reads on", expert.group.MALFORMED, expert.severity.ERROR)
local forked = ProtoExpert.new("peerd.operations.forked", "Not what an earlier packet had of this log",
  expert.group.SEQUENCE, expert.severity.WARN)
peerd.experts = { malformed, unreadable, forked }

-- What is known of earlier packets: each capture begins without it. Packets add to it when they are first dissected, and
-- what they show later is kept by their numbers.
local logs = {}            -- of operations, by their groups and authors
local shown = {}           -- the operations of each part of a log, by packet and part
local join_streams = {}    -- TCP streams, by their numbers
local join_requests = {}   -- the request that each reply answers, by the reply's place
local snapshot_ports = {}  -- TCP ports that beacons name
function peerd.init() logs, shown, join_streams, join_requests, snapshot_ports = {}, {}, {}, {}, {} end

-- ---- refusing -----------------------------------------------------------------------------------------------------

-- A refusal of the bytes is thrown as a table, so that an error of this file itself is not taken for one.
local function refuse(why) error({ refused = why }, 0) end

-- Runs `f`. Returns whether it refused nothing, and its result or else the reason.
local function attempt(f)
  local good, result = pcall(f)
  if good then return true, result end
  if type(result) ~= "table" or not result.refused then error(result, 0) end
  return false, result.refused
end

-- Runs `dissect` and marks a refusal in `tree`, by the expert information `mark`. Returns whether there was none.
local function guarded(tree, mark, dissect)
  local good, why = attempt(dissect)
  if not good then tree:add_proto_expert_info(mark, "Malformed: " .. why) end
  return good
end

-- ---- numbers ------------------------------------------------------------------------------------------------------

local TWO32 = 2 ^ 32
local ALL_ONES = UInt64.new(0xFFFFFFFF, 0xFFFFFFFF)

local function signed(u) return Int64.new(u:lower(), u:higher()) end
-- Decodes zigzag: 0, 1, 2, 3 mean 0, -1, 1, -2.
local function unzigzag(u)
  local half = u:rshift(1)
  if u:lower() % 2 == 1 then half = half:bxor(ALL_ONES) end
  return signed(half)
end

local TIME_MOST = Int64.new(0, 2 ^ 30)  -- 2^62 ns
local function check_time(t)
  if t > TIME_MOST or t < -TIME_MOST then refuse("a time out of range") end
  return t
end

local function is_finite(x) return x == x and x ~= math.huge and x ~= -math.huge end
local function norm(v)
  local sum = 0
  for _, x in ipairs(v) do sum = sum + x * x end
  return math.sqrt(sum)
end
local function check_vector(v)
  for _, x in ipairs(v) do
    if not is_finite(x) or math.abs(x) > 1e12 then refuse("a number that is not finite or beyond 1e12") end
  end
  return v
end
local function check_finite(v)
  for _, x in ipairs(v) do
    if not is_finite(x) then refuse("a number that is not finite") end
  end
end
local function check_unit(v, what)
  check_finite(v)
  if math.abs(norm(v) - 1) > 1e-6 then refuse(what .. " is not of unit length") end
  return v
end
local function is_zero(v)
  for _, x in ipairs(v) do
    if x ~= 0 then return false end
  end
  return true
end

local function add_vector(tree, fields, range, v)
  for i, f in ipairs(fields) do tree:add(f, range, v[i]) end
end

-- Adds text of others. Control characters, which a terminal might obey, become "?".
local function add_text(tree, f, range)
  local raw = range:raw()
  if not raw:find("[%z\1-\8\11-\31\127]") then return tree:add_packet_field(f, range, ENC_UTF_8) end
  return tree:add(f, range, (raw:gsub("[^\t\n -~]", "?")))
end

-- ---- Protobuf -----------------------------------------------------------------------------------------------------

-- Reads a varint at `at`, of at most 10 bytes. Returns its value and the offset after it.
local function varint(tvb, at)
  local value = UInt64.new(0)
  for i = 0, 9 do
    if at + i >= tvb:len() then refuse("a number is cut short") end
    local byte = tvb(at + i, 1):uint()
    value = value:bor(UInt64.new(byte % 128):lshift(7 * i))
    if byte < 128 then return value, at + i + 1 end
  end
  refuse("a number of more than 10 bytes")
end

-- Calls handlers[number] with each field's value and range: for wire type "varint" a UInt64, for "fixed64" nothing, for
-- "bytes" a Tvb. As in Protobuf's own readers, a field of another type than the handler's is unknown, and the last of
-- several fields counts unless it is `repeated`. Repeated messages are all shown; Protobuf merges them.
local WIRE_TYPES = { [0] = "varint", [1] = "fixed64", [2] = "bytes", [5] = "fixed32" }
local function each_field(tvb, tree, handlers)
  local at, calls, last = 0, {}, {}
  while at < tvb:len() do
    local begin, tag, value, range = at, nil, nil, nil
    tag, at = varint(tvb, at)
    -- Protobuf's C++ reader drops the bits of a tag beyond the lowest 32.
    local number, wire = math.floor(tag:lower() / 8), WIRE_TYPES[tag:lower() % 8]
    if number == 0 or at - begin > 5 then refuse("a field without a number") end
    if wire == "varint" then
      value, at = varint(tvb, at)
      range = tvb(begin, at - begin)
    elseif wire == "bytes" then
      local size
      size, at = varint(tvb, at)
      if size:higher() ~= 0 or size:lower() > tvb:len() - at then refuse("field " .. number .. " is cut short") end
      size = size:lower()
      range = tvb(begin, at + size - begin)
      value = size > 0 and tvb(at, size):tvb() or false
      at = at + size
    elseif wire then
      local size = wire == "fixed64" and 8 or 4
      if at + size > tvb:len() then refuse("field " .. number .. " is cut short") end
      range = tvb(at, size)
      at = at + size
    else
      refuse("field " .. number .. " is of no type that peers send")
    end
    local handler = handlers[number]
    if handler and handler[wire] then
      calls[#calls + 1] = { number, handler[wire], value, range }
      last[number] = #calls
    else
      tree:add(F.unknown, range, number)
    end
  end
  for i, call in ipairs(calls) do
    local number, handle, value, range = table.unpack(call, 1, 4)
    if i == last[number] or handlers[number].repeated then
      handle(value, range)
    else
      tree:add(F.unknown, range, number)
    end
  end
end

local function uint32(tree, f, keep)
  return { varint = function(value, range)
    tree:add(f, range, value:lower())
    if keep then keep(value:lower()) end
  end }
end
local function uint64(tree, f)
  return { varint = function(value, range) tree:add(f, range, value) end }
end
local function time64(tree, f, keep)
  return { fixed64 = function(_, range)
    local t = check_time(range:le_int64())
    tree:add(f, range, t)
    if keep then keep(t) end
  end }
end
local function double(into, name)
  return { fixed64 = function(_, range) into[name] = range:le_float() end }
end
local function message(tree, title, dissect)
  return { repeated = true, bytes = function(tvb, range) dissect(tvb, tree:add(range, title), range) end }
end
-- Reads a repeated number, packed or not.
local function numbers(into)
  local function keep(value, range) into[#into + 1] = { value, range } end
  return {
    repeated = true,
    varint = keep,
    bytes = function(tvb)
      local at = 0
      while tvb and at < tvb:len() do
        local begin, value = at, nil
        value, at = varint(tvb, at)
        keep(value, tvb(begin, at - begin))
      end
    end,
  }
end

-- Absent bytes are an empty message.
local function each_field_of(tvb, tree, handlers)
  if tvb then each_field(tvb, tree, handlers) end
end

-- A Vec3 or Quat as a list of its components.
local function components(names, into)
  return { repeated = true, bytes = function(tvb, range)
    local at = {}
    local handlers = {}
    for i, _ in ipairs(names) do handlers[i] = double(at, i) end
    if tvb then each_field(tvb, into.tree, handlers) end
    for i, _ in ipairs(names) do into[i] = at[i] or into[i] or 0 end
    into.range = range
  end }
end
local XYZ, WXYZ = { "x", "y", "z" }, { "w", "x", "y", "z" }

-- ---- bits ---------------------------------------------------------------------------------------------------------

-- Reads the bits of a Tvb from a byte on, the lowest bit of each byte first.
local Bits = {}
Bits.__index = Bits
function Bits.new(tvb, at) return setmetatable({ tvb = tvb, begin = at, bit = 8 * at }, Bits) end
function Bits:get(count)  -- at most 53 bits, which a Lua number holds exactly
  if self.bit + count > 8 * self.tvb:len() then refuse("a record or a list is cut short") end
  local value, weight = 0, 1
  while count > 0 do
    local at, low = math.floor(self.bit / 8), self.bit % 8
    local take = math.min(8 - low, count)
    local byte = self.tvb(at, 1):uint()
    value = value + math.floor(byte / 2 ^ low) % 2 ^ take * weight
    weight = weight * 2 ^ take
    self.bit, count = self.bit + take, count - take
  end
  return value
end
-- Reads a varint, which must be in its shortest form.
function Bits:varint64()
  local value = UInt64.new(0)
  for i = 0, 9 do
    local byte = self:get(8)
    if i == 9 and byte > 1 then break end
    value = value:bor(UInt64.new(byte % 128):lshift(7 * i))
    if byte < 128 then
      if i > 0 and byte == 0 then refuse("a number that is longer than needed") end
      return value
    end
  end
  refuse("a number of more than 64 bits")
end
function Bits:varint32()
  local value = self:varint64()
  if value:higher() ~= 0 then refuse("a number of more than 32 bits") end
  return value:lower()
end
function Bits:time(from) return check_time(from + unzigzag(self:varint64())) end
function Bits:at_end() return self.bit == 8 * self.tvb:len() end
function Bits:pad()
  if self.bit % 8 ~= 0 and self:get(8 - self.bit % 8) ~= 0 then refuse("padding that is not zeros") end
end
function Bits:range() return self.tvb(self.begin, self.bit / 8 - self.begin) end

-- Reads which of three axes are present.
function Bits:mask(may_be_empty)
  if self:get(1) == 0 then return { true, true, true } end
  local mask = self:get(3)
  if mask == 7 or (mask == 0 and not may_be_empty) then refuse("a mask that says nothing") end
  return { mask % 2 == 1, math.floor(mask / 2) % 2 == 1, mask >= 4 }
end
function Bits:signed(magnitude_bits, may_be_zero)
  local negative, magnitude = self:get(1) == 1, self:get(magnitude_bits)
  if magnitude == 0 and (negative or not may_be_zero) then refuse("a zero that is sent") end
  return negative and -magnitude or magnitude
end
-- Reads a vector in steps. Returns it and the width of its longest component. `axes` are its axes where the bits do not
-- name them.
function Bits:steps(step_log2, width_bits, axes)
  local width = self:get(width_bits)
  if width == 0 then return { 0, 0, 0 }, 0 end
  if width > 52 then refuse("a component of " .. width .. " bits") end
  local v, most = { 0, 0, 0 }, 0
  for i, there in ipairs(axes or self:mask(false)) do
    if there then
      local n = self:signed(width, axes ~= nil)
      most = math.max(most, math.abs(n))
      v[i] = math.ldexp(n, step_log2)
    end
  end
  if most < 2 ^ (width - 1) then refuse("a width that is larger than needed") end
  return v, width
end
-- Reads a binary64 number.
function Bits:double()
  local low, high = self:get(32), self:get(32)
  local sign = high >= 2 ^ 31 and -1 or 1
  local exponent, fraction = math.floor(high / 2 ^ 20) % 2 ^ 11, high % 2 ^ 20 * TWO32 + low
  local is_zero_bits = low == 0 and high == 0
  if exponent == 2047 then return fraction == 0 and sign * math.huge or 0 / 0, is_zero_bits end
  if exponent == 0 then return sign * math.ldexp(fraction, -1074), is_zero_bits end
  return sign * math.ldexp(fraction + 2 ^ 52, exponent - 1075), is_zero_bits
end
function Bits:exact()
  local v = { 0, 0, 0 }
  if self:get(1) == 0 then return v end
  for i, there in ipairs(self:mask(false)) do
    if there then
      local zero
      v[i], zero = self:double()
      if zero then refuse("a zero that is sent") end
    end
  end
  return v
end
-- Reads the smallest three components of a unit quaternion, which are whole multiples of 1 / (sqrt(2) 4095). If `upright`,
-- the largest is w or y, and only the other of the two is present.
function Bits:orientation(upright)
  local largest, left = upright and 2 * self:get(1) or self:get(2), 2 * 4095 ^ 2
  local steps = {}
  for i, there in ipairs(upright and { largest == 2, largest == 0, false } or self:mask(largest ~= 0)) do
    steps[i] = there and self:signed(12, upright and largest == 2) or 0
    left = left - steps[i] ^ 2
  end
  if left < 0 then refuse("an orientation that is longer than 1") end
  local step, q, next_step = 1 / (math.sqrt(2) * 4095), {}, 1
  for i = 1, 4 do
    if i == largest + 1 then
      q[i] = left == 2 * 4095 ^ 2 and 1 or step * math.sqrt(left)
    else
      q[i] = step * steps[next_step]
      next_step = next_step + 1
    end
  end
  return q
end

-- ---- records ------------------------------------------------------------------------------------------------------

local FIRST, SECOND, HISTORY, THIRD, TURNING, OSCILLATING, SLIDING = 1, 2, 3, 4, 5, 6, 7
local UNKNOWN_KIND, EXACT = 8, 15

-- The axes of motion of a level record, and the axis of rotation of an upright one.
local ALONG_Y, ALONG_XZ = { false, true, false }, { true, false, true }

local function within(m, axes)
  for name, has in pairs(axes) do
    for i = 1, 3 do
      if m[name] and not has[i] and m[name][i] ~= 0 then return false end
    end
  end
  return true
end

local function is_level(kind, m)
  local rate = kind == TURNING and ALONG_Y or ALONG_XZ
  return within(m, { velocity = ALONG_XZ, acceleration = ALONG_XZ, jerk = ALONG_XZ, rate = rate })
end

local function is_upright(m)
  local turned = m.orientation and (m.orientation[2] ~= 0 or m.orientation[4] ~= 0)
  return not turned and within(m, { spin = ALONG_Y, spin_up = ALONG_Y })
end

local function take_in_steps(bits, kind, step, turned, spins_up, level, upright)
  local m = {}
  local moves, turns = level and ALONG_XZ or nil, upright and ALONG_Y or nil
  local h = (kind == SECOND or kind == HISTORY or kind == THIRD) and 0 or 2
  local a_step, j_step, a_width, j_width = step + 2 - 2 * h, step + 3 - 3 * h, 0, 0
  m.position = bits:steps(step, 6)
  m.velocity = bits:steps(step + 1 - h, 5, moves)
  if kind ~= FIRST then m.acceleration, a_width = bits:steps(a_step, 5, moves) end
  if kind == THIRD or kind == OSCILLATING then m.jerk, j_width = bits:steps(j_step, 5, moves) end
  if kind == TURNING or kind == OSCILLATING then
    m.rate = { 0, 0, 0 }
    local by_a, by_j = a_width + a_step + 3 * h, j_width + j_step + 4 * h - 2
    local most = a_width > 0 and by_a or nil
    if j_width > 0 then most = most and math.max(most, by_j) or by_j end
    if most then m.rate = bits:steps(step + 2 - most, 6, level and kind == TURNING and ALONG_Y or moves) end
  end
  if turned then m.orientation = bits:orientation(upright) end
  m.spin = bits:steps(-10 - h, 5, turns)
  if spins_up then m.spin_up = bits:steps(-9 - 2 * h, 5, turns) end
  if level ~= is_level(kind, m) or upright ~= is_upright(m) then refuse("a record of another form") end
  return m
end

local function take_exactly(bits, kind, turned, spins_up)
  local m = {}
  m.position = bits:exact()
  m.velocity = bits:exact()
  if kind ~= FIRST then m.acceleration = bits:exact() end
  if kind == THIRD or kind == OSCILLATING then m.jerk = bits:exact() end
  if kind == TURNING or kind == OSCILLATING then m.rate = bits:exact() end
  if turned then
    m.orientation = {}
    for i = 1, 4 do m.orientation[i] = bits:double() end
    local q = m.orientation
    if q[1] == 1 and q[2] == 0 and q[3] == 0 and q[4] == 0 then refuse("the identity, which is not sent") end
  end
  m.spin = bits:exact()
  if spins_up then m.spin_up = bits:exact() end
  return m
end

local function check_limits(kind, m)
  check_vector(m.position)
  check_vector(m.velocity)
  if m.acceleration then check_vector(m.acceleration) end
  if m.orientation then check_unit(m.orientation, "an orientation") end
  check_vector(m.spin)
  if norm(m.spin) > 1e4 then refuse("a spin beyond 10,000 rad/s") end
  if m.jerk then
    check_finite(m.jerk)
    if norm(m.jerk) > 1e9 then refuse("a jerk beyond 1e9 m/s^3") end
  end
  if m.rate then
    check_finite(m.rate)
    local most = kind == TURNING and norm(m.rate) or 0
    for _, x in ipairs(m.rate) do
      if kind == OSCILLATING then
        if x < 0 then refuse("a wave of negative rate") end
        most = math.max(most, x)
      end
    end
    if most > 100 then refuse("a rate beyond 100 rad/s") end
  end
  if m.spin_up then
    check_finite(m.spin_up)
    if is_zero(m.spin_up) then refuse("a zero that is sent") end
    if norm(m.spin_up) > 2000 then refuse("a spin acceleration beyond 2,000 rad/s^2") end
  end
end

-- Returns the offset after the record, and its time unless it is of an unknown kind.
local function dissect_record(tvb, tree, at, base_time, only_exact)
  local bits = Bits.new(tvb, at)
  local kind, step = bits:get(4), bits:get(4)
  if kind == UNKNOWN_KIND then
    local size = bits:get(8)
    if at + 2 + size > tvb:len() then refuse("a record is cut short") end
    tree:add(F.record.unknown, tvb(at, 2 + size), kind)
    return at + 2 + size
  end
  if kind == 0 then refuse("a record of kind 0") end
  local is_carried = kind > UNKNOWN_KIND  -- its kind is that many higher
  kind = kind % UNKNOWN_KIND
  local later, decided = bits:get(1) == 1, bits:get(1) == 1
  local turned, spins_up = bits:get(1) == 1, bits:get(1) == 1
  local level, upright, borne = bits:get(1) == 1, bits:get(1) == 1, bits:get(1) == 1
  local object, sequence = bits:varint64(), bits:varint32()
  if sequence == 0 then refuse("sequence 0") end
  local carrier = is_carried and bits:varint64() or nil
  local time, decision = base_time, nil
  if later then
    time = bits:time(base_time)
    if time == base_time then refuse("a zero that is sent") end
  end
  if decided then
    decision = bits:time(time)
    if decision == Int64.new(0) then refuse("a zero that is sent") end
  end
  if only_exact and step ~= EXACT then refuse("a state that is rounded") end
  local m
  if step == EXACT then
    if level or upright then refuse("a record of another form") end
    m = take_exactly(bits, kind, turned, spins_up)
  else
    m = take_in_steps(bits, kind, step - 23, turned, spins_up, level, upright)
  end
  local drive, driven_since = nil, nil
  if borne then
    drive = check_vector(bits:exact())
    driven_since = bits:time(time)
    if driven_since > time then refuse("a drive from after the update") end
  end
  bits:pad()
  check_limits(kind, m)

  local range = bits:range()
  local sub = tree:add(range, string.format("Object %s, number %d: %s", object, sequence, KINDS[kind]))
  local R = F.record
  sub:add(R.object, range, object)
  sub:add(R.sequence, range, sequence)
  if carrier then sub:add(R.carrier, range, carrier) end
  sub:add(R.kind, range, kind)
  sub:add(R.time, range, time)
  if decision then sub:add(R.decision, range, decision) end
  if step == EXACT then sub:add(R.exact, range, true) else sub:add(R.step, range, step - 23) end
  for _, name in ipairs({ "position", "velocity", "acceleration", "jerk", "rate", "orientation", "spin", "spin_up" }) do
    if m[name] then add_vector(sub, R[name], range, m[name]) end
  end
  if drive then
    add_vector(sub, R.drive, range, drive)
    sub:add(R.driven_since, range, driven_since)
  end
  return at + range:len(), time
end

-- Returns the time with those lowest 5 bytes that is nearest to the capture's time. Receivers use session time.
local function nearest_time(low, pinfo)
  local near = tonumber(pinfo.abs_ts) * 1e9
  local period = 2 ^ 40
  local above = math.floor((near - low) / period + 0.5)
  if above < 0 then above = 0 end
  return Int64.new(low % TWO32, above * 256 + math.floor(low / TWO32))
end

local function dissect_records(tvb, tree, pinfo)
  if not tvb then return 0 end
  if tvb:len() <= 5 then refuse("a base time without records") end
  local low = Bits.new(tvb, 0):get(40)
  local base_time = nearest_time(low, pinfo)
  tree:add(F.base_low, tvb(0, 5), UInt64.new(low % TWO32, math.floor(low / TWO32)))
  tree:add(F.base, tvb(0, 5), base_time)
  local at, count = 5, 0
  while at < tvb:len() do
    at = dissect_record(tvb, tree, at, base_time)
    count = count + 1
  end
  return count
end

local function dissect_scene(tvb, tree)
  if not tvb then return 0 end
  if tvb:len() <= 16 then refuse("times without states") end
  local base_time = check_time(tvb(8, 8):le_int64())
  tree:add(F.scene.since, tvb(0, 8), check_time(tvb(0, 8):le_int64()))
  tree:add(F.scene.base, tvb(8, 8), base_time)
  local at, count = 16, 0
  while at < tvb:len() do
    at = dissect_record(tvb, tree, at, base_time, true)
    count = count + 1
  end
  return count
end

-- Takes the lowest byte of a number of quarter seconds. Returns the time that is nearest to the capture's time.
local function ghost_time(low, pinfo)
  local here = math.floor(tonumber(pinfo.abs_ts) * 4)
  local ahead = (low - here) % 256
  if ahead >= 128 then ahead = ahead - 256 end
  local quarters = here + ahead
  return check_time(Int64.new(quarters % TWO32, math.floor(quarters / TWO32)) * Int64.new(250000000, 0))
end
local function ghost_numbers(bits, tree, count)
  for _ = 1, count do
    local number = bits:get(16)
    tree:add(F.ghosts.number, bits.tvb(bits.bit / 8 - 2, 2), number)
  end
  if not bits:at_end() then refuse("numbers of ghosts that are too many") end
end

local function dissect_ghost_digest(tvb, tree, pinfo)
  local bits = Bits.new(tvb, 0)
  tree:add(F.ghosts.time, tvb(0, 1), ghost_time(bits:get(8), pinfo))
  ghost_numbers(bits, tree, 4)
end

local function dissect_ghost_question(tvb, tree, pinfo)
  local bits, G = Bits.new(tvb, 0), F.ghosts
  local owner, region, time = bits:varint32(), bits:varint32(), ghost_time(bits:get(8), pinfo)
  local group = bits:varint32()
  if owner == 0 or group > 3 then refuse("a question to nobody, or about no group") end
  local range = bits:range()
  tree:add(G.owner, range, owner)
  tree:add(G.region, range, region)
  tree:add(G.time, range, time)
  tree:add(G.group, range, group)
  ghost_numbers(bits, tree, 32)
end

local function dissect_ghost_answer(tvb, tree)
  if tvb:len() <= 8 then refuse("a time without states") end
  local base_time = check_time(tvb(0, 8):le_int64())
  tree:add(F.ghosts.time, tvb(0, 8), base_time)
  local at, count, time = 8, 0, nil
  while at < tvb:len() do
    at, time = dissect_record(tvb, tree, at, base_time, true)
    if time and time ~= base_time then refuse("ghosts of two instants") end
    if time then count = count + 1 end
  end
  if count > 12 then refuse("more than 12 ghosts") end
end

local function dissect_ghost_reports(tvb, tree)
  local bits, count = Bits.new(tvb, 0), 0
  while not bits:at_end() do
    local begin = bits.bit / 8
    local object = bits:varint64()
    local at = bits.bit / 8
    bits:get(32)
    local distance = tvb(at, 4):le_float()
    count = count + 1
    if count > 16 or not (distance >= 0 and distance < math.huge) then refuse("a report that nobody sends") end
    tree:add(F.ghosts.reported, tvb(begin, at - begin), object)
    tree:add(F.ghosts.distance, tvb(at, 4), distance)
  end
end

-- ---- hellos -------------------------------------------------------------------------------------------------------

local function each_entry(tvb, take)
  if not tvb then return end
  local bits = Bits.new(tvb, 0)
  while not bits:at_end() do
    bits.begin = bits.bit / 8
    take(bits)
  end
end

local function dissect_echoes(tvb, tree)
  each_entry(tvb, function(bits)
    local E = F.echo
    local peer, hello, held = bits:varint32(), bits:varint32(), bits:varint64()
    local newer, run = bits:varint32(), bits:varint32()
    local counted = math.min(hello + newer, 64)
    local absent = run < counted and bits:varint64() or nil
    local loss = bits:varint32()
    local no_row = hello + newer == 0 or run > math.min(hello + newer, 16383) or (absent and (absent:lower() % 2 == 0 or
      (counted - run < 64 and absent:rshift(counted - run) ~= UInt64.new(0))))
    if held > UInt64.new(10000000000 % TWO32, 2) or loss > 1000 or newer > TWO32 - 1 - hello or no_row then
      refuse("an echo that nobody sends")
    end
    local sub = tree:add(bits:range(), "Echo to peer " .. peer)
    sub:add(E.peer, bits:range(), peer)
    sub:add(E.hello, bits:range(), hello)
    sub:add(E.held, bits:range(), held)
    sub:add(E.newer, bits:range(), newer)
    sub:add(E.run, bits:range(), run)
    if absent then sub:add(E.absent, bits:range(), absent) end
    sub:add(E.loss, bits:range(), loss)
  end)
end

local function dissect_notes(tvb, tree, session_tx)
  each_entry(tvb, function(bits)
    local N = F.note
    local collider, twice, author = bits:varint64(), bits:varint64(), 0
    if twice:higher() >= 4 then refuse("an object of more than 32 bits") end
    if twice:higher() >= 2 then
      author = bits:varint32()
      if author == 0 then refuse("a zero that is sent") end
    end
    local collidee, contact = UInt64.new(twice:rshift(1):lower(), author), bits:time(session_tx)
    local sub = tree:add(bits:range(), string.format("Contact of %s with %s", collider, collidee))
    sub:add(N.collider, bits:range(), collider)
    sub:add(N.collidee, bits:range(), collidee)
    sub:add(N.contact, bits:range(), contact)
    sub:add(N.held, bits:range(), twice:lower() % 2 == 1)
  end)
end

local function dissect_viewpoint(tvb, tree, range)
  local V, position, orientation, angles = F.view, { tree = tree }, { tree = tree }, {}
  each_field_of(tvb, tree, {
    uint64(tree, V.object), components(XYZ, position), components(WXYZ, orientation),
    double(angles, "fov"), double(angles, "aspect"),
  })
  local p = check_vector({ position[1] or 0, position[2] or 0, position[3] or 0 })
  local q = check_unit({ orientation[1] or 0, orientation[2] or 0, orientation[3] or 0, orientation[4] or 0 },
    "an orientation")
  local fov, aspect = angles.fov or 0, angles.aspect or 0
  if not (fov > 0 and fov < math.pi and aspect > 0 and aspect <= 1e12) then refuse("a view that nobody has") end
  add_vector(tree, V.position, range, p)
  add_vector(tree, V.orientation, range, q)
  tree:add(V.fov, range, fov)
  tree:add(V.aspect, range, aspect)
end

local function dissect_introduction(tvb, tree)
  local I, named = F.intro, false
  each_field_of(tvb, tree, {
    { bytes = function(name, range)
      local text = name and name:range():raw() or ""
      if #text == 0 or #text > 64 or text:find("[^!-~]") or text:find("/", 1, true) then refuse("no name") end
      named = true
      tree:add(I.name, range, text)
    end },
    { fixed64 = function(_, range) tree:add_le(I.world, range) end },
    { fixed64 = function(_, range) tree:add_le(I.boot, range) end },
    { bytes = function(list)
      local object = UInt64.new(0)
      each_entry(list, function(bits)
        local more = bits:varint64()
        object = object + more
        if object < more then refuse("an object of more than 64 bits") end
        tree:add(I.enslaved, bits:range(), object)
      end)
    end },
    time64(tree, I.start), time64(tree, I.zero),
    message(tree, "Viewpoint", dissect_viewpoint),
    { fixed64 = function(_, range) tree:add_le(I.as_founder, range) end },
    { fixed64 = function(_, range) tree:add_le(I.line, range) end },
    { varint = function(value, range) tree:add(I.has_edits, range, value ~= UInt64.new(0)) end },
  })
  if not named then refuse("no name") end
end

-- Reads microseconds up to a limit.
local function microseconds(tree, f, most, keep)
  return { varint = function(value, range)
    if value > most then refuse("a clock so wrong that it is none") end
    tree:add(f, range, value)
    if keep then keep() end
  end }
end

local CLOCK_ERROR_MOST = UInt64.new(1152921504606847 % TWO32, math.floor(1152921504606847 / TWO32))  -- 2^60 ns
local OS_ERROR_MOST = UInt64.new(16000000)

-- ---- logs of operations --------------------------------------------------------------------------------------------

local AUTHOR_MOST, LOG_MOST = 2 ^ 31 - 1, UInt64.new(0, 2 ^ 8)  -- 2^40 bytes

local function take_author(bits)
  local author = bits:varint32()
  if author == 0 or author > AUTHOR_MOST then refuse("an author that there is not") end
  return author
end
-- Reads the first byte of a range, and its size.
local function take_extent(bits)
  local from, size = bits:varint64(), bits:varint64()
  if size == UInt64.new(0) or from > LOG_MOST or size > LOG_MOST - from then refuse("a range that is none") end
  return from, size
end
local function add_extent(tree, fields, range, author, from, size)
  tree:add(fields.author, range, author)
  tree:add(fields.from, range, from)
  tree:add(fields.bytes, range, size)
end
-- Calls `take` for each entry. Returns their number.
local function limited(tvb, most, take)
  local count = 0
  each_entry(tvb, function(bits)
    count = count + 1
    if count > most then refuse("more than " .. most .. " entries") end
    take(bits)
  end)
  return count
end

local function dissect_logs(tvb, tree)
  local last = 0
  limited(tvb, 128, function(bits)
    local more, length = bits:varint32(), bits:varint64()
    if more == 0 or more > AUTHOR_MOST - last then refuse("authors that do not ascend") end
    if length == UInt64.new(0) or length > LOG_MOST then refuse("a length that no log has") end
    last = last + more
    local sub = tree:add(bits:range(), "Log of author " .. last)
    sub:add(F.log.author, bits:range(), last)
    sub:add(F.log.bytes, bits:range(), length)
  end)
end

-- ---- operations ---------------------------------------------------------------------------------------------------

-- A Tape takes what is to be added to a tree, so that nothing is shown of what turns out to be refused.
local Tape = {}
Tape.__index = Tape
function Tape.new() return setmetatable({}, Tape) end
for _, method in ipairs({ "add", "add_le", "add_packet_field", "append_text" }) do
  Tape[method] = function(self, ...)
    local child = Tape.new()
    self[#self + 1] = { method, child, table.pack(...) }
    return child
  end
end
function Tape:play(tree)
  for _, entry in ipairs(self) do
    local method, child, arguments = table.unpack(entry)
    child:play(tree[method](tree, table.unpack(arguments, 1, arguments.n)))
  end
end

-- A Tvb of bytes that no packet has in one piece.
local function tvb_of(bytes, title) return ByteArray.new(bytes, true):tvb(title) end

-- The handlers of the fields of a message of which the last one that is there counts, as in a oneof of Protobuf. What
-- there is of that one is put into `into`; the pieces of a message are one message.
local function one_of(into, handlers, members)
  for number, wire in pairs(members) do
    handlers[number] = { repeated = true, [wire] = function(value, range)
      if into.number ~= number then into.number, into.values = number, {} end
      into.values[#into.values + 1] = value
      into.range = range
    end }
  end
  return handlers
end
local function message_of(values)
  if #values == 1 then return values[1] end
  local bytes = ""
  for _, value in ipairs(values) do bytes = bytes .. (value and value:range():raw() or "") end
  return #bytes > 0 and tvb_of(bytes, "A message in pieces") or false
end

-- The fields of operations. Each is also put into `got`, by a name where one is given, for checks of what is absent.
local function id_of_author(tree, f)
  return { varint = function(value, range)
    if value:higher() > AUTHOR_MOST then refuse("operation_id") end
    tree:add(f, range, value)
  end }
end
local function flag(tree, f, keep)
  return { varint = function(value, range)
    local is = value ~= UInt64.new(0)
    tree:add(f, range, is)
    if keep then keep(is) end
  end }
end
local function peer_or(tree, f, got, name)
  return uint32(tree, f, function(value) got[name] = value end)
end
local function vrml(tree, f, got, name)
  return { bytes = function(text)
    if not text or text:range():raw():find("\0", 1, true) then refuse("operation_text") end
    add_text(tree, f, text:range())
    if got then got[name] = true end
  end }
end
local function any_bytes(tree, f)
  return { bytes = function(bytes, range)
    if not bytes then return tree:add(f, range(0, 0)) end
    local raw = bytes:range():raw()
    local item = tree:add(f, bytes:range())
    if not raw:find("[%c\127]") then item:append_text(' ("' .. raw .. '")') end
  end }
end
local function stamp(tree, f, got, name)
  return { fixed64 = function(_, range)
    local t = range:le_int64()
    if t > TIME_MOST or t < -TIME_MOST then refuse("operation_stamp") end
    tree:add(f, range, t)
    if got then got[name] = t end
  end }
end
local function floats(into)
  local function keep(range) into[#into + 1] = { range:le_float(), range } end
  return { repeated = true, fixed32 = function(_, range) keep(range) end, bytes = function(tvb)
    if not tvb then return end
    if tvb:len() % 4 ~= 0 then refuse("not_an_operation") end
    for at = 0, tvb:len() - 4, 4 do keep(tvb(at, 4)) end
  end }
end
local function need(condition, why)
  if not condition then refuse(why) end
end
local function add_placement(tree, translation, rotation)
  need(#translation == 3 and #rotation == 4, "operation_placement")
  local O = F.operation
  local fields = { O.axis[1], O.axis[2], O.axis[3], O.angle }
  for i, each in ipairs(translation) do
    need(is_finite(each[1]), "operation_placement")
    tree:add(O.translation[i], each[2], each[1])
  end
  for i, each in ipairs(rotation) do
    need(is_finite(each[1]), "operation_placement")
    tree:add(fields[i], each[2], each[1])
  end
end

-- What operations do, by the numbers of their fields: a name, and a function that adds the fields of their message.
local BODIES = {
  [8] = { "add_nodes", function(tvb, tree, O)
    local got = {}
    each_field_of(tvb, tree, {
      id_of_author(tree, O.parent), id_of_author(tree, O.before), vrml(tree, O.text, got, "text"),
      uint32(tree, O.first_object), uint32(tree, O.first_node),
      { repeated = true, bytes = function(name, range)
        local has, sub = {}, tree:add(range, "Name")
        each_field_of(name, sub, { vrml(sub, O.path, has, "path"), id_of_author(sub, O.named) })
        need(has.path, "operation_text")
      end },
    })
    need(got.text, "operation_text")
  end },
  [9] = { "remove_object", function(tvb, tree, O) each_field_of(tvb, tree, { id_of_author(tree, O.object) }) end },
  [10] = { "remove_node", function(tvb, tree, O) each_field_of(tvb, tree, { id_of_author(tree, O.node) }) end },
  [11] = { "move_object", function(tvb, tree, O)
    each_field_of(tvb, tree,
      { id_of_author(tree, O.object), id_of_author(tree, O.parent), id_of_author(tree, O.before) })
  end },
  [12] = { "set_field", function(tvb, tree, O)
    local got = {}
    each_field_of(tvb, tree, {
      id_of_author(tree, O.node), vrml(tree, O.field, got, "field"), vrml(tree, O.value, got, "value"),
      uint32(tree, O.first_node),
    })
    need(got.field and got.value, "operation_text")
  end },
  [13] = { "change_route", function(tvb, tree, O)
    local got = {}
    each_field_of(tvb, tree, {
      id_of_author(tree, O.from_node), id_of_author(tree, O.to_node), vrml(tree, O.event_out, got, "out"),
      vrml(tree, O.event_in, got, "into"), flag(tree, O.removes),
    })
    need(got.out and got.into, "operation_text")
  end },
  [14] = { "give_object", function(tvb, tree, O)
    local translation, rotation = {}, {}
    each_field_of(tvb, tree, {
      id_of_author(tree, O.object), uint32(tree, O.owner), uint32(tree, O.owner_before), floats(translation),
      floats(rotation),
    })
    if #translation + #rotation > 0 then add_placement(tree, translation, rotation) end
  end },
  [15] = { "request_object", function(tvb, tree, O)
    local got = { owner = 0, by = 0 }
    each_field_of(tvb, tree, {
      id_of_author(tree, O.object), peer_or(tree, O.owner, got, "owner"), peer_or(tree, O.by, got, "by"),
    })
    need(got.owner ~= 0 and got.by ~= 0, "operation_id")
  end },
  [16] = { "refuse_request", function(tvb, tree, O)
    local got = { author = 0, number = 0 }
    each_field_of(tvb, tree, {
      peer_or(tree, O.request_author, got, "author"), peer_or(tree, O.request_number, got, "number"),
      vrml(tree, O.reason, got, "reason"),
    })
    need(got.author ~= 0 and got.author <= AUTHOR_MOST and got.number ~= 0, "operation_id")
    need(got.reason, "operation_text")
  end },
  [17] = { "set_data", function(tvb, tree, O)
    each_field_of(tvb, tree, { id_of_author(tree, O.node), any_bytes(tree, O.key), any_bytes(tree, O.data) })
  end },
  [18] = { "send_message", function(tvb, tree, O)
    local got = { by = 0 }
    each_field_of(tvb, tree,
      { peer_or(tree, O.by, got, "by"), any_bytes(tree, O.topic), any_bytes(tree, O.message) })
    need(got.by ~= 0, "operation_id")
  end },
  [19] = { "undo_operation", function(tvb, tree, O)
    local got = { number = 0 }
    each_field_of(tvb, tree, {
      peer_or(tree, O.undone_number, got, "number"), stamp(tree, O.undone_stamp), flag(tree, O.redoes),
    })
    need(got.number ~= 0, "operation_id")
  end },
  [20] = { "place_object", function(tvb, tree, O)
    local got, translation, rotation = { owner = 0 }, {}, {}
    each_field_of(tvb, tree, {
      id_of_author(tree, O.object), peer_or(tree, O.owner, got, "owner"), stamp(tree, O.at), floats(translation),
      floats(rotation),
    })
    need(got.owner ~= 0, "operation_id")
    add_placement(tree, translation, rotation)
  end },
  [21] = { "lock_object", function(tvb, tree, O)
    each_field_of(tvb, tree, { id_of_author(tree, O.object), flag(tree, O.unlocks) })
  end },
}

local KNOWS_MOST = 512

local function add_knows(tree, authors, numbers_of)
  need(#authors == #numbers_of and #authors <= KNOWS_MOST, "operation_id")
  local last, K = 0, F.operation.knows
  for i, each in ipairs(authors) do
    local more, number = each[1]:lower(), numbers_of[i][1]:lower()
    need(more ~= 0 and more <= AUTHOR_MOST - last and number ~= 0, "operation_id")
    last = last + more
    tree:add(K.author, each[2], last)
    tree:add(K.number, numbers_of[i][2], number)
  end
end

-- Adds the fields of a message `Operation` to a tape. Returns the operation's number, stamp and kind.
local function read_operation(tvb, tape)
  local O, got, authors, numbers_of, body, bodies = F.operation, { number = 0, stamp = Int64.new(0) }, {}, {}, {}, {}
  for number, _ in pairs(BODIES) do bodies[number] = "bytes" end
  each_field_of(tvb, tape, one_of(body, {
    peer_or(tape, O.number, got, "number"), stamp(tape, O.stamp, got, "stamp"),
    [3] = any_bytes(tape, O.author_key), [5] = numbers(authors), [6] = numbers(numbers_of),
    [100] = any_bytes(tape, O.signature),
  }, bodies))
  need(got.number ~= 0, "operation_number")
  need(body.number, "operation_kind")
  local kind, dissect = table.unpack(BODIES[body.number])
  tape:add(O.kind, body.range, kind)
  dissect(message_of(body.values), tape, O)
  add_knows(tape, authors, numbers_of)
  return got.number, got.stamp, kind
end

-- Decodes the size of the operation that these bytes begin with. Returns it, and how many bytes state it; nothing where
-- they end within it.
local OPERATION_MOST = 2 ^ 20
local function size_of_operation(bytes)
  local size = 0
  for i = 1, 3 do
    local byte = bytes:byte(i)
    if not byte then return nil end
    size = size + byte % 128 * 2 ^ (7 * (i - 1))
    if byte < 128 then
      need(i == 1 or byte ~= 0, "operation_size")
      need(size <= OPERATION_MOST, "operation_too_large")
      return size, i
    end
  end
  refuse("operation_too_large")
end

-- ---- logs of operations, put together -----------------------------------------------------------------------------

-- Parts of a log come in any order, again, and cut anywhere. Of each log there are the `pieces` that have come, which do
-- not overlap; the `runs` that they make, with the place up to which each is `read`; and the `operations` that are whole.
-- All three ascend.

-- The index of the first element of an ascending list whose `key` is above a value.
local function first_above(list, key, value)
  local low, high = 1, #list + 1
  while low < high do
    local middle = math.floor((low + high) / 2)
    if list[middle][key] > value then high = middle else low = middle + 1 end
  end
  return low
end

-- Logs of different sessions may have the same author. A unicast datagram does not say of which one it is.
local function log_of(pinfo, author)
  local group = tostring(pinfo.dst)
  local is_group = group:find("^[fF][fF]") or (tonumber(group:match("^(%d+)%.")) or 0) >= 224
  local key = (is_group and group .. " " .. pinfo.dst_port or "") .. " " .. author
  if not logs[key] then logs[key] = { pieces = {}, runs = {}, operations = {} } end
  return logs[key]
end

local function bytes_of(log, from, to)
  local bytes, i = {}, first_above(log.pieces, "to", from)
  while from < to do
    local piece = log.pieces[i]
    bytes[#bytes + 1] = piece.bytes:sub(from - piece.from + 1, to - piece.from)
    from, i = piece.to, i + 1
  end
  return table.concat(bytes)
end

-- Calls held(piece, from, to) and missing(from, to) for what a log has of a range, and has not.
local function each_extent(log, from, to, held, missing)
  while from < to do
    local piece = log.pieces[first_above(log.pieces, "to", from)]
    local is_held = piece and piece.from <= from
    local stop = math.min(to, is_held and piece.to or piece and piece.from or to)
    if is_held then held(piece, from, stop) else missing(from, stop) end
    from = stop
  end
end

local function differs(log, from, bytes)
  local found = false
  each_extent(log, from, from + #bytes, function(piece, a, b)
    found = found or piece.bytes:sub(a - piece.from + 1, b - piece.from) ~= bytes:sub(a - from + 1, b - from)
  end, function() end)
  return found
end

-- Recognises the beginning of an operation: its size, its number, its stamp. A capture may begin later than a log.
local function begins_operation(bytes)
  local good, size = attempt(function() return (size_of_operation(bytes)) end)
  if not good or not size or size < 12 then return false end
  local at = size >= 2 ^ 14 and 4 or size >= 128 and 3 or 2
  if bytes:byte(at) ~= 0x08 then return false end
  repeat at = at + 1 until (bytes:byte(at) or 0) < 128
  return bytes:byte(at + 1) == 0x11 and #bytes > at + 9
end

-- Keeps a part. Returns the run that it is in.
local function keep_part(log, from, bytes)
  local run = { from = from, to = from + #bytes }
  each_extent(log, run.from, run.to, function() end, function(a, b)
    local piece = { from = a, to = b, bytes = bytes:sub(a - from + 1, b - from) }
    table.insert(log.pieces, first_above(log.pieces, "to", a), piece)
  end)
  local i = first_above(log.runs, "to", from - 1)
  while log.runs[i] and log.runs[i].from <= run.to do
    local other = table.remove(log.runs, i)
    run.from, run.to = math.min(run.from, other.from), math.max(run.to, other.to)
    if not run.read then run.read, run.last, run.is_assumed = other.read, other.last, other.is_assumed end
  end
  table.insert(log.runs, i, run)
  if run.from == 0 and (not run.read or run.is_assumed) then
    run.read, run.last, run.is_assumed = 0, { number = 0 }, false
  elseif not run.read and begins_operation(bytes) then
    run.read, run.last, run.is_assumed = from, nil, true
  end
  return run
end

-- Returns where the operation at the place up to which a run is read ends, and where its message begins; nothing where it
-- is not whole.
local function next_operation(log, run)
  local size, head = size_of_operation(bytes_of(log, run.read, math.min(run.read + 3, run.to)))
  if not size or run.read + head + size > run.to then return nil end
  return run.read + head + size, run.read + head
end

-- The bytes of an operation from where its message begins, in the packet's own bytes where these have them all.
local function message_at(log, part, operation)
  if operation.begin == operation.to then return false end
  if operation.begin >= part.from and operation.to <= part.to then
    return part.tvb(operation.begin - part.from, operation.to - operation.begin):tvb()
  end
  return tvb_of(bytes_of(log, operation.begin, operation.to), "Operation in several parts")
end

local function show_operation(tree, part, operation, tape)
  local O = F.operation
  local first, last = math.max(operation.from, part.from), math.min(operation.to, part.to)
  local range = first < last and part.tvb(first - part.from, last - first) or part.tvb()
  local sub = tree:add(O.whole, range)
  sub:append_text(string.format(" %d of author %d: %s", operation.number, part.author, operation.kind))
  sub:add(O.author, range, part.author)
  sub:add(O.from, range, UInt64(operation.from))
  sub:add(O.bytes, range, operation.to - operation.from)
  if operation.is_repeated then sub:add(O.repeated, range, true) end
  tape:play(sub)
end

-- Reads on in a run, and shows what has become whole. Returns the operations; the last one of them may be unreadable.
local function read_on(tree, log, part, run)
  local found = {}
  while run.read and run.read < run.to do
    local operation = { from = run.read }
    local tape = Tape.new()
    local good, why = attempt(function()
      operation.to, operation.begin = next_operation(log, run)
      if not operation.to then return end
      operation.number, operation.stamp, operation.kind = read_operation(message_at(log, part, operation), tape)
      local last = run.last
      need(not last or operation.number == last.number + 1, "operation_number")
      need(not last or last.number == 0 or operation.stamp > last.stamp, "operation_stamp")
    end)
    if good and not operation.to then break end
    if not good then
      if run.is_assumed then run.read = nil else log.is_broken = true end
      found[#found + 1] = { why = why }
      tree:add_proto_expert_info(unreadable, "Malformed: " .. why)
      break
    end
    run.read, run.last = operation.to, operation
    local i = first_above(log.operations, "to", operation.to)
    local before = log.operations[i - 1]
    if not before or before.to < operation.to then
      table.insert(log.operations, i, operation)
      show_operation(tree, part, operation, tape)
      found[#found + 1] = operation
    end
  end
  return found
end

local function show_again(tree, log, part, operation)
  local tape = Tape.new()
  read_operation(message_at(log, part, operation), tape)
  show_operation(tree, part, operation, tape)
end

-- Shows the operations whose last byte a part brings, again or for the first time. Returns them. A part that differs from
-- what has come before it is not taken.
local function dissect_part(tree, part, pinfo)
  local key = pinfo.number .. " " .. part.index
  local log = log_of(pinfo, part.author)
  if pinfo.visited and shown[key] then
    for _, operation in ipairs(shown[key]) do
      if operation.why then
        tree:add_proto_expert_info(operation.mark, "Malformed: " .. operation.why)
      else
        show_again(tree, log, part, operation)
      end
    end
    return shown[key]
  end
  local bytes, found = part.tvb:range():raw(), {}
  shown[key] = found
  if not log.is_broken and differs(log, part.from, bytes) then
    found[1] = { why = "forked_log", mark = forked }
    tree:add_proto_expert_info(forked, "Malformed: forked_log")
    return found
  end
  local i = first_above(log.operations, "to", part.from)
  while log.operations[i] and log.operations[i].to <= part.to do
    local known = log.operations[i]
    local again = { is_repeated = true }
    for name, value in pairs(known) do again[name] = again[name] or value end
    show_again(tree, log, part, again)
    found[#found + 1] = again
    i = i + 1
  end
  local whole = log.is_broken and {} or read_on(tree, log, part, keep_part(log, part.from, bytes))
  for _, operation in ipairs(whole) do
    if operation.why then operation.mark = unreadable end
    found[#found + 1] = operation
  end
  return found
end

-- Returns how many parts there are, and the kinds of their operations.
local function dissect_operations(tvb, tree, pinfo)
  local kinds, index = {}, 0
  local count = limited(tvb, 64, function(bits)
    local author = take_author(bits)
    local from, size = take_extent(bits)
    local at = bits.bit / 8
    if size > UInt64.new(tvb:len() - at) then refuse("a part is cut short") end
    bits.bit = bits.bit + 8 * size:lower()
    local sub = tree:add(bits:range(), "Part of the log of author " .. author)
    add_extent(sub, F.operations, bits:range(), author, from, size)
    index = index + 1
    local first = from:tonumber()
    local part = { author = author, from = first, to = first + size:lower(), index = index, tvb = tvb(at, size:lower()):tvb() }
    for _, operation in ipairs(dissect_part(sub, part, pinfo)) do
      kinds[#kinds + 1] = operation.kind
      sub:append_text(operation.kind and ", " .. operation.kind or "")
    end
  end)
  return count, kinds
end

local function dissect_requests(tvb, tree)
  return limited(tvb, 32, function(bits)
    local author = take_author(bits)
    local from, size = take_extent(bits)
    add_extent(tree:add(bits:range(), "Of the log of author " .. author), F.asked, bits:range(), author, from, size)
  end)
end

local function dissect_hello(tvb, tree)
  local H, notes, introductions = F.hello, false, {}
  local os_minus_session, os_range, os_known = Int64.new(0), nil, false
  local session_tx = Int64.new(0)
  each_field_of(tvb, tree, {
    time64(tree, H.tx, function(t) session_tx = t end),
    uint32(tree, H.sessions),
    uint32(tree, H.latency, function(ms)
      if ms > 2000 then refuse("a latency beyond 2 s") end
    end),
    { bytes = function(list) dissect_echoes(list, tree) end },
    { bytes = function(list) notes = list end },  -- decoded after the session time, which may follow it
    { repeated = true, bytes = function(...) introductions[#introductions + 1] = { ... } end },
    microseconds(tree, H.clock_error, CLOCK_ERROR_MOST),
    { varint = function(value, range) os_minus_session, os_range = unzigzag(value), range end },
    microseconds(tree, H.os_error, OS_ERROR_MOST, function() os_known = true end),
    { fixed64 = function(_, range) tree:add_le(H.scene_digest, range) end },
    { bytes = function(list) dissect_logs(list, tree) end },
  })
  if os_known and os_range then tree:add(H.os_minus_session, os_range, check_time(os_minus_session)) end
  dissect_notes(notes, tree, session_tx)
  for _, i in ipairs(introductions) do dissect_introduction(i[1], tree:add(i[2], "Introduction")) end
  return #introductions > 0
end

-- ---- decisions, regions -------------------------------------------------------------------------------------------

-- Reads four binary64 numbers; a mask says which of them are not zero.
function Bits:quaternion()
  local q, there = { 0, 0, 0, 0 }, {}
  for i = 1, 4 do there[i] = self:get(1) == 1 end
  for i = 1, 4 do
    if there[i] then
      local zero
      q[i], zero = self:double()
      if zero then refuse("a zero that is sent") end
    end
  end
  return q
end

local STATE = { "position", "velocity", "acceleration", "orientation", "spin" }
local AT_REST = {
  position = { 0, 0, 0 }, velocity = { 0, 0, 0 }, acceleration = { 0, 0, 0 }, orientation = { 1, 0, 0, 0 }, spin = { 0, 0, 0 },
}
-- Compares bit by bit: 0 and -0 differ.
local function same_bits(a, b)
  for i = 1, #a do
    if a[i] ~= b[i] or 1 / a[i] ~= 1 / b[i] then return false end
  end
  return true
end
-- Reads a state by its differences from another state.
local function take_state(bits, was)
  local is = {}
  for _, name in ipairs(STATE) do
    is[name] = was[name]
    if bits:get(1) == 1 then
      is[name] = name == "orientation" and bits:quaternion() or bits:exact()
      if same_bits(is[name], was[name]) then refuse("a change that is none") end
    end
    if name == "orientation" then check_unit(is[name], "an orientation") else check_vector(is[name]) end
  end
  if norm(is.spin) > 1e4 then refuse("a spin beyond 10,000 rad/s") end
  return is
end
-- Compares by value: 0 and -0 are equal.
local function same_value(a, b)
  for i = 1, #a do
    if a[i] ~= b[i] then return false end
  end
  return true
end
local function add_state(tree, range, title, state)
  local sub = tree:add(range, title)
  for i, name in ipairs(STATE) do
    if i == 1 or not same_value(state[name], AT_REST[name]) then add_vector(sub, F.state[name], range, state[name]) end
  end
end

-- Reads a free acceleration of an object that rests by its difference from that before.
local function take_free(bits, before)
  if bits:get(1) == 0 then return nil end
  local free = check_vector(bits:exact())
  if same_bits(free, before.acceleration) then refuse("a change that is none") end
  return free
end

local function dissect_decision(tvb, tree, at, pinfo)
  local bits, D = Bits.new(tvb, at), F.decision
  local contact = nearest_time(bits:get(40), pinfo)
  local collider, collidee, rule = bits:varint64(), bits:varint64(), bits:get(4)
  if rule < 1 or rule > 5 then refuse("rule " .. rule) end
  local known = nil
  if bits:get(1) == 1 then
    known = bits:time(contact)
    if known == Int64.new(0) then refuse("a zero that is sent") end
  end
  local normal = check_unit(bits:exact(), "a normal")
  local collider_before = take_state(bits, AT_REST)
  local collider_after = take_state(bits, collider_before)
  local collidee_before = take_state(bits, AT_REST)
  local collidee_after = take_state(bits, collidee_before)
  local rests, collider_free, collidee_free = bits:get(1) == 1, nil, nil
  if rests then
    collider_free = take_free(bits, collider_before)
    collidee_free = take_free(bits, collidee_before)
  end
  bits:pad()

  local range = bits:range()
  local sub = tree:add(range, string.format("Objects %s and %s", collider, collidee))
  if collider ~= UInt64.new(0) then sub:add(D.collider, range, collider) end
  if collidee ~= UInt64.new(0) then sub:add(D.collidee, range, collidee) end
  sub:add(D.contact, range, contact)
  add_vector(sub, D.normal, range, normal)
  add_state(sub, range, "Collider before", collider_before)
  add_state(sub, range, "Collidee before", collidee_before)
  add_state(sub, range, "Collider after", collider_after)
  add_state(sub, range, "Collidee after", collidee_after)
  sub:add(D.rule, range, rule)
  if known then sub:add(D.known, range, known) end
  if rests then sub:add(D.rests, range, true) end
  if collider_free then add_vector(sub, D.collider_free, range, collider_free) end
  if collidee_free then add_vector(sub, D.collidee_free, range, collidee_free) end
  return at + range:len()
end

local function dissect_decisions(tvb, tree, pinfo)
  local at, count = 0, 0
  while tvb and at < tvb:len() do
    at = dissect_decision(tvb, tree, at, pinfo)
    count = count + 1
  end
  return count
end

local function dissect_entered(list, latest, tree)
  if #list % 2 ~= 0 or #list > 1024 then refuse("regions entered that are no pairs") end
  for i = 1, #list, 2 do
    tree:add(F.entered.region, list[i][2], list[i][1]:lower())
    local since = latest - Int64.new(list[i + 1][1]:lower(), 0) * Int64.new(1000000, 0)
    tree:add(F.entered.since, list[i + 1][2], check_time(since))
  end
end

local function dissect_gone(list, tree)
  if #list % 3 ~= 0 or #list > 1024 then refuse("objects gone that are no threes") end
  for i = 1, #list, 3 do
    local sequence, to = list[i + 1][1], list[i + 2][1]
    if sequence == UInt64.new(0) then refuse("sequence 0") end
    if sequence:higher() ~= 0 or to:higher() ~= 0 then refuse("a number of more than 32 bits") end
    tree:add(F.gone.object, list[i][2], list[i][1])
    tree:add(F.gone.sequence, list[i + 1][2], sequence:lower())
    tree:add(F.gone.to, list[i + 2][2], to:lower())
  end
end

local function dissect_identity(tvb, tree)
  local I = F.identity
  each_field_of(tvb, tree, {
    { fixed64 = function(_, range) tree:add_le(I.asker, range) end },
    { fixed64 = function(_, range) tree:add_le(I.world, range) end },
    { varint = function(v, range) tree:add(I.answers, range, v ~= UInt64.new(0)) end },
  })
end

-- ---- a datagram ---------------------------------------------------------------------------------------------------

local function count_of(n, one) return n .. " " .. one .. (n == 1 and "" or "s") end

local function dissect_datagram(tvb, tree, pinfo, whole)
  if tvb:len() > MOST_BYTES then refuse("more than " .. MOST_BYTES .. " bytes") end
  local version, sender, number, boot_low, introduced = 0, 0, 0, nil, false
  local decisions, updates, hello, leaving, latest = 0, 0, false, false, Int64.new(0)
  local entered, gone, kinds, states, parts, asked, log_parts = {}, {}, {}, 0, 0, 0, nil
  local function is(kind, range)
    kinds[#kinds + 1] = kind
    tree:add(F.kind, range, kind)
  end
  local function about_ghosts(kind, dissect)
    return { bytes = function(inner, range)
      if not inner then return end
      dissect(inner, tree:add(range, (kind:gsub("^g", "G"))), pinfo)
      is(kind, range)
    end }
  end
  each_field(tvb, tree, {
    uint32(tree, F.version, function(v)
      version = v
      if v ~= VERSION then refuse("version " .. v .. ", and this dissector knows " .. VERSION) end
    end),
    uint32(tree, F.sender, function(v) sender = v end),
    uint32(tree, F.number, function(v) number = v end),
    { varint = function(v, range) boot_low = { v:lower() % 2 ^ 21, range } end },
    { repeated = true, bytes = function(inner, range)
      hello = true
      introduced = dissect_hello(inner, tree:add(range, "Hello")) or introduced
      is(introduced and "hello, introduction" or "hello", range)
    end },
    { bytes = function(inner, range) decisions = dissect_decisions(inner, tree:add(range, "Decisions"), pinfo) end },
    { varint = function(v, range)
      leaving = v ~= UInt64.new(0)
      tree:add(F.leaving, range, leaving)
    end },
    { bytes = function(inner, range) updates = dissect_records(inner, tree:add(range, "Records"), pinfo) end },
    numbers(entered),
    time64(tree, F.entered.latest, function(t) latest = t end),
    numbers(gone),
    message(tree, "Question of identity", function(inner, sub, range)
      dissect_identity(inner, sub)
      is("question of identity", range)
    end),
    { bytes = function(inner, range) states = dissect_scene(inner, tree:add(range, "Scene objects")) end },
    { bytes = function(inner, range) log_parts = { inner, tree:add(range, "Operations") } end },
    { bytes = function(inner, range) asked = dissect_requests(inner, tree:add(range, "Operations asked for")) end },
    { varint = function(v, range) tree:add(F.nearby, range, v ~= UInt64.new(0)) end },
    uint32(tree, F.next_hello, function(v)
      if v > NEXT_HELLO_MOST_MS then refuse("a next hello later than in a day") end
    end),
    about_ghosts("ghost digest", dissect_ghost_digest),
    about_ghosts("ghost question", dissect_ghost_question),
    about_ghosts("ghost answer", dissect_ghost_answer),
    about_ghosts("ghost reports", dissect_ghost_reports),
  })
  if version ~= VERSION then refuse("version " .. version .. ", and this dissector knows " .. VERSION) end
  if sender == 0 then refuse("sender 0") end
  if boot_low and not introduced then tree:add(F.boot_low, boot_low[2], boot_low[1]) end
  if #entered > 0 then dissect_entered(entered, latest, tree) end
  if #gone > 0 then dissect_gone(gone, tree) end
  local operations = {}
  if log_parts then parts, operations = dissect_operations(log_parts[1], log_parts[2], pinfo) end
  if updates > 0 then is(count_of(updates, "update"), whole) end
  if decisions > 0 then is(count_of(decisions, "decision"), whole) end
  if states > 0 then is(count_of(states, "scene object"), whole) end
  if parts > 0 then
    is(count_of(parts, "part") .. " of logs" .. (#operations > 0 and ": " .. table.concat(operations, ", ") or ""), whole)
  end
  if asked > 0 then is(count_of(asked, "range") .. " asked for", whole) end
  if #entered > 0 then is(count_of(#entered / 2, "region") .. " entered", whole) end
  if #gone > 0 then is(count_of(#gone / 3, "object") .. " gone", whole) end
  if leaving then is("leaving", whole) end
  if #kinds == 0 then is("nothing", whole) end
  pinfo.cols.info = string.format("peer %d, number %d: %s", sender, number, table.concat(kinds, ", "))
end

local function dissect_greeting(tvb, tree, pinfo)
  local G = F.greeting
  if tvb:len() < 20 then refuse("a greeting is cut short") end
  local flags, regions, peers = tvb(17, 1):uint(), tvb(18, 1):uint(), tvb(19, 1):uint()
  local linked, detached = flags % 8 >= 4, flags >= 8
  local wrong = flags > 15 or (regions > 200 and regions ~= 255) or peers > 20
  if wrong or (linked and peers > 0) or (detached and not linked) then refuse("a greeting that nobody sends") end
  local all = regions == 255
  if all then regions = 0 end
  local note, left = 20 + 4 * regions, tvb:len() - 20 - 4 * regions
  local relays = linked and left >= 33 and tvb(note + 32, 1):uint()
  if linked then
    if not relays or relays > 16 or left ~= 33 + 4 * relays then refuse("a note of the wrong length") end
    left = 0
  end
  local address = left == 6 * peers and 4 or 16
  if left ~= (2 + address) * peers then refuse("a greeting of the wrong length") end
  tree:add(F.kind, tvb(0, 1), "greeting")
  tree:add(G.instance, tvb(1, 4))
  tree:add(G.number, tvb(5, 6), tvb(5, 6):uint64())
  tree:add(G.echo, tvb(11, 6), tvb(11, 6):uint64())
  tree:add(G.reply, tvb(17, 1), flags % 2 == 1)
  tree:add(G.leaving, tvb(17, 1), flags % 4 >= 2)
  tree:add(G.all, tvb(18, 1), all)
  local last = -1
  for i = 0, regions - 1 do
    local range = tvb(20 + 4 * i, 4)
    if range:uint() <= last then refuse("regions that do not ascend") end
    last = range:uint()
    tree:add(G.region, range)
  end
  for i = 0, peers - 1 do
    local range = tvb(20 + 4 * regions + (2 + address) * i, 2 + address)
    local host = address == 4 and tostring(range(2, 4):ipv4()) or "[" .. tostring(range(2, 16):ipv6()) .. "]"
    tree:add(G.peer, range, host .. ":" .. range(0, 2):uint())
  end
  if linked then
    tree:add(G.detached, tvb(17, 1), detached)
    tree:add(G.sent_at, tvb(note, 8))
    tree:add(G.echoed, tvb(note + 8, 8))
    tree:add(G.held, tvb(note + 16, 4))
    tree:add(G.datagrams_out, tvb(note + 20, 4))
    tree:add(G.datagrams_in, tvb(note + 24, 4))
    tree:add(G.offset, tvb(note + 28, 4))
    for i = 0, relays - 1 do tree:add(G.relay, tvb(note + 33 + 4 * i, 4)) end
  end
  local of = not linked and "" or relays > 0 and " of a relay" or " to a relay"
  pinfo.cols.info = "greeting" .. of .. (flags % 4 >= 2 and ", leaving" or "")
end

-- ---- sealed ------------------------------------------------------------------------------------------------------

-- What can be read without the key: peerd record --opened writes datagrams as they were before they were sealed.
local function dissect_sealed(tvb, tree, pinfo)
  local first = tvb(0, 1):uint()
  local epoch = first % 32
  local mark = first - epoch
  local kinds = {[SEALED_MARK] = {"sealed", 24}, [SIGNED_MARK] = {"sealed and signed", 88},
                 [ANNOUNCEMENT_MARK] = {"announcement", 218}, [ROSTER_MARK] = {"part of a roster", 49}}
  local kind, least = kinds[mark][1], kinds[mark][2]
  if tvb:len() < least then refuse("a sealed datagram is cut short") end
  tree:add(F.kind, tvb(0, 1), kind)
  tree:add(F.seal.epoch, tvb(0, 1), epoch)
  if mark == ROSTER_MARK then
    pinfo.cols.info = "part of a roster, for epoch " .. epoch
    return
  end
  tree:add_le(F.seal.sender, tvb(1, 4))
  local sender = tvb(1, 4):le_uint()
  if mark == ANNOUNCEMENT_MARK then
    pinfo.cols.info = "peer " .. sender .. " announces its boot"
  else
    tree:add_le(F.seal.counter, tvb(5, 3))
    pinfo.cols.info = string.format("%s by peer %d, counter %d", kind, sender, tvb(5, 3):le_uint())
  end
end

local function dissect_sealed_greeting(tvb, tree, pinfo)
  if tvb:len() < 41 then refuse("a sealed greeting is cut short") end
  tree:add(F.kind, tvb(0, 1), "sealed greeting")
  pinfo.cols.info = "greeting, sealed"
end

-- ---- who is here --------------------------------------------------------------------------------------------------

local QUESTION, BEACON, QUESTION_BYTES = "peerd?\1", "peerd!\2", 192

-- Each number has the least significant byte first; a name has its length before it.
local function dissect_beacon(tvb, tree)
  local B, at = F.beacon, #BEACON
  local function take(size)
    if at + size > tvb:len() then refuse("a beacon is cut short") end
    at = at + size
    return tvb(at - size, size)
  end
  tree:add_le(B.protocol, take(4))
  tree:add_le(B.session, take(8))
  local peer = take(4)
  if peer:le_uint() == 0 then refuse("peer 0") end
  tree:add_le(B.peer, peer)
  tree:add_le(B.incarnation, take(8))
  local port = take(2)
  tree:add_le(B.port, port)
  if port:le_uint() ~= 0 then snapshot_ports[port:le_uint()] = true end
  local names = {}
  for i, f in ipairs({ B.world, B.name }) do
    local size = take(1):uint()
    if size > 0 then
      add_text(tree, f, take(size))
      names[i] = tvb(at - size, size):string(ENC_UTF_8)
    else
      tree:add(f, tvb(at - 1, 1), "")
      names[i] = ""
    end
  end
  tree:add(B.sealed, take(1))
  if at ~= tvb:len() then refuse("something follows a beacon") end
  return string.format("peer %d, %s, of %s is here", peer:le_uint(), names[2], names[1])
end

local function dissect_discovery(tvb, tree, pinfo)
  local magic = tvb:len() >= #BEACON and tvb(0, #BEACON):raw()
  if magic == QUESTION then
    if tvb:len() < QUESTION_BYTES then refuse("a question that is shorter than its answer") end
    tree:add(F.kind, tvb(), "question")
    pinfo.cols.info = "who is here?"
  elseif magic == BEACON then
    tree:add(F.kind, tvb(), "beacon")
    pinfo.cols.info = dissect_beacon(tvb, tree)
  else
    refuse("no question and no beacon")
  end
end

-- Converts an address to a list of numbers below 2^16; nil for other text.
local function address_words(text)
  local a, b, c, d = text:match("^(%d+)%.(%d+)%.(%d+)%.(%d+)$")
  if a then return { a * 256 + b, c * 256 + d } end
  local head, tail = text:match("^(.-)::(.*)$")
  local function words(part)
    local list = {}
    for word in part:gmatch("%x+") do list[#list + 1] = tonumber(word, 16) end
    return list
  end
  if not head then head, tail = text, "" end
  if not head:find(":") and not text:find("::", 1, true) then return nil end
  local list, last = words(head), words(tail)
  while #list + #last < 8 do list[#list + 1] = 0 end
  for _, word in ipairs(last) do list[#list + 1] = word end
  return #list == 8 and list or nil
end

-- Returns the distance of a group from the first one; nil where it does not follow it.
local function distance(from, group)
  local first, to = address_words(from), address_words(tostring(group))
  if not first or not to or #first ~= #to then return nil end
  local n = #to
  for i = 1, n - 2 do
    if first[i] ~= to[i] then return nil end
  end
  local number = (to[n - 1] - first[n - 1]) * 65536 + to[n] - first[n]
  local most = n == 2 and 0xEFFFFFFF - first[1] * 65536 - first[2] or TWO32 - 1
  return number >= 0 and number <= most and number or nil
end

-- The groups of a world's regions begin at a multiple of this distance.
local WORLD_STEP = 1024

local function region_of(group)
  local from_whole = distance(peerd.prefs.group, group)
  if from_whole == 0 then return 0 end
  if peerd.prefs.regions == "" then return from_whole and from_whole % WORLD_STEP end
  local from_first = distance(peerd.prefs.regions, group)
  return from_first and from_first + 1
end

function peerd.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "peerd"
  local tree = root:add(peerd, tvb())
  local first = tvb:len() > 0 and tvb(0, 1):uint()
  local good = guarded(tree, malformed, function()
    if pinfo.dst_port == DISCOVERY_PORT then return dissect_discovery(tvb, tree, pinfo) end
    if first == GREETING_MARK then return dissect_greeting(tvb, tree, pinfo) end
    if first == SEALED_GREETING_MARK then return dissect_sealed_greeting(tvb, tree, pinfo) end
    local region, datagram = region_of(pinfo.dst), tvb
    if first == REGION_MARK then
      if tvb:len() <= 5 then refuse("no datagram") end
      region, datagram = tvb(1, 4):uint(), tvb(5):tvb()
    elseif first == RELAY_MARK then
      if tvb:len() <= 6 or tvb(5, 1):uint() > 16 then refuse("no datagram of a relay") end
      region, datagram = tvb(1, 4):uint(), tvb(6):tvb()
      tree:add(F.hops, tvb(5, 1))
    end
    if region then
      tree:add(F.region, (first == REGION_MARK or first == RELAY_MARK) and tvb(1, 4) or tvb(0, 0), region)
      tree:append_text(", region " .. region)
    end
    if datagram:len() > 0 and datagram(0, 1):uint() >= SEALED_MARK then return dissect_sealed(datagram, tree, pinfo) end
    dissect_datagram(datagram, tree, pinfo, datagram())
  end)
  if not good then pinfo.cols.info = "malformed" end
  return tvb:len()
end

-- Recognises a datagram of this version by its beginning: version, sender, then a number or another field.
local function looks_like_one(tvb)
  local at = tvb:len() > 5 and tvb(0, 1):uint() == REGION_MARK and 5 or 0
  if tvb:len() > 6 and tvb(0, 1):uint() == RELAY_MARK then at = 6 end
  return tvb:len() >= at + 5 and tvb(at, 3):uint() == 0x080010 + 256 * VERSION
end

DissectorTable.get("udp.port"):add(47474, peerd)
DissectorTable.get("udp.port"):add(DISCOVERY_PORT, peerd)
peerd:register_heuristic("udp", function(tvb, pinfo, root)
  if not looks_like_one(tvb) then return false end
  peerd.dissector(tvb, pinfo, root)
  return true
end)

-- ---- joins: the world by TCP --------------------------------------------------------------------------------------

local join_fields = {}
local function join_field(kind, name, title, ...)
  local f = ProtoField[kind]("peerd_join." .. name, title, ...)
  join_fields[#join_fields + 1] = f
  return f
end
local J = {
  kind = join_field("string", "kind", "Kind"),
  bytes = join_field("uint32", "bytes", "Bytes of the message"),
  session = join_field("uint64", "session", "Session", base.HEX),
  author = join_field("uint32", "range.author", "Author, 0: the archive"),
  from = join_field("uint64", "range.from", "From byte"),
  to = join_field("uint64", "range.to", "To byte"),
  log_author = join_field("uint32", "log.author", "Author"),
  log_bytes = join_field("uint64", "log.bytes", "Bytes of its log"),
  protocol = join_field("uint32", "protocol", "Protocol version"),
  world = join_field("string", "world", "World"),
  settings = join_field("string", "settings", "Settings"),
  genesis = join_field("uint64", "genesis", "World's hash", base.HEX),
  archive_bytes = join_field("uint64", "archive.bytes", "Bytes of the archive"),
  line = join_field("uint64", "line", "Line of descent of its edits", base.HEX),
  archive_digest = join_field("uint64", "archive.digest", "Digest of the archive", base.HEX),
  chunk = join_field("uint32", "chunk.bytes", "Bytes, compressed"),
  unpacked = join_field("uint64", "chunk.unpacked_bytes", "Bytes, unpacked"),
  digest = join_field("uint64", "digest", "Digest", base.HEX),
  refusal = join_field("string", "refusal", "Refusal"),
  request = join_field("framenum", "request_in", "Answers the request in", base.NONE, frametype.REQUEST),
}
joins.fields = join_fields
local bad_join = ProtoExpert.new("peerd_join.malformed", "Malformed", expert.group.MALFORMED, expert.severity.ERROR)
joins.experts = { bad_join }

local REQUEST_MOST, REPLY_MOST, PART_MOST = 2 ^ 20, 2 ^ 21, 2 ^ 15

local function join_logs(tvb, tree)
  local authors, lengths, last = {}, {}, 0
  each_field_of(tvb, tree, { numbers(authors), numbers(lengths) })
  need(#authors == #lengths, "logs without lengths")
  for i, each in ipairs(authors) do
    local author = each[1]:lower()
    need(author > last and author <= AUTHOR_MOST and lengths[i][1] ~= UInt64.new(0), "logs that are not of ascending authors")
    last = author
    tree:add(J.log_author, each[2], author)
    tree:add(J.log_bytes, lengths[i][2], lengths[i][1])
  end
end

local function join_range(tvb, tree)
  local author, from, to = 0, UInt64.new(0), UInt64.new(0)
  each_field_of(tvb, tree, {
    uint32(tree, J.author, function(value) author = value end),
    { varint = function(value, range)
      from = value
      tree:add(J.from, range, value)
    end },
    { varint = function(value, range)
      to = value
      tree:add(J.to, range, value)
    end },
  })
  need(author <= AUTHOR_MOST and from < to and to - from <= UInt64.new(PART_MOST), "no part of a log")
  return author == 0 and string.format("bytes %s to %s of the archive", from, to)
    or string.format("bytes %s to %s of the log of author %d", from, to, author)
end

-- Adds the fields of a request. Returns what it asks for.
local function dissect_join_request(tvb, tree)
  local what = {}
  each_field_of(tvb, tree, one_of(what, { { fixed64 = function(_, range) tree:add_le(J.session, range) end } },
    { [2] = "varint", [3] = "bytes", [4] = "bytes" }))
  need(what.number, "a request for nothing")
  if what.number == 2 then
    tree:add(J.kind, what.range, "offer request")
    return "offer"
  end
  tree:add(J.kind, what.range, what.number == 3 and "range request" or "digests request")
  local inner = message_of(what.values)
  if what.number == 3 then return join_range(inner, tree) end
  join_logs(inner, tree)
  return "digests"
end

-- Reads the headers of a frame of zstd (RFC 8878, 3.1.1). Returns how many bytes it holds.
local function unpacked_size(tvb)
  need(tvb and tvb:len() >= 6 and tvb(0, 4):le_uint() == 0xFD2FB528, "no frame of zstd")
  local flags = tvb(4, 1):uint()
  local is_single, size_flag = math.floor(flags / 32) % 2 == 1, math.floor(flags / 64)
  local size_bytes = size_flag == 0 and (is_single and 1 or 0) or 2 ^ size_flag
  local at = 5 + (is_single and 0 or 1) + ({ 0, 1, 2, 4 })[flags % 4 + 1]
  need(size_bytes > 0, "a frame of zstd that does not say its size")
  need(at + size_bytes <= tvb:len(), "a frame of zstd is cut short")
  local size = tvb(at, size_bytes):le_uint64()
  if size_bytes == 2 then size = size + UInt64.new(256) end
  need(size <= UInt64.new(PART_MOST), "a part that is too large")
  at = at + size_bytes
  local is_last = false
  while not is_last do
    need(at + 3 <= tvb:len(), "a frame of zstd is cut short")
    local header = tvb(at, 3):le_uint()
    local kind = math.floor(header / 2) % 4
    is_last = header % 2 == 1
    need(kind ~= 3, "a block of zstd of no kind")
    at = at + 3 + (kind == 1 and 1 or math.floor(header / 8))
  end
  at = at + (math.floor(flags / 4) % 2 == 1 and 4 or 0)
  need(at == tvb:len(), "a frame of zstd is cut short, or something follows it")
  return size
end

local function dissect_offer(tvb, tree)
  local logs_of = {}
  local function words(f)
    return { bytes = function(text) if text then add_text(tree, f, text:range()) end end }
  end
  local function hash(f)
    return { fixed64 = function(_, range) tree:add_le(f, range) end }
  end
  each_field_of(tvb, tree, {
    uint32(tree, J.protocol), words(J.world), words(J.settings), hash(J.genesis), uint64(tree, J.archive_bytes),
    hash(J.archive_digest),
    { repeated = true, bytes = function(inner) logs_of[#logs_of + 1] = inner end },
    hash(J.session), hash(J.line),
  })
  if #logs_of > 0 then join_logs(message_of(logs_of), tree) end
end

local function dissect_digests(tvb, tree)
  local function add(range) tree:add_le(J.digest, range) end
  each_field_of(tvb, tree, { { repeated = true, fixed64 = function(_, range) add(range) end, bytes = function(list)
    if not list then return end
    need(list:len() % 8 == 0, "digests that are cut short")
    for at = 0, list:len() - 8, 8 do add(list(at, 8)) end
  end } })
end

-- Adds the fields of a reply. Returns what it is.
local function dissect_join_reply(tvb, tree)
  local what = {}
  each_field_of(tvb, tree, one_of(what, {}, { "bytes", "bytes", "bytes", "bytes" }))
  need(what.number, "a reply that says nothing")
  local kind = ({ "refusal", "offer", "chunk", "digests" })[what.number]
  tree:add(J.kind, what.range, kind)
  local last = what.values[#what.values]
  if kind == "refusal" then
    if last then add_text(tree, J.refusal, last:range()) end
  elseif kind == "chunk" then
    local size = unpacked_size(last)
    tree:add(J.chunk, last:range(), last:len())
    tree:add(J.unpacked, last:range(), size)
    return string.format("chunk of %d bytes, of %s unpacked", last:len(), size)
  else
    (kind == "offer" and dissect_offer or dissect_digests)(message_of(what.values), tree)
  end
  return kind
end

-- Recognises a request by its first bytes, as the first of a stream.
local function looks_like_request(tvb)
  if tvb:len() < 6 then return false end
  local size, at = tvb(0, 4):le_uint(), 4
  if size == 0 or size > REQUEST_MOST then return false end
  if tvb(4, 1):uint() == 0x09 then at = 13 end
  if tvb:len() < at + 2 then return false end
  local tag, value = tvb(at, 1):uint(), tvb(at + 1, 1):uint()
  if tag == 0x10 then return value == 1 and 4 + size == at + 2 end
  if tag == 0x1A then return value <= 26 and 4 + size == at + 2 + value end
  return tag == 0x22 and tvb:len() > at + 4 and at > 4
end

local tcp_stream = Field.new("tcp.stream")
local function endpoint(address, port) return tostring(address) .. " " .. port end
local function is_from_client(pinfo)
  return endpoint(pinfo.src, pinfo.src_port) == join_streams[tcp_stream().value].client
end

-- Shows one message, with its size before it.
local function dissect_frame(tvb, pinfo, root)
  local stream = join_streams[tcp_stream().value]
  local tree = root:add(joins, tvb())
  local is_request = is_from_client(pinfo)
  local place = pinfo.number .. " " .. tvb:offset() .. " " .. tvb:len()
  pinfo.cols.protocol = "peerd join"
  local what = "malformed"
  local good = guarded(tree, bad_join, function()
    need(tvb:len() >= 4, "a frame is cut short")
    local size, message = tvb(0, 4):le_uint(), tvb:len() > 4 and tvb(4):tvb() or false
    need(size <= (is_request and REQUEST_MOST or REPLY_MOST), "a frame that is too long")
    tree:add(J.bytes, tvb(0, 4), size)
    local tape = Tape.new()
    what = (is_request and dissect_join_request or dissect_join_reply)(message, tape)
    tape:play(tree)
  end)
  if is_request then
    if not pinfo.visited then table.insert(stream.waiting, { frame = pinfo.number, what = good and what or "?" }) end
    pinfo.cols.info = good and "asks for " .. what or what
    return tvb:len()
  end
  if not pinfo.visited then join_requests[place] = table.remove(stream.waiting, 1) end
  local request = join_requests[place]
  if request then tree:add(J.request, tvb(0, 0), request.frame):set_generated() end
  pinfo.cols.info = what .. (what:find("^chunk") and request and ": " .. request.what or "")
  return tvb:len()
end

-- A frame that is too long has no end: the rest of the segment stands for it.
local function frame_size(tvb, pinfo, at)
  local size = tvb(at, 4):le_uint()
  return size <= (is_from_client(pinfo) and REQUEST_MOST or REPLY_MOST) and 4 + size or tvb:len() - at
end

function joins.dissector(tvb, pinfo, root)
  if tvb:len() == 0 then return 0 end
  local number = tcp_stream().value
  if not join_streams[number] then
    local from, to = endpoint(pinfo.src, pinfo.src_port), endpoint(pinfo.dst, pinfo.dst_port)
    local is_reply = snapshot_ports[pinfo.src_port] or not (snapshot_ports[pinfo.dst_port] or looks_like_request(tvb))
    join_streams[number] = { client = is_reply and to or from, waiting = {} }
  end
  dissect_tcp_pdus(tvb, root, 4, frame_size, dissect_frame)
  return tvb:len()
end

DissectorTable.get("tcp.port"):add_for_decode_as(joins)
joins:register_heuristic("tcp", function(tvb, pinfo, root)
  local is_named = snapshot_ports[pinfo.src_port] or snapshot_ports[pinfo.dst_port]
  if not is_named and not join_streams[tcp_stream().value] and not looks_like_request(tvb) then return false end
  pinfo.conversation = joins
  joins.dissector(tvb, pinfo, root)
  return true
end)

-- ---- the inputs of a recorded peer --------------------------------------------------------------------------------

local what = ProtoField.string("peerd_input.what", "What")
local wall = ProtoField.int64("peerd_input.host_minus_wall_ns", "The host's clock is ahead of Unix time by [ns]")
local text = ProtoField.string("peerd_input.text", "Text")
inputs.fields = { what, wall, text }

function inputs.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "peerd input"
  if tvb:len() == 0 then return 0 end
  local tree = root:add(inputs, tvb())
  local raw = tvb:range():raw()
  local word = raw:match("^[^ ]*")
  tree:add(what, tvb(0, #word), word)
  pinfo.cols.info = word == "peer" and "what the peer is made of" or word
  local rest = #word + 1
  local ns = (word == "control" or word == "poses") and raw:match("^%-?%d+ ", rest + 1)
  if ns then
    tree:add(wall, tvb(rest, #ns - 1), Int64(ns:sub(1, -2)))
    rest = rest + #ns
  end
  if rest < tvb:len() then
    tree:add(text, tvb(rest), raw:sub(rest + 1))
    if word ~= "peer" then pinfo.cols.info = word .. ": " .. raw:sub(rest + 1) end
  end
  return tvb:len()
end
DissectorTable.get("wtap_encap"):add(wtap.USER0, inputs)

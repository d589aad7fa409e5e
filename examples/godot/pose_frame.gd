# A frame of poses as a peer's gateway sends it (docs/reference/gateway.md), for Godot 3 and 4 alike:
#
#    0 u32 "PDF1"   4 u32 rows   8 f64 session time [s]   32 u32 revision of the scene   36 u32 bytes of a row   40 rows:
#       0 u32 node   4 u32 owner   8 u16 kind   10 u16 flags   16 f64 x y z [m]   40 f32 qx qy qz qw
#
# Rows count the nodes of the scene, which is a glTF binary: 12 u32 length of its JSON, 20 the JSON. All is little endian.

const MAGIC = 0x31464450
const HEAD_BYTES = 40
const LEAST_ROW_BYTES = 56

# {error: sentence}, or {session_time, revision, rows: [{node, owner, kind, own, position: [x, y, z], orientation: [x, y, z, w]}]}.
static func read(bytes):
	if bytes.size() < HEAD_BYTES:
		return {"error": "a pose frame of %d bytes is shorter than its head" % bytes.size()}
	var stream = StreamPeerBuffer.new()
	stream.data_array = bytes
	if stream.get_u32() != MAGIC:
		return {"error": "a binary message is not a pose frame"}
	var count = stream.get_u32()
	var frame = {"session_time": stream.get_double(), "rows": []}
	stream.seek(32)
	frame["revision"] = stream.get_u32()
	var row_bytes = stream.get_u32()
	if row_bytes < LEAST_ROW_BYTES or bytes.size() < HEAD_BYTES + count * row_bytes:
		return {"error": "a pose frame of %d bytes cannot have %d rows of %d" % [bytes.size(), count, row_bytes]}
	for i in range(count):
		stream.seek(HEAD_BYTES + i * row_bytes)
		frame["rows"].append(read_row(stream))
	return frame

static func read_row(stream):
	var row = {"node": stream.get_u32(), "owner": stream.get_u32(), "kind": stream.get_u16()}
	row["own"] = (stream.get_u16() & 1) != 0
	stream.get_float() # the threshold
	row["position"] = [stream.get_double(), stream.get_double(), stream.get_double()]
	row["orientation"] = [stream.get_float(), stream.get_float(), stream.get_float(), stream.get_float()]
	return row

# The JSON of a scene as text; empty where it is no glTF binary.
static func scene_json(bytes):
	if bytes.size() < 20:
		return ""
	var stream = StreamPeerBuffer.new()
	stream.data_array = bytes
	if stream.get_u32() != 0x46546c67:
		return ""
	stream.seek(12)
	var length = stream.get_u32()
	stream.seek(20)
	return stream.get_utf8_string(length)

# The path of each node that a row may name, by its number; what is no object has none.
static func paths_of(gltf):
	var paths = {}
	for i in range(gltf["nodes"].size()):
		var node = gltf["nodes"][i]
		if node.has("extras") and node["extras"].has("id"):
			paths[i] = node["extras"]["path"]
	return paths

# A node that shows what a peer knows, for Godot 4: one Node3D for each object, a scene of yours or a box, moved as frames come. Give it the address
# that the peer prints. Godot and the world are both right-handed with +Y up, so that poses are taken as they are.
#
#	$Peerd.ask({"do": "grab", "path": "CAR"}, func(reply): print(reply))
#	$Peerd.ask({"do": "pose", "object": "CAR", "position_m": [1, 0, 2], "time_s": Time.get_unix_time_from_system()})
class_name PeerdClient
extends Node3D

signal event_came(event: Dictionary)
signal failed(sentence: String)

const PoseFrame := preload("pose_frame.gd")

@export var address := "http://127.0.0.1:8080/"
@export_range(1, 120) var hz := 30
@export var object_scene: PackedScene

var session_time := NAN
var _socket := WebSocketPeer.new()
var _http := HTTPRequest.new()
var _page := ""
var _token := ""
var _greeted := false
var _seq := 0
var _waiting := {} # seq: [name, Callable]
var _paths := {} # of the nodes that rows of frames count
var _revision := -1
var _loading := false
var _early: Array[Dictionary] = [] # frames of a scene that is still on its way
var _shown := {} # path: Node3D

func _ready() -> void:
	var parts := address.split("#token=")
	_page = parts[0].trim_suffix("/")
	_token = parts[1] if parts.size() > 1 else ""
	add_child(_http)
	_http.request_completed.connect(_on_scene)
	_socket.inbound_buffer_size = 1 << 24 # the largest message
	var error := _socket.connect_to_url(_page.replace("http", "ws") + "/api/v1/live")
	if error != OK:
		_fail("no connection can be made to %s: %s" % [_page, error_string(error)])

func _process(_delta: float) -> void:
	_socket.poll()
	match _socket.get_ready_state():
		WebSocketPeer.STATE_OPEN:
			_greet()
			while _socket.get_available_packet_count() > 0:
				_take(_socket.get_packet())
		WebSocketPeer.STATE_CLOSED:
			_fail("the connection to the peer has ended: %d %s" % [_socket.get_close_code(), _socket.get_close_reason()])

# Asks for anything of the control protocol. `done` gets the reply; where the peer has refused it, the signal `failed` says why.
func ask(request: Dictionary, done := Callable()) -> void:
	_seq += 1
	_waiting[_seq] = [request["do"], done]
	var message := request.duplicate()
	message["seq"] = _seq
	_socket.send_text(JSON.stringify(message))

func _greet() -> void:
	if _greeted:
		return
	_greeted = true
	if _token != "":
		ask({"do": "token", "token": _token})
	ask({"do": "watch", "hz": hz})

func _take(packet: PackedByteArray) -> void:
	if not _socket.was_string_packet():
		_take_frame(PoseFrame.read(packet))
		return
	var message: Dictionary = JSON.parse_string(packet.get_string_from_utf8())
	if message.has("event"):
		event_came.emit(message)
		return
	var asked: Array = _waiting.get(int(message.get("seq", -1)), ["a message", Callable()])
	_waiting.erase(int(message.get("seq", -1)))
	if not message["ok"]:
		failed.emit("%s: %s" % [asked[0], message["error"]])
	elif message.get("done", true) == false:
		failed.emit("%s: %s" % [asked[0], str(message.get("refused", "not done"))])
	elif asked[1].is_valid():
		asked[1].call(message)

func _take_frame(frame: Dictionary) -> void:
	if frame.has("error"):
		_fail(frame["error"])
		return
	session_time = frame["session_time"]
	if frame["revision"] > _revision:
		_early.append(frame)
		_load_scene()
	elif frame["revision"] == _revision:
		_place(frame["rows"])

func _place(rows: Array) -> void:
	for row in rows:
		if row["kind"] != 0 or not _paths.has(row["node"]):
			continue
		var at: Array = row["position"]
		var turn: Array = row["orientation"]
		var node := _node_of(_paths[row["node"]])
		node.position = Vector3(at[0], at[1], at[2])
		node.quaternion = Quaternion(turn[0], turn[1], turn[2], turn[3])

func _node_of(path: String) -> Node3D:
	if not _shown.has(path):
		var node: Node3D = object_scene.instantiate() if object_scene else _box()
		node.name = path.validate_node_name()
		add_child(node)
		_shown[path] = node
	return _shown[path]

func _box() -> Node3D:
	var box := MeshInstance3D.new()
	box.mesh = BoxMesh.new()
	return box

func _load_scene() -> void:
	if _loading:
		return
	_loading = true
	var error := _http.request(_page + "/api/v1/scene.glb")
	if error != OK:
		_fail("the scene can't be asked for: %s" % error_string(error))

func _on_scene(result: int, code: int, _headers: PackedStringArray, body: PackedByteArray) -> void:
	_loading = false
	if result != HTTPRequest.RESULT_SUCCESS or code != 200:
		_fail("the scene was not given: %d" % code)
		return
	var gltf: Dictionary = JSON.parse_string(PoseFrame.scene_json(body))
	_revision = int(gltf["asset"]["extras"]["revision"])
	_paths = PoseFrame.paths_of(gltf)
	for path in _shown.keys():
		if not _paths.values().has(path):
			_shown[path].queue_free()
			_shown.erase(path)
	var waiting := _early
	_early = []
	for frame in waiting:
		_take_frame(frame)

func _fail(sentence: String) -> void:
	set_process(false)
	failed.emit(sentence)
	push_error(sentence)

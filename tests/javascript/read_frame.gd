# godot3-server -s read_frame.gd FRAME SCENE POSE_FRAME_GD: what examples/godot/pose_frame.gd makes of a frame and a scene that stand in files, as
# one line of JSON after "read: ". By Godot 3, which Debian has.
extends SceneTree

func _init():
	var words = Array(OS.get_cmdline_args())
	words = words.slice(words.size() - 3, words.size() - 1)
	var reader = load(words[2])
	var gltf = JSON.parse(reader.scene_json(bytes_of(words[1]))).result
	var paths = reader.paths_of(gltf)
	var frame = reader.read(bytes_of(words[0]))
	var places = {}
	for row in frame["rows"]:
		if row["kind"] == 0 and paths.has(row["node"]):
			places[paths[row["node"]]] = row
	var cut = reader.read(bytes_of(words[0]).subarray(0, 99))
	print("read: ", JSON.print({"time": frame["session_time"], "places": places, "cut": cut, "same": frame["revision"] == int(gltf["asset"]["extras"]["revision"])}))
	quit()

func bytes_of(path):
	var file = File.new()
	file.open(path, File.READ)
	var bytes = file.get_buffer(file.get_len())
	file.close()
	return bytes

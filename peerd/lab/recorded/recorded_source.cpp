#include "peerd/lab/recorded/recorded_source.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/input/compression.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/answer.hpp"

namespace peerd::recorded {
namespace {

using gateway::RecordedFile;
using Json = nlohmann::ordered_json;

constexpr const char* kNobodyIsHere = "this is a recording: there is no peer that could do that";

RecordedFile bytes_of(std::span<const float> numbers) {
  std::string bytes(numbers.size_bytes(), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return {std::make_shared<const std::string>(std::move(bytes))};
}

// None where it is damaged, which memory is not.
std::optional<RecordedFile> unpacked(const std::string& packed, std::size_t size_bytes, std::string_view type) {
  auto bytes = decompress(packed, size_bytes);
  if (!bytes) return std::nullopt;
  return RecordedFile{std::make_shared<const std::string>(*std::move(bytes)), type};
}

// The number behind a prefix; none where there is another prefix, or no number.
std::optional<std::uint64_t> number_after(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return std::nullopt;
  text.remove_prefix(prefix.size());
  std::uint64_t number = 0;
  const auto [at, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc() || at != text.data() + text.size()) return std::nullopt;
  return number;
}

RecordedFile events_of(const RecordedView& view) {
  std::string text = "[";
  for (const RecordedEvent& event : view.events) {
    if (text.size() > 1) text += ',';
    text += "[" + json_line(Json(event.t_s)) + "," + event.line + "]";
  }
  return {std::make_shared<const std::string>(text + "]"), "application/json"};
}

// The mean of an instant, and its largest one, by turns.
RecordedFile errors_of(const RecordedView& view) {
  std::vector<float> both;
  for (std::size_t i = 0; i < view.errors.mean_m.size(); ++i) {
    both.push_back(view.errors.mean_m[i]);
    both.push_back(view.errors.largest_m[i]);
  }
  return bytes_of(both);
}

std::optional<RecordedFile> file_of(const RecordedView& view, std::string_view name) {
  if (name == "events") return events_of(view);
  if (name == "errors") return errors_of(view);
  if (const auto stretch = number_after(name, "poses-"); stretch && *stretch < view.stretches.size()) {
    const Stretch& s = view.stretches[*stretch];
    return unpacked(s.frames, s.size_bytes, "application/octet-stream");
  }
  if (const auto revision = number_after(name, "scene-")) {
    const auto scene = std::ranges::find(view.scenes, *revision, &SceneRevision::revision);
    if (scene == view.scenes.end() || scene->glb.empty()) return std::nullopt;
    return unpacked(scene->glb, scene->size_bytes, "model/gltf-binary");
  }
  if (const auto object = number_after(name, "errors-")) {
    const auto errors = view.errors.of_object.find(ObjectId::unpacked(*object));
    if (errors == view.errors.of_object.end()) return std::nullopt;
    return bytes_of(errors->second);
  }
  return std::nullopt;
}

Json contents_of(const RecordedView& view) {
  Json scenes = Json::array(), stretches = Json::array();
  for (const SceneRevision& scene : view.scenes) {
    Json row = {{"revision", scene.revision}, {"from_s", scene.from_s}};
    if (!scene.why_not.empty()) row["why_not"] = scene.why_not;
    scenes.push_back(std::move(row));
  }
  for (const Stretch& stretch : view.stretches) {
    stretches.push_back(Json::array({stretch.from_s, stretch.until_s, stretch.revision}));
  }
  return {{"peer", view.peer.value}, {"name", view.name}, {"scenes", scenes}, {"stretches", stretches}};
}

}  // namespace

control::Answer RecordedSource::ask(std::string_view /*request*/) { return {control::refusal(kNobodyIsHere)}; }
std::string RecordedSource::surroundings() { return control::refusal(kNobodyIsHere); }
std::string RecordedSource::hierarchy(const std::string& /*path*/, std::uint32_t /*level*/) {
  return control::refusal(kNobodyIsHere);
}
std::string RecordedSource::pick(const Vec3& /*origin*/, const Vec3& /*direction*/) {
  return control::refusal(kNobodyIsHere);
}
std::string RecordedSource::walk(const view::AvatarSize& /*size*/, const view::Stride& /*stride*/,
                                 const std::string& /*except*/) {
  return control::refusal(kNobodyIsHere);
}
std::string RecordedSource::inspect(std::uint32_t /*node*/) { return control::refusal(kNobodyIsHere); }
std::string RecordedSource::inspect_at(const std::string& /*path*/) { return control::refusal(kNobodyIsHere); }

void RecordedSource::make_scene(std::function<void(const gateway::SceneFile&)> done) {
  done({0, nullptr, "a recording has the scenes of its views"});
}

std::optional<RecordedFile> RecordedSource::recorded_file(std::string_view name) {
  if (name.empty()) return RecordedFile{std::make_shared<const std::string>(contents()), "application/json"};
  const std::string_view view = name.substr(0, name.find('/'));
  const auto index = number_after(view, "");
  if (!index || *index >= recording_.views.size() || view.size() == name.size()) return std::nullopt;
  return file_of(recording_.views[*index], name.substr(view.size() + 1));
}

std::string RecordedSource::contents() const {
  const Recording& r = recording_;
  Json views = Json::array(), peers = Json::array(), happenings = Json::array();
  for (const RecordedView& view : r.views) views.push_back(contents_of(view));
  for (const auto& [id, name] : r.peers) peers.push_back({{"id", id.value}, {"name", name}});
  for (const auto& [t_s, name] : r.happenings) happenings.push_back(Json::array({t_s, name}));
  const Json recording = {{"kind", r.kind == Recording::Kind::kRun ? "run" : "capture"},
                          {"name", r.name},
                          {"title", r.title},
                          {"world", r.world},
                          {"end_s", r.end_s},
                          {"hz", r.hz},
                          {"notes", r.notes},
                          {"peers", peers},
                          {"happenings", happenings},
                          {"views", views}};
  return json_line(Json{{"v", 1}, {"ok", true}, {"recording", recording}});
}

}  // namespace peerd::recorded

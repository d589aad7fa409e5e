#include "peerd/lab/recorded/recording_export.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/recorded/foxglove_messages.hpp"
#include "peerd/lab/recorded/stretch_reader.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;
using recorded::RecordedView;
using recorded::Recording;
using view::PoseKind;
using view::PoseRow;

constexpr const char* kWorldFrame = "world";
constexpr const char* kJson = "json";
constexpr const char* kJsonSchema = "jsonschema";
constexpr const char* kErrorsSchema =
    R"({"title":"peerd.GhostErrors","type":"object","properties":{"mean_m":{"type":"number"},)"
    R"("largest_m":{"type":"number"},"objects":{"type":"object","additionalProperties":{"type":"number"}}}})";
constexpr const char* kEventSchema =
    R"({"title":"peerd.Event","type":"object","properties":{"event":{"type":"string"}}})";

std::uint64_t nanoseconds(double t_s) { return static_cast<std::uint64_t>(std::llround(std::max(0.0, t_s) * 1e9)); }

// The frame that a row says the place of; empty: of none. Truths are said once, in the view of the owner.
std::string frame_of(const PoseRow& row, const std::string& view, const std::string& path) {
  switch (static_cast<PoseKind>(row.kind)) {
    case PoseKind::kShown:
      return view + '/' + path;
    case PoseKind::kGhost:
      return row.owner == kNobody.value ? "" : view + "/ghost/" + path;
    case PoseKind::kTruth:
      return (row.flags & view::kOwn) != 0 && row.owner != kNobody.value ? "truth/" + path : "";
  }
  return "";
}

const recorded::SceneRevision* scene_of(const RecordedView& view, std::uint32_t revision) {
  for (const recorded::SceneRevision& scene : view.scenes) {
    if (scene.revision == revision) return &scene;
  }
  return nullptr;
}

Vec3 vector_in(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

bool is_contact(const std::string& event) { return event.starts_with("contact"); }

}  // namespace

RecordingExport::RecordingExport(std::ostream& out) : mcap_(out) {
  transforms_schema_ = mcap_.add_schema(recorded::kFrameTransforms, kJsonSchema, recorded::frame_transforms_schema());
  scene_schema_ = mcap_.add_schema(recorded::kSceneUpdate, kJsonSchema, recorded::scene_update_schema());
  errors_schema_ = mcap_.add_schema("peerd.GhostErrors", kJsonSchema, kErrorsSchema);
  event_schema_ = mcap_.add_schema("peerd.Event", kJsonSchema, kEventSchema);
  truth_ = mcap_.add_channel(transforms_schema_, "/tf", kJson);
}

void RecordingExport::add(const Recording& recording, const Scenes& scenes) {
  const Quat upright(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));  // +Y becomes +Z, which is up there
  mcap_.add_message(truth_, 0, recorded::frame_transforms(0.0, {{"root", kWorldFrame, {Vec3::Zero(), upright}}}));
  for (const RecordedView& view : recording.views) {
    if (const auto drawn = scenes.find(view.peer); drawn != scenes.end()) add_scenes(view, drawn->second);
    add_poses(view);
    add_errors(recording, view);
    add_events(view);
  }
  mcap_.finish();
}

void RecordingExport::add_scenes(const RecordedView& view, const std::vector<DrawnAt>& scenes) {
  const std::uint16_t channel = mcap_.add_channel(scene_schema_, '/' + view.name + "/scene", kJson);
  std::vector<std::string> before;
  for (const DrawnAt& message : scenes) {
    mcap_.add_message(channel, nanoseconds(message.t_s),
                      recorded::scene_update(message.t_s, message.scene, view.name + '/', kWorldFrame, before));
  }
}

void RecordingExport::add_poses(const RecordedView& view) {
  const std::uint16_t channel = mcap_.add_channel(transforms_schema_, '/' + view.name + "/tf", kJson);
  for (const recorded::Stretch& stretch : view.stretches) {
    const recorded::SceneRevision* const scene = scene_of(view, stretch.revision);
    if (scene == nullptr) continue;
    recorded::read_frames(stretch, [&](double t_s, std::span<const PoseRow> rows) {
      std::vector<recorded::Transform> here, truths;
      for (const PoseRow& row : rows) {
        const std::string frame = frame_of(row, view.name, scene->nodes.at(row.node).path);
        if (frame.empty()) continue;
        const bool is_truth = static_cast<PoseKind>(row.kind) == PoseKind::kTruth;
        (is_truth ? truths : here).push_back({kWorldFrame, frame, pose_of(row)});
      }
      if (!here.empty()) mcap_.add_message(channel, nanoseconds(t_s), recorded::frame_transforms(t_s, here));
      if (!truths.empty()) mcap_.add_message(truth_, nanoseconds(t_s), recorded::frame_transforms(t_s, truths));
    });
  }
}

void RecordingExport::add_errors(const Recording& recording, const RecordedView& view) {
  const std::uint16_t channel = mcap_.add_channel(errors_schema_, '/' + view.name + "/errors", kJson);
  std::map<ObjectId, std::string> paths;
  for (const recorded::SceneRevision& scene : view.scenes) {
    for (const auto& node : scene.nodes) paths[node.id] = node.path;
  }
  for (std::size_t i = 0; i < view.errors.mean_m.size(); ++i) {
    Json objects = Json::object();
    for (const auto& [id, errors] : view.errors.of_object) {
      if (i < errors.size() && std::isfinite(errors[i])) objects[paths[id]] = errors[i];
    }
    if (objects.empty()) continue;
    Json errors;
    if (std::isfinite(view.errors.mean_m[i])) {
      errors["mean_m"] = view.errors.mean_m[i];
      errors["largest_m"] = view.errors.largest_m[i];
    }
    errors["objects"] = std::move(objects);
    mcap_.add_message(channel, nanoseconds(static_cast<double>(i) / recording.hz), json_line(errors));
  }
}

void RecordingExport::add_events(const RecordedView& view) {
  const std::uint16_t contacts = mcap_.add_channel(event_schema_, '/' + view.name + "/contacts", kJson);
  const std::uint16_t marks = mcap_.add_channel(scene_schema_, '/' + view.name + "/contacts/marks", kJson);
  const std::uint16_t others = mcap_.add_channel(event_schema_, '/' + view.name + "/events", kJson);
  std::size_t count = 0;
  for (const recorded::RecordedEvent& event : view.events) {
    const auto json = Json::parse(event.line);
    const std::string name = json.at("event").get<std::string>();
    mcap_.add_message(is_contact(name) ? contacts : others, nanoseconds(event.t_s), event.line);
    if (name != "contact" || !json.contains("collider_position_m")) continue;
    const Json decider = json.value("decider", Json());
    const std::string by = decider.is_number() ? ", by peer " + std::to_string(decider.get<std::uint32_t>()) : "";
    recorded::ContactMark mark{"contact " + std::to_string(++count), json.at("kind").get<std::string>() + by,
                               vector_in(json.at("collider_position_m")), vector_in(json.at("normal"))};
    mcap_.add_message(marks, nanoseconds(event.t_s), recorded::contact_mark(event.t_s, mark, kWorldFrame));
  }
}

}  // namespace peerd

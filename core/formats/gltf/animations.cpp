#include "core/formats/gltf/animations.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/formats/draft/node_draft.hpp"
#include "core/formats/gltf/placement.hpp"

namespace peerd::formats::gltf {
namespace {

using vrml::NodeRef;

class AnimationReader {
 public:
  AnimationReader(const tinygltf::Model& model, Accessors& accessors, const std::vector<NodeRef>& transforms,
                  Reading& reading)
      : model_(model), accessors_(accessors), transforms_(transforms), reading_(reading) {}

  bool read() {
    for (std::size_t i = 0; i < model_.animations.size(); ++i) {
      if (!read(model_.animations[i], "animations/" + std::to_string(i))) return false;
    }
    return true;
  }

 private:
  // The times and values of one interpolator, which several channels may share.
  struct Keys {
    std::vector<float> times, values;  // [s]; and `width` numbers a time
    std::size_t width = 3;
    bool steps = false;
  };
  // The accessors of times and of values, the numbers of a value, and whether it steps.
  using KeysName = std::tuple<int, int, std::size_t, bool>;
  struct Channel {
    std::size_t node = 0;
    std::string target;
    KeysName keys;
  };
  struct Channels {
    std::vector<Channel> list;
    std::map<KeysName, Keys> keys;
  };

  bool fail(const std::string& why) { return reading_.fail(0, why); }
  bool read(const tinygltf::Animation& animation, const std::string& path);
  bool read_channel(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel,
                    const std::string& path, Channels& channels);
  bool read_keys(const KeysName& name, const std::string& path, Keys& keys);
  NodeRef add_interpolator(const Keys& from, float duration_s, NodeRef sensor);
  void add_route(NodeRef from, const char* event_out, NodeRef to, std::string_view event_in);

  const tinygltf::Model& model_;
  Accessors& accessors_;
  const std::vector<NodeRef>& transforms_;
  Reading& reading_;
  std::set<std::pair<std::size_t, std::string>> driven_;  // node and target
};

bool AnimationReader::read_channel(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel,
                                   const std::string& path, Channels& channels) {
  const auto node = static_cast<std::size_t>(channel.target_node);
  if (channel.target_node < 0) {
    reading_.lose("it moves nothing: its target has no node", path.substr(0, path.size() - 2));
    return true;
  }
  if (node >= transforms_.size()) return fail(path + "its target is no node");
  if (channel.sampler < 0 || static_cast<std::size_t>(channel.sampler) >= animation.samplers.size()) {
    return fail(path + "there is no such sampler");
  }
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
  const std::string& target = channel.target_path;
  const auto still = [&](const std::string& why) {
    reading_.warn(0,
                  path + "the " + vrml::quoted(target) + " of nodes/" + std::to_string(node) + " stands still: " + why);
    return true;
  };
  if (!transforms_[node].is_node()) return still("the node is not in the scene");
  if (target != "translation" && target != "rotation" && target != "scale") return still("no interpolator does it");
  if (sampler.interpolation != "LINEAR" && sampler.interpolation != "STEP") {
    return still("no interpolator does " + vrml::quoted(sampler.interpolation) + " exactly");
  }
  const KeysName name{sampler.input, sampler.output, target == "rotation" ? 4U : 3U, sampler.interpolation == "STEP"};
  channels.list.push_back({node, target, name});
  const auto [keys, is_new] = channels.keys.try_emplace(name);
  return !is_new || read_keys(name, path, keys->second);
}

bool AnimationReader::read_keys(const KeysName& name, const std::string& path, Keys& keys) {
  const auto [input, output, width, steps] = name;
  auto times = accessors_.floats(input, 1);
  if (!times) return fail(path + times.error());
  auto values = accessors_.floats(output, width);
  if (!values) return fail(path + values.error());
  if (values->size() != times->size() * width) return fail(path + "it needs one value for each time");
  if (times->front() < 0.0F || std::ranges::adjacent_find(*times, std::greater_equal<>()) != times->end()) {
    return fail(path + "its times must increase from 0 on");
  }
  // An interpolator has a key with each value, and a step needs two.
  if (!reading_.take(Asked::kValues, (steps ? 2 : 1) * times->size() * (width + 1))) {
    return fail(path + std::string(kTooManyValues));
  }
  keys = {std::move(*times), std::move(*values), width, steps};
  return true;
}

void AnimationReader::add_route(NodeRef from, const char* event_out, NodeRef to, std::string_view event_in) {
  vrml::Document& document = reading_.document;
  document.routes.push_back({from.index, to.index, vrml::find_field(*document.nodes[from.index].type, event_out),
                             vrml::find_field(*document.nodes[to.index].type, event_in), reading_.at(0)});
}

NodeRef AnimationReader::add_interpolator(const Keys& from, float duration_s, NodeRef sensor) {
  vrml::Document& document = reading_.document;
  std::vector<float> keys, values;
  const auto add_key = [&](std::size_t time, std::size_t value) {
    keys.push_back(from.times[time] / duration_s);
    const float* const first = from.values.data() + value * from.width;
    if (from.width == 3) {
      values.insert(values.end(), first, first + 3);
    } else {
      const std::array<double, 4> quaternion{first[0], first[1], first[2], first[3]};
      const auto turned = axis_angle(quaternion);
      values.insert(values.end(), turned.begin(), turned.end());
    }
  };
  for (std::size_t i = 0; i < from.times.size(); ++i) {
    if (from.steps && i > 0) add_key(i, i - 1);  // two values at one time are a step
    add_key(i, i);
  }
  const char* const type = from.width == 4 ? "OrientationInterpolator" : "PositionInterpolator";
  const NodeRef made = NodeDraft(document, type, reading_.at(0))
                           .floats("key", std::move(keys))
                           .floats("keyValue", std::move(values))
                           .add();
  document.top_level.push_back(made);
  add_route(sensor, "fraction_changed", made, "set_fraction");
  return made;
}

bool AnimationReader::read(const tinygltf::Animation& animation, const std::string& path) {
  Channels channels;
  for (std::size_t i = 0; i < animation.channels.size(); ++i) {
    const std::string where = path + "/channels/" + std::to_string(i) + ": ";
    if (!read_channel(animation, animation.channels[i], where, channels)) return false;
  }
  float duration_s = 0.0F;
  for (const auto& [name, keys] : channels.keys) duration_s = std::max(duration_s, keys.times.back());
  if (channels.list.empty()) return true;
  if (!(duration_s > 0.0F)) {
    reading_.warn(0, path + ": it stands still: all of its times are 0");
    return true;
  }
  const NodeRef sensor = NodeDraft(reading_.document, "TimeSensor", reading_.at(0))
                             .time("cycleInterval", double{duration_s})
                             .flag("loop", true)
                             .add();
  reading_.document.top_level.push_back(sensor);
  std::map<KeysName, NodeRef> interpolators;
  for (const Channel& channel : channels.list) {
    if (!driven_.emplace(channel.node, channel.target).second) {
      reading_.warn(0, path + ": the " + vrml::quoted(channel.target) + " of nodes/" + std::to_string(channel.node) +
                           " stands still: an earlier animation moves it");
      continue;
    }
    const auto [it, is_new] = interpolators.try_emplace(channel.keys);
    if (is_new) it->second = add_interpolator(channels.keys[channel.keys], duration_s, sensor);
    add_route(it->second, "value_changed", transforms_[channel.node], channel.target);
  }
  return reading_.has_room() || fail(path + ": " + std::string(kTooManyNodes));
}

}  // namespace

bool add_animations(const tinygltf::Model& model, Accessors& accessors, const std::vector<NodeRef>& transforms,
                    Reading& reading) {
  return AnimationReader(model, accessors, transforms, reading).read();
}

}  // namespace peerd::formats::gltf

#include "core/animation/animation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

namespace peerd::animation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_finite(const Value& v) {
  return std::ranges::all_of(v.number, [](double x) { return std::isfinite(x); }) &&
         std::ranges::all_of(v.numbers, [](float x) { return std::isfinite(x); });
}

bool is_float_or_time(const Cell& c) {
  return c.port == static_cast<std::uint8_t>(SensorOutput::kFraction) ||
         c.port == static_cast<std::uint8_t>(SensorOutput::kTime);
}

}  // namespace

Animation::Animation(const Network& network, const AnimationOptions& options)
    : graph_(std::make_unique<CellGraph>(network)),
      control_(std::make_unique<Control>(*graph_, network, options.read_time_s, options.most_transitions,
                                         options.remembered)),
      options_(options),
      place_(graph_->sensor_node.size(), kNone) {
  grow();
}

void Animation::grow() {
  const std::size_t cells = graph_->cells.size();
  has_delivered_.resize(cells, 0);
  seen_.resize(cells, 0);
  claimed_.resize(cells, 0);
  via_.resize(cells, kNone);
}

std::optional<std::uint32_t> Animation::find_or_add(std::uint32_t node, std::string_view name, FieldType type,
                                                    bool in) {
  const std::size_t cells = graph_->cells.size();
  const auto cell = graph_->find_or_add(node, name, type, in);
  if (graph_->cells.size() != cells) {
    grow();
    control_->cell_added(*cell);
  }
  return cell;
}

std::optional<FieldId> Animation::field(std::uint32_t node, std::string_view name) {
  auto cell = graph_->find(node, name);
  if (!cell && !graph_->is_plain(node)) cell = find_or_add(node, name, FieldType::kFloat, false);
  return cell ? std::optional(FieldId{*cell}) : std::nullopt;
}

Field Animation::describe(FieldId id) const {
  const Cell& c = graph_->cells[id.value];
  return {id, c.node, graph_->names[c.name], c.type};
}

std::vector<Field> Animation::driven() const {
  std::vector<Field> out;
  for (std::uint32_t c = 0; c < graph_->cells.size(); ++c) {
    if (graph_->cells[c].driven && graph_->cells[c].kind != CellKind::kInterpolator) out.push_back(describe({c}));
  }
  return out;
}

// Cells whose latest event is known without looking further upstream.
bool Animation::is_leaf(const Cell& c) const {
  return c.control || c.kind == CellKind::kSensorOutput || c.kind == CellKind::kKey;
}

const Animation::Delivered* Animation::delivered(std::uint32_t cell, double t) const {
  if (!has_delivered_[cell]) return nullptr;
  const std::vector<Delivered>& all = delivered_.at(cell);
  const auto after = std::ranges::upper_bound(all, t, {}, &Delivered::t);
  return after == all.begin() ? nullptr : &*std::prev(after);
}

// A cell's own latest event at or before t, those that come over ROUTEs left out unless it is a leaf.
std::optional<Stamp> Animation::leaf_event(std::uint32_t cell, double t, At at) {
  const Cell& c = graph_->cells[cell];
  if (c.control) {
    const CellEvent* event = control_->latest(cell, t);
    return event ? std::optional(event->stamp) : std::nullopt;
  }
  if (c.kind != CellKind::kSensorOutput) {
    const Delivered* d = delivered(cell, t);
    return d ? std::optional(Stamp{d->t, 0, 0}) : std::nullopt;
  }
  const std::uint32_t sensor = graph_->index_of_node[c.node];
  const TimeSensorState& s = control_->sensor(sensor, t);
  const double last = control_->last_time(control_->component_of_sensor(sensor));
  t = std::min(t, last);
  if (!s.ran) return std::nullopt;
  const auto since = [&](double when) { return Stamp{when, when == s.begin_s ? s.begin_step : 0, 0}; };
  if (c.port == static_cast<std::uint8_t>(SensorOutput::kCycleTime)) {
    return since(std::max(s.active ? cycle_start(s.fields, t) : s.final_cycle_s, s.begin_s));
  }
  if (!s.active) return Stamp{s.end_s, s.end_step, 0};
  if (!is_float_or_time(c)) return Stamp{s.begin_s, s.begin_step, 0};
  return at == At::kJustAfter && t < last ? Stamp{kInfinity, 0, 0} : since(t);
}

Keys Animation::keys_at(std::uint32_t cell, double t) const {
  const std::uint32_t i = graph_->index_of_node[graph_->cells[cell].node];
  Keys keys = keys_of(graph_->interpolators[i]);
  const auto [key, key_value] = graph_->key_cells[i];
  if (key != kNone) {
    if (const Delivered* d = delivered(key, t)) keys.key = d->value.numbers;
  }
  if (key_value != kNone) {
    if (const Delivered* d = delivered(key_value, t)) keys.key_value = d->value.numbers;
  }
  return keys;
}

// Whether an event that reaches the cell at t is sent on.
bool Animation::interpolates(std::uint32_t cell, double t) const {
  const Cell& c = graph_->cells[cell];
  if (c.kind != CellKind::kInterpolator) return true;
  return sends(graph_->interpolators[graph_->index_of_node[c.node]].type, keys_at(cell, t));
}

// Most fields hang on one chain of single ROUTEs: then there is nothing to choose. Returns false where there is.
bool Animation::find_simple_path(std::uint32_t cell, double t, At at, bool& found) {
  const std::uint64_t mark = ++mark_;
  path_.clear();
  found = false;
  while (true) {
    if (std::exchange(seen_[cell], mark) == mark) return false;  // a ring
    const Cell& c = graph_->cells[cell];
    path_.push_back(cell);
    if (is_leaf(c)) break;
    if (has_delivered_[cell]) return false;
    if (c.first_in == kNone) break;
    const Link& link = graph_->links[c.first_in];
    if (link.next_in != kNone) return false;
    cell = link.from;
  }
  upstream_ = path_;
  const auto stamp = leaf_event(cell, t, at);  // none of a cell that nothing leads to
  if (!stamp) return true;
  source_ = {*stamp, cell};
  found = std::ranges::all_of(path_, [&](std::uint32_t c) { return interpolates(c, std::min(stamp->t, t)); });
  return true;
}

// Finds the event that is the cell's latest at or before t (or just after t), into source_ and path_: collects all that
// is upstream, then lets the sources' events spread, the latest timestamp first, wave by wave, each cell taking the
// first that reaches it.
bool Animation::find_path(std::uint32_t cell, double t, At at) {
  if (bool found = false; find_simple_path(cell, t, at, found)) return found;
  const std::uint64_t question = ++mark_;
  upstream_.assign(1, cell);
  sources_.clear();
  seen_[cell] = question;
  for (std::size_t i = 0; i < upstream_.size(); ++i) {
    const std::uint32_t at_cell = upstream_[i];
    if (const auto stamp = leaf_event(at_cell, t, at); stamp && interpolates(at_cell, std::min(stamp->t, t))) {
      sources_.push_back({*stamp, at_cell});
    }
    const Cell& c = graph_->cells[at_cell];
    if (is_leaf(c)) continue;
    for (std::uint32_t r = c.first_in; r != kNone; r = graph_->links[r].next_in) {
      const std::uint32_t from = graph_->links[r].from;
      if (std::exchange(seen_[from], question) != question) upstream_.push_back(from);
    }
  }
  std::ranges::sort(sources_, [](const Source& a, const Source& b) {
    return std::tuple(b.stamp.t, b.stamp.step, a.stamp.wave, a.cell) <
           std::tuple(a.stamp.t, a.stamp.step, b.stamp.wave, b.cell);
  });
  const Source* const end = sources_.data() + sources_.size();
  for (const Source* group = sources_.data(); group != end && claimed_[cell] <= question;) {
    const Source* group_end = group;
    while (group_end != end && group_end->stamp.t == group->stamp.t && group_end->stamp.step == group->stamp.step) {
      ++group_end;
    }
    source_ = *group;
    front_.clear();
    spread(group, group_end, cell);
    group = group_end;
  }
  if (claimed_[cell] <= question) return false;
  path_.clear();
  path_.push_back(cell);
  while (via_[path_.back()] != kNone) path_.push_back(graph_->links[via_[path_.back()]].from);
  source_.cell = path_.back();
  return true;
}

// The events of one timestamp. A cell is claimed if its mark is above the question's, seen_[target].
void Animation::spread(const Source* group, const Source* group_end, std::uint32_t target) {
  const std::uint64_t question = seen_[target];
  const double t = group->stamp.t;
  for (std::uint32_t wave = group->stamp.wave; group != group_end || !front_.empty(); ++wave) {
    if (front_.empty()) wave = group->stamp.wave;
    for (; group != group_end && group->stamp.wave == wave; ++group) {
      if (claimed_[group->cell] > question) continue;
      claimed_[group->cell] = ++mark_;
      via_[group->cell] = kNone;
      front_.push_back(group->cell);
    }
    if (claimed_[target] > question) return;
    const std::uint64_t wave_mark = ++mark_;
    next_front_.clear();
    for (const std::uint32_t from : front_) {
      for (std::uint32_t r = graph_->cells[from].first_out; r != kNone; r = graph_->links[r].next_out) {
        const std::uint32_t to = graph_->links[r].to;
        if (seen_[to] != question || is_leaf(graph_->cells[to])) continue;
        if (claimed_[to] == wave_mark) {
          via_[to] = std::max(via_[to], r);
        } else if (claimed_[to] <= question && interpolates(to, t)) {
          claimed_[to] = wave_mark;
          via_[to] = r;
          next_front_.push_back(to);
        }
      }
    }
    std::swap(front_, next_front_);
  }
}

// The event of source_, as it arrives at the other end of path_.
void Animation::evaluate_path(double t, Value& out) {
  const Cell& source = graph_->cells[source_.cell];
  const double when = std::min(source_.stamp.t, t);
  std::size_t next = path_.size() - 1;  // the first cell of the path that has yet to take the event
  if (source.control) {
    out.set(source.type, control_->latest(source_.cell, t)->value);
  } else if (source.kind == CellKind::kSensorOutput) {
    const std::uint32_t sensor = graph_->index_of_node[source.node];
    const double last = control_->last_time(control_->component_of_sensor(sensor));
    const TimeSensorOutput o = *output(control_->sensor(sensor, t), std::min(t, last));
    const double by_port[] = {o.is_active ? 1.0 : 0.0, o.cycle_time_s, o.fraction, o.time_s};
    out.set(source.type, by_port[source.port]);
  } else {
    out = delivered(source_.cell, t)->value;
    ++next;
  }
  while (next-- > 0) {
    const Cell& c = graph_->cells[path_[next]];
    if (c.kind != CellKind::kInterpolator) continue;
    const InterpolatorType type = graph_->interpolators[graph_->index_of_node[c.node]].type;
    evaluate(type, keys_at(path_[next], when), out.scalar(), out);
  }
}

bool Animation::value(FieldId id, double t, Value& out) {
  assert(std::isfinite(t));
  if (!find_path(id.value, t, At::kNow)) return false;
  evaluate_path(t, out);
  return true;
}

std::optional<DeliverError> Animation::deliver(double t, std::uint32_t node, std::string_view name,
                                               const Value& value) {
  if (!std::isfinite(t) || !is_finite(value)) return DeliverError::kNotFinite;
  if (t < options_.read_time_s) return DeliverError::kBeforeRead;
  const auto found = find_or_add(node, name, value.type, true);
  if (!found) return DeliverError::kNoSuchField;
  const std::uint32_t cell = *found;
  const Cell& c = graph_->cells[cell];
  if (value.type != (c.kind == CellKind::kInterpolator ? FieldType::kFloat : c.type)) return DeliverError::kType;
  if (c.control) {
    control_->deliver(t, cell, value.scalar());
    const std::uint32_t component = control_->component_of_cell(cell);
    if (!cursor_valid_) return std::nullopt;
    if (t > cursor_s_) {
      upcoming_.push_back({t, component, false});
      std::push_heap(upcoming_.begin(), upcoming_.end());
      return std::nullopt;
    }
    noted_cells_.push_back(cell);
    const std::vector<std::uint32_t>& sensors = control_->sensors(component);
    noted_sensors_.insert(noted_sensors_.end(), sensors.begin(), sensors.end());
    refresh(component, cursor_s_);
    push_component(component, cursor_s_);
    return std::nullopt;
  }
  has_delivered_[cell] = 1;
  std::vector<Delivered>& all = delivered_[cell];
  const auto at = all.insert(std::ranges::upper_bound(all, t, {}, &Delivered::t), {t, value});
  if (c.kind == CellKind::kKey && c.port == 0) sort_keys(at->value.numbers);
  if (!cursor_valid_) return std::nullopt;
  if (t <= cursor_s_) {
    noted_cells_.push_back(cell);
  } else {
    upcoming_.push_back({t, cell, true});
    std::push_heap(upcoming_.begin(), upcoming_.end());
  }
  return std::nullopt;
}

}  // namespace peerd::animation

#include "tests/sim/living/oracle_motion.hpp"

#include <cstdint>
#include <numbers>

namespace peerd::living {
namespace {

constexpr double kRoom = 1.0 + 1e-9;  // what the rounding of a bound needs, many times over

Point point_of(const Three& p) { return {double(p[0]), double(p[1]), double(p[2])}; }
double length_of(const Three& p) { return std::hypot(double(p[0]), double(p[1]), double(p[2])); }
double distance(const Three& a, const Three& b) {
  return std::hypot(double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]);
}
double largest(const Three& v) {
  return std::max({std::abs(double(v[0])), std::abs(double(v[1])), std::abs(double(v[2]))});
}

bool stops(const Clock& clock) { return clock.stop_s > clock.start_s; }

// Rings of 24 points around y, the first at z < 0, as VRML97 wraps textures.
constexpr int kSlices = 24, kStacks = 12;
void add_ring(std::vector<Three>& points, double radius, double y) {
  for (int k = 0; k < kSlices; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kSlices;
    points.push_back({float(-radius * std::sin(angle)), float(y), float(-radius * std::cos(angle))});
  }
}
void add_band(std::vector<std::array<int, 3>>& triangles, int lower, int upper) {
  for (int k = 0; k < kSlices; ++k) {
    const int next = (k + 1) % kSlices;
    triangles.push_back({lower + k, lower + next, upper + next});
    triangles.push_back({lower + k, upper + next, upper + k});
  }
}
void add_fan(std::vector<std::array<int, 3>>& triangles, int ring, int apex) {
  for (int k = 0; k < kSlices; ++k) triangles.push_back({ring + k, ring + (k + 1) % kSlices, apex});
}
void add_cap(std::vector<std::array<int, 3>>& triangles, int ring) {
  for (int k = 1; k + 1 < kSlices; ++k) triangles.push_back({ring, ring + k, ring + k + 1});
}

}  // namespace

OracleMotion::OracleMotion(const World& world) : world_(world) {
  for (const Form& form : world.forms) solids_.push_back(solid(form));
  for (const Node& node : world.nodes) {
    turns_.emplace_back();
    for (const Turn& turn : node.rotations.value) turns_.back().push_back(quaternion(turn));
    still_turns_.push_back(matrix(quaternion(node.rotation)));
    stretches_.push_back(matrix(quaternion(node.scale_orientation)));
  }
}

// Clocks

std::vector<double> OracleMotion::breaks_of_clock(int index) const {
  const Clock& clock = world_.clocks[std::size_t(index)];
  std::vector<float> keys{0.0F};
  const auto add = [&](const auto& path) {
    if (path.clock == index) keys.insert(keys.end(), path.key.begin(), path.key.end());
  };
  for (const Node& node : world_.nodes) add(node.translations), add(node.scales), add(node.rotations);
  for (const Form& form : world_.forms) add(form.bend);
  std::vector<double> breaks{0.0, world_.duration_s, clock.start_s};
  if (stops(clock)) breaks.push_back(clock.stop_s);
  for (double cycle = 0.0; clock.start_s + cycle * clock.cycle_s <= world_.duration_s; ++cycle) {
    for (const float key : keys) breaks.push_back(clock.start_s + (cycle + double(key)) * clock.cycle_s);
    if (!clock.loop) break;
  }
  std::erase_if(breaks, [&](double t) { return t < 0.0 || t > world_.duration_s; });
  std::ranges::sort(breaks);
  return breaks;
}

bool OracleMotion::fraction(const Clock& clock, double t_s, double within_s, Interval& out, double& middle,
                            bool& runs) const {
  if (within_s < clock.start_s) return false;
  double end_s = clock.loop ? world_.duration_s + 1e3 : clock.start_s + clock.cycle_s;
  if (stops(clock)) end_s = std::min(end_s, clock.stop_s);
  runs = within_s < end_s;
  if (!runs && end_s == clock.start_s + clock.cycle_s) {  // at the end of a cycle the fraction is 1
    out = Interval(1.0);
    middle = 1.0;
    return true;
  }
  const double at_s = runs ? within_s : end_s;
  const double cycle = std::floor((at_s - clock.start_s) / clock.cycle_s);
  middle = (at_s - clock.start_s) / clock.cycle_s - cycle;
  out = (Interval(runs ? t_s : end_s) - Interval(clock.start_s)) / Interval(clock.cycle_s) - Interval(cycle);
  return true;
}

template <class V>
bool OracleMotion::place(const Path<V>& path, double t_s, double within_s, Place& out) const {
  if (!path.drives()) return false;
  const Clock& clock = world_.clocks[std::size_t(path.clock)];
  Interval at;
  double middle = 0.0;
  bool runs = false;
  if (!fraction(clock, t_s, within_s, at, middle, runs)) return false;
  const std::size_t last = path.key.size() - 1;
  if (middle >= path.key[last]) {
    out = {last, last, Interval(0.0), 0.0};
    return true;
  }
  std::size_t i = 0;
  while (!(path.key[i] <= middle && middle < path.key[i + 1])) ++i;
  const Interval from(path.key[i]), to(path.key[i + 1]);
  out = {i, i + 1, (at - from) / (to - from), runs ? (double(path.key[i + 1]) - path.key[i]) * clock.cycle_s : 0.0};
  return true;
}

// Fields

Point OracleMotion::vector(const Path<Three>& path, const Three& in_file, double t_s, double within_s) const {
  Place at;
  if (!place(path, t_s, within_s, at)) return point_of(in_file);
  const Point from = point_of(path.value[at.from]), to = point_of(path.value[at.to]);
  Point out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = from[k] + at.weight * (to[k] - from[k]);
  return out;
}

OracleMotion::Quaternion OracleMotion::quaternion(const Turn& turn) {
  const Point axis{double(turn[0]), double(turn[1]), double(turn[2])};
  const Interval length = square_root(dot(axis, axis)), half(0.5 * double(turn[3]));
  const Interval s = sine(half) / length;
  return {cosine(half), s * axis[0], s * axis[1], s * axis[2]};
}

// Slerp (Shoemake 1985): q = (sin((1 - w) W) a + sin(w W) b) / sin W, where cos W is their dot product. Of b and -b,
// which are one orientation, the nearer counts.
OracleMotion::Quaternion OracleMotion::between(const Quaternion& a, const Quaternion& b, const Interval& weight) {
  Interval product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  assert(product.lo > 0.0 || product.hi < 0.0);
  const double sign = product.hi < 0.0 ? -1.0 : 1.0;
  if (sign < 0.0) product = -product;
  const Interval angle = arc_cosine(product), whole = sine(angle);
  assert(whole.lo > 1e-3);  // equal orientations are not interpolated
  const Interval of_a = sine((Interval(1.0) - weight) * angle) / whole;
  const Interval of_b = Interval(sign) * sine(weight * angle) / whole;
  Quaternion out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = of_a * a[k] + of_b * b[k];
  return out;
}

Matrix OracleMotion::matrix(const Quaternion& q) {
  const auto& [w, x, y, z] = q;
  const Interval one(1.0), two(2.0);
  return {Point{one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)},
          Point{two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)},
          Point{two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)}};
}

Matrix OracleMotion::rotation(int node, double t_s, double within_s) const {
  const Node& n = world_.nodes[std::size_t(node)];
  Place at;
  if (!place(n.rotations, t_s, within_s, at)) return still_turns_[std::size_t(node)];
  const auto& turns = turns_[std::size_t(node)];
  if (at.from == at.to || n.rotations.value[at.from] == n.rotations.value[at.to]) return matrix(turns[at.from]);
  return matrix(between(turns[at.from], turns[at.to], at.weight));
}

// T * C * R * SR * S * SR^-1 * C^-1.
Map OracleMotion::parent_from_local(int node, double t_s, double within_s) const {
  const Node& n = world_.nodes[std::size_t(node)];
  Map out;
  if (n.kind != NodeKind::kTransform) return out;
  const Point scale = vector(n.scales, n.scale, t_s, within_s), center = point_of(n.center);
  const Matrix& sr = stretches_[std::size_t(node)];
  Matrix scaled = transposed(sr);
  for (std::size_t i = 0; i < 3; ++i) {
    for (Interval& entry : scaled[i]) entry = scale[i] * entry;
  }
  out.linear = times(rotation(node, t_s, within_s), times(sr, scaled));
  out.offset = vector(n.translations, n.translation, t_s, within_s) + center - times(out.linear, center);
  if (!n.translations.drives()) {
    for (std::size_t k = 0; k < 3; ++k) out.offset[k] = out.offset[k] + Interval(double(n.velocity[k])) * Interval(t_s);
  }
  return out;
}

std::vector<Point> OracleMotion::points(int form, double t_s, double within_s) const {
  const auto& bend = world_.forms[std::size_t(form)].bend;
  std::vector<Point> out;
  Place at;
  if (!place(bend, t_s, within_s, at)) {
    for (const Three& p : solids_[std::size_t(form)].points) out.push_back(point_of(p));
    return out;
  }
  for (std::size_t i = 0; i < bend.value[at.from].size(); ++i) {
    const Point from = point_of(bend.value[at.from][i]), to = point_of(bend.value[at.to][i]);
    Point& p = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) p[k] = from[k] + at.weight * (to[k] - from[k]);
  }
  return out;
}

// Bounds of speeds

OracleMotion::Bound OracleMotion::bound(int node, const Bound& below, double within_s) const {
  const Node& n = world_.nodes[std::size_t(node)];
  if (n.kind != NodeKind::kTransform) return below;
  double translation_m = length_of(n.translation), speed_m_s = 0.0, scale = largest(n.scale), scale_per_s = 0.0;
  double turn_rad_s = 0.0;
  Place at;
  if (place(n.translations, within_s, within_s, at)) {
    const Three &from = n.translations.value[at.from], &to = n.translations.value[at.to];
    translation_m = std::max(length_of(from), length_of(to));
    if (at.seconds > 0.0) speed_m_s = distance(from, to) / at.seconds;
  }
  if (!n.translations.drives()) {
    speed_m_s = length_of(n.velocity);
    translation_m += speed_m_s * world_.duration_s;
  }
  if (place(n.scales, within_s, within_s, at)) {
    const Three &from = n.scales.value[at.from], &to = n.scales.value[at.to];
    scale = std::max(largest(from), largest(to));
    if (at.seconds > 0.0) scale_per_s = largest({from[0] - to[0], from[1] - to[1], from[2] - to[2]}) / at.seconds;
  }
  if (place(n.rotations, within_s, within_s, at) && at.seconds > 0.0) {
    const auto &a = turns_[std::size_t(node)][at.from], &b = turns_[std::size_t(node)][at.to];
    const Interval product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    const double cosine_of = std::max(std::abs(product.lo), std::abs(product.hi));
    turn_rad_s = (2.0 * std::acos(std::min(1.0, cosine_of)) + 1e-7) / at.seconds;
  }
  // The point goes along T + C + R S p, where R turns at a constant rate and T and S change at one.
  const double arm_m = below.radius_m + length_of(n.center);
  const double scaled_m = scale * arm_m, scaled_m_s = scale_per_s * arm_m + scale * below.speed_m_s;
  const double scaled_m_s2 = 2.0 * scale_per_s * below.speed_m_s + scale * below.acceleration_m_s2;
  return {kRoom * (translation_m + length_of(n.center) + scaled_m),
          kRoom * (speed_m_s + turn_rad_s * scaled_m + scaled_m_s),
          kRoom * (turn_rad_s * turn_rad_s * scaled_m + 2.0 * turn_rad_s * scaled_m_s + scaled_m_s2)};
}

OracleMotion::Bound OracleMotion::bound_of_form(int form, double within_s) const {
  const auto& bend = world_.forms[std::size_t(form)].bend;
  Bound bound;
  Place at;
  if (!place(bend, within_s, within_s, at)) {
    for (const Three& p : solids_[std::size_t(form)].points) bound.radius_m = std::max(bound.radius_m, length_of(p));
    bound.radius_m *= kRoom;
    return bound;
  }
  for (std::size_t i = 0; i < bend.value[at.from].size(); ++i) {
    const Three &from = bend.value[at.from][i], &to = bend.value[at.to][i];
    bound.radius_m = std::max({bound.radius_m, kRoom * length_of(from), kRoom * length_of(to)});
    if (at.seconds > 0.0) bound.speed_m_s = std::max(bound.speed_m_s, kRoom * distance(from, to) / at.seconds);
  }
  return bound;
}

// Geometry

OracleMotion::Solid OracleMotion::solid(const Form& form) {
  Solid out;
  auto& [points, triangles] = out;
  const double radius = form.size[0], half = 0.5 * double(form.size[1]);
  switch (form.kind) {
    case FormKind::kFaces:
      return {form.points, form.triangles};
    case FormKind::kBox:
      for (int corner = 0; corner < 8; ++corner) {
        const auto at = [&](int k) {
          return (corner >> k & 1) != 0 ? 0.5F * form.size[std::size_t(k)] : -0.5F * form.size[std::size_t(k)];
        };
        points.push_back({at(0), at(1), at(2)});
      }
      for (const auto& [a, b, c, d] : {std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}, std::array{0, 1, 5, 4},
                                       std::array{2, 6, 7, 3}, std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}}) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      }
      return out;
    case FormKind::kCone:
      add_ring(points, radius, -half);
      points.push_back({0, float(half), 0});
      add_fan(triangles, 0, kSlices);
      add_cap(triangles, 0);
      return out;
    case FormKind::kCylinder:
      add_ring(points, radius, -half);
      add_ring(points, radius, half);
      add_band(triangles, 0, kSlices);
      add_cap(triangles, 0);
      add_cap(triangles, kSlices);
      return out;
    case FormKind::kSphere:
      for (int stack = 1; stack < kStacks; ++stack) {
        const double polar = std::numbers::pi * stack / kStacks;
        add_ring(points, radius * std::sin(polar), radius * std::cos(polar));
        if (stack > 1) add_band(triangles, (stack - 1) * kSlices, (stack - 2) * kSlices);
      }
      points.push_back({0, float(radius), 0});
      points.push_back({0, float(-radius), 0});
      add_fan(triangles, 0, int(points.size()) - 2);
      add_fan(triangles, (kStacks - 2) * kSlices, int(points.size()) - 1);
      return out;
  }
  return out;
}

}  // namespace peerd::living

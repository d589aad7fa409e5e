#include "tests/sim/living/oracle.hpp"

#include <limits>
#include <map>
#include <set>

namespace peerd::living {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Reported times are whole nanoseconds; times of breaks are rounded by less.
constexpr double kInstant_s = 2e-9;
// Where the bounds would allow less, the search goes on by this, without proof for so long, and by twice as much each
// time up to the other: of two that hover within a hair's breadth nothing can be proven at any time.
constexpr double kLeastStep_s = 2e-5, kBlindStep_s = 16.0 * kLeastStep_s;
// Of steps up to this it is tried whether the two glide along each other: the reference's ticks are no closer together.
constexpr double kGlide_s = 1e-3;
constexpr std::uint64_t kPlacementsMax = 40'000;

}  // namespace

ContactOracle::ContactOracle(const OracleMotion& motion, const World& world, int collider, int collidee,
                             InterestType type)
    : motion_(motion), world_(world), type_(type), collider_(parts_of(collider)), collidee_(parts_of(collidee)) {
  // The frame of what holds both: what they go by together parts them by nothing, however fast it is.
  const auto path_of_end = [&](int node) {
    std::vector<int> path;
    for (int i = node; i >= 0; i = world.nodes[std::size_t(i)].parent) path.insert(path.begin(), i);
    return path;
  };
  const std::vector<int> a = path_of_end(collider), b = path_of_end(collidee);
  if (type != InterestType::kBox) {
    while (common_ < std::min(a.size(), b.size()) && a[common_] == b[common_]) ++common_;
  }
  std::vector<double> breaks{0.0, world.duration_s};
  std::set<int> clocks;
  const auto add = [&](const auto& path) {
    if (path.drives()) clocks.insert(path.clock);
  };
  for (const auto* parts : {&collider_, &collidee_}) {
    for (const Part& part : *parts) {
      for (const int i : part.path) {
        const Node& node = world.nodes[std::size_t(i)];
        add(node.translations), add(node.scales), add(node.rotations);
        if (node.form >= 0) add(world.forms[std::size_t(node.form)].bend);
      }
    }
  }
  for (const int clock : clocks) {
    const auto more = motion.breaks_of_clock(clock);
    breaks.insert(breaks.end(), more.begin(), more.end());
  }
  std::ranges::sort(breaks);
  double begin_s = breaks.front();
  for (const double at_s : breaks) {
    if (at_s - begin_s < kInstant_s) continue;  // one break, rounded differently
    pieces_.push_back({begin_s, at_s});
    begin_s = at_s;
  }
}

std::vector<ContactOracle::Part> ContactOracle::parts_of(int node) const {
  std::vector<Part> parts;
  for (int i = 0; i < int(world_.nodes.size()); ++i) {
    if (world_.nodes[std::size_t(i)].kind != NodeKind::kShape) continue;
    std::vector<int> path;
    for (int k = i; k >= 0; k = world_.nodes[std::size_t(k)].parent) path.insert(path.begin(), k);
    if (std::ranges::find(path, node) == path.end()) continue;
    const int form = world_.nodes[std::size_t(i)].form;
    parts.push_back({i, path, Soup(motion_.triangles(form), motion_.points(form, 0.0, 0.0)), 0.0});
  }
  return parts;
}

std::vector<ContactOracle::Piece> ContactOracle::pieces_at(double t_s) const {
  std::vector<Piece> pieces;
  for (const Piece& piece : pieces_) {
    if (t_s >= piece.begin_s - kInstant_s && t_s <= piece.end_s + kInstant_s) pieces.push_back(piece);
  }
  assert(!pieces.empty());
  return pieces;
}

void ContactOracle::set_bounds(std::vector<Part>& parts, double within_s) const {
  for (Part& part : parts) {
    OracleMotion::Bound bound = motion_.bound_of_form(world_.nodes[std::size_t(part.node)].form, within_s);
    for (std::size_t i = part.path.size(); i-- > common_;) bound = motion_.bound(part.path[i], bound, within_s);
    part.speed_m_s = bound.speed_m_s;
    part.acceleration_m_s2 = bound.acceleration_m_s2;
  }
}

void ContactOracle::place(double t_s, const Piece& piece, bool in_world) {
  ++placements_;
  std::map<int, Map> maps;  // from the frame of a node's children
  const double within_s = piece.middle_s();
  const std::size_t first = in_world ? 0 : common_;
  for (auto* parts : {&collider_, &collidee_}) {
    for (Part& part : *parts) {
      Map map;
      for (std::size_t i = first; i < part.path.size(); ++i) {
        const auto known = maps.find(part.path[i]);
        if (known != maps.end()) {
          map = known->second;
          continue;
        }
        const Map local = motion_.parent_from_local(part.path[i], t_s, within_s);
        map = i == first ? local : times(map, local);
        maps.emplace(part.path[i], map);
      }
      std::vector<Point> points = motion_.points(world_.nodes[std::size_t(part.node)].form, t_s, within_s);
      for (Point& point : points) point = times(map, point);
      part.soup.place(points, kVertexSlack_m);
    }
  }
}

// The box of a box of all vertices: its least and its greatest extent.
struct ContactOracle::Box {
  std::array<Range, 3> lo{}, hi{};
};

ContactOracle::Box ContactOracle::box_of(const std::vector<Part>& parts) {
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.lo[k] = {kInfinity, kInfinity}, box.hi[k] = {-kInfinity, -kInfinity};
    for (const Part& part : parts) part.soup.extend(k, box.lo[k], box.hi[k]);
  }
  return box;
}

std::array<double, 6> ContactOracle::box_gaps() const {
  assert(type_ == InterestType::kBox);
  const Box a = box_of(collider_), b = box_of(collidee_);
  std::array<double, 6> gaps{};
  for (std::size_t k = 0; k < 3; ++k) {
    gaps[2 * k] = down(b.lo[k].lo - a.hi[k].hi);
    gaps[2 * k + 1] = down(a.lo[k].lo - b.hi[k].hi);
  }
  return gaps;
}

Range ContactOracle::distance_placed() const {
  if (type_ != InterestType::kBox) {
    Range range{kInfinity, kInfinity};
    for (const Part& a : collider_) {
      for (const Part& b : collidee_) {
        if (a.node != b.node) Soup::lower_distance(a.soup, b.soup, range);
      }
    }
    return range;
  }
  const Box a = box_of(collider_), b = box_of(collidee_);
  Range gap{std::ranges::max(box_gaps()), -kInfinity};
  for (std::size_t k = 0; k < 3; ++k) gap.hi = std::max({gap.hi, b.lo[k].hi - a.hi[k].lo, a.lo[k].hi - b.hi[k].lo});
  return {std::max(0.0, gap.lo), std::max(0.0, up(gap.hi))};
}

bool ContactOracle::touch_placed() const {
  if (type_ == InterestType::kBox) return distance_placed().hi == 0.0;
  for (const Part& a : collider_) {
    for (const Part& b : collidee_) {
      if (a.node != b.node && Soup::cross(a.soup, b.soup)) return true;
    }
  }
  return false;
}

Range ContactOracle::distance_m(double t_s) {
  Range range{kInfinity, kInfinity};
  for (const Piece& piece : pieces_at(t_s)) {
    place(t_s, piece, true);
    const Range there = distance_placed();
    range = {std::min(range.lo, there.lo), std::min(range.hi, there.hi)};
  }
  return range;
}

bool ContactOracle::touches(double t_s) {
  return std::ranges::any_of(pieces_at(t_s), [&](const Piece& piece) {
    place(t_s, piece, true);
    return touch_placed();
  });
}

ContactOracle::Verdict ContactOracle::judge(double since_s, double t_s) {
  placements_ = 0;
  Verdict verdict;
  verdict.distance_m = distance_m(t_s);
  for (double back_s = kInstant_s; t_s - back_s > since_s; back_s *= 2.0) {
    const auto pieces = pieces_at(t_s - back_s);
    // A jump at that very time may be what the report is of.
    const bool all = std::ranges::all_of(pieces, [&](const Piece& piece) {
      place(t_s - back_s, piece, true);
      return touch_placed();
    });
    if (!all) break;
    verdict.late_s = back_s;
  }
  sweep(since_s, t_s - kInstant_s, verdict);
  verdict.placements = placements_;
  return verdict;
}

// A point that goes from one place to another leaves the straight way between them by a h^2 / 8 at most, and on
// straight ways the gap of two sets along a direction is never less than the lesser one of its ends'.
double ContactOracle::glide_s(const Piece& piece, double at_s, double longest_s, double speed_m_s,
                              double acceleration_m_s2) {
  struct Pair {
    const Part *a, *b;
    Soup::Near near;
  };
  std::vector<Pair> pairs;
  const bool boxes = type_ == InterestType::kBox;
  const auto gaps = boxes ? box_gaps() : std::array<double, 6>{};
  std::vector<Soup::Near> near;
  for (const Part& a : collider_) {
    for (const Part& b : collidee_) {
      if (boxes || a.node == b.node) continue;
      near.clear();
      Soup::find_near(a.soup, b.soup, up(speed_m_s * longest_s), near);  // the other ones do not come to touch
      for (const Soup::Near& pair : near) {
        if (pair.gap_m == 0.0) return 0.0;
        pairs.push_back({&a, &b, pair});
      }
    }
  }
  for (double h_s = longest_s; h_s >= kLeastStep_s; h_s *= 0.5) {
    place(at_s + h_s, piece, false);
    const double bend_m = up(acceleration_m_s2 * h_s * h_s / 8.0);
    const auto stays_apart = [&](const Pair& pair) {
      return std::min(pair.near.gap_m, Soup::gap_m(pair.a->soup, pair.b->soup, pair.near)) > bend_m;
    };
    if (!boxes && std::ranges::all_of(pairs, stays_apart)) return h_s;
    if (!boxes) continue;
    const auto gaps_then = box_gaps();
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      if (std::min(gaps[k], gaps_then[k]) > bend_m) return h_s;
    }
  }
  return 0.0;
}

void ContactOracle::sweep(double since_s, double t_s, Verdict& verdict) {
  for (const Piece& piece : pieces_) {
    if (verdict.earlier_touch_s || !verdict.complete) return;
    sweep_piece(piece, since_s, t_s, verdict);
  }
}

void ContactOracle::sweep_piece(const Piece& piece, double since_s, double t_s, Verdict& verdict) {
  const double end_s = std::min(piece.end_s, t_s);
  double at_s = std::max(piece.begin_s, since_s);
  if (at_s >= end_s) return;
  set_bounds(collider_, piece.middle_s());
  set_bounds(collidee_, piece.middle_s());
  double speed_m_s = 1e-12, acceleration_m_s2 = 0.0;
  for (const Part& a : collider_) {
    for (const Part& b : collidee_) {
      speed_m_s = std::max(speed_m_s, a.speed_m_s + b.speed_m_s);
      acceleration_m_s2 = std::max(acceleration_m_s2, a.acceleration_m_s2 + b.acceleration_m_s2);
    }
  }
  speed_m_s = up(speed_m_s), acceleration_m_s2 = up(acceleration_m_s2);
  double glide = kGlide_s, blind_s = kLeastStep_s;
  while (at_s < end_s) {
    if (placements_ > kPlacementsMax) {
      verdict.complete = false;
      return;
    }
    place(at_s, piece, false);
    const double gap_m = distance_placed().lo;
    double step_s = down(gap_m / speed_m_s);
    if (step_s < kGlide_s && gap_m > 0.0) {
      const double glides_s = glide_s(piece, at_s, std::min(glide, end_s - at_s), speed_m_s, acceleration_m_s2);
      glide = std::clamp(2.0 * glides_s, kLeastStep_s, kGlide_s);
      step_s = std::max(step_s, glides_s);
    }
    if (step_s >= std::min(kLeastStep_s, end_s - at_s)) {
      blind_s = kLeastStep_s;
    } else {
      place(at_s, piece, false);
      if (touch_placed()) {
        verdict.earlier_touch_s = at_s;
        return;
      }
      verdict.unproven_s += std::min(blind_s, end_s - at_s) - step_s;
      step_s = blind_s;
      blind_s = std::min(2.0 * blind_s, kBlindStep_s);
    }
    at_s += step_s;
  }
}

}  // namespace peerd::living

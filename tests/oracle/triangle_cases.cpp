// The generators are small functions, put together by templates that take one and give another: a contact that is exact
// by construction, then placed, then 1 ulp off. To be the same everywhere, libm is asked for nothing that it may round
// in its own way, and no expression draws twice where C++ leaves the order open (in braces it does not).
#include "tests/oracle/triangle_cases.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace peerd::oracle {

Rng::Rng(std::uint64_t seed) {
  for (std::uint64_t& word : state_) {
    seed += 0x9e3779b97f4a7c15;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Rng::next() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

// The modulo's bias is below 2^-10 for every bound used here, and a test does not mind.
std::uint64_t Rng::below(std::uint64_t bound) {
  assert(bound > 0);
  return next() % bound;
}

std::int64_t Rng::integer(std::int64_t low, std::int64_t high) {
  return low + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(high - low) + 1));
}

double Rng::unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

namespace {

using Make = Pair (*)(Rng&);

// Points and triangles

Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator-(const Point& a) { return {-a[0], -a[1], -a[2]}; }
Point operator-(const Point& a, const Point& b) { return a + -b; }
Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Change>  // Point -> Point
Pair each_point(const Pair& pair, const Change& change) {
  const auto apply = [&](const Triangle& t) { return Triangle{change(t[0]), change(t[1]), change(t[2])}; };
  return {apply(pair.a), apply(pair.b)};
}

template <class Change>  // double -> double
Pair each_coordinate(const Pair& pair, const Change& change) {
  return each_point(pair, [&](const Point& p) { return Point{change(p[0]), change(p[1]), change(p[2])}; });
}

double& coordinate(Pair& pair, std::size_t index) { return (index < 9 ? pair.a : pair.b)[index % 9 / 3][index % 3]; }

Point real_point(Rng& rng, double radius) {
  return {rng.real(-radius, radius), rng.real(-radius, radius), rng.real(-radius, radius)};
}

Triangle real_triangle(Rng& rng, const Point& centre, double radius) {
  return {centre + real_point(rng, radius), centre + real_point(rng, radius), centre + real_point(rng, radius)};
}

// Integers of at most `bits` bits, most of them small in half of the calls: then much is parallel or of one plane.
Point integer_point(Rng& rng, int bits) {
  const std::int64_t limit = rng.coin() ? 3 : (std::int64_t{1} << bits) - 1;
  const auto number = [&] { return static_cast<double>(rng.integer(-limit, limit)); };
  return {number(), number(), number()};
}

Point direction(Rng& rng, int bits) {
  Point result;
  do result = integer_point(rng, bits);
  while (result == Point{});
  return result;
}

double small_factor(Rng& rng) { return static_cast<double>(rng.integer(1, 8)); }

template <class T, std::size_t N>
void shuffle(Rng& rng, std::array<T, N>& items) {
  for (std::size_t i = N; i > 1; --i) std::swap(items[i - 1], items[rng.below(i)]);
}

// Modifiers: they take a generator and give another

// Orders of the points, of the triangles and of the axes, and mirrors: all exact. Every row of the tables has it.
template <Make make>
Pair shuffled(Rng& rng) {
  Pair pair = make(rng);
  shuffle(rng, pair.a);
  shuffle(rng, pair.b);
  if (rng.coin()) std::swap(pair.a, pair.b);
  std::array<std::size_t, 3> axes{0, 1, 2};
  shuffle(rng, axes);
  const Point sign{rng.coin() ? 1.0 : -1.0, rng.coin() ? 1.0 : -1.0, rng.coin() ? 1.0 : -1.0};
  return each_point(pair, [&](const Point& p) {
    return Point{sign[0] * p[axes[0]], sign[1] * p[axes[1]], sign[2] * p[axes[2]]};
  });
}

// One coordinate's next neighbour, up or down. Zero's is the smallest denormal.
template <Make make>
Pair ulp(Rng& rng) {
  Pair pair = make(rng);
  constexpr double kMost = std::numeric_limits<double>::max();
  double& changed = coordinate(pair, rng.below(18));
  changed = std::nextafter(changed, rng.coin() ? kMost : -kMost);
  return pair;
}

// Every coordinate by -1, 0 or 1 ulp.
template <Make make>
Pair jittered(Rng& rng) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return each_coordinate(make(rng), [&](double x) {
    const std::uint64_t step = rng.below(3);
    return step == 0 ? x : std::nextafter(x, step == 1 ? kMost : -kMost);
  });
}

// Rounds each coordinate to binary32.
template <Make make>
Pair f32(Rng& rng) {
  return each_coordinate(make(rng), [](double x) {
    // volatile: GCC 12's vectorizer takes two neighbours' way to binary32 and back for nothing, and leaves both out.
    volatile float rounded = static_cast<float>(x);
    return static_cast<double>(rounded);
  });
}

// Scales to a greatest coordinate in [1, 2), exactly.
Pair to_unit(const Pair& pair) {
  double greatest = 0;
  each_coordinate(pair, [&](double x) { return greatest = std::max(greatest, std::abs(x)); });
  const int exponent = greatest == 0 ? 0 : std::ilogb(greatest);
  return each_coordinate(pair, [&](double x) { return std::ldexp(x, -exponent); });
}

template <Make make, int exponent>
Pair unit_times(Rng& rng) {
  return each_coordinate(to_unit(make(rng)), [](double x) { return std::ldexp(x, exponent); });
}

// Not of unit size: for integers, so that the step between them is 2^exponent.
template <Make make, int exponent>
Pair times(Rng& rng) {
  return each_coordinate(make(rng), [](double x) { return std::ldexp(x, exponent); });
}

// Scaling by a factor of 1e30 rounds.
template <Make make>
Pair times_1e30(Rng& rng) {
  return each_coordinate(to_unit(make(rng)), [](double x) { return x * 1e30; });
}

// Each triangle by its own power of two around the origin, where the contacts of contact() stay.
template <Make make, int lowest, int highest>
Pair scaled_apart(Rng& rng) {
  const Pair pair = make(rng);
  const int to_a = static_cast<int>(rng.integer(lowest, highest)),
            to_b = static_cast<int>(rng.integer(lowest, highest));
  const auto by = [](const Pair& p, int n) { return each_coordinate(p, [n](double x) { return std::ldexp(x, n); }); };
  return {by(pair, to_a).a, by(pair, to_b).b};
}

// Translations are whole numbers, so that integers of at most 51 bits stay exact.
template <Make make>
Pair placed(Rng& rng) {
  const Point offset = integer_point(rng, rng.coin() ? 10 : 50);
  return each_point(make(rng), [&](const Point& p) { return p + offset; });
}

template <Make make>
Pair far_away(Rng& rng) {
  Point offset;
  for (double& x : offset) {
    x = static_cast<double>(rng.integer(999'000, 1'001'000));
    if (rng.coin()) x = -x;
  }
  return each_point(to_unit(make(rng)), [&](const Point& p) { return p + offset; });
}

// A rigid motion in floating point: what was a contact is one but for rounding.
template <Make make>
Pair moved(Rng& rng) {
  std::array<double, 4> q;
  double norm = 0;
  while (norm < 0.1) {
    for (double& x : q) x = rng.real(-1, 1);
    norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  }
  for (double& x : q) x /= norm;
  const auto [w, x, y, z] = q;
  const std::array<Point, 3> rotation{Point{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                      Point{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                      Point{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  const Point offset = rng.coin() ? Point{} : real_point(rng, 10);
  return each_point(to_unit(make(rng)), [&](const Point& p) {
    return Point{dot(rotation[0], p), dot(rotation[1], p), dot(rotation[2], p)} + offset;
  });
}

// Ordinary pairs

Pair uniform(Rng& rng) { return {real_triangle(rng, {}, 1), real_triangle(rng, {}, 1)}; }

// Centres up to half a diameter apart along each axis.
Pair neighbours(Rng& rng) {
  const Point centre = real_point(rng, 10);
  return {real_triangle(rng, centre, 1), real_triangle(rng, centre + real_point(rng, 1), 1)};
}

// Each 1 to 1000 times as large as the other one.
Pair sizes(Rng& rng) {
  const double ratio = 1 / rng.real(1e-3, 1);
  return {real_triangle(rng, {}, ratio), real_triangle(rng, real_point(rng, ratio / 2), 1)};
}

// Around two points nearby, so that most of them cross.
Pair crossing(Rng& rng) {
  const auto around = [&](const Point& x) {
    const Point u = real_point(rng, 1), v = real_point(rng, 1);
    const double s = rng.real(0.1, 2), t = rng.real(0.1, 2);
    return Triangle{x + u, x + v, x - s * u - t * v};
  };
  const Point x = real_point(rng, 10);
  return {around(x), around(x + real_point(rng, 0.1))};
}

// Coordinates as in files: three decimals, read to binary64.
Pair decimals(Rng& rng) {
  return each_coordinate(neighbours(rng), [](double x) { return std::nearbyint(x * 1000) / 1000; });
}

template <int limit>
Pair lattice(Rng& rng) {
  return each_coordinate(Pair{}, [&](double) { return static_cast<double>(rng.integer(0, limit)); });
}

// Contacts at the origin, in integers of at most 48 bits: exact by construction

enum class Feature { point, segment_end, segment, vertex, edge, face };

constexpr int tangents(Feature feature) {
  return feature == Feature::face ? 2 : feature == Feature::edge || feature == Feature::segment ? 1 : 0;
}

// Directions in space, or with z = 0.
struct Directions {
  int bits;
  bool flat;
  Point operator()(Rng& rng) const {
    Point result{};
    while (result == Point{}) {
      result = integer_point(rng, bits);
      if (flat) result[2] = 0;
    }
    return result;
  }
};

// A triangle that has the origin on this feature. u, v: along the feature, where it has that many tangents. What is
// left of the triangle lies where side.p >= 0 (up to the rounding of this product, which moves no contact).
Triangle at_origin(Rng& rng, const Directions& any, Feature feature, const Point& u, const Point& v,
                   const Point& side) {
  const auto free = [&] {
    const Point p = any(rng);
    return dot(side, p) < 0 ? -p : p;
  };
  const Point origin{};
  switch (feature) {
    case Feature::point:
      return {origin, origin, origin};
    case Feature::segment_end: {
      const Point p = free();
      return {origin, small_factor(rng) * p, rng.coin() ? origin : small_factor(rng) * p};
    }
    case Feature::segment: {
      const Point back = -small_factor(rng) * u, on = small_factor(rng) * u;
      return {back, on, static_cast<double>(rng.integer(-8, 8)) * u};
    }
    case Feature::vertex:
      return {origin, free(), free()};
    case Feature::edge:
      return {-small_factor(rng) * u, small_factor(rng) * u, free()};
    case Feature::face:
      break;
  }
  const double p = small_factor(rng), q = small_factor(rng), r = small_factor(rng), s = small_factor(rng);
  return {p * u, q * v, -r * u - s * v};
}

// Just touching at the origin where the two features leave room for that (at most two tangents together; one where all
// is flat), else crossing.
Pair contact_of(Rng& rng, const Directions& any, Feature of_a, Feature of_b) {
  const std::array<Point, 4> t{any(rng), any(rng), any(rng), any(rng)};  // two tangents each
  const Point& along = tangents(of_a) > 0 ? t[0] : t[2];
  const Point side = any.flat              ? cross(along, {0, 0, 1})
                     : tangents(of_a) == 2 ? cross(t[0], t[1])
                     : tangents(of_b) == 2 ? cross(t[2], t[3])
                                           : cross(t[0], t[2]);
  return {at_origin(rng, any, of_a, t[0], t[1], side), at_origin(rng, any, of_b, t[2], t[3], -side)};
}

Directions in_space(Rng& rng) { return {.bits = std::array{3, 10, 23, 44}[rng.below(4)], .flat = false}; }

template <Feature of_a, Feature of_b>
Pair contact(Rng& rng) {
  return contact_of(rng, in_space(rng), of_a, of_b);
}

Feature any_feature(Rng& rng) { return static_cast<Feature>(rng.below(6)); }
Pair any_contact(Rng& rng) {
  const Feature of_a = any_feature(rng);
  const Feature of_b = any_feature(rng);
  return contact_of(rng, in_space(rng), of_a, of_b);
}

template <Feature feature>
Pair contact_with_any(Rng& rng) {
  const Feature other = any_feature(rng);
  return contact_of(rng, in_space(rng), feature, other);
}

// The contact is in one tilted plane through the origin: a linear map in whole numbers keeps it.
Pair coplanar_contact(Rng& rng) {
  const Feature of_a = any_feature(rng), of_b = any_feature(rng);
  const Pair flat = contact_of(rng, {.bits = rng.coin() ? 3 : 10, .flat = true}, of_a, of_b);
  const int bits = rng.coin() ? 2 : 30;
  const Point u = direction(rng, bits), v = direction(rng, bits);
  return each_point(flat, [&](const Point& p) { return p[0] * u + p[1] * v; });
}

constexpr Make kVertexVertex = contact<Feature::vertex, Feature::vertex>;
constexpr Make kVertexEdge = contact<Feature::vertex, Feature::edge>;
constexpr Make kVertexFace = contact<Feature::vertex, Feature::face>;
constexpr Make kEdgeEdge = contact<Feature::edge, Feature::edge>;
constexpr Make kEdgeFace = contact<Feature::edge, Feature::face>;
constexpr Make kFaceFace = contact<Feature::face, Feature::face>;
constexpr Make kPoint = contact_with_any<Feature::point>;
constexpr Make kSegmentEnd = contact_with_any<Feature::segment_end>;
constexpr Make kSegment = contact_with_any<Feature::segment>;

// Zero area without a contact made on purpose: points, segments with two equal points or a third between or beyond.
Triangle degenerate(Rng& rng) {
  const Point p = integer_point(rng, 1), u = integer_point(rng, 1);
  if (rng.below(4) == 0) return {p, p, p};
  const auto s = static_cast<double>(rng.integer(1, 2)), t = static_cast<double>(rng.integer(-2, 2));
  return {p, p + s * u, p + t * u};
}

Pair degenerate_and_any(Rng& rng) {
  const auto any = [&] { return Triangle{integer_point(rng, 1), integer_point(rng, 1), integer_point(rng, 1)}; };
  return {degenerate(rng), rng.coin() ? degenerate(rng) : any()};
}

// In one plane

// Both triangles on a small lattice, which axes span and a step makes exact.
Pair on_plane(Rng& rng, const Point& origin, const Point& u, const Point& v) {
  const std::int64_t limit = rng.coin() ? 4 : 100;
  const auto point = [&] {
    const auto i = static_cast<double>(rng.integer(0, limit)), j = static_cast<double>(rng.integer(0, limit));
    return origin + i * u + j * v;
  };
  return {Triangle{point(), point(), point()}, Triangle{point(), point(), point()}};
}

Pair coplanar_axis(Rng& rng) { return on_plane(rng, direction(rng, 20), {1, 0, 0}, {0, 1, 0}); }

Pair coplanar_tilted(Rng& rng) {
  const int bits = rng.coin() ? 3 : 40;
  const Point origin = direction(rng, bits), u = direction(rng, bits), v = direction(rng, bits);
  return on_plane(rng, origin, u, v);
}

// All of a coordinate's bits, on z = constant or z = x.
Pair coplanar_real(Rng& rng) {
  const bool tilted = rng.coin();
  const double height = rng.real(-1, 1);
  return each_point(neighbours(rng), [&](const Point& p) { return Point{p[0], p[1], tilted ? p[0] : height}; });
}

// Parallel planes, one ulp or more apart.
Pair parallel_planes(Rng& rng) {
  Pair pair = coplanar_real(rng);
  const double height = rng.real(1, 2), other = height + static_cast<double>(rng.integer(1, 4)) * 0x1p-52;
  for (Point& p : pair.a) p[2] = height;
  for (Point& p : pair.b) p[2] = other;
  return pair;
}

// Thin ones

// Length 1, width 1e-7, through x.
Triangle needle(Rng& rng, const Point& x) {
  const Point along = real_point(rng, 1), across = real_point(rng, 1e-7);
  const double from = rng.real(0, 1);
  return {x - from * along, x + (1 - from) * along, x + rng.real(-0.5, 0.5) * along + across};
}

Pair needles(Rng& rng) {
  const Point x = real_point(rng, 1);
  return {needle(rng, x), needle(rng, x + real_point(rng, 1e-7))};
}

Pair needle_and_any(Rng& rng) {
  const Point x = real_point(rng, 1), u = real_point(rng, 1), v = real_point(rng, 1);
  const Point near = x + real_point(rng, 1e-7);
  return {needle(rng, x), rng.coin() ? Triangle{near, near + u, near + v} : Triangle{near - u, near + u, near + v}};
}

// The third point is on the line of the others but for rounding.
Triangle sliver(Rng& rng, const Point& x) {
  const Point u = real_point(rng, 1);
  const Point p = x + rng.real(0, 1) * u, q = x - rng.real(0, 1) * u;
  return {p, q, p + rng.real(-0.5, 1.5) * (q - p)};
}

Pair slivers(Rng& rng) {
  const Point x = real_point(rng, 1);
  return {sliver(rng, x), sliver(rng, x)};
}

Pair sliver_and_any(Rng& rng) {
  const Point x = real_point(rng, 1);
  const Triangle a = sliver(rng, x);
  const Point u = real_point(rng, 1), v = real_point(rng, 1);
  switch (rng.below(4)) {
    case 0:
      return {a, {x, x + u, x + v}};
    case 1:
      return {a, {x + u, x - rng.real(0, 1) * u, x + v}};
    case 2:
      return {a, {x + u, x + v, x - u - v}};
    default:
      return {a, {a[0] + 0.5 * (a[1] - a[0]), a[2] + 0.25 * (a[0] - a[2]), x + u}};
  }
}

// Lattice triangles of area 1/2 with sides of 2^20 and more: each orientation is a difference of 1 between products of
// 2^40. Both are taken from the corners of the lattice cells around one cell.
Pair unit_areas(Rng& rng) {
  std::int64_t p = 1, q = 0, r = 0, s = 1;  // p s - q r = 1
  for (int steps = static_cast<int>(rng.integer(4, 24)); steps > 0; --steps) {
    const std::int64_t n = rng.integer(1, 3);
    if (steps % 2 == 0) {
      p += n * r, q += n * s;
    } else {
      r += n * p, s += n * q;
    }
  }
  const Point e = direction(rng, 2), f = direction(rng, 2);
  const Point u = static_cast<double>(p) * e + static_cast<double>(q) * f;
  const Point v = static_cast<double>(r) * e + static_cast<double>(s) * f;
  const auto point = [&] {
    const auto i = static_cast<double>(rng.integer(-1, 2)), j = static_cast<double>(rng.integer(-1, 2));
    return i * u + j * v;
  };
  return {Triangle{point(), point(), point()}, Triangle{point(), point(), point()}};
}

// Shared points

template <std::size_t count>
Pair shared(Rng& rng) {
  Pair pair = neighbours(rng);
  std::copy_n(pair.a.begin(), count, pair.b.begin());
  return pair;
}

// Scales

// Any exponents in +-limit, a coordinate each.
template <int limit>
Pair any_exponents(Rng& rng) {
  return each_coordinate(Pair{}, [&](double) {
    const double mantissa = rng.real(-1, 1);
    return std::ldexp(mantissa, static_cast<int>(rng.integer(-limit, limit)));
  });
}

Pair denormals_and_zeros(Rng& rng) {
  return each_coordinate(lattice<2>(rng), [](double x) { return (x - 1) * std::numeric_limits<double>::denorm_min(); });
}

// Small whole numbers next to denormals.
Pair denormals_and_ones(Rng& rng) {
  return each_coordinate(lattice<2>(rng), [&](double x) { return rng.coin() ? x - 1 : std::ldexp(x - 1, -1074); });
}

Pair signed_zeros(Rng& rng) {
  return each_coordinate(lattice<2>(rng), [&](double x) { return x == 1 && rng.coin() ? -0.0 : x - 1; });
}

// Resting contacts

// One of a box's twelve triangles.
Triangle box_face(Rng& rng, const Point& low, const Point& high) {
  const std::size_t axis = rng.below(3), next = (axis + 1) % 3, last = (axis + 2) % 3;
  Point corner = low;
  if (rng.coin()) corner[axis] = high[axis];
  Point along = corner, across = corner, opposite = corner;
  along[next] = opposite[next] = high[next];
  across[last] = opposite[last] = high[last];
  return rng.coin() ? Triangle{corner, along, opposite} : Triangle{corner, opposite, across};
}

bool boxes_overlap(const Pair& pair) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low_a, high_a] = std::minmax({pair.a[0][k], pair.a[1][k], pair.a[2][k]});
    const auto [low_b, high_b] = std::minmax({pair.b[0][k], pair.b[1][k], pair.b[2][k]});
    if (high_a < low_b || high_b < low_a) return false;
  }
  return true;
}

// A box that stands on another, whose faces meet in one plane; edges are often aligned.
Pair resting(Rng& rng) {
  const bool aligned = rng.coin();
  const auto size = [&] { return aligned ? static_cast<double>(rng.integer(1, 4)) / 4 : rng.real(0.2, 1); };
  const Point low{0, -size(), 0}, high{1, 0, 1};
  Point corner{0, 0, 0}, extent{};
  for (std::size_t k = 0; k < 3; ++k) {
    extent[k] = size();
    if (k != 1) corner[k] = aligned ? static_cast<double>(rng.integer(-2, 3)) / 4 : rng.real(-0.5, 0.7);
  }
  Pair pair{};
  for (int tries = 0; tries < 4; ++tries) {  // most faces are nowhere near each other
    pair = {box_face(rng, low, high), box_face(rng, corner, corner + extent)};
    if (boxes_overlap(pair)) break;
  }
  return pair;
}

// The floor's side that is stood on and the side that stands on it: both in y = 0.
Pair on_floor(Rng& rng) {
  const auto half = [&](double x, double z, double size) {
    const Point p{x, 0, z}, q{x + size, 0, z}, r{x + size, 0, z + size}, s{x, 0, z + size};
    return rng.coin() ? Triangle{p, q, r} : Triangle{p, r, s};
  };
  const auto i = static_cast<double>(rng.integer(0, 3)), j = static_cast<double>(rng.integer(0, 3));
  const double x = rng.real(-0.5, 3.5), z = rng.real(-0.5, 3.5), size = rng.real(0.1, 2);
  return {half(i, j, 1), half(x, z, size)};
}

// Tables

constexpr std::array kGeneral{
    Generator{"uniform_f32", shuffled<f32<uniform>>},       Generator{"uniform_f64", shuffled<uniform>},
    Generator{"neighbours_f32", shuffled<f32<neighbours>>}, Generator{"neighbours_f64", shuffled<neighbours>},
    Generator{"sizes_f32", shuffled<f32<sizes>>},           Generator{"sizes_f64", shuffled<sizes>},
    Generator{"crossing_f32", shuffled<f32<crossing>>},     Generator{"crossing_f64", shuffled<crossing>},
    Generator{"decimals_f32", shuffled<f32<decimals>>},     Generator{"decimals_f64", shuffled<decimals>},
    Generator{"lattice_16", shuffled<lattice<16>>},
};

constexpr std::array kAdversarial{
    // Contacts
    Generator{"touch_vertex_vertex", shuffled<placed<kVertexVertex>>},
    Generator{"touch_vertex_edge", shuffled<placed<kVertexEdge>>},
    Generator{"touch_vertex_face", shuffled<placed<kVertexFace>>},
    Generator{"touch_edge_edge", shuffled<placed<kEdgeEdge>>},
    Generator{"touch_edge_face", shuffled<placed<kEdgeFace>>},
    Generator{"touch_crossing_faces", shuffled<placed<kFaceFace>>},
    Generator{"touch_any_at_origin", shuffled<any_contact>},
    Generator{"ulp_vertex_vertex", shuffled<ulp<placed<kVertexVertex>>>},
    Generator{"ulp_vertex_edge", shuffled<ulp<placed<kVertexEdge>>>},
    Generator{"ulp_vertex_face", shuffled<ulp<placed<kVertexFace>>>},
    Generator{"ulp_edge_edge", shuffled<ulp<placed<kEdgeEdge>>>},
    Generator{"ulp_any_at_origin", shuffled<ulp<any_contact>>},
    Generator{"jittered_vertex_vertex", shuffled<jittered<moved<placed<kVertexVertex>>>>},
    Generator{"jittered_vertex_edge", shuffled<jittered<placed<kVertexEdge>>>},
    Generator{"jittered_vertex_face", shuffled<jittered<placed<kVertexFace>>>},
    Generator{"jittered_edge_edge", shuffled<jittered<placed<kEdgeEdge>>>},
    Generator{"moved_vertex_edge", shuffled<moved<placed<kVertexEdge>>>},
    Generator{"moved_vertex_face", shuffled<moved<placed<kVertexFace>>>},
    Generator{"moved_edge_edge", shuffled<moved<placed<kEdgeEdge>>>},
    Generator{"moved_any_f32", shuffled<f32<moved<placed<any_contact>>>>},
    Generator{"lattice_1", shuffled<lattice<1>>},
    Generator{"lattice_2", shuffled<lattice<2>>},
    Generator{"lattice_4", shuffled<lattice<4>>},
    Generator{"ulp_lattice_2", shuffled<ulp<lattice<2>>>},
    Generator{"signed_zeros", shuffled<signed_zeros>},
    // One plane
    Generator{"coplanar_axis", shuffled<coplanar_axis>},
    Generator{"coplanar_tilted", shuffled<coplanar_tilted>},
    Generator{"coplanar_real", shuffled<coplanar_real>},
    Generator{"touch_coplanar", shuffled<placed<coplanar_contact>>},
    Generator{"ulp_coplanar", shuffled<ulp<placed<coplanar_contact>>>},
    Generator{"jittered_coplanar", shuffled<jittered<placed<coplanar_contact>>>},
    Generator{"moved_coplanar", shuffled<moved<coplanar_contact>>},
    Generator{"ulp_coplanar_axis", shuffled<ulp<coplanar_axis>>},
    Generator{"ulp_coplanar_tilted", shuffled<ulp<coplanar_tilted>>},
    Generator{"ulp_coplanar_real", shuffled<ulp<coplanar_real>>},
    Generator{"moved_coplanar_axis", shuffled<moved<coplanar_axis>>},
    Generator{"moved_coplanar_axis_f32", shuffled<f32<moved<coplanar_axis>>>},
    Generator{"apart_parallel_planes", shuffled<parallel_planes>},
    // Thin
    Generator{"needles", shuffled<needles>},
    Generator{"needle_and_any", shuffled<needle_and_any>},
    Generator{"needles_f32", shuffled<f32<needles>>},
    Generator{"slivers", shuffled<slivers>},
    Generator{"sliver_and_any", shuffled<sliver_and_any>},
    Generator{"sliver_and_any_f32", shuffled<f32<sliver_and_any>>},
    Generator{"unit_areas", shuffled<placed<unit_areas>>},
    Generator{"ulp_unit_areas", shuffled<ulp<placed<unit_areas>>>},
    // Zero area
    Generator{"touch_point", shuffled<placed<kPoint>>},
    Generator{"touch_segment_end", shuffled<placed<kSegmentEnd>>},
    Generator{"touch_segment", shuffled<placed<kSegment>>},
    Generator{"ulp_point", shuffled<ulp<placed<kPoint>>>},
    Generator{"ulp_segment_end", shuffled<ulp<placed<kSegmentEnd>>>},
    Generator{"ulp_segment", shuffled<ulp<placed<kSegment>>>},
    Generator{"moved_segment", shuffled<moved<placed<kSegment>>>},
    Generator{"degenerate_and_any", shuffled<degenerate_and_any>},
    Generator{"ulp_degenerate_and_any", shuffled<ulp<degenerate_and_any>>},
    // Shared points
    Generator{"touch_equal", shuffled<shared<3>>},
    Generator{"touch_shared_edge", shuffled<shared<2>>},
    Generator{"touch_shared_vertex", shuffled<shared<1>>},
    Generator{"jittered_equal", shuffled<jittered<shared<3>>>},
    Generator{"jittered_shared_edge", shuffled<jittered<shared<2>>>},
    Generator{"ulp_shared_vertex", shuffled<ulp<shared<1>>>},
    // Scales
    Generator{"touch_denormal", shuffled<times<any_contact, -1074>>},
    Generator{"ulp_denormal", shuffled<ulp<times<any_contact, -1074>>>},
    Generator{"uniform_1e-310", shuffled<unit_times<neighbours, -1030>>},
    Generator{"denormals_and_zeros", shuffled<denormals_and_zeros>},
    Generator{"denormals_and_ones", shuffled<denormals_and_ones>},
    Generator{"touch_1e-286", shuffled<unit_times<placed<any_contact>, -950>>},
    Generator{"uniform_1e30", shuffled<times_1e30<neighbours>>},
    Generator{"rounded_1e30", shuffled<times_1e30<placed<any_contact>>>},
    Generator{"touch_1e30", shuffled<unit_times<placed<any_contact>, 100>>},
    Generator{"touch_1e150", shuffled<unit_times<placed<any_contact>, 498>>},
    Generator{"ulp_1e150", shuffled<ulp<unit_times<placed<any_contact>, 498>>>},
    Generator{"touch_1e-30_and_1e30", shuffled<scaled_apart<any_contact, -148, 52>>},
    Generator{"touch_1e-150_and_1e150", shuffled<scaled_apart<any_contact, -546, 450>>},
    Generator{"touch_denormal_and_1e150", shuffled<scaled_apart<any_contact, -1074, 450>>},
    Generator{"ulp_1e-30_and_1e30", shuffled<ulp<scaled_apart<any_contact, -148, 52>>>},
    Generator{"ulp_denormal_and_1e150", shuffled<ulp<scaled_apart<any_contact, -1074, 450>>>},
    Generator{"exponents_3", shuffled<any_exponents<3>>},
    Generator{"exponents_100", shuffled<any_exponents<100>>},
    Generator{"exponents_500", shuffled<any_exponents<500>>},
    Generator{"far_neighbours_f64", shuffled<far_away<neighbours>>},
    Generator{"far_neighbours_f32", shuffled<f32<far_away<neighbours>>>},
    Generator{"far_contact", shuffled<far_away<any_contact>>},
    Generator{"ulp_far_contact", shuffled<ulp<far_away<any_contact>>>},
    // Resting
    Generator{"resting", shuffled<resting>},
    Generator{"ulp_resting", shuffled<ulp<resting>>},
    Generator{"moved_resting", shuffled<moved<resting>>},
    Generator{"moved_resting_f32", shuffled<f32<moved<resting>>>},
    Generator{"moved_resting_far", shuffled<far_away<moved<resting>>>},
    Generator{"floor", shuffled<on_floor>},
    Generator{"moved_floor", shuffled<moved<on_floor>>},
    Generator{"moved_floor_f32", shuffled<f32<moved<on_floor>>>},
};

}  // namespace

std::span<const Generator> general() { return kGeneral; }
std::span<const Generator> adversarial() { return kAdversarial; }

}  // namespace peerd::oracle

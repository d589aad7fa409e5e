#include "tests/sim/living/forms.hpp"

#include <cmath>

namespace peerd::living {
namespace {

using sim::testing_support::Chance;
using Outline = std::vector<std::array<float, 2>>;
using Triangles = std::vector<std::array<int, 3>>;

const Outline kL{{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
const Triangles kTrianglesOfL{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
const Outline kU{{-1, -1}, {1, -1}, {1, 1}, {0.5F, 1}, {0.5F, -0.5F}, {-0.5F, -0.5F}, {-0.5F, 1}, {-1, 1}};
const Triangles kTrianglesOfU{{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}};
const Outline kArrow{{0, 1}, {-1, -1}, {0, -0.375F}, {1, -1}};
const Triangles kTrianglesOfArrow{{0, 1, 2}, {0, 2, 3}};

void add_polygon(Form& form, std::vector<int> polygon, Triangles triangles) {
  form.polygons.push_back(std::move(polygon));
  form.triangles.insert(form.triangles.end(), triangles.begin(), triangles.end());
}
void add_triangle(Form& form, int a, int b, int c) { add_polygon(form, {a, b, c}, {{a, b, c}}); }
void add_rectangle(Form& form, int a, int b, int c, int d) { add_polygon(form, {a, b, c, d}, {{a, b, c}, {a, c, d}}); }

// A prism over an outline, or the outline alone, without a back.
Form over(const Outline& outline, const Triangles& triangles, float half_m, float height_m, bool prism) {
  Form form{.kind = FormKind::kFaces};
  const int n = int(outline.size());
  std::vector<int> front;
  for (int i = 0; i < n; ++i) front.push_back(i);
  for (const float z : prism ? std::vector<float>{0.5F * height_m, -0.5F * height_m} : std::vector<float>{0.0F}) {
    for (const auto& [x, y] : outline) form.points.push_back({half_m * x, half_m * y, z});
  }
  add_polygon(form, front, triangles);
  if (!prism) return form;
  std::vector<int> back;
  for (int i = n; i-- > 0;) back.push_back(n + i);
  Triangles of_back;
  for (const auto& [a, b, c] : triangles) of_back.push_back({n + c, n + b, n + a});
  add_polygon(form, back, of_back);
  for (int i = 0; i < n; ++i) add_rectangle(form, (i + 1) % n, i, n + i, n + (i + 1) % n);
  return form;
}

// A box without its lid.
Form open_box(float x, float y, float z) {
  Form form{.kind = FormKind::kFaces};
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](int bit, float size) { return (corner >> bit & 1) != 0 ? 0.5F * size : -0.5F * size; };
    form.points.push_back({at(0, x), at(1, y), at(2, z)});
  }
  add_rectangle(form, 0, 4, 6, 2);
  add_rectangle(form, 1, 3, 7, 5);
  add_rectangle(form, 0, 1, 5, 4);
  add_rectangle(form, 0, 2, 3, 1);
  add_rectangle(form, 4, 5, 7, 6);
  return form;
}

Form tetrahedron(Chance& chance, double size_m) {
  Form form{.kind = FormKind::kFaces};
  const auto near = [&](double x, double y, double z) {
    const auto at = [&](double mean) { return draw(chance, (mean - 0.2) * size_m, (mean + 0.2) * size_m); };
    const float at_x = at(x), at_y = at(y), at_z = at(z);
    form.points.push_back({at_x, at_y, at_z});
  };
  near(0.5, -0.3, -0.3);
  near(-0.5, -0.3, -0.3);
  near(0.0, -0.3, 0.5);
  near(0.0, 0.5, 0.0);
  add_triangle(form, 0, 1, 2);
  add_triangle(form, 0, 3, 1);
  add_triangle(form, 1, 3, 2);
  add_triangle(form, 2, 3, 0);
  return form;
}

// Triangles about a common corner that do not close.
Form fan(Chance& chance, double size_m) {
  Form form{.kind = FormKind::kFaces};
  form.points.push_back({0, draw(chance, 0.2 * size_m, 0.6 * size_m), 0});
  const Outline ring{{1, 0}, {0.5F, 0.875F}, {-0.5F, 0.875F}, {-1, 0}, {-0.5F, -0.875F}};
  for (const auto& [x, z] : ring) {
    const float half = float(0.5 * size_m);
    form.points.push_back({half * x, draw(chance, -0.2 * size_m, 0.2 * size_m), half * z});
  }
  for (int i = 1; i < int(ring.size()); ++i) add_triangle(form, 0, i + 1, i);
  return form;
}

// A sheet of three by three points.
Form sheet(double size_m) {
  Form form{.kind = FormKind::kFaces};
  const float half = float(0.5 * size_m);
  for (const float z : {-half, 0.0F, half}) {
    for (const float x : {-half, 0.0F, half}) form.points.push_back({x, 0, z});
  }
  for (const int i : {0, 1, 3, 4}) {
    add_triangle(form, i, i + 3, i + 1);
    add_triangle(form, i + 1, i + 3, i + 4);
  }
  return form;
}

}  // namespace

float draw(Chance& chance, double low, double high) { return float(chance.between(low, high)); }

Form make_form(Chance& chance, double size_m) {
  const auto part = [&](double low, double high) { return draw(chance, low * size_m, high * size_m); };
  switch (chance.below(12)) {
    case 0:
    case 1:
    case 2: {
      const float x = part(0.5, 1.0), y = part(0.3, 1.0), z = part(0.5, 1.0);
      return {.kind = FormKind::kBox, .size = {x, y, z}};
    }
    case 3: {
      const float radius = part(0.25, 0.5), height = part(0.4, 1.0);
      return {.kind = FormKind::kCone, .size = {radius, height, 0}};
    }
    case 4: {
      const float radius = part(0.2, 0.5), height = part(0.3, 1.0);
      return {.kind = FormKind::kCylinder, .size = {radius, height, 0}};
    }
    case 5:
      return {.kind = FormKind::kSphere, .size = {part(0.2, 0.35), 0, 0}};
    case 6:
    case 7: {
      const bool is_l = chance.happens(0.5);
      const float half = part(0.3, 0.5), height = part(0.2, 0.6);
      return over(is_l ? kL : kU, is_l ? kTrianglesOfL : kTrianglesOfU, half, height, true);
    }
    case 8:
      return chance.happens(0.5) ? over(kArrow, kTrianglesOfArrow, part(0.4, 0.6), 0.0F, false)
                                 : over(kU, kTrianglesOfU, part(0.4, 0.6), 0.0F, false);
    case 9: {
      const float x = part(0.5, 1.0), y = part(0.3, 1.0), z = part(0.5, 1.0);
      return open_box(x, y, z);
    }
    case 10:
      return tetrahedron(chance, size_m);
    default:
      return fan(chance, size_m);
  }
}

Form make_bending_form(Chance& chance, double size_m, int clock, double cycle_s) {
  Form form = chance.happens(0.5) ? sheet(size_m) : tetrahedron(chance, size_m);
  const std::size_t segments = 2 + chance.below(3);
  form.bend.clock = clock;
  form.bend.key = make_keys(chance, segments, cycle_s);
  for (std::size_t i = 0; i < segments; ++i) {
    std::vector<Three> points = form.points;
    for (Three& point : points) {
      for (float& at : point) at += draw(chance, -0.17 * size_m, 0.17 * size_m);
    }
    form.bend.value.push_back(points);
  }
  form.bend.value.push_back(form.bend.value.front());
  return form;
}

std::vector<float> make_keys(Chance& chance, std::size_t segments, double cycle_s) {
  // Every segment gets 0.1 s, or what there is, and a part of the rest.
  const double least = std::min(0.1 / cycle_s, 1.0 / double(segments));
  std::vector<double> parts(segments);
  double sum = 0.0;
  for (double& part : parts) sum += part = chance.between(0.3, 1.0);
  std::vector<float> key{0.0F};
  double at = 0.0;
  for (std::size_t i = 0; i + 1 < segments; ++i) {
    at += least + parts[i] / sum * (1.0 - least * double(segments));
    key.push_back(float(at));
  }
  key.push_back(1.0F);
  return key;
}

}  // namespace peerd::living
